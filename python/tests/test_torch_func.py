"""PyTorch layers in the transforms of `torch.func`: one against the other, batches against loops."""

import pytest

import tangency

torch = pytest.importorskip("torch")

import tangency.torch  # noqa: E402
from dragged import SCENE, inputs  # noqa: E402

# PyTorch's own, at the first use of some transforms.
pytestmark = pytest.mark.filterwarnings("ignore:.*torch.jit.*:FutureWarning", "ignore:.*torch.jit.*:DeprecationWarning")

F = torch.func
close = torch.testing.assert_close
V0 = inputs()[1]


def by_numbers(controls, mass):
    """A function of few numbers, for all transforms."""
    q, v = tangency.torch.rollout(SCENE, v0=V0, controls=controls, values={"mass:box": mass})
    return torch.cat([q[-1, 1:].flatten(), v[-1, 1:].flatten()])


def test_jacobians_agree():
    _, _, controls, mass, *_ = inputs()
    reverse = F.jacrev(by_numbers, (0, 1))(controls, mass)
    forward = F.jacfwd(by_numbers, (0, 1))(controls, mass)
    close(reverse, forward, rtol=1e-10, atol=1e-12)
    tangent = F.jvp(by_numbers, (controls, mass), (torch.ones_like(controls), torch.ones_like(mass)))[1]
    close(tangent, reverse[0].sum((1, 2)) + reverse[1], rtol=1e-10, atol=1e-12)


def test_vmap_is_a_batch():
    _, _, controls, mass, *_ = inputs(batch=3)
    rows = [by_numbers(*row) for row in zip(controls, mass, strict=True)]
    close(F.vmap(by_numbers)(controls, mass), torch.stack(rows), rtol=0, atol=0)
    close(F.vmap(by_numbers, (1, 0), 1)(controls.movedim(0, 1), mass), torch.stack(rows, 1), rtol=0, atol=0)
    shared = [by_numbers(row, mass[0]) for row in controls]
    close(F.vmap(by_numbers, (0, None))(controls, mass[0]), torch.stack(shared), rtol=0, atol=0)
    table = F.vmap(F.vmap(by_numbers, (0, None)), (None, 0))(controls, mass)
    close(table[1, 2], by_numbers(controls[2], mass[1]), rtol=0, atol=0)


def test_vmap_of_derivatives():
    _, _, controls, mass, *_ = inputs(batch=3)
    for transform in (F.jacrev, F.jacfwd):
        derivative = transform(by_numbers, (0, 1))
        rows = [derivative(*row) for row in zip(controls, mass, strict=True)]
        found = F.vmap(derivative)(controls, mass)
        close(found, tuple(torch.stack(parts) for parts in zip(*rows, strict=True)), rtol=1e-10, atol=1e-12)
    # The number is shared by the batch within, and so its derivative is a sum; not over the axis of vmap.
    weights = torch.randn(2, 3, 12, dtype=torch.float64, generator=torch.Generator().manual_seed(0))
    batched = F.vmap(by_numbers, (0, None))
    pull = F.vjp(batched, controls, mass[0])[1]
    by_controls, by_mass = F.vmap(pull)(weights)
    for k in range(2):
        close((by_controls[k], by_mass[k]), pull(weights[k]), rtol=1e-10, atol=1e-12)


def test_explicit_batch_within_vmap():
    def within(controls, friction):
        q, _ = tangency.torch.rollout(SCENE, controls=controls, values={"friction:floor": friction})
        return q[:, -1, 1, 0]

    _, _, controls, _, friction, _ = inputs(batch=4)
    found = F.vmap(within, (None, 0))(controls, friction)
    close(found, torch.stack([within(controls, mu) for mu in friction]), rtol=0, atol=0)
    jacobian = F.vmap(F.jacrev(within, 1), (None, 0))(controls, friction)
    close(jacobian, torch.stack([F.jacrev(within, 1)(controls, mu) for mu in friction]), rtol=1e-10, atol=1e-12)
    close(jacobian, F.vmap(F.jacfwd(within, 1), (None, 0))(controls, friction), rtol=1e-10, atol=1e-12)


def test_second_derivatives_are_refused():
    _, _, controls, mass, *_ = inputs()

    def loss(mass):
        return by_numbers(controls, mass).square().sum()

    def double():
        leaf = mass.clone().requires_grad_()
        (g,) = torch.autograd.grad(loss(leaf), leaf, create_graph=True)
        (g.sum() + leaf.sum()).backward()

    second = [double]
    for outer in (F.jacfwd, F.jacrev):
        second += [lambda a=outer, b=inner: a(b(loss))(mass) for inner in (F.jacfwd, F.jacrev)]
    for it in second:
        with pytest.raises(NotImplementedError, match="first derivatives only"):
            it()

"""PyTorch layers: values and derivatives against the NumPy API, closed forms and finite differences."""

import copy
import pickle
import sys
import threading

import numpy as np
import pytest

import tangency

torch = pytest.importorskip("torch")

import tangency.torch  # noqa: E402

# PyTorch's own, at the first use of some transforms.
pytestmark = pytest.mark.filterwarnings("ignore:.*torch.jit.*:FutureWarning", "ignore:.*torch.jit.*:DeprecationWarning")

F = torch.func
close = torch.testing.assert_close


def dragged() -> tangency.Scene:
    """A box that slides on a floor and drags a rod behind it: contact, friction and a joint; one control."""
    floor = tangency.BodyDef("floor", "static", shapes=[tangency.HalfPlane((0, 1))], friction=0.4)
    box = tangency.BodyDef("box", position=(0, 0.1), velocity=(1.5, 0), shapes=[tangency.Rectangle(0.4, 0.2)])
    rod = tangency.BodyDef("rod", position=(-0.5, 0.13), angle=0.2, shapes=[tangency.Capsule((-0.3, 0), (0.3, 0), 0.03)])
    hinge = tangency.JointDef("hinge", ("box", "rod"), tangency.Revolute((-0.2, 0.1)))
    push = tangency.ControlDef("push", "force_x", "box")
    return tangency.Scene(tangency.SceneDef([floor, box, rod], [hinge], controls=[push], dt=0.01, duration=0.2))


SCENE = dragged()
STEPS = 6
NAMES = ("mass:box", "friction:floor", "gravity.y")


def inputs(batch=None, dtype=torch.float64):
    """q0, v0, controls and values near those of the scene, all with a batch or without."""
    random = np.random.default_rng(1)
    q, v, _ = SCENE.initial_state
    shape = () if batch is None else (batch,)

    def near(x, size):
        return torch.tensor(x + size * random.standard_normal((*shape, *np.shape(x))), dtype=dtype)

    # What is pressed into the floor or apart from it touches or not: velocities and forces vary, poses do not.
    moving = np.array([[0.0], [1.0], [1.0]])
    v0 = torch.as_tensor(v + moving * random.standard_normal((*shape, 1, 1)) * [0.1, 0, 0], dtype=dtype)
    q0 = torch.as_tensor(np.broadcast_to(q, (*shape, *q.shape)).copy(), dtype=dtype)
    values = [near(SCENE.value(name), 0.01) for name in NAMES]
    return q0, v0, near(np.zeros((STEPS, 1)), 0.5), *values


def run(q0, v0, controls, *values, **options):
    values = dict(zip(NAMES, values, strict=True))
    return tangency.torch.rollout(SCENE, q0=q0, v0=v0, controls=controls, values=values, **options)


def alone(q0, v0, controls, *values, kappa=None):
    """One run and its gradient, by the NumPy API; the seeds are ones."""
    scene = SCENE.with_values({name: float(value) for name, value in zip(NAMES, values, strict=True)})
    it = tangency.rollout(scene, STEPS, controls, state=(q0, v0))
    it = it if kappa is None else it.smoothed(kappa)
    g = it.gradient(q=np.ones_like(it.q), v=np.ones_like(it.v))
    return it, [g.q0, g.v0, g.controls, *(g[name] for name in NAMES)]


def backward(given, **options):
    leaves = [x.clone().requires_grad_() for x in given]
    q, v = run(*leaves, **options)
    (q.sum() + v.sum()).backward()
    return q, v, [x.grad for x in leaves]


@pytest.mark.parametrize("kappa", [None, 1e-3])
def test_rollout_is_that_of_numpy(kappa):
    given = inputs()
    q, v, gradient = backward(given, kappa=kappa)
    it, expected = alone(*given, kappa=kappa)
    assert np.array_equal(q.detach(), it.q) and np.array_equal(v.detach(), it.v)
    for g, want in zip(gradient, expected, strict=True):
        assert np.array_equal(g, want)


def test_batch_is_a_loop():
    given = inputs(batch=3)
    q, v, gradient = backward(given)
    for k in range(3):
        it, expected = alone(*(x[k] for x in given))
        assert np.array_equal(q[k].detach(), it.q) and np.array_equal(v[k].detach(), it.v)
        for g, want in zip(gradient, expected, strict=True):
            assert np.array_equal(g[k], want)


def test_what_is_shared_gets_the_sum():
    q0, v0, *_ = inputs()
    _, _, controls, mass, friction, gravity = inputs(batch=3)
    given = (q0, v0, controls, mass[0], friction, gravity)
    q, _, gradient = backward(given)
    assert q.shape == (3, STEPS + 1, 3, 3)
    rows = [alone(q0, v0, controls[k], mass[0], friction[k], gravity[k])[1] for k in range(3)]
    for place in (0, 1, 3):
        close(gradient[place], torch.as_tensor(np.sum([row[place] for row in rows], axis=0)))
    assert [g.shape for g in gradient] == [x.shape for x in given]


def test_an_empty_batch():
    leaf = torch.zeros(0, STEPS, 1, requires_grad=True)
    q, _ = tangency.torch.rollout(SCENE, controls=leaf)
    q.sum().backward()
    assert q.shape == (0, STEPS + 1, 3, 3) and leaf.grad.shape == leaf.shape


def test_gradcheck():
    # Controls and numbers, in both modes; finite differences are PyTorch's.
    _, v0, controls, *values = inputs()
    leaves = [x.clone().requires_grad_() for x in (controls, *values)]

    def last(controls, *values):
        q, v = run(None, v0, controls, *values)
        return q[-1], v[-1]

    assert torch.autograd.gradcheck(last, leaves, eps=1e-6, atol=1e-7, rtol=1e-6, check_forward_ad=True)


def test_gradcheck_of_initial_states():
    # In free flight poses vary freely.
    state = SCENE.initial_state
    q0 = torch.tensor(state.q + [0, 1, 0] * (np.arange(3)[:, None] > 0))
    v0 = torch.tensor(state.v)

    def flight(q, v):
        return tangency.torch.rollout(SCENE, 5, q0=torch.cat([q0[:1], q]), v0=torch.cat([v0[:1], v]))

    leaves = [x[1:].clone().requires_grad_() for x in (q0, v0)]
    assert torch.autograd.gradcheck(flight, leaves, check_forward_ad=True)


def test_float32_is_rounded_only_at_the_ends():
    given = inputs()
    q, _, gradient = backward([x.float() for x in given])
    q64, _, gradient64 = backward([x.float().double() for x in given])
    assert q.dtype == torch.float32 and all(g.dtype == torch.float32 for g in gradient)
    close(q, q64.float(), rtol=0, atol=0)
    for g, want in zip(gradient, gradient64, strict=True):
        close(g, want.float(), rtol=0, atol=0)


def test_dtypes():
    def dtype(**values):
        return tangency.torch.rollout(SCENE, 1, values=values)[0].dtype

    single, double = torch.tensor(0.3), torch.tensor(1.0, dtype=torch.float64)
    assert dtype() == torch.float32
    assert dtype(**{"friction:floor": 0.3}) == torch.float32
    assert dtype(**{"friction:floor": single}) == torch.float32
    assert dtype(**{"friction:floor": single, "mass:box": double}) == torch.float64
    assert dtype(**{"friction:floor": torch.tensor(1)}) == torch.float32
    with pytest.raises(TypeError, match="complex"):
        dtype(**{"friction:floor": torch.tensor(1j)})


@pytest.mark.skipif(not torch.cuda.is_available(), reason="there is no other device")
def test_outputs_are_on_the_device_of_the_inputs():
    given = [x.cuda() for x in inputs()]
    q, _, gradient = backward(given)
    assert q.is_cuda and all(g.is_cuda for g in gradient)
    close(q.cpu(), backward(inputs())[0])


def test_only_what_requires_grad():
    _, v0, controls, *values = inputs()
    leaf = controls.clone().requires_grad_()
    q, _ = run(None, v0, leaf, *values)
    q.sum().backward()
    assert v0.grad is None and leaf.grad is not None
    with torch.no_grad():
        assert not run(None, v0, leaf, *values)[0].requires_grad


def test_step_by_step_is_a_rollout():
    q0, v0, controls, *values = inputs(batch=2)
    leaves = [x.clone().requires_grad_() for x in (q0, v0, controls, *values)]
    numbers = dict(zip(NAMES, leaves[3:], strict=True))
    q, v = leaves[:2]
    for k in range(STEPS):
        q, v = tangency.torch.step(SCENE, q, v, leaves[2][:, k], numbers)
    (q.sum() + v.sum()).backward()
    others = [x.clone().requires_grad_() for x in (q0, v0, controls, *values)]
    runs = run(*others)
    close((q, v), tuple(x[:, -1] for x in runs), rtol=1e-12, atol=1e-12)
    (runs[0][:, -1].sum() + runs[1][:, -1].sum()).backward()
    for a, b in zip(leaves, others, strict=True):
        close(a.grad, b.grad, rtol=1e-9, atol=1e-9)


def test_forces_begin_at_their_time():
    ball = tangency.BodyDef("ball", mass=2.0, shapes=[tangency.Circle(0.1)])
    force = tangency.ForceDef("ball", force=(4.0, 0.0), start=1.0)
    scene = tangency.Scene(tangency.SceneDef([ball], forces=[force], gravity=(0, 0), dt=0.1))
    q = torch.zeros(1, 3, dtype=torch.float64)
    for time, speed in [(0.0, 0.0), (1.5, 0.2)]:  # F dt / m
        _, v = tangency.torch.step(scene, q, q, time=time)
        close(v[0, 0].item(), speed)
        close(tangency.torch.step(scene, q.expand(2, 1, 3), q, time=time)[1][1, 0, 0].item(), speed)


# ---- torch.func ------------------------------------------------------------------------------------------------------


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


# ---- errors ----------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("given", "message"),
    [
        ({"q0": torch.zeros(2, 3)}, r"q0 has shape \(2, 3\); give \(bodies, 3\) = \(3, 3\), or \(batch, bodies, 3\)"),
        ({"controls": torch.zeros(5)}, r"controls has shape \(5,\)"),
        ({"steps": 4, "controls": torch.zeros(5, 1)}, r"controls has shape \(5, 1\).*\(4, 1\)"),
        ({"values": {"mass:box": torch.ones(2, 2)}}, r"mass:box has shape \(2, 2\); give \(\), or \(batch,\)"),
        ({"controls": torch.zeros(2, 5, 1), "values": {"mass:box": torch.ones(3)}}, "batch of 3 and controls one of 2"),
        ({"q0": torch.zeros(3, 3), "values": {"position.x:box": 1.0}}, "q0 is given, which replaces it"),
    ],
)
def test_what_does_not_fit(given, message):
    with pytest.raises(ValueError, match=message):
        tangency.torch.rollout(SCENE, **given)


def test_what_is_no_tensor():
    with pytest.raises(TypeError, match="q0 is of type list; give a tensor"):
        tangency.torch.rollout(SCENE, q0=[0.0])


@pytest.mark.parametrize("batch", [(), (2,)])
def test_errors_of_the_engine(batch):
    with pytest.raises(tangency.SceneError, match="positive"):
        tangency.torch.rollout(SCENE, values={"mass:box": torch.full(batch, -1.0)})
    with pytest.raises(tangency.SceneError, match="no body or group"):
        tangency.torch.rollout(SCENE, values={"mass:nobody": torch.full(batch, 1.0)})
    with pytest.raises(tangency.StepError):
        tangency.torch.rollout(SCENE, controls=torch.full((*batch, 3, 1), torch.nan))
    leaf = torch.zeros(*batch, 3, 1, requires_grad=True)
    q, _ = tangency.torch.rollout(SCENE, controls=leaf)
    with pytest.raises(tangency.GradientError):
        (q.sum() * torch.inf).backward()


# ---- modules ---------------------------------------------------------------------------------------------------------


def test_module_has_the_numbers_as_parameters():
    layer = tangency.torch.Rollout(SCENE, STEPS, ["mass:box", "gravity.y"], dtype=torch.float64)
    names = [name for name, _ in layer.named_parameters()]
    assert names == list(layer.state_dict()) == ["mass:box", "gravity/y"]
    assert layer.values()["gravity.y"].item() == -9.81 and "gravity.y" in repr(layer)
    state = {"mass:box": torch.tensor(0.2), "gravity/y": torch.tensor(-4.0)}
    layer.load_state_dict(state)
    assert layer.scene() == SCENE.with_values({"mass:box": layer.values()["mass:box"].item(), "gravity.y": -4.0})
    for other in (copy.deepcopy(layer), pickle.loads(pickle.dumps(layer))):
        close(other(), layer(), rtol=0, atol=0)
    with pytest.raises(tangency.SceneError, match="no body or group"):
        tangency.torch.Rollout(SCENE, learn=["mass:nobody"])
    with pytest.raises(TypeError, match="list of names"):
        tangency.torch.Rollout(SCENE, learn="mass:box")


def test_module_learns_friction():
    # A block stops after v²/(2 μ g).
    floor = tangency.BodyDef("floor", "static", shapes=[tangency.HalfPlane((0, 1))], friction=0.4)
    block = tangency.BodyDef("block", position=(0, 0.1), shapes=[tangency.Rectangle(0.4, 0.2)], friction=0.4)
    scene = tangency.Scene(tangency.SceneDef([floor, block], dt=0.005, duration=1.0))
    layer = tangency.torch.Rollout(scene, learn=["friction:*"])
    v0 = torch.tensor([[0.0, 0, 0], [2.0, 0, 0]])
    optimizer = torch.optim.SGD(layer.parameters(), lr=0.2)
    for _ in range(40):
        optimizer.zero_grad()
        q, _ = layer(v0=v0)
        loss = (q[-1, 1, 0] - 2.0**2 / (2 * 0.5 * 9.81)).square()
        loss.backward()
        optimizer.step()
    assert layer.scene().value("friction:block") == pytest.approx(0.5, abs=0.01)


def test_parameters_may_be_parametrized():
    class Exp(torch.nn.Module):
        def forward(self, x):
            return x.exp()

        def right_inverse(self, x):
            return x.log()

    layer = tangency.torch.Rollout(SCENE, STEPS, ["mass:box"], dtype=torch.float64)
    plain = copy.deepcopy(layer)
    torch.nn.utils.parametrize.register_parametrization(layer, "mass:box", Exp())
    layer()[0].sum().backward()
    plain()[0].sum().backward()
    mass, (log,) = SCENE.value("mass:box"), layer.parameters()
    close(log.grad, mass * plain.values()["mass:box"].grad)


# ---- complementarity problems ----------------------------------------------------------------------------------------


def problems(count, n=5):
    random = np.random.default_rng(3)
    a = random.standard_normal((count, n, n))
    matrix = a @ a.transpose(0, 2, 1) + np.eye(n) + a - a.transpose(0, 2, 1)
    return torch.tensor(matrix), torch.tensor(random.standard_normal((count, n)))


@pytest.mark.parametrize("free", [0, 2])
def test_lcp(free):
    matrix, q = problems(3)

    def solve(matrix, q):
        return tangency.torch.solve_lcp(matrix, q, free)

    z = solve(matrix, q)
    for k in range(3):
        assert np.array_equal(z[k], tangency.solve_lcp(matrix[k], q[k], free=free).z)
        close(solve(matrix[k], q[k]), z[k], rtol=0, atol=0)
    leaves = (matrix.clone().requires_grad_(), q.clone().requires_grad_())
    assert torch.autograd.gradcheck(solve, leaves, check_forward_ad=True)
    shared = (matrix[0].clone().requires_grad_(), q.clone().requires_grad_())
    assert torch.autograd.gradcheck(solve, shared, check_forward_ad=True)


def test_lcp_errors():
    with pytest.raises(ValueError, match=r"matrix has shape \(2, 3\); give \(n, n\) = \(2, 2\)"):
        tangency.torch.solve_lcp(torch.zeros(2, 3), torch.zeros(2))
    with pytest.raises(tangency.SolveError):
        tangency.torch.solve_lcp(torch.tensor([[0.0]]), torch.tensor([-1.0]))


# ---- threads ---------------------------------------------------------------------------------------------------------


def test_the_lock_is_released():
    # With such a switch interval another thread runs only where this one lets go of the lock.
    order, started = [], threading.Event()

    def work():
        started.set()
        tangency.torch.rollout(SCENE, 20_000)
        order.append("end of the run")

    interval = sys.getswitchinterval()
    sys.setswitchinterval(1e6)
    try:
        thread = threading.Thread(target=work)
        thread.start()
        started.wait()
        order.append("meanwhile")
        thread.join()
    finally:
        sys.setswitchinterval(interval)
    assert order == ["meanwhile", "end of the run"]

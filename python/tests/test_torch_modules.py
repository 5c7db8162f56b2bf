"""Modules that learn numbers of scenes, and complementarity problems as layers."""

import copy
import pickle
import runpy
from pathlib import Path

import numpy as np
import pytest

import tangency

torch = pytest.importorskip("torch")

import tangency.torch  # noqa: E402
from dragged import SCENE, STEPS  # noqa: E402

# PyTorch's own, at the first use of some transforms.
pytestmark = pytest.mark.filterwarnings("ignore:.*torch.jit.*:FutureWarning", "ignore:.*torch.jit.*:DeprecationWarning")

close = torch.testing.assert_close


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


def test_the_example_finds_the_mass():
    example = runpy.run_path(str(Path(__file__).parents[2] / "examples" / "python" / "torch_mass.py"))
    losses, masses = example["learn"](100)
    assert masses[0] == pytest.approx(1.4) and masses[-1] == pytest.approx(0.7, abs=0.01)
    assert losses[-1] < 1e-3 * losses[0]


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

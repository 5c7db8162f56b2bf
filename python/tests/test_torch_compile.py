"""PyTorch layers under `torch.compile`: one graph, the same numbers as without."""

import shutil
import sys

import pytest

import tangency

torch = pytest.importorskip("torch")

import tangency.torch  # noqa: E402

# PyTorch's own, while it compiles.
pytestmark = [
    pytest.mark.filterwarnings("ignore::FutureWarning"),
    pytest.mark.filterwarnings("ignore::DeprecationWarning"),
    pytest.mark.filterwarnings("ignore::UserWarning:torch"),
    pytest.mark.skipif(sys.version_info >= (3, 15), reason="torch.compile may lag behind new versions of Python"),
]

F = torch.func
close = torch.testing.assert_close


def pendulum() -> tangency.Scene:
    """A bar on a motor that swings against a wall: joint, contact and friction; one control."""
    bar = tangency.BodyDef("bar", position=(0.5, 1), shapes=[tangency.Capsule((-0.5, 0), (0.5, 0), 0.05)], mass=1.0)
    wall = tangency.BodyDef("wall", "static", shapes=[tangency.HalfPlane((1, 0), -0.4)], restitution=0.5)
    pivot = tangency.JointDef("pivot", ("world", "bar"), tangency.Revolute((0, 1)))
    torque = tangency.ControlDef("torque", "torque", "bar")
    return tangency.Scene(tangency.SceneDef([bar, wall], [pivot], controls=[torque], dt=0.02, duration=1.0))


SCENE = pendulum()
STEPS = 40


def compiled(f, backend="aot_eager", dynamic=None):
    torch.compiler.reset()
    return torch.compile(f, fullgraph=True, backend=backend, dynamic=dynamic)


def loss(controls, mass):
    """With operations around the layer that the compiler fuses."""
    q, v = tangency.torch.rollout(SCENE, controls=torch.tanh(controls), values={"mass:bar": mass.exp()})
    return torch.sin(q[..., -1, 0, 2]).sum() + v.square().mean()


def inputs(*batch, dtype=torch.float64):
    random = torch.Generator().manual_seed(0)
    controls = torch.randn(*batch, STEPS, 1, generator=random, dtype=dtype)
    return controls, 0.1 * torch.randn(batch, generator=random, dtype=dtype)


def gradients(f, given):
    leaves = [x.clone().requires_grad_() for x in given]
    value = f(*leaves)
    value.backward()
    return value.detach(), *(x.grad for x in leaves)


def test_the_wall_is_hit():
    assert any(tangency.rollout(SCENE, STEPS).contacts(k) for k in range(STEPS))


@pytest.mark.parametrize("dtype", [torch.float64, torch.float32])
def test_values_and_gradients(dtype):
    f = compiled(loss)
    for batch in [(), (2,), (3,)]:
        given = inputs(*batch, dtype=dtype)
        close(gradients(f, given), gradients(loss, given))


def test_sizes_may_be_dynamic():
    f = compiled(loss, dynamic=True)
    for size in (2, 5):
        given = inputs(size)
        close(gradients(f, given), gradients(loss, given))


@pytest.mark.skipif(shutil.which("g++") is None and shutil.which("clang++") is None, reason="there is no C++ compiler")
def test_inductor():
    given = inputs(3)
    close(gradients(compiled(loss, "inductor"), given), gradients(loss, given))


def last(controls, mass):
    q, v = tangency.torch.rollout(SCENE, controls=controls, values={"mass:bar": mass})
    return torch.stack([q[-1, 0, 2], v[-1, 0, 2]])


TRANSFORMS = {
    "jacrev": F.jacrev(last, (0, 1)),
    "jacfwd": F.jacfwd(last, 1),
    "vmap": F.vmap(last, (None, 0)),
    "vmap of grad": F.vmap(F.grad(lambda controls, mass: last(controls, mass).sum(), (0, 1)), (None, 0)),
}


@pytest.mark.parametrize("name", TRANSFORMS)
def test_transforms(name):
    transform = TRANSFORMS[name]
    controls, mass = inputs()[0], torch.tensor(1.1, dtype=torch.float64)
    mass = torch.stack([mass, mass + 1]) if name.startswith("vmap") else mass
    close(compiled(transform)(controls, mass), transform(controls, mass), rtol=1e-11, atol=1e-11)


def test_scenes_and_steps_are_told_apart():
    def run(scene, steps, mass):
        return tangency.torch.rollout(scene, steps, values={"mass:bar": mass})

    f = compiled(run)
    mass = torch.tensor(1.5, dtype=torch.float64)
    other = SCENE.with_values({"gravity.y": -1.0})
    for scene in (SCENE, other, SCENE):
        for steps in (3, 4):
            close(f(scene, steps, mass), run(scene, steps, mass), rtol=0, atol=0)


def test_modules_and_steps():
    layer = tangency.torch.Rollout(SCENE, STEPS, ["mass:bar"], dtype=torch.float64)
    close(compiled(layer)(), layer(), rtol=0, atol=0)
    state = tuple(torch.as_tensor(x) for x in SCENE.initial_state[:2])

    def step(q, v, time):
        return tangency.torch.step(SCENE, q, v, time=time)

    f = compiled(step)
    for time in (0.0, 0.5, 1.0):
        close(f(*state, time), step(*state, time), rtol=0, atol=0)


def test_lcp():
    def solve(matrix, q):
        return tangency.torch.solve_lcp(matrix, q).square().sum()

    given = torch.eye(3, dtype=torch.float64) * 2 + 0.5, torch.tensor([[-1.0, 1, -2], [1, 1, -1]], dtype=torch.float64)
    close(gradients(compiled(solve), given), gradients(solve, given))


def test_errors_of_the_engine():
    f = compiled(lambda mass: tangency.torch.rollout(SCENE, 3, values={"mass:bar": mass}))
    with pytest.raises(tangency.SceneError, match="positive"):
        f(torch.tensor(-1.0))


def test_operators():
    map = tangency.torch.maps.RolloutMap(SCENE, 3, ("controls", "mass:bar"))
    given = [torch.zeros(2, 3, 1, dtype=torch.float64), torch.tensor(1.0, dtype=torch.float64)]
    bars = [torch.ones(2, 4, 2, 3, dtype=torch.float64)] * 2
    # None of them has an autograd rule.
    tests = ("test_schema", "test_faketensor")
    torch.library.opcheck(tangency.torch.operators.value, (given, map.text), test_utils=tests)
    torch.library.opcheck(tangency.torch.operators.pullback, (given, bars, map.text), test_utils=tests)
    torch.library.opcheck(tangency.torch.operators.pushforward, (given, given, map.text), test_utils=tests)

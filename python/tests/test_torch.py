"""PyTorch layers: values and derivatives against the NumPy API, closed forms and finite differences."""

import sys
import threading

import numpy as np
import pytest

import tangency

torch = pytest.importorskip("torch")

import tangency.torch  # noqa: E402
from dragged import NAMES, SCENE, STEPS, inputs  # noqa: E402

# PyTorch's own, at the first use of some transforms.
pytestmark = pytest.mark.filterwarnings("ignore:.*torch.jit.*:FutureWarning", "ignore:.*torch.jit.*:DeprecationWarning")

close = torch.testing.assert_close


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


def test_two_names_of_one_number_are_refused() -> None:
    scene = tangency.Scene(tangency.SceneDef([tangency.BodyDef("ball", shapes=[tangency.Circle(0.1)])]))
    values = {"mass:ball": torch.tensor(1.0), "mass:*": torch.tensor(2.0)}
    with pytest.raises(ValueError, match="same number"):
        tangency.torch.rollout(scene, 1, values=values)

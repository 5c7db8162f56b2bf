"""Runs and steps as functions of JAX: against the NumPy API, finite differences, and themselves."""

from concurrent.futures import ThreadPoolExecutor

import numpy as np
import pytest

import tangency

jax = pytest.importorskip("jax")
import jax.numpy as jnp  # noqa: E402
from jax.test_util import check_grads  # noqa: E402

import tangency.jax as tj  # noqa: E402

STEPS = 30
NAMES = ["friction:box", "mass:box", "gravity.y", "anchor_b.y:hinge"]


@pytest.fixture(autouse=True)
def float64():
    jax.config.update("jax_enable_x64", True)
    yield
    jax.config.update("jax_enable_x64", False)


@pytest.fixture(scope="module")
def scene():
    """A box slides over a floor and carries a pendulum; a ball falls onto the floor beside it."""
    return tangency.Scene(
        tangency.SceneDef(
            bodies=[
                tangency.BodyDef("floor", "static", shapes=[tangency.HalfPlane((0, 1))], restitution=0.6),
                tangency.BodyDef(
                    "box",
                    position=(0, 0.25),
                    velocity=(3, 0),
                    shapes=[tangency.Rectangle(1, 0.5)],
                    mass=2,
                    friction=0.3,
                ),
                tangency.BodyDef(
                    "rod", position=(0.3, 1), angle=0.4, shapes=[tangency.Rectangle(0.1, 0.8)], mass=0.5, mask=0
                ),
                tangency.BodyDef("ball", position=(-2, 0.4), velocity=(1, 0), shapes=[tangency.Circle(0.1)], mass=0.3),
            ],
            joints=[tangency.JointDef("hinge", ("box", "rod"), tangency.Revolute((0.1, 0.6)))],
            controls=[
                tangency.ControlDef("push", "force_x", "box"),
                tangency.ControlDef("twist", "torque", "rod"),
            ],
            dt=0.01,
        )
    )


@pytest.fixture(scope="module")
def point(scene):
    """Everything a run depends on, away from where it was built."""
    rng = np.random.default_rng(1)
    q, v, _ = scene.initial_state
    moving = np.array([0, 1, 1, 1])[:, None]
    return {
        "q0": q.copy(),
        "v0": v + 0.05 * moving * rng.standard_normal(v.shape),
        "controls": rng.standard_normal((STEPS, 2)),
        "values": {"friction:box": 0.35, "mass:box": 1.8, "gravity.y": -9.5, "anchor_b.y:hinge": -0.4},
    }


@pytest.fixture(scope="module")
def plain(scene, point):
    """The same run of the NumPy API."""
    it = scene.with_values(point["values"])
    return tangency.rollout(it, STEPS, point["controls"], state=(point["q0"], point["v0"]))


@pytest.fixture(scope="module")
def weights(scene):
    return np.random.default_rng(2).standard_normal((2, STEPS + 1, len(scene.bodies), 3))


def run(scene, point):
    return jnp.stack(tj.rollout(scene, **point))


def loss_of(scene, weights):
    return lambda point: jnp.sum(run(scene, point) * weights)


def close(found, wanted, tolerance):
    for (path, a), b in zip(jax.tree_util.tree_leaves_with_path(found), jax.tree.leaves(wanted), strict=True):
        scale = max(1.0, np.abs(b).max(initial=0))
        np.testing.assert_allclose(a, b, rtol=0, atol=tolerance * scale, err_msg=str(path))


def batch_of(point, count):
    """Points side by side, all different."""
    return jax.tree.map(lambda x: np.stack([np.asarray(x) * (1 + 0.01 * k) for k in range(count)]), point)


def at(batch, k):
    return jax.tree.map(lambda x: x[k], batch)


@pytest.mark.parametrize("jit", [False, True])
def test_values_have_the_bits_of_the_numpy_api(scene, point, plain, jit):
    q, v = (jax.jit(tj.rollout, static_argnums=0) if jit else tj.rollout)(scene, **point)
    assert q.dtype == np.float64
    assert np.array_equal(q, plain.q)
    assert np.array_equal(v, plain.v)


@pytest.mark.parametrize("jit", [False, True])
def test_gradients_are_those_of_the_numpy_api(scene, point, plain, weights, jit):
    wanted = plain.gradient(*weights, wrt=NAMES)
    loss = jax.value_and_grad(loss_of(scene, weights))
    value, found = (jax.jit(loss) if jit else loss)(point)
    np.testing.assert_allclose(value, np.sum([plain.q, plain.v] * weights), rtol=1e-13)
    close(found["q0"], wanted.q0, 1e-12)
    close(found["v0"], wanted.v0, 1e-12)
    close(found["controls"], wanted.controls, 1e-12)
    close(found["values"], wanted.values, 1e-12)


def test_tangents_are_those_of_the_numpy_api(scene, point, plain):
    rng = np.random.default_rng(3)
    along = jax.tree.map(lambda x: rng.standard_normal(np.shape(x)), point)
    wanted = plain.tangent(**along)
    _, found = jax.jvp(lambda point: run(scene, point), (point,), (along,))
    close(found, jnp.stack(wanted), 1e-12)


def test_derivatives_are_finite_differences(scene, point):
    def motion(v0, controls, values):
        return run(scene, {"v0": v0, "controls": controls, "values": values})

    args = (point["v0"], point["controls"], point["values"])
    check_grads(motion, args, order=1, modes=("fwd", "rev"), atol=2e-6, rtol=2e-6, eps=1e-6)


def test_what_is_not_given_is_that_of_the_scene(scene):
    named = {"position.y:ball": 0.5, "velocity.x:box": 2.0}
    wanted = tangency.rollout(scene.with_values(named), 20)
    q, v = tj.rollout(scene, 20, values=named)
    assert np.array_equal(q, wanted.q)
    assert np.array_equal(v, wanted.v)
    assert tj.rollout(scene)[0].shape == (scene.steps + 1, 4, 3)

    gradient = wanted.gradient(q=wanted.q, wrt=list(named))
    found = jax.grad(lambda values: 0.5 * jnp.sum(tj.rollout(scene, 20, values=values)[0] ** 2))(named)
    close(found, gradient.values, 1e-12)


def test_forward_and_reverse_agree(scene, point):
    def end(point):
        return run(scene, point)[:, -1]

    close(jax.jacfwd(end)(point), jax.jacrev(end)(point), 1e-10)


def test_smoothed_derivatives_are_those_of_the_numpy_api(scene, point, plain, weights):
    wanted = plain.smoothed(1e-3).gradient(*weights, wrt=NAMES)
    found = jax.grad(lambda p: jnp.sum(jnp.stack(tj.rollout(scene, **p, kappa=1e-3)) * weights))(point)
    close(found["values"], wanted.values, 1e-12)
    assert abs(wanted["friction:box"] - plain.gradient(*weights)["friction:box"]) > 1e-6


def test_batches_are_loops(scene, point, weights):
    batch = batch_of(point, 3)
    loss = loss_of(scene, weights)
    assert np.array_equal(
        jax.vmap(lambda p: run(scene, p))(batch), np.stack([run(scene, at(batch, k)) for k in range(3)])
    )
    loop = [jax.grad(loss)(at(batch, k)) for k in range(3)]
    wanted = jax.tree.map(lambda *parts: np.stack(parts), *loop)
    close(jax.vmap(jax.grad(loss))(batch), wanted, 1e-13)
    close(jax.jit(jax.vmap(jax.grad(loss)))(batch), wanted, 1e-13)
    close(jax.grad(lambda batch: jnp.sum(jax.vmap(loss)(batch)))(batch), wanted, 1e-13)


def test_batches_of_batches(scene, point, weights):
    loss = loss_of(scene, weights)
    batch = batch_of(point, 4)
    grid = jax.tree.map(lambda x: x.reshape(2, 2, *x.shape[1:]), batch)
    flat = jax.vmap(jax.grad(loss))(batch)
    found = jax.jit(jax.vmap(jax.vmap(jax.grad(loss))))(grid)
    close(jax.tree.map(lambda x: x.reshape(4, *x.shape[2:]), found), flat, 1e-13)


def test_what_a_batch_shares_gets_the_sum(scene, point):
    def end(friction, speed):
        q, _ = tj.rollout(scene, STEPS, v0=point["v0"].at[1, 0].set(speed), values={"friction:box": friction})
        return q[-1, 1, 0]

    point = {"v0": jnp.asarray(point["v0"])}
    speeds = jnp.array([2.0, 3.0, 4.0])
    found = jax.grad(lambda friction: jnp.sum(jax.vmap(end, (None, 0))(friction, speeds)))(0.3)
    np.testing.assert_allclose(found, sum(jax.grad(end)(0.3, speed) for speed in speeds), rtol=1e-12)


def test_jacobians_of_a_batch(scene, point):
    def end(controls):
        return tj.rollout(scene, controls=controls)[0][-1, 1]

    batch = jnp.stack([jnp.zeros((5, 2)), jnp.asarray(point["controls"][:5])])
    forward, reverse = jax.vmap(jax.jacfwd(end))(batch), jax.jit(jax.vmap(jax.jacrev(end)))(batch)
    assert forward.shape == (2, 3, 5, 2)
    close(forward, reverse, 1e-10)
    close(forward, np.stack([jax.jacfwd(end)(controls) for controls in batch]), 1e-13)


def test_steps_make_a_run(scene, point, weights):
    def steps(point):
        def one(state, control):
            after = tj.step(scene, *state, control, point["values"])
            return after, after

        start = (point["q0"], point["v0"])
        _, states = jax.lax.scan(one, start, point["controls"])
        return jnp.stack([jnp.concatenate([first[None], rest]) for first, rest in zip(start, states, strict=True)])

    point = jax.tree.map(jnp.asarray, point)
    close(steps(point), run(scene, point), 1e-12)
    found = jax.jit(jax.grad(lambda point: jnp.sum(steps(point) * weights)))(point)
    close(found, jax.grad(loss_of(scene, weights))(point), 1e-9)


def test_timed_forces_begin_with_their_time():
    ball = tangency.BodyDef("ball", shapes=[tangency.Circle(0.1)], mass=2)
    force = tangency.ForceDef("ball", (4, 0), start=1.0)
    scene = tangency.Scene(tangency.SceneDef([ball], forces=[force], gravity=(0, 0), dt=0.5))
    q, v, _ = scene.initial_state
    assert tj.step(scene, q, v)[1][0, 0] == 0.0
    assert tj.step(scene, q, v, time=1.0)[1][0, 0] == 1.0


def test_single_precision(scene, point, weights):
    exact = jax.grad(loss_of(scene, weights))(point)
    jax.config.update("jax_enable_x64", False)
    assert run(scene, point).dtype == np.float32
    found = jax.jit(jax.grad(loss_of(scene, weights)))(point)
    assert {leaf.dtype for leaf in jax.tree.leaves(found)} == {np.dtype(np.float32)}
    close(found, exact, 1e-4)


def test_single_precision_beside_double(scene, point):
    v0 = point["v0"].astype(np.float32)
    assert tj.rollout(scene, 3, v0=v0)[0].dtype == np.float32
    assert tj.rollout(scene, 3, v0=v0, q0=point["q0"])[0].dtype == np.float64


class Counted:
    """Counts the runs of the engine."""

    def __init__(self, monkeypatch):
        self.sizes = []
        monkeypatch.setattr("tangency.jax.runs.Batch", self)

    def __call__(self, scene, count, **settings):
        self.sizes.append(count)
        return tangency.Batch(scene, count, **settings)


def test_a_value_and_its_gradient_are_one_run_and_a_batch_one_call(scene, point, monkeypatch):
    loss = jax.jit(jax.value_and_grad(lambda v0: jnp.sum(tj.rollout(scene, 7, v0=v0)[0] ** 2)))
    batch = jnp.stack([point["v0"] + 0.25, point["v0"] + 0.5])
    counted = Counted(monkeypatch)
    kept = loss(point["v0"] + 0.125), jax.vmap(loss)(batch)
    jax.block_until_ready(kept)
    assert counted.sizes == [1, 2]
    tj.keep_tapes(0)
    try:
        again = loss(point["v0"] + 0.125), jax.vmap(loss)(batch)
        jax.block_until_ready(again)
    finally:
        tj.keep_tapes(1 << 18)
    assert counted.sizes == [1, 2, 1, 1, 2, 2]
    assert jax.tree.all(jax.tree.map(np.array_equal, kept, again))


def test_threads(scene, point, weights):
    gradient = jax.jit(jax.grad(loss_of(scene, weights)))
    points = [at(batch_of(point, 4), k) for k in range(4)] * 3
    with ThreadPoolExecutor(4) as pool:
        found = list(pool.map(gradient, points))
    for k, each in enumerate(found):
        close(each, gradient(points[k]), 1e-13)


def test_second_derivatives_are_refused(scene):
    def end(friction):
        return tj.rollout(scene, 5, values={"friction:box": friction})[0][-1, 1, 0]

    for second in [jax.hessian(end), jax.jit(jax.grad(jax.grad(end)))]:
        with pytest.raises(NotImplementedError, match="first derivatives only"):
            second(0.3)


def test_what_does_not_fit_is_refused(scene, point):
    q0, v0 = point["q0"], point["v0"]
    cases = [
        (lambda: tj.rollout(scene, q0=q0[:2]), r"q0 has shape \(2, 3\); give \(bodies, 3\) = \(4, 3\)"),
        (lambda: tj.rollout(scene, 4, controls=np.zeros((5, 2))), r"controls has shape \(5, 2\); give .* = \(4, 2\)"),
        (lambda: tj.rollout(scene, controls=1.0), r"controls has shape \(\)"),
        (lambda: tj.rollout(scene, values={"mass:box": [1.0]}), r"mass:box has shape \(1,\); give a scalar"),
        (lambda: tj.rollout(scene, values={"mass:bx": 1.0}), 'no body or group "bx"'),
        (lambda: tj.rollout(scene, q0=q0, values={"position.x:box": 1.0}), "values has 'position.x:box'"),
        (lambda: tj.rollout(scene, v0=v0, values={"velocity.x:box": 1.0}), "values has 'velocity.x:box'"),
        (lambda: tj.rollout(scene, values={"mass:box": 1.0, "inertia:box": 1.0}), "set the same number"),
        (lambda: tj.rollout(scene, values={"friction:*": 1.0, "friction:rod": 1.0}), "set the same number"),
        (lambda: tj.rollout(scene, v0=v0 * 1j), "v0 is complex"),
        (lambda: tj.step(scene, q0, v0[:1]), r"v has shape \(1, 3\)"),
        (lambda: tj.step(scene, q0, v0, np.zeros(3)), r"control has shape \(3,\); give \(channels,\) = \(2,\)"),
        (lambda: tj.keep_tapes(-1), "body_steps is -1"),
    ]
    for call, message in cases:
        with pytest.raises(ValueError, match=message):
            call()


def test_errors_of_the_engine_come_through(scene):
    def end(mass):
        return tj.rollout(scene, 5, values={"mass:box": mass})[0][-1]

    with pytest.raises(tangency.SceneError, match=r"Mass\(1\) is -1"):
        end(-1.0)
    with pytest.raises(jax.errors.JaxRuntimeError, match=r'SceneError: "mass:box": Mass\(1\) is -1'):
        jax.block_until_ready(jax.jit(end)(-1.0))

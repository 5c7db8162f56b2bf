"""Reverse mode against forward mode, both against finite differences and closed forms."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt
import pytest

import tangency as tg

G = 9.81
Array = npt.NDArray[np.float64]


def resting(mass: float = 2.0, dt: float = 0.01, kick: float = 0.0) -> tg.Scene:
    """A box on a floor with μ = 0.5, and a channel that pushes it."""
    floor = tg.BodyDef("floor", "static", shapes=[tg.HalfPlane((0, 1))])
    box = tg.BodyDef("box", position=(0, 0.1), velocity=(kick, 0), shapes=[tg.Rectangle(0.4, 0.2)], mass=mass)
    return tg.Scene(tg.SceneDef([floor, box], controls=[tg.ControlDef("push", "force_x", "box")], dt=dt))


CASES = {
    "chain_and_ball": ["mass:links", "restitution:*", "gravity.y"],
    "incline": ["friction:*", "gravity.x"],
    "cartpole": ["mass:cart", "mass:pole", "dt"],
    "newtons_cradle": ["mass:*"],
    "billiards": ["friction:*", "restitution:*"],
}


@pytest.mark.parametrize("name", CASES)
@pytest.mark.parametrize("kappa", [None, 1e-3])
def test_both_modes_give_the_same_number(scenes: Path, name: str, kappa: float | None) -> None:
    """⟨L̄, J d⟩ = ⟨Jᵀ L̄, d⟩ for random directions d and seeds L̄ at every state."""
    random = np.random.default_rng(1)
    scene = tg.Scene.load(scenes / f"{name}.toml")
    names = CASES[name]
    steps, n, m = 40, len(scene.bodies), len(scene.controls)
    run = tg.rollout(scene, controls=random.normal(size=(steps, m)))
    run = run if kappa is None else run.smoothed(kappa)
    assert run.kappa == kappa
    bar_q, bar_v = random.normal(size=(2, steps + 1, n, 3))
    dq0, dv0 = random.normal(size=(2, n, 3))
    du, rates = random.normal(size=(steps, m)), dict(zip(names, random.normal(size=len(names))))
    gradient = run.gradient(bar_q, bar_v, wrt=names)
    dq, dv = run.tangent(q0=dq0, v0=dv0, controls=du, values=rates)
    terms = np.concatenate([(bar_q * dq).ravel(), (bar_v * dv).ravel()])
    backward = (gradient.q0 * dq0).sum() + (gradient.v0 * dv0).sum() + (gradient.controls * du).sum()
    backward += sum(gradient.values[name] * rate for name, rate in rates.items())
    assert backward == pytest.approx(terms.sum(), abs=1e-12 * np.abs(terms).sum())
    assert all(gradient[name] == gradient.values[name] for name in names)


def central(loss: Any, x: float, h: float) -> float:
    """A central difference."""
    return float((loss(x + h) - loss(x - h)) / (2 * h))


def test_against_finite_differences(scenes: Path) -> None:
    scene = tg.Scene.load(scenes / "cartpole.toml")
    q0, v0, _ = scene.initial_state
    u = np.sin(np.arange(50.0))[:, None]
    seed = np.array([[1.0, 0.0, 0.5], [0.3, -0.2, 2.0]])

    def loss(scene: tg.Scene = scene, q: Array = q0, v: Array = v0, u: Array = u) -> float:
        last = tg.rollout(scene, controls=u, state=(q, v)).last
        return float((seed * last.q).sum() + (seed * last.v).sum())

    gradient = tg.rollout(scene, controls=u).gradient(seed, seed, wrt=["mass:pole", "gravity.y"])
    for name in ("mass:pole", "gravity.y"):
        value = scene.value(name)
        found = central(lambda x, name=name: loss(scene.with_values({name: x})), value, 1e-5)
        assert gradient.values[name] == pytest.approx(found, rel=1e-6, abs=1e-8)
    one = np.zeros_like(q0)
    one[1, 2] = 1.0
    assert gradient.v0[1, 2] == pytest.approx(central(lambda h: loss(v=v0 + h * one), 0, 1e-5), rel=1e-6)
    # Where the cart begins does not matter to angles, and moves both bodies along.
    along = np.zeros_like(q0)
    along[:, 0] = 1.0
    assert (gradient.q0 * along).sum() == pytest.approx(central(lambda h: loss(q=q0 + h * along), 0, 1e-4), rel=1e-6)
    step = np.zeros_like(u)
    step[20] = 1.0
    assert gradient.controls[20, 0] == pytest.approx(central(lambda h: loss(u=u + h * step), 0, 1e-4), rel=1e-6)


def test_losses_may_see_impulses() -> None:
    """What the floor gives to a resting box in a step is m g dt, so its derivatives are g dt, −m dt and m g."""
    scene = resting()
    run = tg.rollout(scene, 3)
    normal = [impulse for impulse in run.impulses(1) if impulse.kind == "normal"]
    assert {impulse.source for impulse in normal} <= {"contact floor/box", "contact box/floor"}
    assert sum(impulse.value for impulse in normal) == pytest.approx(2 * G * 0.01, rel=1e-10)
    assert all((impulse.step, impulse.part) == (1, None) for impulse in normal)
    gradient = run.gradient(impulses=[(impulse, 1.0) for impulse in normal], wrt=["mass:box", "gravity.y"])
    assert gradient.values["mass:box"] == pytest.approx(G * 0.01, rel=1e-8)
    assert gradient.values["gravity.y"] == pytest.approx(-2 * 0.01, rel=1e-8)


def test_derivatives_of_a_step_are_those_of_the_run(scenes: Path) -> None:
    """A dx + B du + P dp of one step, against forward mode through it."""
    random = np.random.default_rng(2)
    scene = tg.Scene.load(scenes / "cartpole.toml")
    run = tg.rollout(scene, controls=[[1.0], [2.0], [3.0]])
    found = run.step_jacobian(2, wrt=["mass:pole", "gravity.y"])
    assert (found.state.shape, found.control.shape, found.parameters.shape) == ((12, 12), (12, 1), (12, 2))
    assert found.wrt == ["mass:pole", "gravity.y"]
    assert found.is_smooth
    single = tg.rollout(scene, controls=[[3.0]], state=run.state(2))
    dq0, dv0 = random.normal(size=(2, 2, 3))
    dq, dv = single.tangent(q0=dq0, v0=dv0, controls=[[0.7]], values={"mass:pole": -0.3, "gravity.y": 0.2})
    change = found.state @ np.concatenate([dq0.ravel(), dv0.ravel()])
    change += found.control @ [0.7] + found.parameters @ [-0.3, 0.2]
    np.testing.assert_allclose(change, np.concatenate([dq[1].ravel(), dv[1].ravel()]), rtol=1e-9, atol=1e-9)


def test_smoothed_where_friction_holds() -> None:
    """Exactly, a push that friction holds moves nothing; smoothed, it moves less than without friction."""
    scene = resting()
    run = tg.rollout(scene, controls=np.full((10, 1), 3.0))
    seed = [[0, 0, 0], [1, 0, 0]]
    np.testing.assert_allclose(run.gradient(seed).controls, 0, atol=1e-12)
    smoothed = run.smoothed(1e-2)
    assert smoothed.q.tobytes() == run.q.tobytes()
    by_push = smoothed.gradient(seed).controls[:, 0]
    free = np.arange(10, 0, -1) * 0.01**2 / 2.0  # of the k-th push without friction: (T − k) dt² / m
    assert (by_push > 1e-3 * free).all()
    assert (by_push < free).all()


def test_smoothed_tends_to_exact() -> None:
    scene = resting(kick=2.0)
    run = tg.rollout(scene, 10)
    seed = [[0, 0, 0], [1, 0, 0]]
    exact = run.gradient(seed, wrt=["friction:*"]).values["friction:*"]
    # Sliding all the way: x(T) = … − ½ T (T + 1) dt² μ g
    assert exact == pytest.approx(-55 * 0.01**2 * G, rel=1e-8)
    errors = [abs(run.smoothed(kappa).gradient(seed)["friction:*"] - exact) for kappa in (1e-2, 1e-5, 1e-8)]
    assert errors[2] < errors[1] < errors[0]
    assert errors[2] < 1e-4 * abs(exact)


def test_report_of_a_smooth_run_and_of_a_switch() -> None:
    sliding = tg.rollout(resting(kick=2.0), 5).gradient(q=[[0, 0, 0], [1, 0, 0]])
    assert sliding.report.is_smooth
    assert sliding.report.growth.shape == (6,)
    free = tg.BodyDef("free", position=(0, 0.1), velocity=(0, 0), shapes=[tg.Circle(0.1)])
    floor = tg.BodyDef("floor", "static", shapes=[tg.HalfPlane((0, 1))])
    # Touching without weight: the contact is between open and closed.
    scene = tg.Scene(tg.SceneDef([floor, free], gravity=(0, 0)))
    report = tg.rollout(scene, 1).gradient(q=[[0, 0, 0], [0, 1, 0]]).report
    assert not report.is_smooth
    step, source, row, between = report.one_sided[0]
    assert (step, row, between) == (0, "normal", "touching")
    assert source in ("contact floor/free", "contact free/floor")


def test_gradient_by_time_and_shapes(scenes: Path) -> None:
    scene = tg.Scene.load(scenes / "cartpole.toml")
    gradient = tg.rollout(scene, 8).gradient()
    assert (gradient.q0.shape, gradient.v0.shape, gradient.controls.shape) == ((2, 3), (2, 3), (8, 1))
    assert gradient.time0 == 0.0
    assert gradient.values == {}


def test_forces_that_begin_depend_on_the_time() -> None:
    """A force from t₁ on gives F (T − t₁ + t₀)/m; with accurate steps dv/dt₀ = F/m."""
    body = tg.BodyDef("a", mass=2.0, inertia=1.0)
    push = tg.ForceDef("a", (6.0, 0.0), start=0.055)
    scene = tg.Scene(tg.SceneDef([body], forces=[push], dt=0.01, stepping={"accurate": {}}))
    run = tg.rollout(scene, 10)
    assert run.v[-1, 0, 0] == pytest.approx(3 * 0.045, abs=1e-12)
    assert run.gradient(v=[[1, 0, 0]]).time0 == pytest.approx(3.0, abs=1e-9)

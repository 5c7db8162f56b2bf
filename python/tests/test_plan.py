"""Plans against the closed form of Riccati, with costs and dynamics of all kinds."""

from __future__ import annotations

from typing import Any

import numpy as np
import numpy.typing as npt
import pytest

import tangency as tg

Array = npt.NDArray[np.float64]
DT, T = 0.1, 25
A = np.array([[1.0, DT], [0.0, 1.0]])
B = np.array([[DT * DT], [DT]])


class DoubleIntegrator:
    """v⁺ = v + dt u, x⁺ = x + dt v⁺."""

    states = 2
    controls = 1

    def step(self, x: Array, u: Array) -> Array:
        return A @ x + B @ u

    def linearise(self, x: Array, u: Array) -> tuple[Array, Array]:
        return A, B


class Effort:
    """½ r u² and in the end ½ w |x|², in Python."""

    def __init__(self, r: float, w: float) -> None:
        self.r, self.w = r, w

    def running(self, k: int, x: Array, u: Array) -> float:
        return float(0.5 * self.r * u @ u)

    def running_expansion(self, k: int, x: Array, u: Array) -> tuple[Array, Array, Array, Array, Array]:
        n, m = len(x), len(u)
        return np.zeros(n), self.r * u, np.zeros((n, n)), np.zeros((m, n)), self.r * np.eye(m)

    def last(self, x: Array) -> float:
        return float(0.5 * self.w * x @ x)

    def last_expansion(self, x: Array) -> tuple[Array, Array]:
        return self.w * x, self.w * np.eye(len(x))


def quadratic(r: float, w: float, places: list[int], states: int) -> tg.Quadratic:
    cost = tg.Quadratic.of_effort(states, 1, r)
    for place in places:
        cost.aim(place, 0.0, 0.0, w)
    return cost


def riccati(r: float, w: float) -> tuple[list[Array], Array]:
    """Gains of the optimal feedback u = K x, and the matrix V of the cost ½ xᵀ V x from the start."""
    value = w * np.eye(2)
    gains: list[Array] = []
    for _ in range(T):
        gain = -np.linalg.solve(r * np.eye(1) + B.T @ value @ B, B.T @ value @ A)
        value = A.T @ value @ (A + B @ gain)
        gains.insert(0, gain)
    return gains, value


def follow(gains: list[Array], x: Array) -> tuple[Array, Array]:
    controls, states = [], [x]
    for gain in gains:
        controls.append(gain @ states[-1])
        states.append(A @ states[-1] + B @ controls[-1])
    return np.array(controls), np.array(states)


START = np.array([1.0, 0.5])


@pytest.mark.parametrize("cost", [quadratic(0.1, 10.0, [0, 1], 2), Effort(0.1, 10.0)])
def test_dynamics_in_python(cost: Any) -> None:
    gains, value = riccati(0.1, 10.0)
    controls, states = follow(gains, START)
    plan = tg.plan(DoubleIntegrator(), cost, np.zeros((T, 1)), state=START)
    np.testing.assert_allclose(plan.controls, controls, atol=1e-8)
    np.testing.assert_allclose(plan.states, states, atol=1e-8)
    np.testing.assert_allclose(plan.gains, np.array(gains), atol=1e-7)
    assert plan.cost == pytest.approx(0.5 * START @ value @ START, rel=1e-10)
    assert plan.ending == "optimal"
    assert plan.history[-1] == plan.cost
    assert len(plan.history) <= plan.iterations + 1


def test_a_scene() -> None:
    """A body of 2 kg with a force along x: the same motion with u = F/2, so R is a quarter."""
    body = tg.BodyDef("a", position=(1, 0), velocity=(0.5, 0), mass=2, inertia=1)
    push = tg.ControlDef("push", "force_x", "a")
    scene = tg.Scene(tg.SceneDef([body], controls=[push], gravity=(0, 0), dt=DT))
    plan = tg.plan(scene, quadratic(0.1 / 4, 10.0, [0, 3], 6), np.zeros((T, 1)))
    controls, states = follow(riccati(0.1, 10.0)[0], START)
    np.testing.assert_allclose(plan.controls, 2 * controls, atol=1e-7)
    np.testing.assert_allclose(plan.states[:, [0, 3]], states, atol=1e-7)
    run = tg.rollout(scene, controls=plan.controls)
    np.testing.assert_allclose(scene.coordinates(run.last), plan.states[-1], atol=1e-12)
    # Feedback keeps to the plan after a disturbance.
    x = plan.states[3] + [0.01, 0, 0, 0, 0, 0]
    np.testing.assert_allclose(plan.feedback(3, x), plan.controls[3] + plan.gains[3] @ (x - plan.states[3]))


def test_limits_hold() -> None:
    plan = tg.plan(DoubleIntegrator(), Effort(0.1, 10.0), np.zeros((T, 1)), state=START, lower=-0.75, upper=[0.25])
    assert plan.controls.min() == -0.75
    assert plan.controls.max() <= 0.25
    assert (plan.gains[plan.controls[:, 0] == -0.75] == 0).all()
    assert plan.feedback(0, START + 100).tolist() == [-0.75]


@pytest.mark.parametrize("broken", ["running", "running_expansion", "last", "last_expansion", "step", "linearise"])
def test_what_callbacks_raise_comes_out(broken: str) -> None:
    def fail(*_: Any) -> Any:
        raise LookupError(f"no {broken}")

    dynamics, cost = DoubleIntegrator(), Effort(0.1, 10.0)
    setattr(dynamics if hasattr(dynamics, broken) else cost, broken, fail)
    with pytest.raises(LookupError, match=f"no {broken}"):
        tg.plan(dynamics, cost, np.zeros((T, 1)), state=START)


@pytest.mark.parametrize(
    ("method", "answer", "message"),
    [
        ("step", np.zeros(3), r"the state after `step` has shape \(3,\); give \(states,\) = \(2,\)"),
        ("linearise", (np.zeros((2, 3)), B), r"A of `linearise` has shape \(2, 3\); give \(states, states\)"),
        ("linearise", (A, np.zeros(2)), r"B of `linearise` has shape \(2,\); give \(states, controls\) = \(2, 1\)"),
        ("running_expansion", (np.zeros(2),), "an expansion of the cost has 1 parts, too few"),
        ("running_expansion", [np.zeros(3), np.zeros(1), np.eye(2), np.zeros((1, 2)), np.eye(1)], "∂l/∂x of the cost"),
        ("last_expansion", (np.zeros(2), np.eye(3)), "of the last cost"),
        ("last", np.nan, "NaN"),
    ],
)  # fmt: skip
def test_what_callbacks_return_is_checked(method: str, answer: Any, message: str) -> None:
    dynamics, cost = DoubleIntegrator(), Effort(0.1, 10.0)
    setattr(dynamics if hasattr(dynamics, method) else cost, method, lambda *_: answer)
    with pytest.raises(ValueError, match=message):
        tg.plan(dynamics, cost, np.zeros((T, 1)), state=START)


def test_arguments_are_checked() -> None:
    dynamics, cost, guess = DoubleIntegrator(), Effort(0.1, 10.0), np.zeros((T, 1))
    with pytest.raises(ValueError, match="give the initial `state`"):
        tg.plan(dynamics, cost, guess)  # type: ignore[call-overload]
    with pytest.raises(ValueError, match=r"state has shape \(3,\); give \(states,\) = \(2,\)"):
        tg.plan(dynamics, cost, guess, state=np.zeros(3))
    with pytest.raises(ValueError, match=r"controls has shape \(25,\); give \(steps, channels\)"):
        tg.plan(dynamics, cost, guess[:, 0], state=START)
    with pytest.raises(ValueError, match=r"upper has shape \(2,\); give \(channels,\) = \(1,\)"):
        tg.plan(dynamics, cost, guess, state=START, upper=[1, 2])
    with pytest.raises(ValueError, match="limits of the control"):
        tg.plan(dynamics, cost, np.zeros((T, 2)), state=START)
    with pytest.raises(ValueError, match="tolerance"):
        tg.plan(dynamics, cost, guess, state=START, tolerance=-1.0)
    with pytest.raises(ValueError, match="target"):
        tg.plan(dynamics, tg.Quadratic.of_effort(3, 1, 1.0), guess, state=START)


def test_an_early_end_has_the_best_plan_so_far() -> None:
    with pytest.raises(tg.PlanError) as found:
        tg.plan(DoubleIntegrator(), Effort(0.1, 10.0), np.zeros((T, 1)), state=START, max_iterations=1)
    assert found.value.plan is not None
    assert found.value.plan.ending is None
    gains, _ = riccati(0.1, 10.0)
    np.testing.assert_allclose(found.value.plan.controls, follow(gains, START)[0], atol=1e-8)

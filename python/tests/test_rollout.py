"""Runs against closed forms; policies; what a run tells about itself."""

from __future__ import annotations

import json
import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import tangency as tg

G = 9.81


def ball_above_floor(height: float = 1.0, **options: Any) -> tg.Scene:
    """A disc of radius 0.1 m and 2 kg, and a floor, both with restitution 0.5."""
    floor = tg.BodyDef("floor", "static", shapes=[tg.HalfPlane((0, 1))], restitution=0.5)
    ball = tg.BodyDef("ball", position=(0, height), shapes=[tg.Circle(0.1)], restitution=0.5, mass=2.0)
    return tg.Scene(tg.SceneDef([ball, floor], **{"dt": 0.005, **options}))


def agm(a: float, b: float) -> float:
    """The arithmetic-geometric mean."""
    while abs(a - b) > 1e-15 * a:
        a, b = (a + b) / 2, math.sqrt(a * b)
    return a


def test_free_fall() -> None:
    """Steps of fixed length: v = v₀ + k dt g and y = y₀ + k dt v₀ + ½ k (k + 1) dt² g, exactly."""
    body = tg.BodyDef("stone", position=(0, 5), velocity=(2, 1), angular_velocity=0.5, mass=1, inertia=1)
    run = tg.rollout(tg.Scene(tg.SceneDef([body], dt=0.01)), steps=100)
    k, dt = np.arange(101), 0.01
    np.testing.assert_allclose(run.time, k * dt, rtol=1e-13)
    np.testing.assert_allclose(run.v[:, 0], np.stack([2 + 0 * k, 1 - G * k * dt, 0.5 + 0 * k], axis=1), atol=1e-12)
    np.testing.assert_allclose(run.q[:, 0, 1], 5 + k * dt - 0.5 * k * (k + 1) * dt**2 * G, atol=1e-12)
    np.testing.assert_allclose(run.q[:, 0, [0, 2]], np.stack([2 * k * dt, 0.5 * k * dt], axis=1), atol=1e-12)


def test_bounce_and_its_derivative() -> None:
    """The yardstick: where a disc is after a bounce, and how that depends on where it began.

    With h the height of its lowest point, t₁ = √(2 h / g), τ = T − t₁ and e the restitution:

        y = r + e g t₁ τ − ½ g τ²,      dy/dy₀ = e τ/t₁ − e + τ/t₁
    """
    scene = ball_above_floor(stepping={"accurate": {}})
    run = tg.rollout(scene, steps=150)
    first = math.sqrt(2 * 0.9 / G)
    rest = 0.75 - first
    assert run.q[-1, 0, 1] == pytest.approx(0.1 + 0.5 * G * first * rest - G * rest**2 / 2, abs=1e-12)
    gradient = run.gradient(q=[[0, 1, 0], [0, 0, 0]])
    closed = 1.5 * rest / first - 0.5
    assert closed == pytest.approx(0.626338944, abs=1e-9)
    assert gradient.q0[0, 1] == pytest.approx(closed, abs=1e-9)
    assert gradient["position.y:ball"] == gradient.q0[0, 1]


def test_period_of_a_pendulum(scenes: Path) -> None:
    """A slender rod of 1 m, let go at 2.5 rad: T = 2π √(2 l / 3 g) / agm(1, cos ½θ)."""
    period = 2 * math.pi * math.sqrt(2 / (3 * G)) / agm(1, math.cos(1.25))
    definition = json.loads(tg.Scene.load(scenes / "pendulum.toml").text())
    scene = tg.Scene({**definition, "stepping": {"accurate": {}}, "dt": period / 1000})
    run = tg.rollout(scene, steps=1000)
    assert run.q[-1, 0, 2] == pytest.approx(2.5, abs=1e-9)
    assert run.v[-1, 0, 2] == pytest.approx(0, abs=1e-8)
    np.testing.assert_allclose(run.energy, run.energy[0], atol=1e-8)
    assert scene.joint_drift(run.last) < 1e-12


def test_a_block_slides_until_friction_stops_it() -> None:
    """Over v²/(2 μ g), with derivative −v²/(2 μ² g) by μ."""
    floor = tg.BodyDef("floor", "static", shapes=[tg.HalfPlane((0, 1))], friction=0.3)
    block = tg.BodyDef("block", position=(0, 0.1), velocity=(3, 0), shapes=[tg.Rectangle(0.4, 0.2)], friction=0.3)
    scene = tg.Scene(tg.SceneDef([floor, block], dt=0.01, stepping={"accurate": {}}))
    run = tg.rollout(scene, steps=120)
    gradient = run.gradient(q=[[0, 0, 0], [1, 0, 0]], wrt=["friction:*", "velocity.x:block"])
    assert run.q[-1, 1, 0] == pytest.approx(9 / (2 * 0.3 * G), abs=1e-9)
    assert gradient.values["friction:*"] == pytest.approx(-9 / (2 * 0.09 * G), abs=1e-8)
    assert gradient.values["velocity.x:block"] == pytest.approx(3 / (0.3 * G), abs=1e-9)
    assert list(gradient.values) == ["friction:*", "velocity.x:block"]


def test_backends_agree() -> None:
    scene = ball_above_floor(0.1)
    ends = [tg.rollout(scene, 20, backend=name).q for name in ("ipm", "clarabel", "lemke")]
    np.testing.assert_allclose(ends[1], ends[0], atol=1e-9)
    np.testing.assert_allclose(ends[2], ends[0], atol=1e-9)


def test_the_same_bits_again(scenes: Path) -> None:
    scene = tg.Scene.load(scenes / "pyramid.toml")
    first, second = tg.rollout(scene, 20), tg.rollout(scene, 20)
    assert first.q.tobytes() == second.q.tobytes()
    simulator = tg.Simulator(scene)
    states = [simulator.step() for _ in range(20)]
    assert np.stack([state.q for state in states]).tobytes() == first.q[1:].tobytes()
    assert states[-1].time == simulator.time == first.time[-1]
    assert (simulator.steps, len(first), first.steps) == (20, 20, 20)


def test_a_run_goes_on_from_a_state(scenes: Path) -> None:
    scene = tg.Scene.load(scenes / "double_pendulum.toml")
    whole = tg.rollout(scene, 40)
    half = tg.rollout(scene, 20)
    rest = tg.rollout(scene, 20, state=half.last)
    np.testing.assert_allclose(rest.q, whole.q[20:], atol=1e-13)
    np.testing.assert_allclose(rest.time, whole.time[20:], atol=1e-13)
    assert whole.state(-1).q.tobytes() == whole.last.q.tobytes() == whole.q[-1].tobytes()
    assert whole.state(3).time == whole.time[3]


def test_a_simulator_goes_back(scenes: Path) -> None:
    scene = tg.Scene.load(scenes / "cartpole.toml")
    simulator = tg.Simulator(scene)
    simulator.step(2.0)
    after = simulator.step([2.0])
    start = simulator.reset()
    assert (simulator.steps, simulator.residual, simulator.impulses()) == (0, 0.0, [])
    assert start.q.tobytes() == scene.initial_state.q.tobytes()
    assert simulator.step(np.float64(2.0)).q.tobytes() != after.q.tobytes()
    assert simulator.step(2).q.tobytes() == after.q.tobytes()
    simulator.reset((after.q, after.v))
    assert (simulator.q.tobytes(), simulator.v.tobytes()) == (after.q.tobytes(), after.v.tobytes())
    assert simulator.state.time == 0.0


def test_a_failed_step_leaves_a_simulator_where_it_was(scenes: Path) -> None:
    simulator = tg.Simulator(tg.Scene.load(scenes / "cartpole.toml"))
    before = simulator.step(1.0)
    with pytest.raises(tg.StepError):
        simulator.step(np.nan)
    assert simulator.state.q.tobytes() == before.q.tobytes()
    assert simulator.steps == 1


def test_number_of_steps(scenes: Path) -> None:
    scene = tg.Scene.load(scenes / "cartpole.toml")
    assert tg.rollout(scene, 0).q.shape == (1, 2, 3)
    assert tg.rollout(scene, controls=np.zeros((7, 1))).steps == 7
    assert tg.rollout(ball_above_floor(duration=0.05)).steps == 10


def test_any_array_will_do(scenes: Path) -> None:
    scene = tg.Scene.load(scenes / "cartpole.toml")
    u = np.arange(12, dtype=np.float64).reshape(6, 2)
    expected = tg.rollout(scene, controls=u[:, 1:]).q.tobytes()
    for same in (u[:, 1:].astype(np.float32), u[:, 1:].astype(int), u[:, 1:].tolist(), np.asfortranarray(u)[:, 1:]):
        assert tg.rollout(scene, controls=same).q.tobytes() == expected


def test_arrays_are_copies() -> None:
    run = tg.rollout(ball_above_floor(), 3)
    q = run.q
    q[:] = 7.0
    assert run.q[0, 0, 1] == 1.0


def test_a_policy_sees_every_state(scenes: Path) -> None:
    scene = tg.Scene.load(scenes / "cartpole.toml")
    seen: list[tuple[int, tg.State]] = []

    def policy(k: int, state: tg.State) -> list[float]:
        seen.append((k, state))
        return [3 * state.q[1, 2] - state.v[0, 0]]

    run = tg.rollout(scene, 30, policy)
    assert [k for k, _ in seen] == list(range(30))
    assert all(state.q.tobytes() == run.q[k].tobytes() for k, state in seen)
    np.testing.assert_array_equal(run.controls[:, 0], 3 * run.q[:-1, 1, 2] - run.v[:-1, 0, 0])
    assert tg.rollout(scene, controls=run.controls).q.tobytes() == run.q.tobytes()


def test_what_a_policy_raises_comes_out(scenes: Path) -> None:
    scene = tg.Scene.load(scenes / "cartpole.toml")
    calls: list[int] = []

    def policy(k: int, _: tg.State) -> list[float]:
        calls.append(k)
        if k == 3:
            raise LookupError("no idea")
        return [0.0]

    with pytest.raises(LookupError, match="no idea"):
        tg.rollout(scene, 10, policy)
    assert calls == [0, 1, 2, 3]
    with pytest.raises(ValueError, match="the policy gave 2 numbers at step 0; give one per control channel, 1"):
        tg.rollout(scene, 10, lambda k, state: [0.0, 1.0])
    with pytest.raises(TypeError, match="the policy returned None at step 0"):
        tg.rollout(scene, 10, lambda k, state: None)  # type: ignore[arg-type, return-value]


def test_what_pushes_a_resting_ball() -> None:
    """Weight times the time step, up, at the lowest point."""
    run = tg.rollout(ball_above_floor(0.1), 1)
    (contact,) = run.contacts(0)
    up = 1 if contact["bodies"] == ("floor", "ball") else -1
    assert set(contact["bodies"]) == {"ball", "floor"}
    assert contact["point"] == pytest.approx((0, 0), abs=1e-12)
    assert contact["normal"] == pytest.approx((0, up), abs=1e-12)
    assert contact["gap"] == pytest.approx(0, abs=1e-12)
    assert contact["normal_impulse"] == pytest.approx(2.0 * G * 0.005, rel=1e-10)
    assert contact["tangent_impulse"] == pytest.approx(0, abs=1e-12)
    counts = run.counts(0)
    assert (counts["lcp_islands"], counts["contacts"], counts["impacts"]) == (1, 1, 0)
    assert tg.rollout(ball_above_floor(), 1).counts(0)["free_bodies"] == 1

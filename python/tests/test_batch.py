"""Batches have the bits of single runs, and say what failed."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import tangency as tg

B, T = 5, 30


@pytest.fixture(scope="module")
def scene(scenes: Path) -> tg.Scene:
    return tg.Scene.load(scenes / "cartpole.toml")


@pytest.fixture(scope="module")
def masses() -> list[float]:
    return [0.1, 0.2, 0.3, 0.4, 0.5]


@pytest.fixture
def batch(scene: tg.Scene, masses: list[float]) -> tg.Batch:
    batch = tg.Batch(scene, B)
    batch.set("mass:pole", masses)
    return batch


def controls() -> np.ndarray[tuple[int, ...], np.dtype[np.float64]]:
    return np.random.default_rng(3).normal(size=(B, T, 1))


def test_runs_are_those_of_single_scenes(scene: tg.Scene, batch: tg.Batch, masses: list[float]) -> None:
    u, random = controls(), np.random.default_rng(4)
    q0, v0 = scene.initial_state.q + 0 * u[:, :1], random.normal(size=(B, 2, 3)) * [1, 0, 0]
    v0[:, 1] = v0[:, 0]
    batch.reset_to(q0, v0)
    runs = batch.rollout(controls=u)
    seed_q, seed_v = random.normal(size=(2, B, T + 1, 2, 3))
    gradient = runs.gradient(seed_q, seed_v, wrt=["mass:pole"])
    dq0, dv0, du = random.normal(size=(B, 2, 3)), random.normal(size=(B, 2, 3)), random.normal(size=u.shape)
    rates = random.normal(size=B)
    dq, dv = runs.tangent(q0=dq0, v0=dv0, controls=du, values={"mass:pole": rates})
    assert (len(runs), runs.steps, len(gradient)) == (B, T, B)
    for k in range(B):
        single = tg.rollout(scene.with_values({"mass:pole": masses[k]}), controls=u[k], state=(q0[k], v0[k]))
        assert runs.q[k].tobytes() == single.q.tobytes()
        assert runs.v[k].tobytes() == single.v.tobytes()
        assert runs.time[k].tobytes() == single.time.tobytes()
        assert runs.controls[k].tobytes() == single.controls.tobytes()
        assert runs.residual[k] == single.residual
        assert runs.value("mass:pole", k) == masses[k]
        by = single.gradient(seed_q[k], seed_v[k], wrt=["mass:pole"])
        assert gradient.q0[k].tobytes() == by.q0.tobytes()
        assert gradient.v0[k].tobytes() == by.v0.tobytes()
        assert gradient.controls[k].tobytes() == by.controls.tobytes()
        assert gradient.values["mass:pole"][k] == gradient["mass:pole"][k] == by.values["mass:pole"]
        assert gradient.reports[k].growth.tobytes() == by.report.growth.tobytes()
        along = single.tangent(q0=dq0[k], v0=dv0[k], controls=du[k], values={"mass:pole": float(rates[k])})
        assert (dq[k].tobytes(), dv[k].tobytes()) == (along[0].tobytes(), along[1].tobytes())


def test_steps_end_where_runs_do(batch: tg.Batch) -> None:
    u = controls()
    runs = batch.rollout(controls=u)
    assert (batch.time == 0).all()
    for k in range(T // 2):
        batch.step(u[:, k])
    batch.advance(T - T // 2, u[:, T // 2 :])
    assert batch.q.tobytes() == np.ascontiguousarray(runs.q[:, -1]).tobytes()
    assert batch.v.tobytes() == np.ascontiguousarray(runs.v[:, -1]).tobytes()
    assert batch.time.tobytes() == runs.time[:, -1].tobytes()


def test_held_controls_and_none(batch: tg.Batch) -> None:
    held = controls()[:, 0]
    planned = np.repeat(held[:, None], 4, axis=1)
    assert batch.rollout(4, held).q.tobytes() == batch.rollout(controls=planned).q.tobytes()
    assert batch.rollout(4).q.tobytes() == batch.rollout(4, np.zeros((B, 1))).q.tobytes()


def test_resets_of_some(scene: tg.Scene, batch: tg.Batch) -> None:
    batch.advance(5, np.ones((B, 1)))
    moved = batch.q
    batch.reset([1, 3])
    assert batch.q[[1, 3]].tobytes() == np.stack([scene.initial_state.q] * 2).tobytes()
    assert batch.q[[0, 2, 4]].tobytes() == moved[[0, 2, 4]].tobytes()
    assert batch.time.tolist() == [batch.time[0], 0, batch.time[0], 0, batch.time[0]]
    batch.reset_to(v=np.ones((1, 2, 3)), time=2.0, environments=[2])
    assert batch.v[2].tolist() == [[1, 1, 1]] * 2
    assert batch.q[2].tobytes() == scene.initial_state.q.tobytes()
    assert batch.time[2] == 2.0
    batch.reset()
    assert (batch.time == 0).all()


def test_numbers_of_some(batch: tg.Batch, masses: list[float]) -> None:
    batch.set("mass:pole", 7.0, [4])
    batch.set("friction:*", 0.25)
    runs = batch.rollout(1)
    assert [runs.value("mass:pole", k) for k in range(B)] == [*masses[:4], 7.0]
    assert [runs.value("friction:cart", k) for k in range(B)] == [0.25] * B


def test_all_or_nothing(scene: tg.Scene, batch: tg.Batch, masses: list[float]) -> None:
    """Where one of several values cannot be, none is set."""
    with pytest.raises(tg.SceneError, match='"mass:pole": .* is -1'):
        batch.set("mass:pole", [1.0, 2.0, -1.0, 3.0, 4.0])
    runs = batch.rollout(1)
    assert [runs.value("mass:pole", k) for k in range(B)] == masses
    q = np.stack([scene.initial_state.q + 1] * B)
    q[3] = np.nan
    with pytest.raises(ValueError, match="environment 3: pose of body 0 is not finite"):
        batch.reset_to(q)
    assert batch.q.tobytes() == np.stack([scene.initial_state.q] * B).tobytes()


def test_failures_are_listed(batch: tg.Batch) -> None:
    u = controls()
    u[1, 4], u[3, 2] = np.nan, np.inf
    with pytest.raises(tg.StepError, match="2 of 5 environments failed; the first: environment 1, step 4") as found:
        batch.rollout(controls=u)
    assert [environment for environment, _ in found.value.failures] == [1, 3]
    assert found.value.failures[1][1].startswith("environment 3, step 2: control 0 is not finite")
    with pytest.raises(tg.StepError):
        batch.advance(T, u)
    # Those that failed stay before the step that they failed at, all others have taken all.
    steps = np.rint(batch.time / batch.scene.dt)
    assert steps.tolist() == [T, 4, T, 2, T]


def test_failures_of_gradients_name_the_environment(batch: tg.Batch) -> None:
    seed = np.zeros((B, 2, 3))
    seed[2] = np.nan
    with pytest.raises(tg.GradientError, match="environment 2: .* not finite"):
        batch.rollout(3).gradient(q=seed)
    with pytest.raises(tg.GradientError, match="environment 2: .* not finite"):
        batch.rollout(3).tangent(v0=seed)


def test_smoothed_batches(scenes: Path) -> None:
    scene = tg.Scene.load(scenes / "incline.toml")
    seed = np.random.default_rng(5).normal(size=(len(scene.bodies), 3))
    runs = tg.Batch(scene, 2, kappa=1e-3).rollout(10)
    found = runs.gradient(np.stack([seed, seed]))["friction:*"]
    single = tg.rollout(scene, 10).smoothed(1e-3).gradient(seed)["friction:*"]
    assert runs.kappa == 1e-3
    assert found.tolist() == [single, single]


def test_an_empty_batch(scene: tg.Scene) -> None:
    runs = tg.Batch(scene, 0).rollout(3)
    assert runs.q.shape == (0, 4, 2, 3)
    assert runs.gradient(np.zeros((0, 2, 3))).q0.shape[0] == 0

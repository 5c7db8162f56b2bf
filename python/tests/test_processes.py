"""Pickles, other processes, forks, threads."""

from __future__ import annotations

import copy
import multiprocessing
import pickle
import subprocess
import sys
from concurrent.futures import ProcessPoolExecutor, ThreadPoolExecutor
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import tangency as tg


@pytest.fixture(scope="module")
def scene(scenes: Path) -> tg.Scene:
    """With contacts, joints and numbers that are not the file's."""
    return tg.Scene.load(scenes / "chain_and_ball.toml").with_values({"mass:links": 0.7, "gravity.y": -5.0})


def same(value: Any) -> Any:
    """Through a pickle and back."""
    return pickle.loads(pickle.dumps(value))


def test_scenes(scene: tg.Scene) -> None:
    again = same(scene)
    assert again == scene
    assert hash(again) == hash(scene)
    assert again._key == scene._key
    assert again.value("mass:links") == 0.7
    assert copy.deepcopy(scene) == scene
    assert tg.rollout(again, 20).q.tobytes() == tg.rollout(scene, 20).q.tobytes()


def test_states(scene: tg.Scene) -> None:
    state = same(scene.initial_state)
    assert isinstance(state, tg.State)
    assert state.q.tobytes() == scene.initial_state.q.tobytes()


def test_definitions() -> None:
    definition = tg.SceneDef([tg.BodyDef("a", shapes=[tg.Circle(1.0)])])
    assert same(definition) == definition


def test_simulators_go_on_to_the_same_bits(scene: tg.Scene) -> None:
    simulator = tg.Simulator(scene, backend="ipm", tolerance=1e-12)
    for _ in range(60):
        simulator.step()
    again = same(simulator)
    assert (again.steps, again.time, again.residual) == (60, simulator.time, simulator.residual)
    for _ in range(20):
        assert again.step().q.tobytes() == simulator.step().q.tobytes()


@pytest.mark.parametrize("kappa", [None, 1e-3])
def test_runs_have_the_same_derivatives(scene: tg.Scene, kappa: float | None) -> None:
    run = tg.rollout(scene, 60)
    run = run if kappa is None else run.smoothed(kappa)
    again = same(run)
    seed = np.ones((len(scene.bodies), 3))
    assert again.scene == scene
    assert again.kappa == kappa
    assert again.q.tobytes() == run.q.tobytes()
    # Factorisations stay behind; those of the copy are its own, and equal to rounding.
    np.testing.assert_allclose(again.gradient(seed).q0, run.gradient(seed).q0, rtol=1e-9, atol=1e-9)
    assert again.gradient(seed)["mass:links"] == pytest.approx(run.gradient(seed)["mass:links"], rel=1e-9)


def test_exceptions() -> None:
    with pytest.raises(tg.StepError) as found:
        tg.Batch(pushed(), 2).step([[0.0], [np.nan]])
    again = same(found.value)
    assert (type(again), str(again), again.failures) == (tg.StepError, str(found.value), found.value.failures)


def pushed() -> tg.Scene:
    body = tg.BodyDef("a", mass=1, inertia=1)
    return tg.Scene(tg.SceneDef([body], controls=[tg.ControlDef("push", "force_x", "a")]))


def in_another_process(parts: tuple[tg.Scene, tg.Simulator, tg.Rollout]) -> tuple[bytes, Any, tg.Rollout]:
    scene, simulator, run = parts
    seed = np.ones((len(scene.bodies), 3))
    return simulator.step().q.tobytes(), run.gradient(seed).q0, tg.rollout(scene, 10)


def test_a_spawned_process(scene: tg.Scene) -> None:
    parts = (scene, tg.Simulator(scene), tg.rollout(scene, 5))
    with ProcessPoolExecutor(1, mp_context=multiprocessing.get_context("spawn")) as pool:
        stepped, gradient, ended = pool.submit(in_another_process, parts).result(timeout=60)
    run = tg.rollout(scene, 10)
    assert ended.q.tobytes() == run.q.tobytes()
    assert stepped == run.q[1].tobytes()
    here = parts[2].gradient(np.ones((len(scene.bodies), 3))).q0
    np.testing.assert_allclose(gradient, here, rtol=1e-9, atol=1e-9)


FORK = """
import os, sys
import numpy as np
import tangency as tg

body = tg.BodyDef("a", position=(0, 1), shapes=[tg.Circle(0.1)])
floor = tg.BodyDef("floor", "static", shapes=[tg.HalfPlane((0, 1))])
batch = tg.Batch(tg.Scene(tg.SceneDef([body, floor])), 64)
before = batch.rollout(50).q.tobytes()  # the pool's threads are there now
child = os.fork()
if child == 0:
    runs = batch.rollout(50)
    fine = runs.q.tobytes() == before and np.isfinite(runs.gradient(np.ones((64, 2, 3))).q0).all()
    os._exit(0 if fine else 1)
_, status = os.waitpid(child, 0)
assert batch.rollout(50).q.tobytes() == before  # and the parent goes on
sys.exit(os.waitstatus_to_exitcode(status))
"""


@pytest.mark.skipif(sys.platform == "win32", reason="there is no fork")
def test_a_forked_process_has_threads_of_its_own() -> None:
    subprocess.run([sys.executable, "-W", "ignore", "-c", FORK], check=True, timeout=60)


def test_threads_share_a_scene_and_a_run(scene: tg.Scene) -> None:
    run = tg.rollout(scene, 40)
    seed = np.ones((len(scene.bodies), 3))

    def work(_: int) -> tuple[bytes, bytes, bytes]:
        batch = tg.Batch(scene, 3).rollout(10).q
        return tg.rollout(scene, 40).q.tobytes(), run.gradient(seed).q0.tobytes(), batch.tobytes()

    with ThreadPoolExecutor(4) as pool:
        results = set(pool.map(work, range(8)))
    assert results == {work(0)}


def test_a_policy_may_run_scenes(scene: tg.Scene) -> None:
    """Python's lock is there again while a policy runs, and everything may be called from it."""

    def policy(k: int, state: tg.State) -> list[float]:
        return [float(tg.Batch(pushed(), 20).rollout(3, np.full((20, 1), k)).v[7, -1, 0, 0])]

    run = tg.rollout(pushed(), 4, policy)
    np.testing.assert_allclose(run.controls[:, 0], 3 * 0.01 * np.arange(4), rtol=1e-12)

"""Scenes, runs and results on workers of Ray."""

import runpy
from pathlib import Path

import numpy as np
import pytest

import tangency

ray = pytest.importorskip("ray")

EXAMPLE = runpy.run_path(str(Path(__file__).parents[2] / "examples" / "python" / "ray_sweep.py"))


@pytest.fixture(scope="module", autouse=True)
def cluster():
    ray.init(num_cpus=2, include_dashboard=False, runtime_env={"env_vars": {"RAYON_NUM_THREADS": "1"}})
    yield
    ray.shutdown()


@pytest.fixture(scope="module")
def scene():
    return EXAMPLE["wall_scene"]()


def test_a_sweep_over_workers_is_the_closed_form(scene):
    frictions, restitutions = np.array([0.2, 0.4]), np.array([0.0, 0.5, 1.0])
    found = EXAMPLE["sweep"](scene, frictions, restitutions)
    np.testing.assert_allclose(found, EXAMPLE["closed_form"](frictions[:, None], restitutions), atol=1e-9)


def test_fits_over_workers_find_what_was_seen(scene):
    seen = EXAMPLE["watched"](scene, np.array([0.3, 0.7])).q[:, scene.body("box"), 0]
    found = EXAMPLE["fits"](scene, seen, np.array([[0.5, 0.5], [0.2, 0.9]]))
    assert found[0][0] < 1e-9
    np.testing.assert_allclose(found[0][1], [0.3, 0.7], atol=1e-8)


def test_runs_come_back_with_their_derivatives(scene):
    run = ray.get(ray.remote(lambda scene: tangency.rollout(scene, 50)).remote(scene))
    here = tangency.rollout(scene, 50)
    assert np.array_equal(run.q, here.q)
    assert run.gradient(q=here.q)["friction:*"] == here.gradient(q=here.q)["friction:*"]

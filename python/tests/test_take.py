"""Runs of a batch taken by their environments."""

import numpy as np
import pytest

import tangency


@pytest.fixture
def runs():
    ball = tangency.BodyDef("ball", shapes=[tangency.Circle(0.1)])
    batch = tangency.Batch(tangency.Scene(tangency.SceneDef([ball])), 3)
    batch.set("velocity.x:ball", [1.0, 2.0, 3.0])
    batch.reset()
    return batch.rollout(10)


def test_runs_are_taken_in_any_order_and_as_often_as_named(runs):
    taken = runs.take([2, 0, 2, 2])
    assert len(taken) == 4
    assert np.array_equal(taken.q, runs.q[[2, 0, 2, 2]])
    assert taken.value("velocity.x:ball", 1) == 1.0
    gradient = taken.gradient(q=np.eye(4)[:, :1, None] * [[1.0, 0.0, 0.0]], wrt=["velocity.x:ball"])
    np.testing.assert_allclose(gradient["velocity.x:ball"], [0.1, 0, 0, 0], atol=1e-15)  # x = v T


def test_other_environments_are_refused(runs):
    with pytest.raises(IndexError, match="no environment 3; there are 3"):
        runs.take([0, 3])

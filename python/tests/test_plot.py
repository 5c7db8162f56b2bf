"""Plots: what the axes hold."""

from __future__ import annotations

import numpy as np
import pytest

matplotlib = pytest.importorskip("matplotlib")
matplotlib.use("Agg")

import matplotlib.pyplot as plt  # noqa: E402

import tangency  # noqa: E402
from tangency import BodyDef, Capsule, Circle, HalfPlane, Polygon, Rectangle, SceneDef, plot  # noqa: E402


@pytest.fixture(autouse=True)
def _close_figures():
    yield
    plt.close("all")


def areas(ax):
    """Areas of what was drawn, m², by Gauss's formula."""

    def area(patch):
        outline = patch.get_patch_transform().transform_path(patch.get_path())
        x, y = outline.to_polygons(closed_only=False)[0].T
        return abs(np.dot(x, np.roll(y, 1)) - np.dot(y, np.roll(x, 1))) / 2

    return [area(patch) for patch in ax.patches]


SHAPES = {
    "circle": (Circle(0.5, (0.2, 0.1)), np.pi / 4),
    "rectangle": (Rectangle(2.0, 0.5, (1.0, 0.0), 0.3), 1.0),
    "polygon": (Polygon([(1, 1), (0, 0), (0.4, 0.5), (1, 0), (0, 1), (0.5, 0.0)]), 1.0),
    "capsule": (Capsule((0.0, 0.3), (1.0, 0.3), 0.25), 0.5 + np.pi / 16),
}


@pytest.mark.parametrize("kind", SHAPES)
def test_shapes_have_their_areas_and_places(kind):
    shape, area = SHAPES[kind]
    body = BodyDef("body", position=(3.0, -2.0), angle=0.7, shapes=[shape])
    scene = tangency.Scene(SceneDef([body]))
    ax = plot.draw(scene)
    assert areas(ax) == pytest.approx([area], rel=0.03)
    (patch,) = ax.patches
    outline = patch.get_patch_transform().transform_path(patch.get_path()).to_polygons()[0]
    center = outline.min(axis=0) / 2 + outline.max(axis=0) / 2
    if kind != "polygon":
        assert center == pytest.approx(scene.initial_state.q[0, :2], abs=0.01)


def test_half_planes_do_not_stretch_the_axes():
    floor = BodyDef("floor", "static", shapes=[HalfPlane((0, 1))])
    ball = BodyDef("ball", position=(0, 1), shapes=[Circle(0.5)])
    ax = plot.draw(tangency.Scene(SceneDef([floor, ball])))
    assert ax.get_xlim()[1] < 1.0
    assert len(ax.patches) + len(ax.artists) == 2


@pytest.fixture
def run():
    ball = BodyDef("ball", position=(0, 1), velocity=(1, 0), shapes=[Circle(0.1)])
    floor = BodyDef("floor", "static", shapes=[HalfPlane((0, 1))])
    return tangency.rollout(tangency.Scene(SceneDef([floor, ball], dt=0.01)), 40)


def test_trajectories_are_those_of_the_run(run):
    ax = plot.trajectory(run)
    (path,) = (line for line in ax.lines if line.get_label() == "ball")
    assert np.array_equal(path.get_xydata(), run.q[:, 1, :2])
    _, ax = plt.subplots()
    assert plot.trajectory(run, ["ball", "floor"], ax) is ax
    with pytest.raises(KeyError, match="no body"):
        plot.trajectory(run, ["balloon"])


def test_energy_is_that_of_the_run(run):
    (line,) = plot.energy(run).lines
    assert np.array_equal(line.get_xdata(), run.time)
    assert np.array_equal(line.get_ydata(), run.energy)


def test_films_show_the_states_nearest_to_the_times(run):
    ax = plot.film(run, [0.0, 0.1, 0.4])
    frames = ax.child_axes
    assert [frame.get_title() for frame in frames] == ["0 s", "0.1 s", "0.4 s"]
    centers = [frame.patches[-1].center for frame in frames]
    assert np.allclose(centers, run.q[[0, 10, 40], 1, :2])
    assert len({frame.get_xlim() for frame in frames}) == 1


@pytest.mark.parametrize("times", [[], [-0.1], [0.0, 0.5]])
def test_films_refuse_times_outside_of_the_run(run, times):
    with pytest.raises(ValueError, match="within 0.0 to 0.4"):
        plot.film(run, times)


def test_states_of_another_scene_are_refused(run):
    with pytest.raises(ValueError, match=r"q has shape \(3, 3\); give \(bodies, 3\) = \(2, 3\)"):
        plot.draw(run.scene, (np.zeros((3, 3)), np.zeros((3, 3))))

"""Pictures and replay pages of scenes and runs."""

from __future__ import annotations

import html
import re

import numpy as np
import pytest

import tangency
from tangency import BodyDef, Capsule, Circle, HalfPlane, Rectangle, SceneDef


@pytest.fixture
def scene():
    floor = BodyDef("floor", "static", shapes=[HalfPlane((0, 1))])
    ball = BodyDef("ball", position=(0, 1), shapes=[Circle(0.25)])
    return tangency.Scene(SceneDef([floor, ball], dt=0.01, name='Ball "on" <floor>'))


def test_a_picture_shows_what_is_where(scene):
    picture = scene.picture(width=400, height=200, view=(-2, 2, -0.5, 1.5))
    assert picture.dtype == np.uint8
    assert picture.shape == (200, 400, 3)
    white = picture[10, 10]
    assert tuple(white) == (255, 255, 255)
    ball, floor = picture[50, 190], picture[180, 200]  # 100 pixels per metre; the ball's mark points to the right
    assert tuple(ball) != tuple(white)
    assert tuple(floor) not in (tuple(white), tuple(ball))
    disc = np.any(picture[:140] != white, axis=-1).sum()
    assert disc == pytest.approx(np.pi * 25.5**2, rel=0.02)  # its rim reaches half a pixel out
    assert (scene.picture(width=400, height=200, view=(-2, 2, -0.5, 1.5)) == picture).all()


def test_a_picture_follows_the_state(scene):
    q = scene.initial_state.q.copy()
    q[1, :2] = 1.0, 0.5
    moved = scene.picture((q, np.zeros((2, 3))), 400, 200, view=(-2, 2, -0.5, 1.5))
    assert tuple(moved[50, 190]) == (255, 255, 255)
    assert tuple(moved[100, 290]) == tuple(scene.picture(None, 400, 200, view=(-2, 2, -0.5, 1.5))[50, 190])


def test_a_fitted_view_holds_all_of_the_scene(scene):
    picture = scene.picture()
    assert picture.shape == (400, 600, 3)
    edges = np.concatenate([picture[0], picture[:300, 0], picture[:300, -1]])
    assert (edges == 255).all()


def test_runs_are_drawn_state_by_state(scene):
    run = tangency.rollout(scene, 40)
    view = (-2, 2, -0.5, 1.5)
    assert (run.picture(0, view=view) == scene.picture(view=view)).all()
    assert (run.picture(-1, view=view) == scene.picture(run.last, view=view)).all()
    assert (run.picture(0) != run.picture(40)).any()
    with pytest.raises(IndexError, match="there is no state 41; there are 41"):
        run.picture(41)


@pytest.mark.parametrize(
    ("wrong", "message"),
    [
        ({"width": 0}, "give `width` and `height` from 1 to"),
        ({"height": 9000}, "give `width` and `height` from 1 to"),
        ({"view": (1, 1, 0, 1)}, "the view reaches from"),
        ({"view": (0, float("nan"), 0, 1)}, "the view reaches from"),
        ({"state": (np.zeros((3, 3)), np.zeros((2, 3)))}, r"q has shape \(3, 3\)"),
    ],
)
def test_what_cannot_be_drawn_is_refused(scene, wrong, message):
    with pytest.raises(ValueError, match=message):
        scene.picture(**wrong)


def test_notebooks_show_scenes_as_png(scene):
    assert scene._repr_png_()[:8] == b"\x89PNG\r\n\x1a\n"


def test_replay_pages_hold_the_run(scene, tmp_path):
    run = tangency.rollout(scene, 100)
    page = run.replay()
    assert page.lower().startswith("<!doctype html>")
    assert '<title>Ball "on" &lt;floor>' in page
    assert "ball" in page
    assert "http://" not in page.replace("http://www.w3.org", "")
    assert "https://" not in page
    assert "<title>Fall" in run.replay("Fall")
    run.save_replay(tmp_path / "run.html", title="Fall")
    assert (tmp_path / "run.html").read_text(encoding="utf-8") == run.replay("Fall")
    with pytest.raises(OSError):
        run.save_replay(tmp_path / "no" / "folder.html")


def test_notebooks_show_runs_in_a_frame(scene):
    run = tangency.rollout(scene, 20)
    shown = run._repr_html_()
    frame = re.fullmatch(r'<iframe srcdoc="([^"]*)"[^<>]*></iframe>', shown)
    assert frame
    assert html.unescape(frame[1]) == run.replay()


def test_notebooks_are_spared_large_pages():
    motion = {"velocity": (0.37, 0.29), "angular_velocity": 1.3, "shapes": [Circle(0.1)], "mask": 0}
    balls = [BodyDef(f"ball{k}", position=(k, 0.0), **motion) for k in range(20)]
    run = tangency.rollout(tangency.Scene(SceneDef(balls, dt=1e-3)), 7000)
    assert len(run.replay()) > 3_000_000
    shown = run._repr_html_()
    assert "save_replay" in shown
    assert len(shown) < 200


def test_shapes_are_given_about_centres_of_mass():
    """Two squares of a dumbbell, whose centre of mass is in the middle."""
    squares = [Rectangle(1, 1, (0, 0)), Rectangle(1, 1, (4, 0), 0.5)]
    capsule = BodyDef("capsule", "static", shapes=[Capsule((0, 0), (1, 0), 0.1)])
    scene = tangency.Scene(SceneDef([BodyDef("dumbbell", shapes=squares), capsule]))
    (first, second), _ = scene.shapes
    assert first["rectangle"]["center"] == pytest.approx([-2, 0])
    assert second["rectangle"]["center"] == pytest.approx([2, 0])
    assert second["rectangle"]["angle"] == 0.5


def test_shapes_have_the_numbers_that_were_given(scene):
    assert scene.with_values({"radius:ball": 0.4}).shapes[1] == [{"circle": {"radius": 0.4, "center": [0.0, 0.0]}}]

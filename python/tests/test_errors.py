"""Wrong input is refused by the right exception, with a message that says what to do."""

from __future__ import annotations

import re
from collections.abc import Callable
from pathlib import Path
from typing import Any, cast

import numpy as np
import pytest

import tangency as tg

NAN = float("nan")


@pytest.fixture(scope="module")
def cartpole(scenes: Path) -> tg.Scene:
    return tg.Scene.load(scenes / "cartpole.toml")


def refused(kind: type[Exception], message: str, call: Callable[[], Any]) -> BaseException:
    """The exception of a call, of this very kind and with this message."""
    with pytest.raises(kind, match=re.escape(message)) as found:
        call()
    assert type(found.value) is kind
    return found.value


def test_exceptions_are_also_those_of_the_language() -> None:
    assert issubclass(tg.SceneError, ValueError)
    for kind in (tg.StepError, tg.SolveError, tg.GradientError, tg.PlanError):
        assert issubclass(kind, RuntimeError)
    assert list(tg.StepError("x").failures) == list(tg.GradientError("x").failures) == []
    assert tg.PlanError("x").plan is None


@pytest.mark.parametrize(
    ("definition", "kind", "message"),
    [
        (tg.SceneDef([tg.BodyDef("a", mass=-1.0)]), tg.SceneError, "bodies[0].mass is -1: give a positive"),
        (tg.SceneDef([tg.BodyDef("a", position=(NAN, 0))]), ValueError, "scene.bodies[0].position[0] is nan"),
        (tg.SceneDef([tg.BodyDef("a", position=(0,))]), tg.SceneError, "position"),
        (tg.SceneDef([tg.BodyDef("a"), tg.BodyDef("a")]), tg.SceneError, "a"),
        (tg.SceneDef(forces=[tg.ForceDef("ghost")]), tg.SceneError, "ghost"),
        ({"bodiez": []}, tg.SceneError, "did you mean `bodies`?"),
        ({"dt": {1, 2}}, TypeError, "scene.dt is a set, which has no place in a scene"),
        ("scenes/bounce.toml", TypeError, "to read a file use Scene.load"),
        (None, TypeError, "not of NoneType"),
    ],
)  # fmt: skip
def test_definitions(definition: Any, kind: type[Exception], message: str) -> None:
    refused(kind, message, lambda: tg.Scene(definition))


def test_files_and_texts(tmp_path: Path) -> None:
    refused(tg.SceneError, "cannot be read; check the path", lambda: tg.Scene.load(tmp_path / "none.toml"))
    refused(tg.SceneError, "line 2, column 1: b: unknown field `b`", lambda: tg.Scene.parse("dt = 0.1\nb = 1"))
    refused(ValueError, 'format is "yaml"; give "toml" or "json"', lambda: tg.Scene.parse("", cast(Any, "yaml")))
    refused(ValueError, 'format is "xml"', lambda: tg.Scene(tg.SceneDef()).text(cast(Any, "xml")))


def test_names(cartpole: tg.Scene) -> None:
    run = tg.rollout(cartpole, 2)
    refused(KeyError, 'the scene has no body "ghost"', lambda: cartpole.body("ghost"))
    refused(KeyError, 'the scene has no joint "ghost"', lambda: cartpole.joint("ghost"))
    refused(KeyError, 'no body or group "ghost"', lambda: run.gradient()["mass:ghost"])
    unknown = [
        lambda: cartpole.value("mass:ghost"),
        lambda: cartpole.with_values({"mass:ghost": 1.0}),
        lambda: run.gradient(wrt=["mass:ghost"]),
        lambda: run.tangent(values={"mass:ghost": 1.0}),
        lambda: run.step_jacobian(0, wrt=["mass:ghost"]),
        lambda: tg.Batch(cartpole, 2).set("mass:ghost", 1.0),
        lambda: tg.Batch(cartpole, 2).rollout(1).gradient(wrt=["mass:ghost"]),
        lambda: tg.Batch(cartpole, 2).rollout(1).value("mass:ghost", 0),
    ]
    for call in unknown:
        refused(tg.SceneError, '"mass:ghost": the scene has no body or group "ghost"', call)
    refused(tg.SceneError, '"weight": no quantity "weight"; known: mass,', lambda: cartpole.value("weight"))


def test_numbers_of_a_scene(cartpole: tg.Scene) -> None:
    message = '"mass:pole": Mass(1) is -2: give a positive'
    refused(tg.SceneError, message, lambda: cartpole.with_values({"mass:pole": -2.0}))
    refused(tg.SceneError, message, lambda: tg.Batch(cartpole, 2).set("mass:pole", -2.0))
    refused(tg.SceneError, "is NaN", lambda: cartpole.with_values({"mass:pole": NAN}))


def test_shapes(cartpole: tg.Scene) -> None:
    run, batch = tg.rollout(cartpole, 5), tg.Batch(cartpole, 4)
    runs = batch.rollout(5)
    wrong: dict[str, Callable[[], Any]] = {
        "controls has shape (5, 2); give (steps, channels) = (5, 1)": lambda: tg.rollout(cartpole, 5, np.zeros((5, 2))),
        "controls has shape (5,); give (steps, channels) = (5, 1)": lambda: tg.rollout(cartpole, controls=np.zeros(5)),
        "q has shape (3, 3); give (bodies, 3) = (2, 3)": lambda: tg.rollout(
            cartpole, 5, state=(np.zeros((3, 3)), np.zeros((2, 3)))
        ),
        "v has shape (2,); give (bodies, 3) = (2, 3)": lambda: cartpole.energy((np.zeros((2, 3)), np.zeros(2))),
        "x has shape (3,); give (6 dynamic bodies,) = (12,)": lambda: cartpole.at_coordinates(np.zeros(3)),
        "q has shape (7, 3); give (6, 2, 3) for all states, or (2, 3)": lambda: run.gradient(q=np.zeros((7, 3))),
        "v0 has shape (3,); give (bodies, 3) = (2, 3)": lambda: run.tangent(v0=np.zeros(3)),
        "controls has shape (4, 1); give (steps, channels) = (5, 1)": lambda: run.tangent(controls=np.zeros((4, 1))),
        "control has shape (2,); give (channels,) = (1,)": lambda: tg.Simulator(cartpole).step(np.zeros(2)),
        "controls has shape (3, 1); give (environments, channels) = (4, 1)": lambda: batch.step(np.zeros((3, 1))),
        "or (environments, steps, channels) = (4, 7, 1)": lambda: batch.rollout(7, np.zeros((4, 6, 1))),
        "values has shape (3,); give (environments,) = (4,)": lambda: batch.set("mass:pole", [1, 2, 3]),
        "q has shape (4, 3); give (environments, bodies, 3) = (4, 2, 3)": lambda: batch.reset_to(q=np.zeros((4, 3))),
        "q has shape (2, 3); give (4, 6, 2, 3) for all": lambda: runs.gradient(q=np.zeros((2, 3))),
        "q0 has shape (2, 3); give (environments, bodies, 3)": lambda: runs.tangent(q0=np.zeros((2, 3))),
        "mass:pole has shape (); give (environments,) = (4,)": lambda: runs.tangent(values={"mass:pole": 1.0}),
        "matrix has shape (2, 2); give (n, n) = (3, 3)": lambda: tg.solve_lcp(np.eye(2), np.zeros(3)),
        "q has shape (1, 2); give (n,) = (2,)": lambda: tg.solve_lcp(np.eye(2), np.zeros((1, 2))),
        "free is 3; give at most n = 2": lambda: tg.solve_lcp(np.eye(2), np.zeros(2), free=3),
        "z has shape (3,); give (n,) = (2,)": lambda: tg.solve_lcp(np.eye(2), -np.ones(2)).vjp(np.zeros(3)),
        "a state is a tangency.State, or a tuple (q, v)": lambda: cartpole.energy(cast(Any, {"q": 0, "v": 1})),
        "or (q, v, time)": lambda: cartpole.energy(cast(Any, "ab")),
    }
    for message, call in wrong.items():
        refused(ValueError, message, call)


def test_indices(cartpole: tg.Scene) -> None:
    run, batch = tg.rollout(cartpole, 5), tg.Batch(cartpole, 4)
    refused(IndexError, "there is no state 6; there are 6", lambda: run.state(6))
    refused(IndexError, "there is no state -7; there are 6", lambda: run.state(-7))
    for call in (run.step_jacobian, run.contacts, run.impulses, run.counts):
        refused(IndexError, "there is no step 5; the run has 5", lambda call=call: call(5))  # type: ignore[misc]
    refused(IndexError, "there is no environment 4; there are 4", lambda: batch.reset([4]))
    refused(IndexError, "there are 4 environments", lambda: batch.rollout(1).value("dt", 4))


def test_numbers_that_are_none(cartpole: tg.Scene) -> None:
    run, nan = tg.rollout(cartpole, 3), np.full((2, 3), NAN)
    good = np.zeros((2, 3))
    not_finite = "not finite"
    refused(tg.StepError, "control 0 is not finite", lambda: tg.rollout(cartpole, 3, np.full((3, 1), NAN)))
    refused(tg.StepError, "control 0 is not finite", lambda: tg.Simulator(cartpole).step([np.inf]))
    refused(ValueError, "pose of body 0 is not finite", lambda: tg.rollout(cartpole, 3, state=(nan, good)))
    refused(ValueError, "velocity of body 0 is not finite", lambda: tg.Simulator(cartpole, (good, nan)))
    refused(tg.GradientError, not_finite, lambda: run.gradient(q=nan))
    refused(tg.GradientError, not_finite, lambda: run.tangent(v0=nan))
    refused(tg.GradientError, "kappa is -1; give a positive", lambda: run.smoothed(-1.0))
    refused(ValueError, "kappa is -1; give a positive", lambda: tg.Batch(cartpole, 2, kappa=-1.0))
    refused(ValueError, "the run is smoothed", lambda: run.smoothed(1e-4).smoothed(1e-4))
    refused(ValueError, "could not convert string", lambda: tg.rollout(cartpole, controls="abc"))


def test_backends_and_tolerances(cartpole: tg.Scene) -> None:
    assert tg.backends() == ["ipm", "clarabel", "lemke"]
    none = cast(Any, "magic")
    for call in (
        lambda: tg.rollout(cartpole, 1, backend=none),
        lambda: tg.Simulator(cartpole, backend=none),
        lambda: tg.Batch(cartpole, 1, backend=none),
        lambda: tg.solve_lcp(np.eye(1), [1.0], backend=none),
    ):
        refused(ValueError, 'backend is "magic"; give one of ipm, clarabel, lemke', call)
    refused(ValueError, "tolerance is 2; give a number in (0, 1)", lambda: tg.rollout(cartpole, 1, tolerance=2.0))
    refused(ValueError, "leave `tolerance` out", lambda: tg.Batch(cartpole, 1, backend="lemke", tolerance=1e-8))

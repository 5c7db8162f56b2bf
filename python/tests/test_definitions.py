"""Definitions in Python say what scene files say."""

from __future__ import annotations

import dataclasses
import json
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import tangency as tg
from tangency import definitions

NAMES = [
    "billiards", "bounce", "bridge", "cartpole", "chain_and_ball", "conveyor", "domino_wave", "double_pendulum",
    "four_bar", "incline", "newtons_cradle", "pendulum", "pyramid", "ragdoll", "slider_crank", "stack",
    "wrecking_ball",
]  # fmt: skip


def everything() -> tg.SceneDef:
    """A scene with every class of definitions, and every field other than its default."""
    shapes: list[definitions.Shape] = [
        tg.Circle(0.1, (0.5, 0.0)),
        tg.Rectangle(0.4, 0.2, (0.1, 0.0), 0.3),
        tg.Polygon([(0.0, 0.0), (0.3, 0.0), (0.0, 0.3)]),
        tg.Capsule((-0.2, 0.0), (0.2, 0.0), 0.05),
    ]
    ground = tg.BodyDef("ground", "static", shapes=[tg.HalfPlane((0.0, 1.0), -1.0)])
    first = tg.BodyDef(
        "first", position=(1.0, 2.0), angle=0.5, velocity=(0.1, 0.2), angular_velocity=0.3, shapes=shapes, mass=2.0,
        inertia=0.7, friction=0.25, restitution=0.75, gravity_scale=0.5, groups=["links"], category=2, mask=3,
    )  # fmt: skip
    second = tg.BodyDef("second", position=(3.0, 2.0), shapes=[tg.Circle(0.1)], density=3.0)
    limits, motor = tg.Limits(-0.5, 0.5), tg.Motor(1.5, 10.0)
    pair = ("first", "second")
    joints = [
        tg.JointDef("hinge", pair, tg.Revolute((2.0, 2.0), (2.0, 2.0), limits, motor), True, tg.Softness(1e3, 10.0)),
        tg.JointDef("weld", pair, tg.Weld((2.0, 2.0))),
        tg.JointDef("slide", pair, tg.Prismatic((2.0, 2.0), (1.0, 0.0), limits, motor)),
        tg.JointDef("slot", pair, tg.Slot((2.0, 2.0), (0.0, 1.0), limits, motor)),
        tg.JointDef("rod", pair, tg.Distance((1.0, 2.0), (3.0, 2.0), 2.0)),
        tg.JointDef("lock", ("world", "second"), tg.Lock(True, False, True)),
        tg.JointDef("spring", pair, tg.Spring((1.0, 2.0), (3.0, 2.0), 50.0, 1.5, 0.2)),
    ]
    controls = [
        tg.ControlDef("push", "force_x", "first"),
        tg.ControlDef("lift", "force_y", "first"),
        tg.ControlDef("turn", "torque", "second"),
        tg.ControlDef("speed", "motor_speed", "hinge"),
        tg.ControlDef("press", "joint_force", "slide"),
    ]
    return tg.SceneDef(
        [ground, first, second], joints, [tg.ForceDef("first", (1.0, -1.0), 0.1, 0.25, 0.5)], controls,
        [tg.PairDef(pair, True, 0.1, 0.9)], (0.5, -1.62), 0.005, 2.5, {"impact_resolved": {"max_impacts": 4}}, "gap",
        {"joints": "post", "contacts": {"baumgarte": {"fraction": 0.5}}}, 0.5, 2.0, 1e-9, "Everything", "All of it.",
    )  # fmt: skip


TEXT = """
version = 1
name = "Everything"
description = "All of it."
gravity = [0.5, -1.62]
dt = 0.005
duration = 2.5
stepping = { impact_resolved = { max_impacts = 4 } }
contact_model = "gap"
stabilisation = { joints = "post", contacts = { baumgarte = { fraction = 0.5 } } }
recovery_speed = 0.5
recovery_rate = 2.0
tolerance = 1e-9

[[bodies]]
name = "ground"
kind = "static"
shapes = [{ half_plane = { normal = [0.0, 1.0], offset = -1.0 } }]

[[bodies]]
name = "first"
position = [1.0, 2.0]
angle = 0.5
velocity = [0.1, 0.2]
angular_velocity = 0.3
shapes = [
  { circle = { radius = 0.1, center = [0.5, 0.0] } },
  { rectangle = { width = 0.4, height = 0.2, center = [0.1, 0.0], angle = 0.3 } },
  { polygon = { points = [[0.0, 0.0], [0.3, 0.0], [0.0, 0.3]] } },
  { capsule = { a = [-0.2, 0.0], b = [0.2, 0.0], radius = 0.05 } },
]
mass = 2.0
inertia = 0.7
friction = 0.25
restitution = 0.75
gravity_scale = 0.5
groups = ["links"]
category = 2
mask = 3

[[bodies]]
name = "second"
position = [3.0, 2.0]
shapes = [{ circle = { radius = 0.1 } }]
density = 3.0

[[joints]]
name = "hinge"
bodies = ["first", "second"]
collide = true
softness = { stiffness = 1e3, damping = 10.0 }
kind = { revolute = { anchor = [2.0, 2.0], anchor_b = [2.0, 2.0], limits = { lower = -0.5, upper = 0.5 }, \
motor = { speed = 1.5, max = 10.0 } } }

[[joints]]
name = "weld"
bodies = ["first", "second"]
kind = { weld = { anchor = [2.0, 2.0] } }

[[joints]]
name = "slide"
bodies = ["first", "second"]
kind = { prismatic = { anchor = [2.0, 2.0], axis = [1.0, 0.0], limits = { lower = -0.5, upper = 0.5 }, \
motor = { speed = 1.5, max = 10.0 } } }

[[joints]]
name = "slot"
bodies = ["first", "second"]
kind = { slot = { anchor = [2.0, 2.0], axis = [0.0, 1.0], limits = { lower = -0.5, upper = 0.5 }, \
motor = { speed = 1.5, max = 10.0 } } }

[[joints]]
name = "rod"
bodies = ["first", "second"]
kind = { distance = { anchor_a = [1.0, 2.0], anchor_b = [3.0, 2.0], length = 2.0 } }

[[joints]]
name = "lock"
bodies = ["world", "second"]
kind = { lock = { x = true, y = false, rotation = true } }

[[joints]]
name = "spring"
bodies = ["first", "second"]
kind = { spring = { anchor_a = [1.0, 2.0], anchor_b = [3.0, 2.0], stiffness = 50.0, length = 1.5, damping = 0.2 } }

[[forces]]
body = "first"
force = [1.0, -1.0]
torque = 0.1
start = 0.25
end = 0.5

[[controls]]
name = "push"
input = { force_x = { body = "first" } }

[[controls]]
name = "lift"
input = { force_y = { body = "first" } }

[[controls]]
name = "turn"
input = { torque = { body = "second" } }

[[controls]]
name = "speed"
input = { motor_speed = { joint = "hinge" } }

[[controls]]
name = "press"
input = { joint_force = { joint = "slide" } }

[[pairs]]
bodies = ["first", "second"]
collide = true
friction = 0.1
restitution = 0.9
"""


def parts(value: Any) -> Iterator[Any]:
    """All definitions within a definition."""
    if dataclasses.is_dataclass(value):
        yield value
        value = [getattr(value, item.name) for item in dataclasses.fields(value)]
    if isinstance(value, (list, tuple)):
        for item in value:
            yield from parts(item)


def test_every_class_and_field_says_what_the_file_says() -> None:
    assert tg.Scene(everything()) == tg.Scene.parse(TEXT)


def test_the_scene_has_every_class_and_no_field_at_its_default() -> None:
    found = list(parts(everything()))
    classes = {name for name in definitions.__all__ if isinstance(getattr(definitions, name), type)}
    assert {type(part).__name__ for part in found} == classes
    for name in sorted(classes - {"Limits", "Lock", "ControlDef"}):
        for item in dataclasses.fields(getattr(definitions, name)):
            values = [getattr(part, item.name) for part in found if type(part).__name__ == name]
            other = [value for value in values if value != item.default and value is not None]
            assert other or item.name == "contact_model", f"{name}.{item.name} is nowhere but at its default"


@pytest.mark.parametrize("format", ["toml", "json"])
def test_text_says_the_same(format: Any) -> None:
    scene = tg.Scene(everything())
    assert tg.Scene.parse(scene.text(format), format) == scene


def test_defaults_are_those_of_the_file() -> None:
    minimal = tg.Scene.parse('[[bodies]]\nname = "a"\nshapes = [{ circle = { radius = 1.0 } }]')
    assert tg.Scene(tg.SceneDef([tg.BodyDef("a", shapes=[tg.Circle(1.0)])])) == minimal


def test_a_mapping_does_as_well() -> None:
    scene = tg.Scene(everything())
    assert tg.Scene(json.loads(scene.text("json"))) == scene
    mixed = tg.SceneDef([{"name": "a", "shapes": [{"circle": {"radius": 1}}]}], gravity=np.array([0.0, -9.81]))
    assert tg.Scene(mixed) == tg.Scene(tg.SceneDef([tg.BodyDef("a", shapes=[tg.Circle(1.0)])]))


def test_scene_files(scenes: Path) -> None:
    assert sorted(path.stem for path in scenes.glob("*.toml")) == NAMES


@pytest.mark.parametrize("name", NAMES)
def test_every_scene_loads_and_steps(scenes: Path, name: str) -> None:
    scene = tg.Scene.load(scenes / f"{name}.toml")
    assert tg.Scene.parse((scenes / f"{name}.toml").read_text()) == scene
    assert tg.Scene(json.loads(scene.text())) == scene
    run = tg.rollout(scene, steps=2)
    assert run.q.shape == (3, len(scene.bodies), 3)
    assert np.isfinite(run.v).all()
    assert run.residual <= 1e-10


def test_names_and_places() -> None:
    scene = tg.Scene(everything())
    assert scene.bodies == ("ground", "first", "second")
    assert scene.dynamic == (1, 2)
    assert [scene.body(name) for name in scene.bodies] == [0, 1, 2]
    assert scene.joints[scene.joint("slot")] == "slot"
    assert scene.controls == ("push", "lift", "turn", "speed", "press")
    assert (scene.name, scene.description) == ("Everything", "All of it.")
    assert (scene.dt, scene.duration, scene.steps) == (0.005, 2.5, 500)


def test_other_values_make_another_scene() -> None:
    scene = tg.Scene(everything())
    heavy = scene.with_values({"mass:links": 5.0, "gravity.y": -1.0})
    assert (heavy.value("mass:first"), heavy.value("gravity.y")) == (5.0, -1.0)
    assert (scene.value("mass:first"), scene.value("gravity.y")) == (2.0, -1.62)
    assert heavy != scene
    assert heavy._key != scene._key
    assert heavy == scene.with_values({"mass:links": 5.0, "gravity.y": -1.0})
    assert len({scene, heavy, tg.Scene(everything())}) == 2


def test_energy_momentum_and_mass_of_one_body() -> None:
    body = tg.BodyDef("a", position=(1.0, 2.0), velocity=(3.0, 4.0), angular_velocity=5.0, mass=2.0, inertia=0.5)
    scene = tg.Scene(tg.SceneDef([body, tg.BodyDef("fixed", "static")], gravity=(0.0, -10.0)))
    assert scene.mass.tolist() == [[2.0, 2.0, 0.5], [0.0, 0.0, 0.0]]
    assert scene.energy() == pytest.approx(0.5 * 2 * 25 + 0.5 * 0.5 * 25 + 2 * 10 * 2, rel=1e-15)
    # L = I ω + m (x vy − y vx)
    assert scene.momentum().tolist() == pytest.approx([6.0, 8.0, 0.5 * 5 + 2 * (1 * 4 - 2 * 3)], rel=1e-15)
    x = scene.coordinates()
    assert x.tolist() == [1.0, 2.0, 0.0, 3.0, 4.0, 5.0]
    state = scene.at_coordinates(2 * x, state=(*scene.initial_state[:2], 0.5))
    assert (state.q[0].tolist(), state.v[0].tolist(), state.time) == ([2.0, 4.0, 0.0], [6.0, 8.0, 10.0], 0.5)
    assert scene.joint_drift() == scene.penetration() == 0.0


def test_inspect_tells_what_is_modelled(scenes: Path) -> None:
    scene = tg.Scene.load(scenes / "cartpole.toml")
    found = scene.inspect()
    assert found["dynamic_bodies"] == 2
    (island,) = found["islands"]
    assert island["bodies"] == ["cart", "pole"]
    assert island["path"] == "linear"
    assert island["equality_rows"] == 4  # two of the rail, two of the hinge
    assert island["contact_rows"] == island["friction_rows"] == 0

"""Scenes as a person describes them: plain data.

The classes say what a scene file says, in the same words (see ``docs/scene-file.md``); every field has the
file's default. ``Scene(definition)`` checks all of it.
"""

from __future__ import annotations

import dataclasses
import json
import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any, Literal, Union

import numpy as np
import numpy.typing as npt

__all__ = [
    "BodyDef",
    "Capsule",
    "Circle",
    "ControlDef",
    "Distance",
    "ForceDef",
    "HalfPlane",
    "JointDef",
    "Limits",
    "Lock",
    "Motor",
    "PairDef",
    "Polygon",
    "Prismatic",
    "Rectangle",
    "Revolute",
    "SceneDef",
    "Slot",
    "Softness",
    "Spring",
    "Weld",
    "to_json",
]

Point = Union[Sequence[float], npt.NDArray[np.float64]]
"""Two numbers, m."""


@dataclass
class Circle:
    """A disc of `radius` (m) about `center` (m) in its body's frame."""

    radius: float
    center: Point = (0.0, 0.0)


@dataclass
class Rectangle:
    """A rectangle of `width` and `height` (m) about `center` (m), turned by `angle` (rad)."""

    width: float
    height: float
    center: Point = (0.0, 0.0)
    angle: float = 0.0


@dataclass
class Polygon:
    """The convex hull of at least three `points` (m)."""

    points: Sequence[Point]


@dataclass
class Capsule:
    """All points within `radius` (m) of the segment from `a` to `b` (m)."""

    a: Point
    b: Point
    radius: float


@dataclass
class HalfPlane:
    """Everything where n·x ≤ `offset` (m), n the unit vector along `normal`; for bodies that do not move."""

    normal: Point
    offset: float = 0.0


Shape = Union[Circle, Rectangle, Polygon, Capsule, HalfPlane]


@dataclass
class Limits:
    """Least and greatest value of a joint's free coordinate (rad or m), counted from the start."""

    lower: float | None = None
    upper: float | None = None


@dataclass
class Motor:
    """Drives a joint's free coordinate at `speed` (rad/s or m/s), with at most `max` (N·m or N)."""

    speed: float
    max: float | None = None


@dataclass
class Softness:
    """Makes a joint's rows springs (N/m, N·m/rad) and dampers (N·s/m, N·m·s/rad)."""

    stiffness: float
    damping: float = 0.0


@dataclass
class Revolute:
    """Two points coincide; the relative angle is free. Anchors are points of the world at the start, m."""

    anchor: Point
    anchor_b: Point | None = None
    limits: Limits = field(default_factory=Limits)
    motor: Motor | None = None


@dataclass
class Weld:
    """Two frames coincide; nothing is free."""

    anchor: Point


@dataclass
class Prismatic:
    """Body b slides along an `axis` of body a without turning; the travel (m) is free."""

    anchor: Point
    axis: Point
    limits: Limits = field(default_factory=Limits)
    motor: Motor | None = None


@dataclass
class Slot:
    """A point of body b slides along an `axis` of body a and may turn; the travel (m) is free."""

    anchor: Point
    axis: Point
    limits: Limits = field(default_factory=Limits)
    motor: Motor | None = None


@dataclass
class Distance:
    """Two points keep their distance: a massless rod of `length` (m; that of the start unless given)."""

    anchor_a: Point
    anchor_b: Point
    length: float | None = None


@dataclass
class Lock:
    """Coordinates of body b's centre of mass stay as at the start."""

    x: bool = False
    y: bool = False
    rotation: bool = False


@dataclass
class Spring:
    """A spring (N/m) and damper (N·s/m) between two points."""

    anchor_a: Point
    anchor_b: Point
    stiffness: float
    length: float | None = None
    damping: float = 0.0


JointKind = Union[Revolute, Weld, Prismatic, Slot, Distance, Lock, Spring]


@dataclass
class BodyDef:
    """A body.

    Parameters
    ----------
    name : str
        Unique; ``"world"`` is taken.
    kind : {"dynamic", "static", "kinematic"}
        Moved by forces, never, or with its given velocity whatever touches it.
    position, angle : (float, float) and float
        Where the body's frame lies at the start, m and rad.
    velocity, angular_velocity : (float, float) and float
        Of the centre of mass at the start, m/s and rad/s.
    shapes : sequence of shapes
        In the body's frame; several make a compound, none makes a body that cannot touch.
    mass, density : float, optional
        kg, or kg/m²: one of them; density 1 unless given.
    inertia : float, optional
        About the centre of mass, kg·m²; from the shapes unless given.
    friction, restitution : float
        μ ≥ 0 and e in [0, 1]; a pair has √(μ_a μ_b) and (e_a + e_b)/2.
    gravity_scale : float
        Factor on gravity.
    groups : sequence of str
        Tags that address several bodies at once, as in ``"mass:links"``.
    category, mask : int
        Two bodies collide if each one's category is in the other's mask.
    """

    name: str
    kind: Literal["dynamic", "static", "kinematic"] = "dynamic"
    position: Point = (0.0, 0.0)
    angle: float = 0.0
    velocity: Point = (0.0, 0.0)
    angular_velocity: float = 0.0
    shapes: Sequence[Shape | Mapping[str, Any]] = ()
    mass: float | None = None
    density: float | None = None
    inertia: float | None = None
    friction: float = 0.5
    restitution: float = 0.0
    gravity_scale: float = 1.0
    groups: Sequence[str] = ()
    category: int = 1
    mask: int = 0xFFFF_FFFF


@dataclass
class JointDef:
    """A joint between two bodies, or the ``"world"`` and a body.

    Parameters
    ----------
    name : str
        Unique.
    bodies : (str, str)
        Bodies a and b.
    kind : Revolute, Weld, Prismatic, Slot, Distance, Lock or Spring
        What it holds.
    collide : bool
        Whether its two bodies may touch each other.
    softness : Softness, optional
        Makes its rows springs and dampers.
    """

    name: str
    bodies: Sequence[str]
    kind: JointKind | Mapping[str, Any]
    collide: bool = False
    softness: Softness | None = None


@dataclass
class ForceDef:
    """A `force` (N) and `torque` (N·m) on a `body` from `start` to `end` (s), or always."""

    body: str
    force: Point = (0.0, 0.0)
    torque: float = 0.0
    start: float | None = None
    end: float | None = None


@dataclass
class ControlDef:
    """A channel: one number per step that drives one thing.

    Parameters
    ----------
    name : str
        Unique.
    input : {"force_x", "force_y", "torque", "motor_speed", "joint_force"}
        What the number does.
    target : str
        The body, or for ``"motor_speed"`` and ``"joint_force"`` the joint.
    """

    name: str
    input: Literal["force_x", "force_y", "torque", "motor_speed", "joint_force"]
    target: str

    def to_dict(self) -> dict[str, Any]:
        """The same as in a scene file."""
        on = "joint" if self.input in ("motor_speed", "joint_force") else "body"
        return {"name": self.name, "input": {self.input: {on: self.target}}}


@dataclass
class PairDef:
    """What two bodies do differently: `collide` or not, their own `friction` and `restitution`."""

    bodies: Sequence[str]
    collide: bool | None = None
    friction: float | None = None
    restitution: float | None = None


@dataclass
class SceneDef:
    """A scene.

    Parameters
    ----------
    bodies, joints, forces, controls, pairs : sequences
        What there is.
    gravity : (float, float)
        m/s².
    dt : float
        Time step, s.
    duration : float
        How long a run lasts unless told otherwise, s.
    stepping : "fixed", {"impact_resolved": {"max_impacts": 8}} or {"accurate": {"max_events": 32}}
        How steps treat impacts.
    contact_model : "gap" or {"velocity": {"contact_distance": 0.01}}
        What a contact constrains.
    stabilisation : mapping, optional
        How position errors of ``joints`` and ``contacts`` are removed.
    recovery_speed, recovery_rate : float
        Greatest speed (m/s, rad/s) at which they are.
    tolerance : float
        Greatest scaled residual of an accepted step.
    name, description : str
        For people.
    """

    bodies: Sequence[BodyDef | Mapping[str, Any]] = ()
    joints: Sequence[JointDef | Mapping[str, Any]] = ()
    forces: Sequence[ForceDef | Mapping[str, Any]] = ()
    controls: Sequence[ControlDef | Mapping[str, Any]] = ()
    pairs: Sequence[PairDef | Mapping[str, Any]] = ()
    gravity: Point = (0.0, -9.81)
    dt: float = 0.01
    duration: float = 1.0
    stepping: str | Mapping[str, Any] = "fixed"
    contact_model: str | Mapping[str, Any] = "gap"
    stabilisation: Mapping[str, Any] | None = None
    recovery_speed: float = 1.0
    recovery_rate: float = 1.0
    tolerance: float = 1e-10
    name: str = ""
    description: str = ""


_TAGGED: dict[type, str] = {
    Circle: "circle",
    Rectangle: "rectangle",
    Polygon: "polygon",
    Capsule: "capsule",
    HalfPlane: "half_plane",
    Revolute: "revolute",
    Weld: "weld",
    Prismatic: "prismatic",
    Slot: "slot",
    Distance: "distance",
    Lock: "lock",
    Spring: "spring",
}


def to_json(definition: Any) -> str:
    """The text of a scene file (JSON) that says the same.

    Parameters
    ----------
    definition : SceneDef or mapping
        A definition, or a mapping with the keys of a scene file.

    Raises
    ------
    TypeError
        If it is neither, or holds something that has no place in a scene.
    ValueError
        If a number is NaN or infinite.
    """
    if not isinstance(definition, (SceneDef, Mapping)):
        kind = type(definition).__name__
        raise TypeError(f"a scene is made of a SceneDef or a mapping, not of {kind}; to read a file use Scene.load")
    return json.dumps(_plain(definition, "scene"))


def _plain(value: Any, path: str) -> Any:
    """Dictionaries, lists and numbers only; what is None is left out."""
    if isinstance(value, ControlDef):
        return value.to_dict()
    if dataclasses.is_dataclass(value) and not isinstance(value, type):
        names = (item.name for item in dataclasses.fields(value))
        table = _plain({name: getattr(value, name) for name in names}, path)
        tag = _TAGGED.get(type(value))
        return table if tag is None else {tag: table}
    if isinstance(value, Mapping):
        items = ((key, item) for key, item in value.items() if item is not None)
        return {str(key): _plain(item, f"{path}.{key}") for key, item in items}
    if isinstance(value, (np.ndarray, np.generic)):
        return _plain(value.tolist(), path)
    if isinstance(value, float) and not math.isfinite(value):
        raise ValueError(f"{path} is {value}; give a finite number")
    if value is None or isinstance(value, (str, bool, int, float)):
        return value
    if isinstance(value, Sequence):
        return [_plain(item, f"{path}[{index}]") for index, item in enumerate(value)]
    raise TypeError(f"{path} is a {type(value).__name__}, which has no place in a scene")

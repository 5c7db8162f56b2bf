"""Scenes made of the bodies, forces and constraints of lcp-physics."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from itertools import groupby
from typing import Any, Protocol

import numpy as np

from tangency._native import Scene
from tangency.definitions import (
    BodyDef,
    Circle,
    ForceDef,
    JointDef,
    JointKind,
    Lock,
    PairDef,
    Polygon,
    Rectangle,
    Revolute,
    SceneDef,
    Shape,
    Weld,
)
from tangency.lcp_physics import parts
from tangency.lcp_physics.vectors import numbers, to_tangency, wrench_to_tangency

__all__ = ["scene_def", "scene_def_of_world"]


class _World(Protocol):
    """What is read of a world."""

    @property
    def bodies(self) -> Sequence[Any]: ...
    @property
    def joints(self) -> Sequence[Any]: ...
    @property
    def dt(self) -> float: ...
    @property
    def eps(self) -> float: ...
    @property
    def tol(self) -> float: ...
    @property
    def fric_dirs(self) -> int: ...
    @property
    def post_stab(self) -> bool: ...


def scene_def_of_world(world: _World, *, pixels_per_meter: float = 1.0, duration: float = 10.0) -> SceneDef:
    """The scene of a ``World`` as it is now.

    Parameters
    ----------
    world : lcp_physics.physics.world.World
        Or anything with its attributes ``bodies``, ``joints``, ``dt``, ``eps``, ``tol``, ``fric_dirs`` and
        ``post_stab``.
    pixels_per_meter, duration
        As of `scene_def`.

    Returns
    -------
    SceneDef

    Raises
    ------
    ValueError
        As `scene_def`.
    """
    return scene_def(
        world.bodies,
        [joint[0] for joint in world.joints],
        dt=float(world.dt),
        eps=float(world.eps),
        tol=float(world.tol),
        fric_dirs=world.fric_dirs,
        post_stab=world.post_stab,
        strict_no_penetration=getattr(world, "strict_no_pen", True),
        pixels_per_meter=pixels_per_meter,
        duration=duration,
    )


def scene_def(
    bodies: Sequence[Any],
    constraints: Iterable[Any] = (),
    *,
    dt: float = 1 / 30,
    eps: float = 0.1,
    tol: float = 1e-6,
    fric_dirs: int = 2,
    post_stab: bool = False,
    strict_no_penetration: bool = True,
    pixels_per_meter: float = 1.0,
    duration: float = 10.0,
) -> SceneDef:
    """The scene of bodies and constraints of lcp-physics.

    Bodies are named by kind and place, as ``"circle 0"``; those under a ``TotalConstraint`` are static.

    Parameters
    ----------
    bodies : sequence
        ``Circle``, ``Rect`` and ``Hull``, with their forces.
    constraints : iterable
        ``Joint``, ``FixedJoint``, ``XConstraint``, ``YConstraint``, ``RotConstraint`` and ``TotalConstraint``.
    dt : float
        Time step, s.
    eps : float
        Distance within which pairs are constrained, px.
    tol : float
        Greatest penetration at the start, px, if `strict_no_penetration`.
    fric_dirs : int
        Directions of friction: in the plane there are 2.
    post_stab : bool
        Whether position errors of joints are removed after each step. Those of contacts always are, which takes
        the place of halving steps until nothing penetrates.
    strict_no_penetration : bool
        Whether a penetration at the start is refused.
    pixels_per_meter : float
        Pixels per metre: the scene is in metres.
    duration : float
        How long a run lasts, s. Forces in time are taken down so far, at the beginning of every step.

    Returns
    -------
    SceneDef
        With the contact model and the rule for friction of lcp-physics.

    Raises
    ------
    ValueError
        If a body or constraint is of no known kind, or something penetrates at the start.
    """
    if fric_dirs != 2:
        raise ValueError(f"fric_dirs is {fric_dirs}; in the plane there are 2")
    reader = _Reader(list(bodies), list(constraints), pixels_per_meter, dt, duration)
    gravity = reader.gravity()
    definition = SceneDef(
        bodies=[reader.body(k, gravity) for k in range(len(bodies))],
        joints=reader.joints(),
        forces=[force for k in range(len(bodies)) for force in reader.forces(k)],
        pairs=reader.pairs(),
        gravity=(0.0, -gravity / pixels_per_meter),
        dt=dt,
        duration=duration,
        contact_model={"velocity": {"contact_distance": eps / pixels_per_meter}},
        stabilisation={"joints": "post" if post_stab else "none", "contacts": "post"},
    )
    if strict_no_penetration:
        depth = Scene(definition).penetration() * pixels_per_meter
        if depth > tol:
            raise ValueError(f"bodies penetrate by {depth:g} px at the start, more than tol = {tol:g} px")
    return definition


def _kind(value: Any) -> str:
    """Name of the class of lcp-physics that a body or constraint is, also where it is a subclass of one."""
    for base in type(value).__mro__:
        if base.__name__ in parts.__all__:
            return base.__name__
    raise ValueError(f"{type(value).__name__} is none of {', '.join(parts.__all__)}")


class _Reader:
    """Bodies and constraints, told in definitions."""

    def __init__(
        self, bodies: list[Any], constraints: list[Any], scale: float, dt: float, duration: float
    ) -> None:
        self.bodies, self.constraints, self.scale, self.dt, self.duration = bodies, constraints, scale, dt, duration
        self.names = [f"{_kind(body).lower()} {k}" for k, body in enumerate(bodies)]
        self.places = {id(body): k for k, body in enumerate(bodies)}
        total = (constraint.body1 for constraint in constraints if _kind(constraint) == "TotalConstraint")
        self.static = {self.place(body) for body in total}

    def place(self, body: Any) -> int:
        if id(body) not in self.places:
            raise ValueError(f"a constraint holds a {type(body).__name__} that is not among the bodies")
        return self.places[id(body)]

    def body(self, k: int, gravity: float) -> BodyDef:
        body, still = self.bodies[k], k in self.static
        x, y, angle = to_tangency(body.p, self.scale).tolist()
        vx, vy, spin = to_tangency(body.v, self.scale).tolist()
        return BodyDef(
            self.names[k],
            "static" if still else "dynamic",
            position=(x, y),
            angle=angle,
            velocity=(0.0, 0.0) if still else (vx, vy),
            angular_velocity=0.0 if still else spin,
            shapes=[self.shape(body)],
            mass=None if still else float(body.mass),
            friction=float(body.fric_coeff),
            restitution=float(body.restitution),
            gravity_scale=self.weight(body) / gravity if gravity else 1.0,
        )

    def shape(self, body: Any) -> Shape:
        if _kind(body) == "Circle":
            return Circle(float(body.rad) / self.scale)
        if _kind(body) == "Rect":
            width, height = (numbers(body.dims) / self.scale).tolist()
            return Rectangle(width, height)
        # Its points are turned with the body; here they are those at angle zero.
        angle = float(body.p[0])
        c, s = math.cos(angle), math.sin(angle)
        points = np.stack([numbers(point) for point in body.verts]) @ np.array([[c, -s], [s, c]])
        return Polygon((points * [1, -1] / self.scale).tolist())

    def weight(self, body: Any) -> float:
        """Its acceleration of gravity, px/s²."""
        return sum(float(force.multiplier) for force in body.forces if _kind(force) == "Gravity")

    def gravity(self) -> float:
        """That of the first body that has one; the others are given a factor."""
        return next((weight for weight in map(self.weight, self.bodies) if weight), 0.0)

    def forces(self, k: int) -> list[ForceDef]:
        """Forces in time, constant over whole steps."""
        acting = [force for force in self.bodies[k].forces if _kind(force) != "Gravity"]
        if not acting or k in self.static:
            return []
        found = []
        for wrench, steps in groupby(range(round(self.duration / self.dt)), lambda step: self.wrench(acting, step)):
            if any(wrench):
                first, *rest = steps
                start, end = first * self.dt, (rest[-1] if rest else first) * self.dt + self.dt
                found.append(ForceDef(self.names[k], wrench[:2], wrench[2], start, end))
        return found

    def wrench(self, acting: list[Any], step: int) -> tuple[float, float, float]:
        total = sum((numbers(force.force(step * self.dt)) for force in acting), np.zeros(3))
        x, y, torque = wrench_to_tangency(total, self.scale).tolist()
        return x, y, torque

    def joints(self) -> list[JointDef]:
        kept = [constraint for constraint in self.constraints if _kind(constraint) != "TotalConstraint"]
        return [self.joint(k, constraint) for k, constraint in enumerate(kept)]

    def joint(self, k: int, constraint: Any) -> JointDef:
        kind, first = _kind(constraint), self.place(constraint.body1)
        name = f"{kind.lower()} {k}"
        if constraint.body2 is None:
            held = self.held(kind, constraint)
            return JointDef(name, ("world", self.names[first]), held, collide=True)
        second = self.place(constraint.body2)
        anchor = constraint.pos if kind == "Joint" else constraint.body1.p[1:]
        x, y = self.point(anchor)
        held = Revolute((x, y)) if kind == "Joint" else Weld((x, y))
        return JointDef(name, (self.names[first], self.names[second]), held, collide=not self.apart(first, second))

    def held(self, kind: str, constraint: Any) -> JointKind:
        """What a constraint of one body holds."""
        if kind == "Joint":
            return Revolute(self.point(constraint.pos))
        return Lock(x=kind == "XConstraint", y=kind == "YConstraint", rotation=kind == "RotConstraint")

    def point(self, point: Any) -> tuple[float, float]:
        x, y = (numbers(point) / self.scale).tolist()
        return x, -y

    def apart(self, i: int, j: int) -> bool:
        """Whether two bodies pass through each other."""
        return self.bodies[j].geom in self.bodies[i].geom.no_contact

    def pairs(self) -> list[PairDef]:
        """Pairs that do not collide, and those whose friction, (μ_a + μ_b)/2 there, is not √(μ_a μ_b)."""
        found = []
        for j, b in enumerate(self.bodies):
            for i, a in enumerate(self.bodies[:j]):
                names = (self.names[i], self.names[j])
                if self.apart(i, j):
                    found.append(PairDef(names, collide=False))
                elif float(a.fric_coeff) != float(b.fric_coeff):
                    found.append(PairDef(names, friction=(float(a.fric_coeff) + float(b.fric_coeff)) / 2))
        return found

"""Bodies, forces and constraints with the names and arguments of lcp-physics, without its library."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import numpy.typing as npt

from tangency.lcp_physics.vectors import numbers

__all__ = [
    "Circle",
    "ExternalForce",
    "FixedJoint",
    "Gravity",
    "Hull",
    "Joint",
    "Rect",
    "RotConstraint",
    "TotalConstraint",
    "XConstraint",
    "YConstraint",
]

Array = npt.NDArray[np.float64]


class _Geom:
    """What a body does not collide with."""

    def __init__(self) -> None:
        self.no_contact: set[Any] = set()


def _with_angle(values: Any) -> Array:
    """(θ, x, y) from that or from (x, y)."""
    found = numbers(values)
    if found.shape not in ((2,), (3,)):
        raise ValueError(f"a pose or velocity has shape {found.shape}; give (x, y) or (angle, x, y)")
    return np.concatenate([np.zeros(3 - found.size), found])


class _Body:
    def __init__(self, pos: Any, vel: Any, mass: float, restitution: float, fric_coeff: float) -> None:
        self.p, self.v = _with_angle(pos), _with_angle(vel)
        self.mass, self.restitution, self.fric_coeff = mass, restitution, fric_coeff
        self.forces: list[Any] = []
        self.geom = _Geom()

    def add_force(self, force: Gravity | ExternalForce) -> None:
        """Lets a force act on the body."""
        self.forces.append(force)

    def add_no_contact(self, other: _Body) -> None:
        """Lets the two bodies pass through each other."""
        self.geom.no_contact.add(other.geom)
        other.geom.no_contact.add(self.geom)


class Circle(_Body):
    """A disc of radius `rad` (px) at `pos`, (x, y) or (θ, x, y)."""

    def __init__(
        self, pos: Any, rad: float, vel: Any = (0, 0, 0), mass: float = 1.0, restitution: float = 0.5,
        fric_coeff: float = 0.9,
    ) -> None:  # fmt: skip
        super().__init__(pos, vel, mass, restitution, fric_coeff)
        self.rad = rad


class Rect(_Body):
    """A rectangle with sides `dims` (px, px) at `pos`, (x, y) or (θ, x, y)."""

    def __init__(
        self, pos: Any, dims: Any, vel: Any = (0, 0, 0), mass: float = 1.0, restitution: float = 0.5,
        fric_coeff: float = 0.9,
    ) -> None:  # fmt: skip
        super().__init__(pos, vel, mass, restitution, fric_coeff)
        self.dims = dims


class Hull(_Body):
    """A convex polygon with `vertices` (px) about `ref_point`; its position is that of its centroid."""

    def __init__(
        self, ref_point: Any, vertices: Any, vel: Any = (0, 0, 0), mass: float = 1.0, restitution: float = 0.5,
        fric_coeff: float = 0.9,
    ) -> None:  # fmt: skip
        points = numbers(vertices)
        after = np.roll(points, -1, axis=0)
        cross = points[:, 0] * after[:, 1] - points[:, 1] * after[:, 0]
        centroid = (cross[:, None] * (points + after)).sum(axis=0) / (3 * cross.sum())
        super().__init__(numbers(ref_point) + centroid, vel, mass, restitution, fric_coeff)
        self.verts = list(points - centroid)


class Gravity:
    """A force of `g` (px/s²) times the mass, down."""

    def __init__(self, g: float = 10.0) -> None:
        self.multiplier = g


class ExternalForce:
    """A wrench in time: `multiplier` times ``force_func(t)``, which returns (τ, fx, fy)."""

    def __init__(self, force_func: Callable[[float], Any], multiplier: float = 100.0) -> None:
        self.multiplier = multiplier
        self.force = lambda t: multiplier * numbers(force_func(t))


class _Constraint:
    """On one body."""

    def __init__(self, body1: Any) -> None:
        self.body1, self.body2 = body1, None


class XConstraint(_Constraint):
    """The body does not move along x."""


class YConstraint(_Constraint):
    """The body does not move along y."""


class RotConstraint(_Constraint):
    """The body does not turn."""


class TotalConstraint(_Constraint):
    """The body does not move."""


class Joint:
    """A hinge of two bodies, or of one and the world, at `pos` (px)."""

    def __init__(self, body1: Any, body2: Any, pos: Any) -> None:
        self.body1, self.body2, self.pos = body1, body2, pos


class FixedJoint:
    """Two bodies move as one."""

    def __init__(self, body1: Any, body2: Any) -> None:
        self.body1, self.body2 = body1, body2

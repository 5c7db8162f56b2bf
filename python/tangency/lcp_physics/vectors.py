"""Vectors of lcp-physics and of this engine."""

from __future__ import annotations

from typing import Any

import numpy as np
import numpy.typing as npt

__all__ = ["from_tangency", "numbers", "to_tangency", "wrench_from_tangency", "wrench_to_tangency"]

Array = npt.NDArray[np.float64]


def numbers(value: Any) -> Array:
    """Numbers of an array, or of a tensor that may have a gradient."""
    return np.asarray(value.detach().cpu() if hasattr(value, "detach") else value, dtype=np.float64)


def _triples(value: Any) -> Array:
    found = numbers(value)
    if found.ndim == 0 or found.size % 3 or (found.ndim > 1 and found.shape[-1] != 3):
        raise ValueError(f"vectors have shape {found.shape}; give (..., 3), or a flat vector of 3 per body")
    return found.reshape(-1, 3) if found.ndim == 1 and found.size != 3 else found


def to_tangency(vectors: Any, pixels_per_meter: float = 1.0) -> Array:
    """Poses (θ, x, y) or velocities (ω, vx, vy) as this engine has them.

    Parameters
    ----------
    vectors : array_like or tensor, shape (..., 3) or (3 bodies,)
        rad and px, y down; a flat vector, such as ``world.v``, becomes (bodies, 3).
    pixels_per_meter : float
        Pixels per metre.

    Returns
    -------
    ndarray, shape (..., 3)
        (x, y, angle), m and rad, y up.
    """
    angle, x, y = np.moveaxis(_triples(vectors), -1, 0)
    return np.stack([x / pixels_per_meter, -y / pixels_per_meter, -angle], axis=-1)


def from_tangency(vectors: Any, pixels_per_meter: float = 1.0) -> Array:
    """The inverse of `to_tangency`: (x, y, angle) becomes (θ, x, y)."""
    x, y, angle = np.moveaxis(_triples(vectors), -1, 0)
    return np.stack([-angle, x * pixels_per_meter, -y * pixels_per_meter], axis=-1)


def wrench_to_tangency(wrenches: Any, pixels_per_meter: float = 1.0) -> Array:
    """Wrenches (τ, fx, fy) as (fx, fy, torque), N and N·m.

    Parameters
    ----------
    wrenches : array_like or tensor, shape (..., 3) or (3 bodies,)
        kg·px²/s² and kg·px/s², y down.
    pixels_per_meter : float
        Pixels per metre.

    Returns
    -------
    ndarray, shape (..., 3)
    """
    torque, x, y = np.moveaxis(_triples(wrenches), -1, 0)
    return np.stack([x / pixels_per_meter, -y / pixels_per_meter, -torque / pixels_per_meter**2], axis=-1)


def wrench_from_tangency(wrenches: Any, pixels_per_meter: float = 1.0) -> Array:
    """The inverse of `wrench_to_tangency`: (fx, fy, torque) becomes (τ, fx, fy)."""
    x, y, torque = np.moveaxis(_triples(wrenches), -1, 0)
    return np.stack([-torque * pixels_per_meter**2, x * pixels_per_meter, -y * pixels_per_meter], axis=-1)

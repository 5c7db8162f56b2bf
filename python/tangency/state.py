"""States of scenes."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import numpy.typing as npt

__all__ = ["State"]


class State(NamedTuple):
    """Poses and velocities of all bodies of a scene, static ones included, in the scene's order.

    Wherever a state is asked for, a plain tuple ``(q, v)`` or ``(q, v, time)`` does as well.

    Attributes
    ----------
    q : ndarray of float64, shape (bodies, 3)
        Poses of the centres of mass: x (m), y (m), angle (rad, counter-clockwise).
    v : ndarray of float64, shape (bodies, 3)
        Their velocities: m/s, m/s, rad/s.
    time : float
        s.
    """

    q: npt.NDArray[np.float64]
    v: npt.NDArray[np.float64]
    time: float = 0.0

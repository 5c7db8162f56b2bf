"""A billiard table of its own: hard discs in a square box, from event to event.

Nothing here uses the engine: the data that a model with the engine inside learns from must not come from the
engine. Between events discs move on straight lines, and events are solved for::

    wall    x + v t = r   or   1 − r
    pair    |Δx + Δv t| = 2 r     →    t = (−b − √(b² − a c)) / a,   a = Δv², b = Δx·Δv < 0, c = Δx² − 4 r²

At a wall the velocity across it turns round; two discs of equal mass exchange their velocities along the line of
centres. Nothing is lost: kinetic energy and, but for walls, momentum are constants.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

__all__ = ["Table", "Trial"]

Array = npt.NDArray[np.float64]


@dataclass(frozen=True)
class Trial:
    """Discs at the times of frames.

    Attributes
    ----------
    x, v : ndarray, shape (frames, discs, 2)
        Centres, in sides of the box, and velocities, in sides per second.
    """

    x: Array
    v: Array


@dataclass(frozen=True)
class Table:
    """The unit square with `discs` equal discs of a `radius`."""

    discs: int = 3
    radius: float = 0.1
    greatest_speed: float = 1.2
    interval: float = 1.0 / 20.0
    """Time between frames, s."""

    def start(self, rng: np.random.Generator) -> tuple[Array, Array]:
        """Places that do not overlap, and velocities of any direction; shape (discs, 2) each."""
        x = np.empty((0, 2))
        while len(x) < self.discs:
            place = rng.uniform(self.radius, 1.0 - self.radius, 2)
            if np.all(np.linalg.norm(x - place, axis=1) > 2.0 * self.radius):
                x = np.vstack([x, place])
        speed = self.greatest_speed * np.sqrt(rng.uniform(0.05, 1.0, self.discs))
        angle = rng.uniform(0.0, 2.0 * np.pi, self.discs)
        return x, np.stack([speed * np.cos(angle), speed * np.sin(angle)], axis=1)

    def run(self, x: Array, v: Array, frames: int) -> Trial:
        """The motion from (x, v), seen at so many frames, the first one at once."""
        x, v = x.copy(), v.copy()
        xs, vs = [x.copy()], [v.copy()]
        for _ in range(frames - 1):
            self._advance(x, v, self.interval)
            xs.append(x.copy())
            vs.append(v.copy())
        return Trial(np.array(xs), np.array(vs))

    def _advance(self, x: Array, v: Array, left: float) -> None:
        """Moves the discs through all events of some time, in place."""
        while True:
            at, event = self._next(x, v)
            if at > left:
                x += left * v
                return
            x += at * v
            left -= at
            self._collide(x, v, event)

    def _next(self, x: Array, v: Array) -> tuple[float, tuple[int, int]]:
        """When the next event is, and what: (disc, −1 − axis) for a wall, (disc, disc) for a pair."""
        with np.errstate(divide="ignore", invalid="ignore"):
            room = np.where(v > 0.0, 1.0 - self.radius - x, self.radius - x)
            walls = np.where(v == 0.0, np.inf, np.maximum(room / v, 0.0))
        disc, axis = np.unravel_index(np.argmin(walls), walls.shape)
        at, event = float(walls[disc, axis]), (int(disc), -1 - int(axis))
        for i in range(self.discs):
            for j in range(i):
                meeting = self._meeting(x[i] - x[j], v[i] - v[j])
                if meeting < at:
                    at, event = meeting, (i, j)
        return at, event

    def _meeting(self, dx: Array, dv: Array) -> float:
        """When two discs touch; never unless they approach."""
        a, b, c = float(dv @ dv), float(dx @ dv), float(dx @ dx) - 4.0 * self.radius**2
        under_root = b * b - a * c
        if b >= 0.0 or under_root <= 0.0:
            return np.inf
        return max(c / (-b + float(np.sqrt(under_root))), 0.0)  # the smaller root, without cancellation

    def _collide(self, x: Array, v: Array, event: tuple[int, int]) -> None:
        i, j = event
        if j < 0:
            v[i, -1 - j] *= -1.0
            return
        n = x[i] - x[j]
        n /= np.linalg.norm(n)
        exchanged = ((v[i] - v[j]) @ n) * n
        v[i] -= exchanged
        v[j] += exchanged

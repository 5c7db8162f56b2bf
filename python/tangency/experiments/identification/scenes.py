"""What is identified, and from what."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

import tangency

__all__ = ["BLOCK", "POLYGON", "Case"]

ACCURATE: dict[str, dict[str, int]] = {"accurate": {}}


@dataclass(frozen=True)
class Case:
    """A scene with the true numbers, the names of those that are unknown, and where the search begins."""

    name: str
    scene: tangency.Scene
    unknown: tuple[str, ...]
    guess: tuple[float, ...]
    steps: int
    body: str
    """The one that is seen."""
    noise: tuple[float, float, float]
    """Standard deviation of what is seen of x (m), y (m) and the angle (rad)."""

    @property
    def truth(self) -> tuple[float, ...]:
        """The true numbers."""
        return tuple(self.scene.value(name) for name in self.unknown)


def _block() -> Case:
    """A block slides over a floor, bounces off a wall, and slides back until friction stops it."""
    floor = tangency.BodyDef("floor", "static", shapes=[tangency.HalfPlane((0, 1))], friction=0.3)
    wall = tangency.BodyDef("wall", "static", shapes=[tangency.HalfPlane((-1, 0), -1.0)], friction=0.0, restitution=0.6)
    size = tangency.Rectangle(0.2, 0.1)
    block = tangency.BodyDef(
        "block", position=(0.0, 0.05), velocity=(3.0, 0.0), shapes=[size], friction=0.3, restitution=0.6
    )
    scene = tangency.Scene(tangency.SceneDef([floor, wall, block], dt=0.01, stepping=ACCURATE, name="Block"))
    return Case("block", scene, ("friction:block", "restitution:block"), (0.2, 0.8), 120, "block", (2e-3, 2e-3, 5e-3))


def _polygon() -> Case:
    """A quadrilateral is thrown on a floor, tumbles and comes to rest."""
    floor = tangency.BodyDef("floor", "static", shapes=[tangency.HalfPlane((0, 1))], friction=0.5, restitution=0.3)
    shape = tangency.Polygon([(-0.15, -0.1), (0.2, -0.08), (0.12, 0.12), (-0.1, 0.1)])
    stone = tangency.BodyDef(
        "stone", position=(0.0, 0.3), angle=0.3, velocity=(1.5, 0.0), angular_velocity=-10.0, shapes=[shape],
        friction=0.5, restitution=0.3,
    )  # fmt: skip
    scene = tangency.Scene(tangency.SceneDef([floor, stone], dt=0.01, stepping=ACCURATE, name="Stone"))
    names = tuple(f"vertex.{k}.{axis}:stone" for k in range(4) for axis in "xy")
    truth = np.array([scene.value(name) for name in names])
    guess = tuple(truth + 0.01 * np.array([1, -1, -1, 1, 1, 1, -1, 1]))
    return Case("polygon", scene, names, guess, 120, "stone", (1e-3, 1e-3, 3e-3))


BLOCK = _block()
POLYGON = _polygon()

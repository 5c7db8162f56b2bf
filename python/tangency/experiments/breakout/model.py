"""The model: ball, walls and paddle in the engine, with pixels for metres and frames for seconds.

The paddle slides under a push against a drag; its mass is 1, so that after a frame

::

    v⁺ = (v + c s a)/(1 + c),        a = −1, 0, 1

with s the speed that a lasting push leads to (one for each direction) and c the drag. The screen shows what a push
does some frames later: the delay. Heights are minus the rows of the screen.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache

import tangency
from tangency.experiments.breakout.frames import BALL, LEFT, PADDLE_ROW, RIGHT, TOP

__all__ = ["Numbers", "scene"]

WIDTHS = (16.0, 8.0)
"""Of the paddle, pixels."""


@dataclass(frozen=True)
class Numbers:
    """What is learned.

    Attributes
    ----------
    left, right : float
        Speeds under a lasting push, pixels per frame.
    drag : float
        Per frame.
    delay : int
        Frames.
    """

    left: float
    right: float
    drag: float
    delay: int

    def force(self, push: int) -> float:
        """Of a push −1, 0 or 1."""
        return self.drag * push * (self.left if push < 0 else self.right)


@lru_cache(maxsize=8)
def scene(drag: float, width: float = WIDTHS[0]) -> tangency.Scene:
    """Ball and paddle in the court; bodies are ``court``, ``ball``, ``paddle``, the channel is the push."""
    shapes = [
        tangency.HalfPlane((1.0, 0.0), float(LEFT)),
        tangency.HalfPlane((-1.0, 0.0), float(-RIGHT)),
        tangency.HalfPlane((0.0, -1.0), float(TOP)),
    ]
    court = tangency.BodyDef("court", "static", shapes=shapes, friction=0.0, restitution=1.0)
    middle, height = (LEFT + RIGHT) / 2.0, -PADDLE_ROW
    disc = [tangency.Circle(BALL[0] / 2.0)]
    ball = tangency.BodyDef("ball", position=(middle, -120.0), shapes=disc, mass=1e-3, friction=0.0, restitution=1.0)
    bar = [tangency.Rectangle(width, 4.0)]
    paddle = tangency.BodyDef("paddle", position=(middle, height), shapes=bar, mass=1.0, friction=0.0, restitution=1.0)
    rail = tangency.Prismatic((middle, height), (1.0, 0.0))
    damper = tangency.Spring((middle - 1000.0, height), (middle, height), stiffness=0.0, damping=drag)
    return tangency.Scene(
        tangency.SceneDef(
            [court, ball, paddle],
            [tangency.JointDef("rail", ("world", "paddle"), rail), tangency.JointDef("drag", ("world", "paddle"), damper)],
            controls=[tangency.ControlDef("push", "force_x", "paddle")],
            pairs=[tangency.PairDef(("court", "paddle"), collide=False)],
            gravity=(0.0, 0.0),
            dt=1.0,
            name="Breakout",
        )
    )

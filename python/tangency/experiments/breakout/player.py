"""Who plays: at random, by following the ball, or by planning through the model.

A player sees frames alone. It serves when no ball has been in sight for a while; a ball that bricks hide for a few
frames is taken to move on.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol

import numpy as np
import numpy.typing as npt

import tangency
from tangency.experiments.breakout.frames import LEFT, PADDLE_ROW, RIGHT, Sight, see
from tangency.experiments.breakout.game import ACTIONS, Action, Game, Image
from tangency.experiments.breakout.model import WIDTHS, Numbers, scene

__all__ = ["Eyes", "Follower", "Planner", "Player", "Random", "play"]

Array = npt.NDArray[np.float64]

LAST_LEFT = RIGHT - 8
"""Column of the paddle's left edge at the right end of its travel; a wide one is half behind the wall."""

PATIENCE = 12
"""Frames without a ball before serving."""

HORIZON = 5
"""Of a plan, frames."""

EFFORT = 1e-3
"""Weight of the squared push (in units of a full one) beside the squared distance in pixels."""

REACH = 0.35
"""Greatest distance of an aim from the middle of the paddle, in widths."""

BAND = 0.5
"""Part of a full push below which a planned one is none."""


_BODIES = scene(1.0)
_BALL, _PADDLE = _BODIES.body("ball"), _BODIES.body("paddle")


class Player(Protocol):
    """Chooses an action for every frame."""

    def act(self, frame: Image) -> Action:
        """The action after a frame."""


class Eyes:
    """What was seen, over time."""

    def __init__(self) -> None:
        self.ball: tuple[float, float] | None = None
        """Column and row; moved on by its velocity while hidden."""
        self.velocity = (0.0, 0.0)
        """From its last two places, pixels per frame, rows downwards."""
        self.center, self.width = (LEFT + RIGHT) / 2.0, WIDTHS[0]
        """Of the paddle."""
        self.hidden = 0
        """Frames since the ball was seen."""

    def look(self, frame: Image) -> None:
        """Takes in the next frame."""
        sight = see(frame)
        self._look_for_paddle(sight)
        if sight.ball is None:
            self.hidden += 1
            if self.hidden > PATIENCE:
                self.ball = None
            elif self.ball is not None:
                self.ball = (self.ball[0] + self.velocity[0], self.ball[1] + self.velocity[1])
            return
        if self.ball is not None:
            self.velocity = (sight.ball[0] - self.ball[0], sight.ball[1] - self.ball[1])
        else:
            self.velocity = (0.0, 0.0)
        self.ball, self.hidden = sight.ball, 0

    def _look_for_paddle(self, sight: Sight) -> None:
        if sight.paddle is None:
            return
        left, end = sight.paddle
        if end < RIGHT and float(end - left) in WIDTHS:
            self.width = float(end - left)
        self.center = left + self.width / 2.0

    def blocked(self, way: float) -> bool:
        """Whether the paddle is at the end of its travel, that way."""
        left = self.center - self.width / 2.0
        return (way < 0.0 and left <= LEFT) or (way > 0.0 and left >= LAST_LEFT)

    @property
    def falling(self) -> bool:
        """Whether there is a ball above the paddle that comes down."""
        return self.ball is not None and self.velocity[1] > 0.0 and self.ball[1] < PADDLE_ROW

    @property
    def serve(self) -> bool:
        """Whether to serve: every other frame without a ball."""
        return self.ball is None and self.hidden > PATIENCE and self.hidden % 2 == 0


class Random:
    """The baseline without eyes: one of the four actions, drawn anew every four frames."""

    def __init__(self, seed: int) -> None:
        self._rng = np.random.default_rng(seed)
        self._left, self._action = 0, Action.NOOP

    def act(self, frame: Image) -> Action:
        """See `Player`."""
        if self._left == 0:
            self._left, self._action = 4, [*ACTIONS.values(), Action.FIRE][self._rng.integers(4)]
        self._left -= 1
        return self._action


class Follower:
    """The baseline without a model: goes towards the ball's column unless the ball is over the paddle's middle half."""

    def __init__(self) -> None:
        self._eyes = Eyes()

    def act(self, frame: Image) -> Action:
        """See `Player`."""
        eyes = self._eyes
        eyes.look(frame)
        if eyes.ball is None:
            return Action.FIRE if eyes.serve else Action.NOOP
        away = eyes.ball[0] - eyes.center
        return ACTIONS[0 if abs(away) < eyes.width / 4.0 else int(np.sign(away))]


@dataclass
class _Aim:
    """Where on the paddle the ball is to land, drawn for every fall, so that no flight repeats for ever."""

    rng: np.random.Generator
    offset: float = 0.0
    falling: bool = False

    def update(self, falling: bool, width: float) -> float:
        if falling and not self.falling:
            self.offset = float(self.rng.uniform(-REACH, REACH)) * width
        self.falling = falling
        return self.offset


class Planner:
    """Iterative LQR through the engine over five frames, anew at every frame.

    The cost is the paper's: the squared distance of paddle and ball while the ball falls, and else that of the paddle
    from the middle. The action is the sign of the plan's first push, or none if that is less than half a full one. The
    ball is met with a place of the paddle that is drawn for every fall.
    """

    def __init__(self, numbers: Numbers, seed: int) -> None:
        self._numbers = numbers
        self._eyes, self._aim = Eyes(), _Aim(np.random.default_rng(seed))
        self._pushes = [0] * (numbers.delay + 1)
        self._speed = 0.0
        self._guess = np.zeros((HORIZON, 1))
        self._limits = (numbers.force(-1), numbers.force(1))

    def act(self, frame: Image) -> Action:
        """See `Player`."""
        self._eyes.look(frame)
        push = self._push()
        self._pushes = [*self._pushes[1:], push]
        speed = float(self._ahead(self._state(), self._pushes[:1]).v[_PADDLE, 0])
        self._speed = 0.0 if self._eyes.blocked(speed) else speed
        return Action.FIRE if self._eyes.serve else ACTIONS[push]

    def _push(self) -> int:
        """−1, 0 or 1: the plan's first, from where the pushes under way will have led."""
        state = self._ahead(self._state(), self._pushes[1:])
        falling = self._eyes.falling
        cost = self._cost(falling, self._aim.update(falling, self._eyes.width))
        found = _plan(self._scene, cost, self._guess, state, self._limits)
        self._guess = np.vstack([found[1:], found[-1:]])
        first = float(found[0, 0])
        part = first / abs(self._limits[int(first > 0.0)])
        return 0 if abs(part) < BAND or self._eyes.blocked(part) else int(np.sign(part))

    @property
    def _scene(self) -> tangency.Scene:
        return scene(self._numbers.drag, self._eyes.width)

    def _state(self) -> tangency.State:
        """The engine's, as seen; a ball that is not above the paddle rests in the middle."""
        eyes, start = self._eyes, self._scene.initial_state
        q, v = start.q.copy(), np.zeros_like(start.v)
        q[_PADDLE, 0], v[_PADDLE, 0] = eyes.center, self._speed
        if eyes.ball is not None and eyes.ball[1] < PADDLE_ROW - 3.0:
            q[_BALL, :2] = eyes.ball[0], -eyes.ball[1]
            v[_BALL, :2] = eyes.velocity[0], -eyes.velocity[1]
        return tangency.State(q, v)

    def _ahead(self, state: tangency.State, pushes: list[int]) -> tangency.State:
        """After some pushes."""
        if not pushes:
            return state
        forces = np.array([[self._numbers.force(push)] for push in pushes])
        after: tangency.State = tangency.rollout(self._scene, len(pushes), forces, state=state).last
        return after

    def _cost(self, falling: bool, offset: float) -> tangency.Quadratic:
        """Coordinates are (ball x y θ, paddle x y θ | their rates)."""
        lower, upper = self._limits
        cost = tangency.Quadratic.of_effort(12, 1, EFFORT / max(-lower, upper) ** 2)
        if not falling:
            cost.aim(3, (LEFT + RIGHT) / 2.0, 1.0, 1.0)
            return cost
        cost.target[3] = -offset  # ½ (x_paddle − x_ball + offset)²
        for weights in (cost.state, cost.last):
            weights[np.ix_([0, 3], [0, 3])] = [[1.0, -1.0], [-1.0, 1.0]]
        return cost


def _plan(
    model: tangency.Scene, cost: tangency.Quadratic, guess: Array, state: tangency.State, limits: tuple[float, float]
) -> Array:
    """The planned forces, (steps, 1), or the best ones where the search was ended."""
    lower, upper = limits
    try:
        found = tangency.plan(model, cost, guess, state=state, lower=lower, upper=upper, max_iterations=20, tolerance=1e-6)
    except tangency.PlanError as error:
        best: tangency.Plan | None = getattr(error, "plan", None)
        if best is None:
            raise
        found = best
    forces: Array = found.controls
    return forces


def play(player: Player, seed: int, most_frames: int) -> Game:
    """A game to its end, or as far as it went in so many frames."""
    game = Game(seed)
    while not game.over and game.frames < most_frames:
        game.act(player.act(game.frame()))
    return game

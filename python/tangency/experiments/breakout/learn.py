"""Learning how the paddle moves from random play, by gradient descent through the engine.

Random play is cut into stretches; each is run from the paddle's place and speed at its beginning, under the pushes
of then, and the loss is the mean squared distance between paddle and screen.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

import tangency
from tangency.experiments.breakout.frames import LEFT, RIGHT, see
from tangency.experiments.breakout.game import ACTIONS, Action, Game
from tangency.experiments.breakout.model import WIDTHS, Numbers, scene

__all__ = ["START", "Experience", "learn", "random_play"]

Array = npt.NDArray[np.float64]

START = Numbers(left=1.0, right=1.0, drag=3.0, delay=0)
"""Before anything is learned."""

DELAYS = (0, 1, 2)
LENGTH = 10
"""Of a stretch, frames."""

HOLD, FIRE_EVERY = 4, 40
"""Of random play, frames."""

_SCENE = scene(START.drag)
_PADDLE = _SCENE.body("paddle")
_HALF = WIDTHS[0] / 2.0

ROUNDS, RATE = 300, 0.3
"""Of the descent (Adam), on the logarithms of the numbers."""


@dataclass(frozen=True)
class Experience:
    """Frames of random play.

    Attributes
    ----------
    paddle : ndarray, shape (frames + 1,)
        The paddle's left edge, pixels; NaN where it is not free to move or not seen.
    pushes : ndarray of int, shape (frames,)
        −1, 0 or 1.
    """

    paddle: Array
    pushes: npt.NDArray[np.int64]


def random_play(frames: int, seed: int) -> Experience:
    """Plays at random, game after game: a push is drawn every four frames, and every 40th frame serves."""
    rng = np.random.default_rng(seed)
    game, push = Game(seed), 0
    places, pushes = [_edge(game)], []
    for k in range(frames):
        if game.over:
            game = Game(seed + 1_000 * (k + 1))
            places[-1] = math.nan  # of the game before
        if k % HOLD == 0:
            push = int(rng.integers(-1, 2))
        serve = k % FIRE_EVERY == FIRE_EVERY - 1
        game.act(Action.FIRE if serve else ACTIONS[push])
        pushes.append(0 if serve else push)
        places.append(_edge(game))
    return Experience(np.array(places), np.array(pushes))


def _edge(game: Game) -> float:
    paddle = see(game.frame()).paddle
    free = paddle is not None and LEFT < paddle[0] and paddle[1] < RIGHT
    return float(paddle[0]) if paddle is not None and free else math.nan


@dataclass(frozen=True)
class _Stretches:
    """Pieces of experience in which the paddle was free: places (B, L + 1), speeds (B,), pushes (B, L)."""

    places: Array
    speeds: Array
    pushes: npt.NDArray[np.int64]

    @classmethod
    def of(cls, experience: Experience, delay: int) -> _Stretches:
        starts = list(_free(experience.paddle))
        if not starts:
            frames = experience.pushes.size
            raise ValueError(f"experience has {frames} frames and no stretch in which the paddle moves freely; give more")
        within = np.array(starts)[:, None] + np.arange(-1, LENGTH + 1)
        places, pushes = experience.paddle[within], experience.pushes[within[:, 1:-1] - delay]
        return cls(places[:, 1:], places[:, 1] - places[:, 0], pushes)


def _free(paddle: Array) -> Iterator[int]:
    """Where stretches begin: one after the other, each with the frame before it; alike for all delays."""
    start = 1 + max(DELAYS)
    while start + LENGTH < paddle.size:
        free = np.isfinite(paddle[start - 1 : start + LENGTH + 1])
        if free.all():
            yield start
            start += LENGTH
        else:
            start += 1 + int(np.flatnonzero(~free)[-1])


def learn(experience: Experience) -> tuple[Numbers, float]:
    """The numbers that explain the experience best, and their root of the mean squared error, pixels.

    Raises
    ------
    ValueError
        If the paddle never moves freely for long enough.
    """
    found = [_descend(_Stretches.of(experience, delay), delay) for delay in DELAYS]
    return min(found, key=lambda it: it[1])


def _descend(data: _Stretches, delay: int) -> tuple[Numbers, float]:
    """Adam, with a rate that falls to zero, on the logarithms of the numbers and the starts of the stretches."""
    x = np.concatenate([np.log([START.left, START.right, START.drag]), data.places[:, 0], data.speeds])
    mean, square = np.zeros_like(x), np.zeros_like(x)
    for k in range(1, ROUNDS + 1):
        _, slope = loss(data, x)
        mean, square = 0.9 * mean + 0.1 * slope, 0.99 * square + 0.01 * slope**2
        rate = RATE * 0.5 * (1.0 + math.cos(math.pi * k / ROUNDS))
        x = x - rate * (mean / (1.0 - 0.9**k)) / (np.sqrt(square / (1.0 - 0.99**k)) + 1e-12)
    left, right, drag = (float(number) for number in np.exp(x[:3]))
    return Numbers(left, right, drag, delay), math.sqrt(loss(data, x)[0])


def loss(data: _Stretches, x: Array) -> tuple[float, Array]:
    """The mean squared error, pixels², and its derivative by x.

    Parameters
    ----------
    x : ndarray, shape (3 + 2 B,)
        Logarithms of left, right and drag, then places and then speeds at the beginning of stretches.
    """
    left, right, drag = np.exp(x[:3])
    count, length = data.pushes.shape
    speeds = np.where(data.pushes < 0, left, right) * data.pushes
    run = _run(drag, x[3 : 3 + count], x[3 + count :], drag * speeds)
    error = run.q[:, :, _PADDLE, 0] - _HALF - data.places
    seed = np.zeros_like(run.q)
    seed[:, :, _PADDLE, 0] = 2.0 * error / error.size
    gradient = run.gradient(q=seed, wrt=["damping:drag"])
    of_force = gradient.controls[:, :, 0] * drag * speeds  # by the logarithm of the force
    of_drag = drag * float(gradient["damping:drag"].sum()) + float(of_force.sum())
    numbers = [float(of_force[data.pushes < 0].sum()), float(of_force[data.pushes > 0].sum()), of_drag]
    return float((error**2).mean()), np.concatenate([numbers, gradient.q0[:, _PADDLE, 0], gradient.v0[:, _PADDLE, 0]])


def _run(drag: float, places: Array, speeds: Array, forces: Array) -> tangency.Rollouts:
    """The paddle from places and speeds (B,) under forces (B, L); the ball rests."""
    count, length = forces.shape
    worlds = tangency.Batch(_SCENE, count)
    worlds.set("damping:drag", np.full(count, drag))
    q = np.tile(_SCENE.initial_state.q, (count, 1, 1))
    v = np.zeros_like(q)
    q[:, _PADDLE, 0], v[:, _PADDLE, 0] = places + _HALF, speeds
    worlds.reset_to(q, v)
    return worlds.rollout(length, forces[:, :, None])

"""What is measured: scores against the frames of random play that the model learned from, and those of baselines."""

from __future__ import annotations

import multiprocessing
import os
from collections.abc import Callable, Iterator
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass
from functools import partial

from tangency.experiments.breakout.learn import START, learn, random_play
from tangency.experiments.breakout.model import Numbers
from tangency.experiments.breakout.player import Follower, Planner, Player, Random, play

__all__ = ["FULL", "QUICK", "Point", "Setting", "points"]


@dataclass(frozen=True)
class Setting:
    """How much is measured."""

    counts: tuple[int, ...]
    """Frames of experience."""
    games: int
    """Of each player."""
    most_frames: int
    """After which a game ends, at 60 a second."""


QUICK = Setting(counts=(100, 1000), games=4, most_frames=3_000)
FULL = Setting(counts=(100, 300, 1000, 3000, 10_000), games=20, most_frames=10_800)

EXPERIENCE = 6
"""Seed of the random play."""

FIRST_GAME = 10_000
"""Seed of the first game; the same games for every player, and none of the experience's."""


@dataclass(frozen=True)
class Point:
    """What a player achieved.

    Attributes
    ----------
    player : str
        ``random``, ``follower``, ``untaught`` (the planner before anything is learned) or ``planner``.
    experience : int
        Frames.
    error : float or None
        Root of the mean squared error of the paddle's place where it was learned, pixels.
    numbers : Numbers or None
        What was learned.
    scores, frames, lives : tuple of int
        Of the games.
    """

    player: str
    experience: int
    error: float | None
    numbers: Numbers | None
    scores: tuple[int, ...]
    frames: tuple[int, ...]
    lives: tuple[int, ...]


def points(setting: Setting, tell: Callable[[str], None]) -> Iterator[Point]:
    """The baselines, then the planner for every amount of experience.

    Parameters
    ----------
    tell : callable
        Is told what was played after every game.
    """
    spawn = multiprocessing.get_context("spawn")
    with ProcessPoolExecutor(os.cpu_count(), mp_context=spawn) as pool:
        measure = partial(_measure, pool, setting, tell)
        yield measure("random", 0, None, None)
        yield measure("follower", 0, None, None)
        yield measure("untaught", 0, START, None)
        for count in setting.counts:
            numbers, error = learn(random_play(count, seed=EXPERIENCE))
            yield measure("planner", count, numbers, error)


def _measure(
    pool: ProcessPoolExecutor, setting: Setting, tell: Callable[[str], None],
    player: str, experience: int, numbers: Numbers | None, error: float | None,
) -> Point:  # fmt: skip
    seeds = range(FIRST_GAME, FIRST_GAME + setting.games)
    found: list[tuple[int, int, int]] = []
    for result in pool.map(partial(_game, player, numbers, setting.most_frames), seeds):
        found.append(result)
        tell(f"{player} ({experience}): {result[0]}")
    scores, frames, lives = zip(*found)
    return Point(player, experience, error, numbers, scores, frames, lives)


def _game(player: str, numbers: Numbers | None, most_frames: int, seed: int) -> tuple[int, int, int]:
    """Score, frames and lives left."""
    who: Player
    if numbers is not None:
        who = Planner(numbers, seed)
    else:
        who = Random(seed) if player == "random" else Follower()
    game = play(who, seed, most_frames)
    return game.score, game.frames, game.lives

"""The real game: Atari's Breakout in the Arcade Learning Environment, frame by frame."""

from __future__ import annotations

from enum import IntEnum
from pathlib import Path

import numpy as np
import numpy.typing as npt
from ale_py import ALEInterface, LoggerMode, roms

__all__ = ["ACTIONS", "HIGHEST", "Action", "Game", "Image"]

Image = npt.NDArray[np.uint8]


class Action(IntEnum):
    """What the game understands, as the Arcade Learning Environment numbers it; FIRE serves."""

    NOOP = 0
    FIRE = 1
    RIGHT = 3
    LEFT = 4


ACTIONS = {-1: Action.LEFT, 0: Action.NOOP, 1: Action.RIGHT}
"""By the direction of the push."""

HIGHEST = 864
"""Two walls of bricks; there is no third."""


class Game:
    """A game at 60 frames a second: no frame is skipped, no action is repeated.

    Parameters
    ----------
    seed : int
        Of the number of frames, 0 to 30, that pass before the first action. Nothing else in the game is random.
    """

    def __init__(self, seed: int) -> None:
        ALEInterface.setLoggerMode(LoggerMode.Error)
        self._ale = ALEInterface()
        self._ale.setInt("random_seed", seed)
        self._ale.setInt("frame_skip", 1)
        self._ale.setFloat("repeat_action_probability", 0.0)
        self._ale.loadROM(Path(str(roms.get_rom_path("breakout"))))
        self.score, self.frames = 0, 0
        for _ in range(int(np.random.default_rng(seed).integers(31))):
            self.act(Action.NOOP)

    @property
    def over(self) -> bool:
        """Whether all five lives are lost, or nothing is left to hit."""
        return bool(self._ale.game_over()) or self.score >= HIGHEST

    @property
    def lives(self) -> int:
        """How many are left."""
        return int(self._ale.lives())

    def frame(self) -> Image:
        """What the screen shows, (210, 160, 3) in RGB."""
        picture: Image = self._ale.getScreenRGB()
        return picture

    def act(self, action: Action) -> None:
        """Goes on by a frame."""
        self.score += int(self._ale.act(int(action)))
        self.frames += 1

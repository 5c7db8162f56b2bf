"""Paddle, ball and bricks in a frame, found by their colours.

::

    row  32  ┌──────────────┐  top wall                 columns 8 … 151 are the court
         57  │▒▒▒▒▒▒▒▒▒▒▒▒▒▒│  six rows of 18 bricks of 8 × 6 pixels
         93  │       ▪      │  ball, 2 × 4
        189  │     ▬▬▬      │  paddle, 16 × 4, or 8 × 4 once the ball was at the top
        193  └              ┘

The ball has the colour of the row of bricks that it is in, and the paddle's elsewhere; the right wall ends in that
colour too, beside the paddle. The red channel alone tells all colours of the court apart.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from tangency.experiments.breakout.game import Image

__all__ = ["BALL", "LEFT", "PADDLE_ROW", "RIGHT", "TOP", "Sight", "see"]

LEFT, RIGHT, TOP, END = 8, 152, 32, 196
"""Of the court: the first column and row within it, and those after its last."""

BALL = (2, 4)
"""Width and height, pixels."""

PADDLE_ROW = 191.0
"""The paddle's middle, rows from the top."""

FIRST_BRICK, ROWS, COLUMNS = 57, 6, 18
BRICK = (8, 6)
RED = 200
BRICK_REDS = (200, 198, 180, 162, 72, 66)
"""Red channel of the rows of bricks from the top, and of ball and paddle."""

Mask = npt.NDArray[np.bool_]


def _reds() -> npt.NDArray[np.uint8]:
    """What is not black in a row of the court has this in its red channel, (rows, 1)."""
    reds = np.full(END - TOP, RED, dtype=np.uint8)
    first = FIRST_BRICK - TOP
    reds[first : first + ROWS * BRICK[1]] = np.repeat(BRICK_REDS, BRICK[1])
    return reds[:, None]


_REDS = _reds()


@dataclass(frozen=True)
class Sight:
    """What a frame shows; places in pixels from the left and top of the screen.

    Attributes
    ----------
    paddle : (int, int) or None
        Its first column, and the one after its last; a wide paddle may have its right half behind the wall.
    ball : (float, float) or None
        Column and row of its middle; none before it is served, after it is lost, and where bricks hide all of it.
    bricks : ndarray of bool, shape (6, 18)
        Which are left, from the top.
    """

    paddle: tuple[int, int] | None
    ball: tuple[float, float] | None
    bricks: Mask


def see(frame: Image) -> Sight:
    """Finds everything in a frame, (210, 160, 3) in RGB."""
    if frame.shape != (210, 160, 3):
        raise ValueError(f"frame has shape {frame.shape}; give (210, 160, 3)")
    coloured: Mask = frame[TOP:END, LEFT:RIGHT, 0] == _REDS
    bricks = _take_bricks(coloured)
    paddle = _take_paddle(coloured)
    return Sight(paddle, _ball(coloured), bricks)


def _take_bricks(coloured: Mask) -> Mask:
    """Bricks, which fill all of their places; takes them away from what is coloured."""
    first = FIRST_BRICK - TOP
    wall = coloured[first : first + ROWS * BRICK[1]].reshape(ROWS, BRICK[1], COLUMNS, BRICK[0])
    bricks: Mask = np.all(wall, axis=(1, 3))
    wall &= ~bricks[:, None, :, None]  # a view
    return bricks


def _take_paddle(coloured: Mask) -> tuple[int, int] | None:
    """The widest piece that fills the paddle's rows, if it is wider than the ball; takes it away."""
    top = int(PADDLE_ROW) - 2 - TOP
    filled = np.zeros(RIGHT - LEFT + 2, dtype=np.int8)
    filled[1:-1] = coloured[top : top + 4].all(axis=0)
    edges = np.diff(filled)
    starts, ends = np.flatnonzero(edges == 1), np.flatnonzero(edges == -1)
    if not starts.size:
        return None
    widest = int(np.argmax(ends - starts))
    start, end = int(starts[widest]), int(ends[widest])
    if end - start <= 2 * BALL[0]:
        return None
    coloured[top : top + 4, start:end] = False
    return LEFT + start, LEFT + end


def _ball(coloured: Mask) -> tuple[float, float] | None:
    """The middle of what is left, if it is no larger than a ball."""
    rows, columns = np.flatnonzero(coloured.any(axis=1)), np.flatnonzero(coloured.any(axis=0))
    if not rows.size:
        return None
    left, right, top, end = int(columns[0]), int(columns[-1]) + 1, int(rows[0]), int(rows[-1]) + 1
    if right - left > BALL[0] or end - top > BALL[1]:
        return None
    return LEFT + (left + right) / 2.0, TOP + (top + end) / 2.0

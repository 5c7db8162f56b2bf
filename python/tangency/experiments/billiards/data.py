"""Samples: what a network sees of a trial, and what was really there.

The input of a disc is, as in the paper's figure 2, three frames with the disc masked out of each by its colour, and the
flow from each frame to the next, seen through the same masks: 3 · 3 + 2 · 2 = 13 channels. A pretrained flow network's
weights cannot be had, so OpenCV's dense inverse search stands in for it.
"""

from __future__ import annotations

from dataclasses import dataclass

import cv2
import numpy as np
import numpy.typing as npt
import torch

from tangency.experiments.billiards.frames import Image, frame, masks
from tangency.experiments.billiards.table import Table, Trial

__all__ = ["AHEAD", "CHANNELS", "SEEN", "Samples", "samples"]

SEEN = 3
"""Frames that go in."""

AHEAD = 10
"""Frames from the last one seen to the one that is predicted."""

CHANNELS = 13
"""Of the input of a disc."""


@dataclass(frozen=True)
class Samples:
    """Samples of one table, in a fixed order.

    Attributes
    ----------
    inputs : uint8 tensor, shape (samples, discs, 13, size, size)
        255 times the input; flow as 128 + 127 (pixels per frame)/8.
    states : tensor, shape (samples, discs, 4)
        x, y (sides), vx, vy (sides/s) at the last frame seen: the labels.
    later : tensor, shape (samples, discs, 4)
        The same, ten frames later: the labels of the physics.
    frames : uint8 tensor, shape (samples, 3, size, size)
        The frame ten frames later.
    """

    inputs: torch.Tensor
    states: torch.Tensor
    later: torch.Tensor
    frames: torch.Tensor

    def __len__(self) -> int:
        return len(self.inputs)

    def part(self, which: torch.Tensor) -> Samples:
        """Some of them."""
        return Samples(self.inputs[which], self.states[which], self.later[which], self.frames[which])


def flow(one: Image, two: Image) -> npt.NDArray[np.float32]:
    """The motion of each pixel from one frame to the next: (2, height, width), pixels per frame."""
    search = cv2.DISOpticalFlow.create(cv2.DISOPTICAL_FLOW_PRESET_MEDIUM)
    grey = [cv2.cvtColor(picture, cv2.COLOR_RGB2GRAY) for picture in (one, two)]
    still = np.zeros((*grey[0].shape, 2), dtype=np.float32)
    found = np.asarray(search.calc(grey[0], grey[1], still), dtype=np.float32)
    return np.moveaxis(found, -1, 0)


def inputs_of(pictures: list[Image], discs: int) -> npt.NDArray[np.uint8]:
    """The inputs of all discs: (discs, 13, height, width)."""
    shares = [masks(picture, discs) for picture in pictures]
    flows = [flow(one, two) for one, two in zip(pictures[:-1], pictures[1:], strict=True)]
    inputs = []
    for disc in range(discs):
        seen = [np.moveaxis(picture, -1, 0) * share[disc] for picture, share in zip(pictures, shares, strict=True)]
        moved = [128.0 + 127.0 / 8.0 * it * share[disc] for it, share in zip(flows, shares[:-1], strict=True)]
        inputs.append(np.concatenate([*seen, *moved]))
    found: npt.NDArray[np.uint8] = np.clip(np.rint(np.array(inputs)), 0, 255).astype(np.uint8)
    return found


def samples(table: Table, count: int, size: int, seed: int) -> Samples:
    """So many trials of a table, in pictures of size × size."""
    rng = np.random.default_rng(seed)
    parts = [_sample(table, table.run(*table.start(rng), SEEN + AHEAD), size) for _ in range(count)]
    inputs, states, later, frames = (np.array(column) for column in zip(*parts, strict=True))
    return Samples(
        torch.from_numpy(inputs),
        torch.from_numpy(states.astype(np.float32)),
        torch.from_numpy(later.astype(np.float32)),
        torch.from_numpy(frames),
    )


def _sample(table: Table, trial: Trial, size: int) -> tuple[npt.NDArray[np.generic], ...]:
    pictures = [frame(x, table.radius, size) for x in trial.x[:SEEN]]
    states = np.concatenate([trial.x, trial.v], axis=-1)
    last = frame(trial.x[-1], table.radius, size)
    return inputs_of(pictures, table.discs), states[SEEN - 1], states[-1], np.moveaxis(last, -1, 0)

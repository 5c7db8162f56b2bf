"""Pictures of the table, and what may be seen in them."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from tangency.experiments.billiards.table import Array

__all__ = ["COLOURS", "frame", "masks"]

Image = npt.NDArray[np.uint8]

COLOURS = np.array([[220, 50, 47], [38, 139, 210], [133, 153, 0]], dtype=np.float64)
"""Of the discs, red, blue and green, (3, 3) in 0 … 255."""

CLOTH = np.array([24.0, 24.0, 28.0])


def frame(x: Array, radius: float, size: int) -> Image:
    """The table from above, y up: `size` × `size` pixels in RGB.

    The part of a pixel that a disc covers is taken as that of a half-plane at its distance, which is right to a
    few levels of 255 for discs that are large beside a pixel.

    Parameters
    ----------
    x : ndarray, shape (discs, 2)
        Centres, in sides of the box.
    radius : float
        In sides of the box.
    """
    at = (np.arange(size) + 0.5) / size
    picture = np.broadcast_to(CLOTH, (size, size, 3)).copy()
    for center, colour in zip(x, COLOURS, strict=False):
        distance = np.hypot(at[None, :] - center[0], at[::-1, None] - center[1])
        cover = np.clip(0.5 + (radius - distance) * size, 0.0, 1.0)[..., None]
        picture += cover * (colour - picture)
    rounded: Image = np.rint(picture).astype(np.uint8)
    return rounded


def masks(picture: Image, discs: int) -> npt.NDArray[np.float32]:
    """How much each pixel has of each disc's colour: (discs, height, width) in 0 … 1.

    The share s of a colour c over the cloth b is the least-squares one of pixel = b + s (c − b).
    """
    apart = COLOURS[:discs] - CLOTH
    share = (picture - CLOTH) @ np.linalg.pinv(apart)
    found: npt.NDArray[np.float32] = np.clip(np.moveaxis(share, -1, 0), 0.0, 1.0).astype(np.float32)
    return found

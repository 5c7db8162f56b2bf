"""Names of backends."""

from typing import Literal

__all__ = ["Backend"]

Backend = Literal["ipm", "clarabel", "lemke"]
"""What solves complementarity problems; `tangency.backends()` lists those that this build has."""

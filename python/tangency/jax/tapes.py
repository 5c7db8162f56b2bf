"""The tapes of the last calls, so that a derivative need not compute its value again."""

from __future__ import annotations

import os
import threading
from collections import OrderedDict
from collections.abc import Hashable
from typing import Any, Protocol

import numpy as np
import numpy.typing as npt

__all__ = ["Array", "HostMap", "Indices", "Tape", "keep_tapes", "tape_of"]

Array = npt.NDArray[np.float64]
Indices = npt.NDArray[np.intp]


class Tape(Protocol):
    """What maps did at a batch of points, and the derivatives there."""

    @property
    def size(self) -> int:
        """How many body-steps it holds."""

    def value(self) -> Array:
        """f at all points, (points, out)."""

    def tangent(self, places: Indices, v: Array) -> Array:
        """J v, (directions, out), from v, (directions, in), each at the point of index `places`, (directions,)."""

    def cotangent(self, places: Indices, w: Array) -> Array:
        """Jᵀ w, (directions, in), from w, (directions, out), each at the point of index `places`."""


class HostMap(Hashable, Protocol):
    """A differentiable map from vectors to vectors that NumPy computes."""

    @property
    def out(self) -> int:
        """Length of the vectors it gives."""

    def record(self, x: Array) -> Tape:
        """Computes f at all points x, (points, in)."""


class _Tapes:
    """The tapes used last; the oldest ones go when all together are larger than `limit`."""

    def __init__(self, limit: int) -> None:
        self.limit = limit
        self.forget()

    def forget(self) -> None:
        self.lock = threading.Lock()
        self.tapes: OrderedDict[Any, Tape] = OrderedDict()
        self.size = 0

    def find(self, key: Hashable) -> Tape | None:
        with self.lock:
            tape = self.tapes.get(key)
            if tape is not None:
                self.tapes.move_to_end(key)
            return tape

    def keep(self, key: Hashable, tape: Tape) -> None:
        with self.lock:
            if key not in self.tapes:
                self.tapes[key] = tape
                self.size += tape.size
            self.trim()

    def trim(self) -> None:
        while self.size > self.limit:
            _, oldest = self.tapes.popitem(last=False)
            self.size -= oldest.size


_TAPES = _Tapes(limit=1 << 18)
# A lock that another thread held at the fork would stay held in the child.
if hasattr(os, "register_at_fork"):
    os.register_at_fork(after_in_child=_TAPES.forget)


def tape_of(host: HostMap, x: Array) -> Tape:
    """The tape of `host` at the points x, (points, in): the one kept, or a new one."""
    key = (host, x.shape, x.tobytes())
    tape = _TAPES.find(key)
    if tape is None:
        tape = host.record(x)
        _TAPES.keep(key, tape)
    return tape


def keep_tapes(body_steps: int) -> None:
    """Sets how many tapes of past runs are kept for derivatives at the same point.

    Parameters
    ----------
    body_steps : int
        Environments times steps times bodies, summed over the runs that are kept; 0.6 to 3 kB each, the more the
        more contacts. At first 262144. The runs used last are kept; a batch that is larger by itself is not, and runs
        again when its derivative is asked for. 0 keeps none.

    Raises
    ------
    ValueError
        If it is negative.
    """
    if body_steps < 0:
        raise ValueError(f"body_steps is {body_steps}; give 0 or more")
    with _TAPES.lock:
        _TAPES.limit = body_steps
        _TAPES.trim()

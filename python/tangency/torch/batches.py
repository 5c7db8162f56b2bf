"""How maps meet batches: which inputs have one, and what is shared."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, Protocol

import numpy as np
import numpy.typing as npt

from tangency.torch.maps import Map, Tape

__all__ = ["Evaluation", "batch_size"]

Array = npt.NDArray[np.float64]

#: So many runs at a time are made again for derivatives whose batch is larger than that of the tape.
ROUND = 256


class Sized(Protocol):
    @property
    def shape(self) -> Any: ...
    @property
    def ndim(self) -> int: ...


def batch_size(arrays: Sequence[Sized | None], ranks: Sequence[int]) -> int | None:
    """The size of the batch: the first dimension of whatever has one more than its rank."""
    for array, rank in zip(arrays, ranks, strict=True):
        if array is not None and array.ndim > rank:
            size: int = array.shape[0]
            return size
    return None


def _spread(arrays: Sequence[Array | None], ranks: Sequence[int], batch: int | None) -> list[Any]:
    """Repeats what has no batch."""
    if batch is None:
        return list(arrays)
    pairs = zip(arrays, ranks, strict=True)
    return [a if a is None or a.ndim > rank else np.broadcast_to(a, (batch, *a.shape)) for a, rank in pairs]


class Evaluation:
    """One evaluation of a map, and its derivatives.

    The tape is kept. Derivatives along more directions than there are runs on it (``torch.func.jacrev`` and its like)
    go over it again and again if it holds one run, and make their runs again, in rounds, if it holds a batch.
    """

    def __init__(self, map: Map) -> None:
        self.map = map
        self.ranks = [len(shape) for shape in map.shapes]
        self.output_ranks = [len(shape) for shape in map.outputs]
        self._tape: tuple[int | None, Tape] | None = None

    def value(self, inputs: Sequence[Array]) -> list[Array]:
        """The outputs; what has no batch is shared by it."""
        batch = batch_size(inputs, self.ranks)
        outputs, tape = self.map.run(_spread(inputs, self.ranks, batch), batch)
        self._tape = (batch, tape)
        return outputs

    def vjp(self, inputs: Sequence[Array], bars: Sequence[Array | None]) -> list[Array]:
        """Derivatives by the inputs, of their shapes: shared ones get the sum over the batch."""
        found, batch = self._derivative("vjp", inputs, bars, self.output_ranks)
        if batch is None:
            return found
        # An empty batch has forgotten its shapes.
        found = [np.reshape(g, (batch, *shape)) for g, shape in zip(found, self.map.shapes, strict=True)]
        return [g if x.ndim > rank else g.sum(0) for g, x, rank in zip(found, inputs, self.ranks, strict=True)]

    def jvp(self, inputs: Sequence[Array], rates: Sequence[Array | None]) -> list[Array]:
        """Changes of the outputs."""
        return self._derivative("jvp", inputs, rates, self.ranks)[0]

    def _derivative(
        self, way: str, inputs: Sequence[Array], along: Sequence[Array | None], ranks: Sequence[int]
    ) -> tuple[list[Array], int | None]:
        batch = batch_size([*inputs, *along], [*self.ranks, *ranks])
        along = _spread(along, ranks, batch)
        if self._tape is not None and self._tape[0] == batch:
            return getattr(self._tape[1], way)(along), batch
        if batch is None:
            return getattr(self.map.run(inputs, None)[1], way)(along), None
        if self._tape is not None and self._tape[0] is None:
            rows = [getattr(self._tape[1], way)(_rows(along, k)) for k in range(batch)]
            return [np.stack(parts) for parts in zip(*rows, strict=True)], batch
        return self._again(way, _spread(inputs, self.ranks, batch), along, batch), batch

    def _again(self, way: str, inputs: Sequence[Array], along: Sequence[Array | None], batch: int) -> list[Array]:
        rounds = []
        for start in range(0, max(batch, 1), ROUND):
            part = slice(start, min(start + ROUND, batch))
            tape = self.map.run(_rows(inputs, part), part.stop - start)[1]
            rounds.append(getattr(tape, way)(_rows(along, part)))
        return [np.concatenate(parts) for parts in zip(*rounds, strict=True)]


def _rows(arrays: Sequence[Array | None], part: int | slice) -> list[Any]:
    return [None if array is None else array[part] for array in arrays]

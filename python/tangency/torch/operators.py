"""Maps as operators that `torch.compile` takes as they are: opaque, pure, known by their shapes.

They have no autograd rule of their own: the functions in `functions.py` give them derivatives. (An operator that has
one is constant, without a word, in forward mode and refuses `torch.func.grad`.) Maps travel as text, and nothing
is kept between calls: derivatives make the run again.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
import numpy.typing as npt
import torch
from torch import Tensor

from tangency.torch.batches import Evaluation, batch_size
from tangency.torch.maps import Shape, map_from

__all__ = ["arrays", "pullback", "pushforward", "tensors", "value"]


def arrays(given: Sequence[Tensor]) -> list[npt.NDArray[np.float64]]:
    """The arrays that tensors (CPU, float64) hold."""
    return [tensor.detach().numpy() for tensor in given]


def tensors(given: Sequence[npt.NDArray[np.float64]]) -> list[Tensor]:
    """Tensors of new arrays."""
    return [torch.from_numpy(np.asarray(array, order="C")) for array in given]


def _value(inputs: list[Tensor], map: str) -> list[Tensor]:
    return tensors(Evaluation(map_from(map)).value(arrays(inputs)))


def _pullback(inputs: list[Tensor], bars: list[Tensor], map: str) -> list[Tensor]:
    return tensors(Evaluation(map_from(map)).vjp(arrays(inputs), arrays(bars)))


def _pushforward(inputs: list[Tensor], rates: list[Tensor], map: str) -> list[Tensor]:
    return tensors(Evaluation(map_from(map)).jvp(arrays(inputs), arrays(rates)))


def _ranks(shapes: Sequence[Shape]) -> list[int]:
    return [len(shape) for shape in shapes]


def _outputs(like: Tensor, batch: int | None, shapes: Sequence[Shape]) -> list[Tensor]:
    return [like.new_empty(shape if batch is None else (batch, *shape)) for shape in shapes]


def _value_shapes(inputs: list[Tensor], map: str) -> list[Tensor]:
    it = map_from(map)
    return _outputs(inputs[0], batch_size(inputs, _ranks(it.shapes)), it.outputs)


def _pullback_shapes(inputs: list[Tensor], bars: list[Tensor], map: str) -> list[Tensor]:
    return [torch.empty_like(tensor, memory_format=torch.contiguous_format) for tensor in inputs]


def _pushforward_shapes(inputs: list[Tensor], rates: list[Tensor], map: str) -> list[Tensor]:
    it = map_from(map)
    batch = batch_size([*inputs, *rates], _ranks(it.shapes) * 2)
    return _outputs(inputs[0], batch, it.outputs)


def _operator(name: str, run: Any, shapes: Any, schema: str) -> Any:
    operator: Any = torch.library.custom_op(f"tangency::{name}", run, mutates_args=(), schema=schema)
    operator.register_fake(shapes)
    return operator


value = _operator("value", _value, _value_shapes, "(Tensor[] inputs, str map) -> Tensor[]")
pullback = _operator(
    "pullback", _pullback, _pullback_shapes, "(Tensor[] inputs, Tensor[] bars, str map) -> Tensor[]"
)
pushforward = _operator(
    "pushforward", _pushforward, _pushforward_shapes, "(Tensor[] inputs, Tensor[] rates, str map) -> Tensor[]"
)

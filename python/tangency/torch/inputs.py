"""Tensors that come from a program: what they may be, and their way to the engine and back."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import torch
from torch import Tensor

from tangency.torch.batches import batch_size
from tangency.torch.maps import Shape

__all__ = ["Inputs"]


@dataclass
class Inputs:
    """Tensors by name.

    Attributes
    ----------
    tensors : what was given, in order.
    dtype, device : those of the outputs. Numbers that are not tensors have no say in it.
    """

    tensors: dict[str, Tensor]
    dtype: torch.dtype
    device: torch.device

    @classmethod
    def of(cls, given: Mapping[str, Tensor | float | None]) -> Inputs:
        """Takes what is there; numbers become tensors."""
        tensors = {name: _tensor(name, it) for name, it in given.items() if it is not None}
        typed = [tensors[name] for name in tensors if isinstance(given[name], Tensor)]
        return cls(tensors, _dtype(typed), _device(typed))

    def check(self, shapes: Mapping[str, Shape], meanings: Mapping[str, str]) -> None:
        """Refuses tensors that have neither their shape nor a batch of it, and batches of different sizes."""
        for name, tensor in self.tensors.items():
            shape = shapes.get(name, ())
            if tensor.ndim - len(shape) not in (0, 1) or tensor.shape[tensor.ndim - len(shape) :] != shape:
                meaning = meanings.get(name, "()")
                batched = f"(batch, {meaning[1:]}" if shape else "(batch,)"
                where = f"{meaning} = {shape}" if shape else "()"
                raise ValueError(f"{name} has shape {tuple(tensor.shape)}; give {where}, or {batched}")
        self._check_batch(shapes)

    def _check_batch(self, shapes: Mapping[str, Shape]) -> None:
        sizes = {name: batch_size([tensor], [len(shapes.get(name, ()))]) for name, tensor in self.tensors.items()}
        batched = {name: size for name, size in sizes.items() if size is not None}
        for name, size in batched.items():
            first = next(iter(batched))
            if size != batched[first]:
                raise ValueError(f"{name} has a batch of {size} and {first} one of {batched[first]}; give one size")

    def to_engine(self) -> list[Tensor]:
        """What the engine takes: float64 on the CPU."""
        return [tensor.to("cpu", torch.float64) for tensor in self.tensors.values()]

    def from_engine(self, outputs: Sequence[Tensor]) -> list[Tensor]:
        """What the engine gives, as it is wanted."""
        return [output.to(self.device, self.dtype) for output in outputs]


def _tensor(name: str, given: object) -> Tensor:
    if isinstance(given, Tensor):
        return given
    if isinstance(given, (int, float)):
        return torch.tensor(float(given), dtype=torch.float64)
    raise TypeError(f"{name} is of type {type(given).__name__}; give a tensor")


def _dtype(tensors: Sequence[Tensor]) -> torch.dtype:
    """The promoted dtype; the default one where there is none with a floating point."""
    if not tensors:
        return torch.get_default_dtype()
    dtype = tensors[0].dtype
    for tensor in tensors:
        dtype = torch.promote_types(dtype, tensor.dtype)
    if dtype.is_complex:
        raise TypeError("tensors are complex; give real ones")
    return dtype if dtype.is_floating_point else torch.get_default_dtype()


def _device(tensors: Sequence[Tensor]) -> torch.device:
    """That of the first tensor that is not on the CPU, if there is one."""
    return next((tensor.device for tensor in tensors if tensor.device.type != "cpu"), torch.device("cpu"))

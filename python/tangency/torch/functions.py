"""Maps as functions that PyTorch differentiates: reverse and forward mode, `torch.func`, `torch.compile`."""

from __future__ import annotations

import inspect
from collections.abc import Callable, Sequence
from typing import Any, NoReturn

import torch
from torch import Tensor

from tangency.torch import operators
from tangency.torch.batches import Evaluation, batch_size
from tangency.torch.maps import Map, map_from, map_text

__all__ = ["evaluate", "evaluate_opaque"]

REFUSED = (
    "Tangency has first derivatives only, and this asks for a second one: "
    "leave out create_graph=True, or take finite differences of the gradient"
)


class Call(Evaluation):
    """One evaluation in PyTorch: as it is, or by operators that `torch.compile` does not look into."""

    def __init__(self, map: Map, opaque: bool) -> None:
        super().__init__(map)
        self.opaque = opaque


def evaluate(map: Map, inputs: Sequence[Tensor]) -> tuple[Tensor, ...]:
    """The outputs of a map; inputs and outputs are float64 and on the CPU."""
    outputs: tuple[Tensor, ...] = Value.apply(Call(map, False), *inputs)
    return outputs


@torch.compiler.allow_in_graph  # type: ignore[untyped-decorator]
def evaluate_opaque(kind: str, parts: tuple[object, ...], *inputs: Tensor) -> tuple[Tensor, ...]:
    """The same within a graph, where maps are made of constants."""
    map = map_from(map_text(kind, [_constant(part) for part in parts]))
    outputs: tuple[Tensor, ...] = Value.apply(Call(map, True), *inputs)
    return outputs


def _constant(part: object) -> object:
    """A number, where the compiler put a symbol for it: what changes is compiled anew."""
    if isinstance(part, torch.SymInt):
        return int(part)
    return float(part) if isinstance(part, torch.SymFloat) else part


def signed(forward: Callable[..., tuple[Tensor, ...]]) -> Callable[..., tuple[Tensor, ...]]:
    """Writes a function's signature down: PyTorch asks for it in every call, and to find it out takes long."""
    forward.__signature__ = inspect.signature(forward)  # type: ignore[attr-defined]
    return forward


class Value(torch.autograd.Function):
    """The outputs."""

    @staticmethod
    @signed
    def forward(call: Call, *inputs: Tensor) -> tuple[Tensor, ...]:
        if call.opaque:
            return tuple(operators.value(list(inputs), call.map.text))
        return tuple(operators.tensors(call.value(operators.arrays(inputs))))

    @staticmethod
    def setup_context(ctx: Any, inputs: tuple[Any, ...], output: tuple[Tensor, ...]) -> None:
        ctx.call = inputs[0]
        ctx.set_materialize_grads(ctx.call.opaque)
        ctx.save_for_backward(*inputs[1:])
        ctx.save_for_forward(*inputs[1:])

    @staticmethod
    def backward(ctx: Any, *bars: Tensor | None) -> tuple[Tensor | None, ...]:
        found = Pullback.apply(ctx.call, *bars, *ctx.saved_tensors)
        wanted = ctx.needs_input_grad[1:]
        return None, *(g if want else None for g, want in zip(found, wanted, strict=True))

    @staticmethod
    def jvp(ctx: Any, _: None, *rates: Tensor | None) -> tuple[Tensor, ...]:
        outputs: tuple[Tensor, ...] = Pushforward.apply(ctx.call, *rates, *ctx.saved_tensors)
        return outputs

    @staticmethod
    def vmap(info: Any, dims: tuple[Any, ...], call: Call, *inputs: Tensor) -> tuple[Any, ...]:
        axis = Axis(info.batch_size, inputs, dims[1:], call.ranks)
        outputs = Value.apply(call, *(axis.joined(k) if axis.has_any(k) else x for k, x in enumerate(inputs)))
        return tuple(map(axis.parted, outputs)), (0,) * len(outputs)


class Derivative(torch.autograd.Function):
    """A derivative, linear in its first arguments; to differentiate it is refused, in both modes.

    (`once_differentiable` would refuse only where those arguments need a gradient, and else give a second derivative
    of zero.)
    """

    @staticmethod
    def setup_context(ctx: Any, inputs: tuple[Any, ...], output: tuple[Tensor, ...]) -> None:
        pass

    @staticmethod
    def backward(ctx: Any, *bars: Tensor) -> NoReturn:
        raise NotImplementedError(REFUSED)

    @staticmethod
    def jvp(ctx: Any, *rates: Tensor) -> NoReturn:
        raise NotImplementedError(REFUSED)


def _arrays(given: Sequence[Tensor | None]) -> list[Any]:
    return [None if tensor is None else operators.arrays([tensor])[0] for tensor in given]


class Pullback(Derivative):
    """Derivatives by all inputs, from those by the outputs."""

    @staticmethod
    @signed
    def forward(call: Call, *given: Any) -> tuple[Tensor, ...]:
        count = len(call.output_ranks)
        bars, inputs = given[:count], given[count:]
        if call.opaque:
            return tuple(operators.pullback(list(inputs), list(bars), call.map.text))
        return tuple(operators.tensors(call.vjp(_arrays(inputs), _arrays(bars))))

    @staticmethod
    def vmap(info: Any, dims: tuple[Any, ...], call: Call, *given: Any) -> tuple[Any, ...]:
        axis = Axis(info.batch_size, given, dims[1:], [*call.output_ranks, *call.ranks])
        found = Pullback.apply(call, *map(axis.joined, range(len(given))))
        # A batch within that an input does not have: the input is shared by it, but not by the axis.
        shared = [not axis.is_batched(k) for k in range(len(call.output_ranks), len(given))]
        parted = [axis.parted(g) for g in found]
        if axis.inner is not None:
            parted = [g.sum(1) if alone else g for g, alone in zip(parted, shared, strict=True)]
        return tuple(parted), (0,) * len(parted)


class Pushforward(Derivative):
    """Changes of the outputs, from those of the inputs."""

    @staticmethod
    @signed
    def forward(call: Call, *given: Any) -> tuple[Tensor, ...]:
        count = len(call.ranks)
        rates, inputs = given[:count], given[count:]
        if call.opaque:
            return tuple(operators.pushforward(list(inputs), list(rates), call.map.text))
        return tuple(operators.tensors(call.jvp(_arrays(inputs), _arrays(rates))))

    @staticmethod
    def vmap(info: Any, dims: tuple[Any, ...], call: Call, *given: Any) -> tuple[Any, ...]:
        axis = Axis(info.batch_size, given, dims[1:], [*call.ranks, *call.ranks])
        outputs = Pushforward.apply(call, *map(axis.joined, range(len(given))))
        return tuple(map(axis.parted, outputs)), (0,) * len(outputs)


class Axis:
    """An axis of `torch.vmap`, joined with the batch that is within, if there is one."""

    def __init__(
        self, size: int, tensors: Sequence[Tensor | None], dims: Sequence[int | None], ranks: Sequence[int]
    ) -> None:
        self.size = size
        # The axis in front, where a tensor has it.
        self.tensors = [t if t is None or d is None else t.movedim(d, 0) for t, d in zip(tensors, dims, strict=True)]
        self.mapped = [dim is not None for dim in dims]
        self.ranks = ranks
        within = [t[0] if t is not None and mapped else t for t, mapped in zip(self.tensors, self.mapped, strict=True)]
        self.inner = batch_size(within, ranks)

    def is_batched(self, k: int) -> bool:
        """Whether a tensor has the batch within."""
        tensor = self.tensors[k]
        return tensor is not None and tensor.ndim - self.mapped[k] > self.ranks[k]

    def has_any(self, k: int) -> bool:
        return self.mapped[k] or self.is_batched(k)

    def joined(self, k: int) -> Tensor | None:
        """A tensor whose batch is the axis and the batch within; repeated where it has neither."""
        tensor = self.tensors[k]
        if tensor is None:
            return None
        if not self.mapped[k]:
            tensor = tensor.expand(self.size, *tensor.shape)
        if self.inner is None:
            return tensor
        if not self.is_batched(k):
            tensor = tensor.unsqueeze(1).expand(self.size, self.inner, *tensor.shape[1:])
        return tensor.flatten(0, 1)

    def parted(self, tensor: Tensor) -> Tensor:
        """The axis and the batch within apart again."""
        return tensor if self.inner is None else tensor.reshape(self.size, self.inner, *tensor.shape[1:])

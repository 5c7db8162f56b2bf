"""What the engine computes, on arrays: values of maps, and their derivatives both ways.

Nothing here knows PyTorch. A map takes arrays of fixed ranks; with a batch, every array has one dimension more, in
front.
"""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property, lru_cache
from typing import Any, Protocol

import numpy as np
import numpy.typing as npt

from tangency._native import Batch, LcpSolution, Rollout, Rollouts, Scene, rollout, solve_lcp
from tangency.backend import Backend

__all__ = ["LcpMap", "Map", "RolloutMap", "Tape", "map_from", "map_text", "scene_text"]

Array = npt.NDArray[np.float64]
Shape = tuple[int, ...]


class Tape(Protocol):
    """What an evaluation leaves for its derivatives. All arrays have the batch of the evaluation."""

    def vjp(self, bars: Sequence[Array | None]) -> list[Array]:
        """The derivatives of a loss by all inputs, from those by the outputs; ``None`` is zero."""

    def jvp(self, rates: Sequence[Array | None]) -> list[Array]:
        """The change of all outputs, from that of the inputs; ``None`` is zero."""


class Map(Protocol):
    """A function of arrays.

    Attributes
    ----------
    names : what the inputs are called.
    shapes : shapes of the inputs, without a batch.
    outputs : shapes of the outputs, without a batch.
    text : all of the map, for `map_from`.
    """

    @property
    def names(self) -> tuple[str, ...]: ...
    @property
    def shapes(self) -> tuple[Shape, ...]: ...
    @property
    def outputs(self) -> tuple[Shape, ...]: ...
    @property
    def text(self) -> str: ...

    def run(self, inputs: Sequence[Array], batch: int | None) -> tuple[list[Array], Tape]:
        """Outputs and tape; all inputs have the batch, if there is one."""


@dataclass(frozen=True)
class RolloutMap:
    """Runs of a scene: ``(q, v)`` of all states, from any of q0, v0, controls and numbers of the scene."""

    scene: Scene
    steps: int
    names: tuple[str, ...]
    backend: Backend = "ipm"
    kappa: float | None = None
    time: float = 0.0

    @cached_property
    def shapes(self) -> tuple[Shape, ...]:
        state = (len(self.scene.bodies), 3)
        known = {"q0": state, "v0": state, "controls": (self.steps, len(self.scene.controls))}
        return tuple(known.get(name, ()) for name in self.names)

    @cached_property
    def outputs(self) -> tuple[Shape, ...]:
        return ((self.steps + 1, len(self.scene.bodies), 3),) * 2

    @cached_property
    def text(self) -> str:
        scene = scene_text(self.scene)
        return map_text("rollout", (scene, self.steps, self.names, self.backend, self.kappa, self.time))

    def run(self, inputs: Sequence[Array], batch: int | None) -> tuple[list[Array], RolloutTape]:
        given = dict(zip(self.names, inputs, strict=True))
        state = {name: given.pop(name, None) for name in ("q0", "v0", "controls")}
        if len(given) > 1:
            self.scene._check_apart(list(given))
        runs = self._alone(state, given) if batch is None else self._side_by_side(state, given, batch)
        return [runs.q, runs.v], RolloutTape(runs, self.names)

    def _alone(self, state: Mapping[str, Array | None], values: Mapping[str, Array]) -> Rollout:
        scene = self.scene.with_values({name: float(value) for name, value in values.items()})
        initial = scene.initial_state
        q = initial.q if state["q0"] is None else state["q0"]
        v = initial.v if state["v0"] is None else state["v0"]
        run = rollout(scene, self.steps, state["controls"], state=(q, v, self.time), backend=self.backend)
        return run if self.kappa is None else run.smoothed(self.kappa)

    def _side_by_side(self, state: Mapping[str, Array | None], values: Mapping[str, Array], size: int) -> Rollouts:
        batch = Batch(self.scene, size, backend=self.backend, kappa=self.kappa)
        for name, value in values.items():
            batch.set(name, value)
        batch.reset_to(state["q0"], state["v0"], self.time)
        return batch.rollout(self.steps, state["controls"])


@dataclass(frozen=True)
class RolloutTape:
    """Derivatives of runs."""

    runs: Rollout | Rollouts
    names: tuple[str, ...]

    def vjp(self, bars: Sequence[Array | None]) -> list[Array]:
        numbers = [name for name in self.names if name not in ("q0", "v0", "controls")]
        found = self.runs.gradient(bars[0], bars[1], wrt=numbers)
        return [np.asarray(found[name] if name in numbers else getattr(found, name)) for name in self.names]

    def jvp(self, rates: Sequence[Array | None]) -> list[Array]:
        pairs = zip(self.names, rates, strict=True)
        along: dict[str, Any] = {name: rate for name, rate in pairs if rate is not None}
        state = {name: along.pop(name, None) for name in ("q0", "v0", "controls")}
        return list(self.runs.tangent(**state, values=along))


@dataclass(frozen=True)
class LcpMap:
    """z of the problem ``w = M z + q``, ``0 ≤ z ⟂ w ≥ 0``, from M (n, n) and q (n,)."""

    size: int
    free: int = 0
    backend: Backend = "ipm"
    names: tuple[str, ...] = ("matrix", "q")

    @property
    def shapes(self) -> tuple[Shape, ...]:
        return ((self.size, self.size), (self.size,))

    @property
    def outputs(self) -> tuple[Shape, ...]:
        return ((self.size,),)

    @cached_property
    def text(self) -> str:
        return map_text("lcp", (self.size, self.free, self.backend))

    def run(self, inputs: Sequence[Array], batch: int | None) -> tuple[list[Array], LcpTape]:
        problems = [inputs] if batch is None else zip(*inputs, strict=True)
        solutions = [solve_lcp(matrix, q, free=self.free, backend=self.backend) for matrix, q in problems]
        tape = LcpTape(solutions, self.size, batch is not None)
        return [tape.laid_out([solution.z for solution in solutions], (self.size,))], tape


@dataclass(frozen=True)
class LcpTape:
    """Derivatives of solutions."""

    solutions: Sequence[LcpSolution]
    size: int
    batched: bool

    def laid_out(self, parts: Sequence[Array], shape: Shape) -> Array:
        """One array per solution, as one array."""
        return np.reshape(parts, (len(parts), *shape)) if self.batched else parts[0]

    def each(self, arrays: Sequence[Array | None]) -> list[list[Array | None]]:
        """For each solution, its part of the arrays."""
        if not self.batched:
            return [list(arrays)]
        return [[None if a is None else a[k] for a in arrays] for k in range(len(self.solutions))]

    def vjp(self, bars: Sequence[Array | None]) -> list[Array]:
        n = self.size
        seeds = [np.zeros(n) if z is None else z for (z,) in self.each(bars)]
        pairs = [s.vjp(z) for s, z in zip(self.solutions, seeds, strict=True)]
        return [self.laid_out([m for m, _ in pairs], (n, n)), self.laid_out([q for _, q in pairs], (n,))]

    def jvp(self, rates: Sequence[Array | None]) -> list[Array]:
        parts = [s.jvp(*rate) for s, rate in zip(self.solutions, self.each(rates), strict=True)]
        return [self.laid_out(parts, (self.size,))]


def scene_text(scene: Scene) -> str:
    """A scene as text."""
    return json.dumps(scene.__reduce__()[1])


def map_text(kind: str, parts: Sequence[object]) -> str:
    """A map as text, from what makes one."""
    return json.dumps([kind, *parts])


@lru_cache(maxsize=64)
def map_from(text: str) -> Map:
    """The map of a text."""
    kind, *parts = json.loads(text)
    return LcpMap(*parts) if kind == "lcp" else _rollout_from(*parts)


def _rollout_from(scene: str, steps: int, names: list[str], *settings: Any) -> RolloutMap:
    definition, changes = json.loads(scene)
    rebuilt = Scene._rebuild(definition, [(name, value) for name, value in changes])
    return RolloutMap(rebuilt, steps, tuple(names), *settings)

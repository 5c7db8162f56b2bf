"""Raw linear complementarity problems."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import jax
import jax.numpy as jnp
import numpy as np

from tangency import _native
from tangency.backend import Backend
from tangency.jax.host import ArrayLike, array, call, pack
from tangency.jax.tapes import Array, Indices

__all__ = ["solve_lcp"]


def solve_lcp(matrix: ArrayLike, q: ArrayLike, free: int = 0, *, backend: Backend = "ipm") -> jax.Array:
    """Solves w = M z + q, 0 ≤ z ⟂ w ≥ 0; a differentiable pure function of `matrix` and `q`.

    Parameters
    ----------
    matrix : array, shape (n, n)
        M.
    q : array, shape (n,)
        The constant.
    free : int
        So many unknowns come first that may have any sign and whose w is zero.
    backend : str
        One of ``tangency.backends()``.

    Returns
    -------
    z : array, shape (n,)
        The solution.

    Raises
    ------
    ValueError
        If a shape does not fit.
    SolveError
        If no solution is found; under `jit` inside a `jax.errors.JaxRuntimeError`.
    """
    q = jnp.asarray(q)
    shape = q.shape
    if len(shape) != 1:
        raise ValueError(f"q has shape {shape}; give (n,)")
    parts = [array("matrix", matrix, "(n, n)", (*shape, *shape)), array("q", q, "(n,)", shape)]
    return call(_Problems(shape[0], free, backend), pack(parts))


@dataclass(frozen=True)
class _Problems:
    """The solution as a map from vectors (M, row by row, then q) to vectors z."""

    out: int
    free: int
    backend: Backend

    def record(self, x: Array) -> _Tape:
        solve = _native.solve_lcp
        problems = zip(*self.split(x))
        return _Tape(self, [solve(m, q, free=self.free, backend=self.backend) for m, q in problems])

    def split(self, x: Array) -> tuple[Array, Array]:
        """Matrices, (problems, n, n), and constants, (problems, n)."""
        n = self.out
        return x[:, : n * n].reshape(-1, n, n), x[:, n * n :]


@dataclass(frozen=True)
class _Tape:
    """Solutions of a batch of problems."""

    host: _Problems
    solutions: Sequence[_native.LcpSolution]

    @property
    def size(self) -> int:
        return len(self.solutions) * self.host.out

    def value(self) -> Array:
        return np.stack([solution.z for solution in self.solutions])

    def tangent(self, places: Indices, v: Array) -> Array:
        along = zip(places, *self.host.split(v))
        return np.stack([self.solutions[k].jvp(matrix, q) for k, matrix, q in along])

    def cotangent(self, places: Indices, w: Array) -> Array:
        found = [self.solutions[k].vjp(z) for k, z in zip(places, w)]
        return np.stack([np.concatenate([matrix.ravel(), q]) for matrix, q in found])

"""Runs of scenes, and single steps."""

from __future__ import annotations

import math
from collections.abc import Container, Mapping
from dataclasses import dataclass

import jax
import jax.numpy as jnp
import numpy as np

from tangency._native import Batch, Rollouts, Scene
from tangency.backend import Backend
from tangency.jax.host import ArrayLike, array, call, halves, pack
from tangency.jax.tapes import Array, Indices

__all__ = ["rollout", "step"]

def rollout(
    scene: Scene,
    steps: int | None = None,
    *,
    q0: ArrayLike | None = None,
    v0: ArrayLike | None = None,
    controls: ArrayLike | None = None,
    values: Mapping[str, ArrayLike] | None = None,
    backend: Backend = "ipm",
    kappa: float | None = None,
) -> tuple[jax.Array, jax.Array]:
    """Runs a scene; a pure function of `q0`, `v0`, `controls` and `values`, all differentiable.

    Parameters
    ----------
    scene : Scene
        What is run.
    steps : int, optional
        How many steps; as many as there are controls, or else those of the scene's duration, unless given.
    q0, v0 : array, shape (bodies, 3), optional
        Poses and velocities at the start; the scene's own unless given.
    controls : array, shape (steps, channels), optional
        Zero unless given.
    values : mapping of str to scalars, optional
        Numbers of the scene by name, as in ``Scene.value``: ``{"mass:links": 0.7}``. ``"position..."`` does not go with
        `q0`, ``"velocity..."`` not with `v0`, nor two names that set the same number.
    backend : str
        One of ``tangency.backends()``.
    kappa : float, optional
        Where derivatives are smoothed, how much; exact ones unless given.

    Returns
    -------
    q, v : array, shape (steps + 1, bodies, 3)
        Poses and velocities, those of the start first.

    Raises
    ------
    ValueError
        If a shape or name does not fit.
    StepError, SceneError, GradientError
        As the engine does; under `jit` inside a `jax.errors.JaxRuntimeError`.
    """
    if steps is None:
        shape = () if controls is None else jnp.asarray(controls).shape
        steps = shape[0] if shape else scene.steps
    poses = (len(scene.bodies), 3)
    table = [
        ("q0", q0, "(bodies, 3)", poses),
        ("v0", v0, "(bodies, 3)", poses),
        ("controls", controls, "(steps, channels)", (steps, len(scene.controls))),
    ]
    given = {name: array(name, part, names, shape) for name, part, names, shape in table if part is not None}
    return _run(scene, steps, given, values or {}, backend=backend, kappa=kappa)


def step(
    scene: Scene,
    q: ArrayLike,
    v: ArrayLike,
    control: ArrayLike | None = None,
    values: Mapping[str, ArrayLike] | None = None,
    *,
    time: float = 0.0,
    backend: Backend = "ipm",
    kappa: float | None = None,
) -> tuple[jax.Array, jax.Array]:
    """One step from a state; a pure function of `q`, `v`, `control` and `values`, all differentiable.

    Parameters
    ----------
    q, v : array, shape (bodies, 3)
        Poses and velocities.
    control : array, shape (channels,), optional
        Zero unless given.
    time : float
        When the step begins, s: matters only to forces that begin or end. Not traced.
    scene, values, backend, kappa
        As in `rollout`.

    Returns
    -------
    q, v : array, shape (bodies, 3)
        Poses and velocities after the step.

    Raises
    ------
    ValueError, StepError, SceneError, GradientError
        As `rollout`.
    """
    poses = (len(scene.bodies), 3)
    given = {"q0": array("q", q, "(bodies, 3)", poses), "v0": array("v", v, "(bodies, 3)", poses)}
    if control is not None:
        given["controls"] = array("control", control, "(channels,)", (len(scene.controls),))[None]
    return _run(scene, None, given, values or {}, backend=backend, kappa=kappa, time=time)


def _run(
    scene: Scene,
    steps: int | None,
    given: Mapping[str, jax.Array],
    values: Mapping[str, ArrayLike],
    *,
    backend: Backend,
    kappa: float | None,
    time: float = 0.0,
) -> tuple[jax.Array, jax.Array]:
    """`steps` steps and all their states, or (None) one step and the state after it alone."""
    numbers = [array(name, value, "a scalar", ()) for name, value in values.items()]
    _check_names(scene, list(values), given)
    host = _Runs(
        scene,
        steps,
        shapes=tuple((name, part.shape) for name, part in given.items()),
        values=tuple(values),
        backend=backend,
        kappa=kappa,
        time=time,
    )
    states: tuple[jax.Array, jax.Array] = halves(call(host, pack([*given.values(), *numbers])), host.states)
    return states


def _check_names(scene: Scene, names: list[str], given: Container[str]) -> None:
    """Refuses numbers of a scene that something else sets, too."""
    scene._check_apart(names)
    for name in names:
        if ("q0" in given and name.startswith("position")) or ("v0" in given and name.startswith("velocity")):
            raise ValueError(f"values has {name!r}, but all of that state is given, too; give one of them")


@dataclass(frozen=True)
class _Runs:
    """Runs of a scene as a map from vectors (all that is given, one after the other) to vectors (q, v)."""

    scene: Scene
    steps: int | None
    shapes: tuple[tuple[str, tuple[int, ...]], ...]
    """What is given of q0, v0 and controls; numbers of the scene come after them."""
    values: tuple[str, ...]
    backend: Backend
    kappa: float | None
    time: float

    @property
    def states(self) -> tuple[int, ...]:
        """Shape of the poses of one run."""
        bodies = len(self.scene.bodies)
        return (bodies, 3) if self.steps is None else (self.steps + 1, bodies, 3)

    @property
    def out(self) -> int:
        return 2 * math.prod(self.states)

    def record(self, x: Array) -> _Tape:
        given, values = self.split(x)
        batch = Batch(self.scene, len(x), backend=self.backend, kappa=self.kappa)
        for name, numbers in values.items():
            batch.set(name, numbers)
        batch.reset_to(given.get("q0"), given.get("v0"), time=self.time)
        steps = 1 if self.steps is None else self.steps
        return _Tape(self, batch.rollout(steps, given.get("controls")))

    def split(self, x: Array) -> tuple[dict[str, Array], dict[str, Array]]:
        """Vectors taken apart: q0, v0, controls; and numbers of the scene."""
        sizes = [math.prod(shape) for _, shape in self.shapes]
        *parts, numbers = np.split(x, np.cumsum(sizes), axis=1)
        given = {name: part.reshape(-1, *shape) for (name, shape), part in zip(self.shapes, parts)}
        return given, dict(zip(self.values, numbers.T))


@dataclass(frozen=True)
class _Tape:
    """Runs at a batch of points."""

    host: _Runs
    runs: Rollouts

    @property
    def size(self) -> int:
        return len(self.runs) * (self.host.steps or 1) * len(self.host.scene.bodies)

    def value(self) -> Array:
        return self.join(self.runs.q, self.runs.v)

    def tangent(self, places: Indices, v: Array) -> Array:
        given, rates = self.host.split(v)
        return self.join(*self.at(places).tangent(**given, values=rates))

    def cotangent(self, places: Indices, w: Array) -> Array:
        q, v = np.split(w, 2, axis=1)
        shape = (len(w), *self.host.states)
        found = self.at(places).gradient(q.reshape(shape), v.reshape(shape), wrt=list(self.host.values))
        parts = [getattr(found, name).reshape(len(w), -1) for name, _ in self.host.shapes]
        return np.concatenate([*parts, *(found[name][:, None] for name in self.host.values)], axis=1)

    def at(self, places: Indices) -> Rollouts:
        """The runs at these points."""
        return self.runs.take(places.tolist())

    def join(self, q: Array, v: Array) -> Array:
        """All states, or the last ones, as vectors."""
        if self.host.steps is None:
            q, v = q[:, -1], v[:, -1]
        return np.concatenate([q.reshape(len(q), -1), v.reshape(len(v), -1)], axis=1)

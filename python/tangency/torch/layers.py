"""The engine as layers."""

from __future__ import annotations

from collections.abc import Mapping

import torch
from torch import Tensor

from tangency._native import Scene
from tangency.torch.functions import evaluate, evaluate_opaque
from tangency.torch.inputs import Inputs
from tangency.backend import Backend
from tangency.torch.maps import LcpMap, RolloutMap, scene_text

__all__ = ["rollout", "solve_lcp", "step"]


def rollout(
    scene: Scene,
    steps: int | None = None,
    *,
    q0: Tensor | None = None,
    v0: Tensor | None = None,
    controls: Tensor | None = None,
    values: Mapping[str, Tensor | float] | None = None,
    backend: Backend = "ipm",
    kappa: float | None = None,
    time: float = 0.0,
) -> tuple[Tensor, Tensor]:
    """Runs a scene; differentiable by everything that is a tensor.

    Any input may have a batch dimension in front. What has none is shared by the batch, and its gradient is the sum
    over it. Runs of a batch are made side by side, over all cores, without Python's lock. The engine computes in
    float64 on the CPU, whatever the tensors are.

    Parameters
    ----------
    scene : Scene
    steps : int, optional
        By default as many as `controls` has, or else as the scene's own duration has.
    q0, v0 : Tensor, shape (bodies, 3) or (batch, bodies, 3), optional
        Poses (m, m, rad) and velocities (m/s, m/s, rad/s) at the beginning; by default the scene's own.
    controls : Tensor, shape (steps, channels) or (batch, steps, channels), optional
        By default zero.
    values : mapping of str to Tensor, shape () or (batch,), or float, optional
        Numbers of the scene by name, as ``{"friction:box": mu}``, in the order in which they are set. No two may set
        the same number of the scene.
    backend : str
        What solves complementarity problems; one of `tangency.backends()`.
    kappa : float, optional
        Smooths derivatives along the central path, so much. Values stay exact.
    time : float
        At the beginning, s; forces may begin and end.

    Returns
    -------
    q, v : Tensor, shape (steps + 1, bodies, 3) or (batch, steps + 1, bodies, 3)
        All states, the first one included, in the promoted dtype of the tensors given and on their device.

    Raises
    ------
    ValueError
        Where a shape does not fit.
    SceneError
        Where the scene has no such number, or it cannot have that value.
    StepError
        Where a step cannot be taken.
    GradientError
        In the backward pass, where there is no derivative.
    NotImplementedError
        Where a second derivative is asked for.

    Examples
    --------
    >>> import torch, tangency, tangency.torch
    >>> ball = tangency.BodyDef("ball", position=(0, 1), shapes=[tangency.Circle(0.1)], restitution=0.5)
    >>> floor = tangency.BodyDef("floor", "static", shapes=[tangency.HalfPlane((0, 1))], restitution=0.5)
    >>> scene = tangency.Scene(tangency.SceneDef([ball, floor], dt=0.005, stepping={"accurate": {}}))
    >>> height = torch.tensor(1.0, dtype=torch.float64, requires_grad=True)
    >>> q, v = tangency.torch.rollout(scene, 150, values={"position.y:ball": height})
    >>> q[-1, 0, 1].backward()
    >>> print(f"{q[-1, 0, 1]:.6f} {height.grad:.6f}")
    0.268348 0.626339
    """
    values = values or {}
    for name in values:
        _refuse_both(name, q0, v0)
    inputs = Inputs.of({"q0": q0, "v0": v0, "controls": controls, **values})
    bodies, channels, default = _sizes(scene)
    if steps is None:
        steps = default if controls is None or controls.ndim < 2 else controls.shape[-2]
    shapes = {"q0": (bodies, 3), "v0": (bodies, 3), "controls": (steps, channels)}
    inputs.check(shapes, {"q0": "(bodies, 3)", "v0": "(bodies, 3)", "controls": "(steps, channels)"})
    names = tuple(inputs.tensors)
    if torch.compiler.is_compiling():
        parts = (_text(scene), steps, names, backend, kappa, time)
        outputs = evaluate_opaque("rollout", parts, *inputs.to_engine())
    else:
        map = RolloutMap(scene, steps, names, backend, kappa, time)
        outputs = evaluate(map, inputs.to_engine())
    q, v = inputs.from_engine(outputs)
    return q, v


def step(
    scene: Scene,
    q: Tensor,
    v: Tensor,
    control: Tensor | None = None,
    values: Mapping[str, Tensor | float] | None = None,
    *,
    backend: Backend = "ipm",
    kappa: float | None = None,
    time: float = 0.0,
) -> tuple[Tensor, Tensor]:
    """One step; differentiable, and batched as `rollout` is.

    Runs of many steps are faster by `rollout`.

    Parameters
    ----------
    scene : Scene
    q, v : Tensor, shape (bodies, 3) or (batch, bodies, 3)
        Poses and velocities before the step.
    control : Tensor, shape (channels,) or (batch, channels), optional
        By default zero.
    values, backend, kappa, time
        As of `rollout`.

    Returns
    -------
    q, v : Tensor, shape (bodies, 3) or (batch, bodies, 3)
        Poses and velocities after it.
    """
    if control is not None:
        Inputs.of({"control": control}).check({"control": (_sizes(scene)[1],)}, {"control": "(channels,)"})
        control = control.unsqueeze(-2)
    q, v = rollout(scene, 1, q0=q, v0=v, controls=control, values=values, backend=backend, kappa=kappa, time=time)
    return q.select(-3, 1), v.select(-3, 1)


def solve_lcp(matrix: Tensor, q: Tensor, free: int = 0, *, backend: Backend = "ipm") -> Tensor:
    """Solves linear complementarity problems ``w = M z + q``, ``0 ≤ z ⟂ w ≥ 0``; differentiable by both.

    Parameters
    ----------
    matrix : Tensor, shape (n, n) or (batch, n, n)
        M.
    q : Tensor, shape (n,) or (batch, n)
    free : int
        The first so many entries of z are free, and those of w zero.
    backend : str
        One of `tangency.backends()`.

    Returns
    -------
    z : Tensor, shape (n,) or (batch, n)

    Raises
    ------
    ValueError
        Where a shape does not fit.
    SolveError
        Where no solution is found.
    RuntimeError
        In the backward pass, where the solution has no derivative.

    Examples
    --------
    >>> import torch, tangency.torch
    >>> q = torch.tensor([-1.0, 1.0], requires_grad=True)
    >>> z = tangency.torch.solve_lcp(torch.tensor([[2.0, 0.0], [0.0, 1.0]]), q)
    >>> z.sum().backward()
    >>> [round(number, 12) for number in (*z.tolist(), *q.grad.tolist())]
    [0.5, 0.0, -0.5, 0.0]
    """
    inputs = Inputs.of({"matrix": matrix, "q": q})
    n = q.shape[-1] if q.ndim else 1
    inputs.check({"matrix": (n, n), "q": (n,)}, {"matrix": "(n, n)", "q": "(n,)"})
    if torch.compiler.is_compiling():
        outputs = evaluate_opaque("lcp", (n, free, backend), *inputs.to_engine())
    else:
        outputs = evaluate(LcpMap(n, free, backend), inputs.to_engine())
    return inputs.from_engine(outputs)[0]


def _refuse_both(name: str, q0: Tensor | None, v0: Tensor | None) -> None:
    """A number of the initial state would have no effect where that state is given."""
    for what, given, quantity in (("q0", q0, "position."), ("v0", v0, "velocity.")):
        if given is not None and name.startswith(quantity):
            raise ValueError(f"values has {name!r} and {what} is given, which replaces it; give one of them")


# `torch.compile` takes these for constants of a scene, and compiles anew for another one.


@torch.compiler.assume_constant_result  # type: ignore[untyped-decorator]
def _sizes(scene: Scene) -> tuple[int, int, int]:
    """Bodies, control channels, steps."""
    return len(scene.bodies), len(scene.controls), scene.steps


@torch.compiler.assume_constant_result  # type: ignore[untyped-decorator]
def _text(scene: Scene) -> str:
    return scene_text(scene)

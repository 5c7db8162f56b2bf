"""Scenes and runs drawn with Matplotlib.

Every function draws into `ax`, or into new axes, and returns the axes. Lengths are in m, times in s, energies in J.

>>> import tangency, tangency.plot
>>> ball = tangency.BodyDef("ball", position=(0, 1), shapes=[tangency.Circle(0.1)])
>>> run = tangency.rollout(tangency.Scene(tangency.SceneDef([ball])), steps=30)
>>> axes = tangency.plot.trajectory(run)
>>> axes.get_xlabel()
'x, m'
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import Any

import matplotlib.pyplot as plt
import numpy as np
import numpy.typing as npt
from matplotlib.axes import Axes
from matplotlib.patches import Circle, Patch, PathPatch, Polygon
from matplotlib.path import Path
from matplotlib.transforms import Affine2D

from tangency import Rollout, Scene, State

__all__ = ["draw", "energy", "film", "trajectory"]

Array = npt.NDArray[np.float64]
FIXED = "0.8"


def draw(
    scene: Scene,
    state: State | tuple[Array, Array] | None = None,
    ax: Axes | None = None,
    *,
    alpha: float = 1.0,
) -> Axes:
    """Draws the shapes of a scene at a state.

    Parameters
    ----------
    scene : Scene
        What is drawn: moving bodies in colours, a line showing their angle, others grey.
    state : State, optional
        Where everything is; the initial state unless given.
    ax : matplotlib.axes.Axes, optional
        Where to draw; half planes reach as far as its limits, which grow to hold all other shapes.
    alpha : float
        Opacity of moving bodies, 0 to 1.

    Returns
    -------
    matplotlib.axes.Axes
    """
    ax = _axes(ax)
    q = scene.initial_state.q if state is None else np.asarray(state[0], dtype=np.float64)
    if q.shape != (len(scene.bodies), 3):
        raise ValueError(f"q has shape {q.shape}; give (bodies, 3) = {(len(scene.bodies), 3)}")
    for body, shapes in enumerate(scene.shapes):
        placed = Affine2D().rotate(q[body, 2]).translate(q[body, 0], q[body, 1])
        moves = body in scene.dynamic
        color, opacity = (f"C{scene.dynamic.index(body)}", alpha) if moves else (FIXED, 1.0)
        for shape in shapes:
            patch = _patch(shape, placed)
            if patch is None:
                _half_plane(ax, shape["half_plane"], placed)
                continue
            patch.set(facecolor=color, edgecolor="0.2", linewidth=0.8, alpha=opacity, zorder=2 if moves else 1)
            ax.add_patch(patch)
        if moves and shapes:
            ends = placed.transform([[0.0, 0.0], [_mark(shapes), 0.0]])
            ax.plot(*ends.T, color="0.2", linewidth=0.8, alpha=opacity, zorder=3)
    ax.set_aspect("equal")
    ax.autoscale_view()
    return ax


def trajectory(run: Rollout, bodies: Sequence[str] | None = None, ax: Axes | None = None) -> Axes:
    """Draws the paths of centres of mass, with the scene's start behind and a dot at the end.

    Parameters
    ----------
    run : Rollout
        The motion.
    bodies : sequence of str, optional
        Names of the bodies; all that forces move unless given.
    ax : matplotlib.axes.Axes, optional
        Where to draw.
    """
    scene = run.scene
    names = [scene.bodies[body] for body in scene.dynamic] if bodies is None else bodies
    ax = draw(scene, run.state(0), ax, alpha=0.25)
    for name in names:
        body = scene.body(name)
        color = f"C{scene.dynamic.index(body)}" if body in scene.dynamic else "0.4"
        path = run.q[:, body, :2]
        ax.plot(path[:, 0], path[:, 1], color=color, label=name, zorder=4)
        ax.plot(*path[-1], "o", color=color, markersize=4, zorder=4)
    ax.set(xlabel="x, m", ylabel="y, m")
    if names:
        ax.legend()
    return ax


def energy(run: Rollout, ax: Axes | None = None) -> Axes:
    """Draws the mechanical energy over time."""
    ax = _axes(ax)
    ax.plot(run.time, run.energy)
    ax.set(xlabel="time, s", ylabel="energy, J")
    ax.margins(x=0.0)
    return ax


def film(run: Rollout, times: Sequence[float], ax: Axes | None = None) -> Axes:
    """Draws the scene at several times (s), side by side from left to right.

    Raises
    ------
    ValueError
        If there are no times, or one is not within the run.
    """
    ends = run.time[0], run.time[-1]
    if len(times) == 0 or min(times) < ends[0] - 1e-9 or max(times) > ends[1] + 1e-9:
        raise ValueError(f"times are {list(times)}; give at least one, all within {ends[0]} to {ends[1]} s")
    if ax is None:
        _, ax = plt.subplots(figsize=(2.2 * len(times), 2.6), layout="constrained")
    (left, right), (low, high) = _bounds(run)
    for k, time in enumerate(times):
        step = int(np.argmin(np.abs(run.time - time)))
        frame = ax.inset_axes((k / len(times), 0.0, 0.98 / len(times), 1.0))
        frame.set(xlim=(left, right), ylim=(low, high), xticks=[], yticks=[])
        frame.set_autoscale_on(False)
        draw(run.scene, run.state(step), frame)
        frame.set_title(f"{run.time[step]:.3g} s", fontsize="medium")
    ax.set_axis_off()
    return ax


def _axes(ax: Axes | None) -> Axes:
    return plt.subplots()[1] if ax is None else ax


def _patch(shape: Mapping[str, Any], placed: Affine2D) -> Patch | None:
    """A bounded shape of a body that is placed so; none for a half plane."""
    ((kind, values),) = shape.items()
    if kind == "circle":
        (center,) = placed.transform([values["center"]])
        return Circle(center, values["radius"])
    if kind == "capsule":
        return PathPatch(placed.transform_path(_capsule(values["a"], values["b"], values["radius"])))
    if kind == "rectangle":
        corners = 0.5 * np.array([[-1, -1], [1, -1], [1, 1], [-1, 1]]) * (values["width"], values["height"])
        turned = Affine2D().rotate(values["angle"]).translate(*values["center"])
        return Polygon(placed.transform(turned.transform(corners)))
    return Polygon(placed.transform(_hull(values["points"]))) if kind == "polygon" else None


def _capsule(a: Sequence[float], b: Sequence[float], radius: float) -> Path:
    """Two half circles, joined."""
    along = math.degrees(math.atan2(b[1] - a[1], b[0] - a[0]))
    caps = [
        Affine2D().scale(radius).translate(*end).transform_path(Path.arc(start, start + 180.0))
        for end, start in ((b, along - 90.0), (a, along + 90.0))
    ]
    vertices = np.concatenate([np.asarray(cap.vertices) for cap in caps])
    codes = np.concatenate([np.asarray(cap.codes) for cap in caps])
    codes[len(codes) // 2] = Path.LINETO  # both have as many
    return Path(np.vstack([vertices, vertices[:1]]), np.append(codes, Path.CLOSEPOLY))


def _hull(points: Sequence[Sequence[float]]) -> Array:
    """Corners of the convex hull, counter-clockwise: lower chain, then upper chain (Andrew 1979)."""
    ordered = sorted((float(x), float(y)) for x, y in points)
    corners: list[tuple[float, float]] = []
    for chain in (ordered, ordered[::-1]):
        start = len(corners)
        for x, y in chain:
            while len(corners) > start + 1:
                (x0, y0), (x1, y1) = corners[-2:]
                if (x1 - x0) * (y - y0) > (y1 - y0) * (x - x0):
                    break
                corners.pop()
            corners.append((x, y))
        corners.pop()
    return np.array(corners)


def _half_plane(ax: Axes, values: Mapping[str, Any], placed: Affine2D) -> None:
    """Fills everything below the edge, as far as the axes show."""
    normal = np.asarray(values["normal"]) / math.hypot(*values["normal"])
    far, along = 1e3, np.array([-normal[1], normal[0]])
    edge = values["offset"] * normal
    corners = [edge - far * along, edge + far * along, edge + far * (along - normal), edge - far * (along + normal)]
    patch = Polygon(placed.transform(corners), facecolor=FIXED, edgecolor="0.5", linewidth=0.8, zorder=0)
    ax.add_artist(patch)  # unlike `add_patch` it leaves the limits alone


def _reach(shapes: Sequence[Mapping[str, Any]]) -> float:
    """Radius of the circle about the centre of mass that holds the bounded shapes, m."""
    patches = (_patch(shape, Affine2D()) for shape in shapes)
    return max((_farthest(patch) for patch in patches if patch is not None), default=0.0)


def _farthest(patch: Patch) -> float:
    outline = patch.get_patch_transform().transform(patch.get_path().to_polygons()[0])
    return float(np.max(np.hypot(*outline.T)))


def _mark(shapes: Sequence[Mapping[str, Any]]) -> float:
    """Length of the line that shows a body's angle, m."""
    circle = shapes[0].get("circle") if len(shapes) == 1 else None
    return float(circle["radius"]) if circle else 0.35 * _reach(shapes)


def _bounds(run: Rollout) -> tuple[tuple[float, float], tuple[float, float]]:
    """What holds the moving bodies during the whole run: x from, to and y from, to, m."""
    scene = run.scene
    reach = np.array([_reach(scene.shapes[body]) for body in scene.dynamic])[:, None]
    centers = run.q[:, list(scene.dynamic), :2]
    low, high = (centers - reach).min(axis=(0, 1)), (centers + reach).max(axis=(0, 1))
    margin = 0.05 * float(max(high - low))
    (left, bottom), (right, top) = low - margin, high + margin
    return (float(left), float(right)), (float(bottom), float(top))

"""The base of all environments: a scene, and what is made of its states."""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Mapping
from typing import Any, ClassVar

import gymnasium
import numpy as np
import numpy.typing as npt
from gymnasium import spaces

from tangency import Scene, SceneDef, Simulator, State

__all__ = ["SceneEnv"]

Array = npt.NDArray[np.float64]
Frame = npt.NDArray[np.uint8]


class SceneEnv(gymnasium.Env[npt.NDArray[np.float32], npt.NDArray[np.float32]]):
    """An environment whose physics is a scene.

    A subclass describes the scene and says in a few lines what an action does, what is observed and what is
    rewarded. It does so through the scene's *coordinates*: the few numbers x that say where everything is and
    how it moves, such as a hinge's angle and its rate. Its methods take arrays with any number of leading
    dimensions, so that the same lines serve one environment and the many of `VectorEnv`.

    Parameters
    ----------
    dt : float, optional
        Time step of the physics, s; it divides the class's `period`.
    stepping : "fixed", {"impact_resolved": {}} or {"accurate": {}}
        How the physics steps; see `tangency.SceneDef`.
    values : mapping of str to float, optional
        Other numbers for the scene, as in ``{"mass:pole": 0.2}``; see `tangency.Scene.with_values`.
    render_mode : None or "rgb_array"
        Whether `render` gives pictures.

    Attributes
    ----------
    scene : tangency.Scene
        The physics.
    simulator : tangency.Simulator
        Where the physics is now.

    Raises
    ------
    ValueError
        If the period is not a whole number of steps of the physics, or there is no such render mode.
    """

    metadata: dict[str, Any] = {"render_modes": ["rgb_array"], "render_fps": 50}

    period: ClassVar[float]
    """Time that one action lasts, s."""
    default_dt: ClassVar[float]
    """Time step of the physics unless told otherwise, s."""
    start: ClassVar[tuple[tuple[float, ...], tuple[float, ...]]]
    """Least and greatest coordinates at the start of an episode; they are drawn evenly."""
    view: ClassVar[tuple[float, float, float, float]]
    """What pictures show: x from, to, y from, to, m."""
    frame_size: ClassVar[tuple[int, int]] = (600, 400)
    """Width and height of pictures, pixels."""

    action_space: spaces.Box[np.float32]
    observation_space: spaces.Box[np.float32]

    def __init__(
        self,
        *,
        dt: float | None = None,
        stepping: str | Mapping[str, Any] = "fixed",
        values: Mapping[str, float] | None = None,
        render_mode: str | None = None,
    ) -> None:
        if render_mode not in (None, *self.metadata["render_modes"]):
            raise ValueError(f'render_mode is {render_mode!r}; give "rgb_array" or None')
        definition = self.definition()
        definition.dt = self.default_dt if dt is None else dt
        definition.stepping = stepping
        self.steps_per_action = _whole(self.period, definition.dt)
        self.scene = Scene(definition).with_values(dict(values or {}))
        self.simulator = Simulator(self.scene)
        self.render_mode = render_mode
        self._x = self.coordinates(self.simulator.q, self.simulator.v)

    # What a subclass says.

    @classmethod
    @abstractmethod
    def definition(cls) -> SceneDef:
        """The scene; `dt` and `stepping` are set by whoever asks."""

    @abstractmethod
    def place(self, x: Array) -> tuple[Array, Array]:
        """Poses and velocities q and v, (..., bodies, 3), at coordinates x, (..., n)."""

    @abstractmethod
    def coordinates(self, q: Array, v: Array) -> Array:
        """Coordinates x, (..., n), of poses and velocities, (..., bodies, 3)."""

    @abstractmethod
    def controls(self, action: Array) -> Array:
        """What the scene's control channels are given, (..., channels), for actions in the action space."""

    @abstractmethod
    def observe(self, x: Array) -> Array:
        """Observations, (...,) and the observation space's shape."""

    @abstractmethod
    def reward(self, x: Array, action: Array, after: Array, terminated: npt.NDArray[np.bool_]) -> Array:
        """Rewards, (...,), of actions that led from coordinates `x` to `after`."""

    def terminated(self, x: Array) -> npt.NDArray[np.bool_]:
        """Whether the episode ends here, (...,); never unless overridden."""
        return np.zeros(x.shape[:-1], dtype=np.bool_)

    def bounded(self, x: Array) -> Array:
        """Coordinates to go on from; x itself unless speeds are limited."""
        return x

    # What follows from it.

    @property
    def state(self) -> State:
        """Poses and velocities of all bodies now."""
        state: State = self.simulator.state
        return state

    def draw_start(self, generator: np.random.Generator, options: Mapping[str, Any] | None = None) -> Array:
        """Coordinates of a start.

        Parameters
        ----------
        generator : numpy.random.Generator
            Where chance comes from.
        options : mapping, optional
            ``"low"`` and ``"high"`` (numbers, or one per coordinate) instead of `start`; or ``"x"``, the
            coordinates themselves.

        Raises
        ------
        ValueError
            If there is an unknown option or one of a wrong shape.
        """
        if not options:
            return generator.uniform(*self.start)
        options = dict(options)
        low, high = (np.asarray(end, dtype=np.float64) for end in self.start)
        exact = options.pop("x", None)
        low = _like(low, "low", options.pop("low", low))
        high = _like(high, "high", options.pop("high", high))
        if options:
            raise ValueError(f'unknown options {sorted(options)}; there are "low", "high" and "x"')
        if exact is not None:
            return _like(low, "x", exact)
        if not np.all(low <= high):
            raise ValueError(f'options "low" {low} is above "high" {high}')
        return generator.uniform(low, high)

    def reset(
        self, *, seed: int | None = None, options: dict[str, Any] | None = None
    ) -> tuple[npt.NDArray[np.float32], dict[str, Any]]:
        """Starts an episode; `options` are those of `draw_start`."""
        super().reset(seed=seed)
        self._go_on_from(self.draw_start(self.np_random, options))
        return self._observation(), {}

    def step(
        self, action: npt.ArrayLike
    ) -> tuple[npt.NDArray[np.float32], float, bool, bool, dict[str, Any]]:
        """Acts for one period; actions outside of the action space are clipped to it.

        Raises
        ------
        ValueError
            If the action has another shape.
        tangency.StepError
            If a step of the physics cannot be solved.
        """
        bounded = self.clipped(action, self.action_space.shape)
        controls = self.controls(bounded)
        for _ in range(self.steps_per_action):
            self.simulator.step(controls)
        before, after = self._x, self.coordinates(self.simulator.q, self.simulator.v)
        self._x = self.bounded(after)
        if not np.array_equal(self._x, after):
            self._go_on_from(self._x)
        terminated = self.terminated(self._x)
        reward = self.reward(before, bounded, self._x, terminated)
        return self._observation(), float(reward), bool(terminated), False, {}

    def render(self) -> Frame | None:
        """A picture, uint8 of shape (height, width, 3), in the mode ``"rgb_array"``."""
        if self.render_mode is None:
            gymnasium.logger.warn('there are no pictures; make the environment with render_mode="rgb_array"')
            return None
        return self.picture(self.state)

    def picture(self, state: State | tuple[Array, Array]) -> Frame:
        """A picture of a state, uint8 of shape (height, width, 3)."""
        width, height = self.frame_size
        frame: Frame = self.scene.picture(state, width, height, view=self.view)
        return frame

    def clipped(self, action: npt.ArrayLike, shape: tuple[int, ...]) -> Array:
        """Actions of a shape, inside of the action space."""
        given = np.asarray(action, dtype=np.float64)
        if given.shape != shape:
            raise ValueError(f"action has shape {given.shape}; give {shape}")
        return np.clip(given, self.action_space.low, self.action_space.high)

    def _go_on_from(self, x: Array) -> None:
        self._x = x
        self.simulator.reset(self.place(x))

    def _observation(self) -> npt.NDArray[np.float32]:
        return self.observe(self._x).astype(np.float32)


def box(*high: float) -> spaces.Box[np.float32]:
    """A box from -`high` to `high`."""
    ends = np.array(high, dtype=np.float32)
    return spaces.Box(-ends, ends, dtype=np.float32)


def stacked(bodies: list[list[Array]]) -> Array:
    """Three arrays (...,) per body as one, (..., bodies, 3)."""
    return np.stack([np.stack(body, axis=-1) for body in bodies], axis=-2)


def _whole(period: float, dt: float) -> int:
    steps = round(period / dt) if dt > 0.0 else 0
    if steps < 1 or abs(steps * dt - period) > 1e-9 * period:
        raise ValueError(f"dt is {dt} s; give one that divides the {period} s of an action")
    return steps


def _like(x: Array, name: str, given: Any) -> Array:
    value = np.asarray(given, dtype=np.float64)
    if value.shape not in ((), x.shape) or (name == "x" and value.shape != x.shape):
        raise ValueError(f'option "{name}" has shape {value.shape}; give {x.shape}, one number per coordinate')
    return np.broadcast_to(value, x.shape).copy()

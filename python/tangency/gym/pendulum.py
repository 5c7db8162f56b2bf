"""A pendulum is swung up."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import numpy.typing as npt

from tangency import BodyDef, ControlDef, JointDef, Rectangle, Revolute, SceneDef
from tangency.gym.scene_env import Array, SceneEnv, box, stacked
from tangency.gym.vector_env import VectorEnv

__all__ = ["PendulumEnv"]

LENGTH = 1.0
MAX_TORQUE = 2.0
MAX_RATE = 8.0


class PendulumEnv(SceneEnv):
    """Swing a rod up and hold it there with a weak motor: the system of ``Pendulum-v1``.

    ===========  =============================================================================
    action       one number in [-1, 1]: the torque τ, in 2 N·m
    observation  cos θ, sin θ, θ̇ (rad/s); θ is 0 upright, counter-clockwise
    coordinates  θ, θ̇
    reward       -(θ² + 0.1 θ̇² + 0.001 τ²), θ in [-π, π), before the step
    start        θ in ±π, θ̇ in ±1
    ends         after 200 steps of 0.05 s (``TimeLimit``)
    ===========  =============================================================================

    A rod of 1 kg and 1 m, g = 10 m/s², no friction: θ̈ = 3g/(2l) sin θ + 3/(m l²) τ, as in ``Pendulum-v1``.
    What differs: the action is normalised, the time step of the physics is 10 ms instead of 50 ms, and the limit
    |θ̇| ≤ 8 rad/s acts after each action, not within it.
    """

    metadata = {"render_modes": ["rgb_array"], "render_fps": 20}
    period = 0.05
    default_dt = 0.01
    start = ((-math.pi, -1.0), (math.pi, 1.0))
    view = (-1.2, 1.2, -1.2, 1.2)
    frame_size = (500, 500)

    def __init__(self, **options: Any) -> None:
        super().__init__(**options)
        self.action_space = box(1.0)
        self.observation_space = box(1.0, 1.0, MAX_RATE)

    @classmethod
    def definition(cls) -> SceneDef:
        """A rod on a pivot."""
        rod = BodyDef("rod", position=(0.0, 0.5 * LENGTH), mass=1.0, inertia=LENGTH**2 / 12.0)
        rod.shapes = [Rectangle(0.1, LENGTH)]
        pivot = JointDef("pivot", ("world", "rod"), Revolute((0.0, 0.0)))
        motor = ControlDef("motor", "joint_force", "pivot")
        return SceneDef([rod], [pivot], controls=[motor], gravity=(0.0, -10.0), name="Pendulum")

    def place(self, x: Array) -> tuple[Array, Array]:
        """The rod at (θ, θ̇)."""
        angle, rate = np.moveaxis(x, -1, 0)
        across, up = -0.5 * LENGTH * np.sin(angle), 0.5 * LENGTH * np.cos(angle)
        return stacked([[across, up, angle]]), stacked([[-up * rate, across * rate, rate]])

    def coordinates(self, q: Array, v: Array) -> Array:
        """(θ, θ̇)."""
        return np.stack([q[..., 0, 2], v[..., 0, 2]], axis=-1)

    def bounded(self, x: Array) -> Array:
        """At most 8 rad/s."""
        return np.stack([x[..., 0], np.clip(x[..., 1], -MAX_RATE, MAX_RATE)], axis=-1)

    def controls(self, action: Array) -> Array:
        """The torque, N·m."""
        return MAX_TORQUE * action

    def observe(self, x: Array) -> Array:
        """cos θ, sin θ, θ̇."""
        return np.stack([np.cos(x[..., 0]), np.sin(x[..., 0]), x[..., 1]], axis=-1)

    def reward(self, x: Array, action: Array, after: Array, terminated: npt.NDArray[np.bool_]) -> Array:
        """What the distance from upright, the rate and the torque cost."""
        angle = (x[..., 0] + np.pi) % (2.0 * np.pi) - np.pi
        torque = MAX_TORQUE * action[..., 0]
        return -(np.square(angle) + 0.1 * np.square(x[..., 1]) + 0.001 * np.square(torque))


def make_vec(num_envs: int = 1, **options: Any) -> VectorEnv:
    """Many of them side by side."""
    return VectorEnv(PendulumEnv, num_envs, **options)

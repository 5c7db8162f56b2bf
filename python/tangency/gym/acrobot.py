"""Two links swing up by the joint between them."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import numpy.typing as npt

from tangency import BodyDef, ControlDef, JointDef, Rectangle, Revolute, SceneDef
from tangency.gym.scene_env import Array, SceneEnv, box, stacked
from tangency.gym.vector_env import VectorEnv

__all__ = ["AcrobotEnv"]

LENGTH = 1.0
MAX_TORQUE = 1.0
MAX_RATES = (4.0 * math.pi, 9.0 * math.pi)


class AcrobotEnv(SceneEnv):
    """Swing the end of two links above a line by a motor at the joint between them: the system of ``Acrobot-v1``.

    ===========  =============================================================================
    action       one number in [-1, 1]: the torque between the links, N·m
    observation  cos θ₁, sin θ₁, cos θ₂, sin θ₂, θ̇₁, θ̇₂ (rad/s)
    coordinates  θ₁ (0 hanging), θ₂ (of the second link against the first), θ̇₁, θ̇₂
    reward       -1 per step, 0 for the last one
    start        all four in ±0.1
    ends         the tip is 1 m above the pivot; after 500 steps of 0.2 s (``TimeLimit``)
    ===========  =============================================================================

    Links of 1 kg, 1 m and 1 kg·m² about their middles, g = 9.8 m/s²: the equations of motion are those of the
    book in ``Acrobot-v1``. What differs: the torque is continuous, the time step of the physics is 10 ms instead of
    one Runge-Kutta step of 0.2 s, and the limits on the rates (4π and 9π rad/s) act after each action.
    """

    metadata = {"render_modes": ["rgb_array"], "render_fps": 15}
    period = 0.2
    default_dt = 0.01
    start = ((-0.1,) * 4, (0.1,) * 4)
    view = (-2.2, 2.2, -2.2, 2.2)
    frame_size = (500, 500)

    def __init__(self, **options: Any) -> None:
        super().__init__(**options)
        self.action_space = box(1.0)
        self.observation_space = box(1.0, 1.0, 1.0, 1.0, *MAX_RATES)

    @classmethod
    def definition(cls) -> SceneDef:
        """Two links, hanging."""
        upper, lower = (
            BodyDef(name, position=(0.0, y), mass=1.0, inertia=1.0, shapes=[Rectangle(0.12, LENGTH)])
            for name, y in (("upper", -0.5 * LENGTH), ("lower", -1.5 * LENGTH))
        )
        shoulder = JointDef("shoulder", ("world", "upper"), Revolute((0.0, 0.0)))
        elbow = JointDef("elbow", ("upper", "lower"), Revolute((0.0, -LENGTH)))
        motor = ControlDef("motor", "joint_force", "elbow")
        joints, gravity = [shoulder, elbow], (0.0, -9.8)
        return SceneDef([upper, lower], joints, controls=[motor], gravity=gravity, name="Acrobot")

    def place(self, x: Array) -> tuple[Array, Array]:
        """Both links at (θ₁, θ₂, θ̇₁, θ̇₂)."""
        angle, bend, rate, bending = np.moveaxis(x, -1, 0)
        second, second_rate = angle + bend, rate + bending
        half = 0.5 * LENGTH
        a = [half * np.sin(angle), -half * np.cos(angle)]
        b = [half * np.sin(second), -half * np.cos(second)]
        q = [[*a, angle], [2.0 * a[0] + b[0], 2.0 * a[1] + b[1], second]]
        a_speed, b_speed = [-a[1] * rate, a[0] * rate], [-b[1] * second_rate, b[0] * second_rate]
        end_speed = [2.0 * a_speed[0] + b_speed[0], 2.0 * a_speed[1] + b_speed[1]]
        return stacked(q), stacked([[*a_speed, rate], [*end_speed, second_rate]])

    def coordinates(self, q: Array, v: Array) -> Array:
        """(θ₁, θ₂, θ̇₁, θ̇₂)."""
        angles, rates = q[..., 2], v[..., 2]
        parts = [angles[..., 0], angles[..., 1] - angles[..., 0], rates[..., 0], rates[..., 1] - rates[..., 0]]
        return np.stack(parts, axis=-1)

    def bounded(self, x: Array) -> Array:
        """At most 4π and 9π rad/s."""
        most = np.array(MAX_RATES)
        return np.concatenate([x[..., :2], np.clip(x[..., 2:], -most, most)], axis=-1)

    def controls(self, action: Array) -> Array:
        """The torque, N·m."""
        return MAX_TORQUE * action

    def observe(self, x: Array) -> Array:
        """Cosines and sines of the angles, and the rates."""
        first, second = x[..., 0], x[..., 1]
        parts = [np.cos(first), np.sin(first), np.cos(second), np.sin(second), x[..., 2], x[..., 3]]
        return np.stack(parts, axis=-1)

    def reward(self, x: Array, action: Array, after: Array, terminated: npt.NDArray[np.bool_]) -> Array:
        """Minus one until the tip is up."""
        return np.where(terminated, 0.0, -1.0)

    def terminated(self, x: Array) -> npt.NDArray[np.bool_]:
        """Whether the tip is 1 m above the pivot."""
        height = -np.cos(x[..., 0]) - np.cos(x[..., 0] + x[..., 1])
        return np.asarray(LENGTH * height > 1.0)


def make_vec(num_envs: int = 1, **options: Any) -> VectorEnv:
    """Many of them side by side."""
    return VectorEnv(AcrobotEnv, num_envs, **options)

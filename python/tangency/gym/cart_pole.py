"""A pole balances on a cart."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import numpy.typing as npt

from tangency import BodyDef, ControlDef, JointDef, Prismatic, Rectangle, Revolute, SceneDef
from tangency.gym.scene_env import Array, SceneEnv, box, stacked
from tangency.gym.vector_env import VectorEnv

__all__ = ["CartPoleEnv"]

HALF_LENGTH = 0.5
MAX_FORCE = 10.0
MAX_POSITION = 2.4
MAX_ANGLE = math.radians(12.0)


class CartPoleEnv(SceneEnv):
    """Keep a pole upright by pushing its cart: the system of ``CartPole-v1``.

    ===========  =============================================================================
    action       one number in [-1, 1]: the push on the cart, in 10 N
    observation  x (m), ẋ (m/s), θ (rad, positive to the right), θ̇ (rad/s); also the coordinates
    reward       1 per step
    start        all four in ±0.05
    ends         |x| > 2.4 m or |θ| > 12°; after 500 steps of 0.02 s (``TimeLimit``)
    ===========  =============================================================================

    Cart 1 kg, pole 0.1 kg and 1 m, g = 9.8 m/s², no friction: the equations of motion are those of
    ``CartPole-v1``. What differs: the push is continuous, the time step of the physics is 5 ms instead of one
    explicit Euler step of 20 ms, and the bounds of the observed speeds are finite (20 m/s, 20 rad/s: more than is
    reached before the episode ends).
    """

    period = 0.02
    default_dt = 0.005
    start = ((-0.05,) * 4, (0.05,) * 4)
    view = (-2.4, 2.4, -1.1, 2.1)

    def __init__(self, **options: Any) -> None:
        super().__init__(**options)
        self.action_space = box(1.0)
        self.observation_space = box(2.0 * MAX_POSITION, 20.0, 2.0 * MAX_ANGLE, 20.0)

    @classmethod
    def definition(cls) -> SceneDef:
        """A cart on a rail, and a pole on the cart."""
        cart = BodyDef("cart", mass=1.0, mask=0, shapes=[Rectangle(0.5, 0.3)])
        pole = BodyDef("pole", position=(0.0, HALF_LENGTH), mass=0.1, inertia=0.1 / 12.0, mask=0)
        pole.shapes = [Rectangle(0.08, 2.0 * HALF_LENGTH)]
        rail = JointDef("rail", ("world", "cart"), Prismatic((0.0, 0.0), (1.0, 0.0)))
        hinge = JointDef("hinge", ("cart", "pole"), Revolute((0.0, 0.0)))
        push = ControlDef("push", "joint_force", "rail")
        return SceneDef([cart, pole], [rail, hinge], controls=[push], gravity=(0.0, -9.8), name="CartPole")

    def place(self, x: Array) -> tuple[Array, Array]:
        """Cart and pole at (x, ẋ, θ, θ̇)."""
        position, speed, angle, rate = np.moveaxis(x, -1, 0)
        rise, lean = HALF_LENGTH * np.cos(angle), HALF_LENGTH * np.sin(angle)
        zero = np.zeros_like(position)
        q = [[position, zero, zero], [position + lean, rise, -angle]]
        v = [[speed, zero, zero], [speed + rise * rate, -lean * rate, -rate]]
        return stacked(q), stacked(v)

    def coordinates(self, q: Array, v: Array) -> Array:
        """(x, ẋ, θ, θ̇); body angles are counter-clockwise, θ is clockwise."""
        return np.stack([q[..., 0, 0], v[..., 0, 0], -q[..., 1, 2], -v[..., 1, 2]], axis=-1)

    def controls(self, action: Array) -> Array:
        """The push, N."""
        return MAX_FORCE * action

    def observe(self, x: Array) -> Array:
        """The coordinates."""
        return x

    def reward(self, x: Array, action: Array, after: Array, terminated: npt.NDArray[np.bool_]) -> Array:
        """One per step."""
        return np.ones(after.shape[:-1])

    def terminated(self, x: Array) -> npt.NDArray[np.bool_]:
        """Whether the cart is too far or the pole leans too much."""
        return (np.abs(x[..., 0]) > MAX_POSITION) | (np.abs(x[..., 2]) > MAX_ANGLE)


def make_vec(num_envs: int = 1, **options: Any) -> VectorEnv:
    """Many of them side by side."""
    return VectorEnv(CartPoleEnv, num_envs, **options)

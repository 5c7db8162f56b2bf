"""A finger pushes a box to a goal."""

from __future__ import annotations

from typing import Any

import numpy as np
import numpy.typing as npt

from tangency import BodyDef, Circle, ControlDef, HalfPlane, JointDef, Limits, Prismatic, Rectangle, SceneDef
from tangency.gym.scene_env import Array, SceneEnv, box, stacked
from tangency.gym.vector_env import VectorEnv

__all__ = ["PushBoxEnv"]

MAX_FORCE = 10.0
RADIUS = 0.05
WIDTH, HEIGHT = 0.4, 0.2
POLE_HEIGHT = 0.4
NEAR, SLOW = 0.02, 0.05
FINGER_LIMITS = (-1.5, 2.0)


class PushBoxEnv(SceneEnv):
    """Push a box over a rough floor so that it comes to rest at a goal.

    ===========  =============================================================================
    action       one number in [-1, 1]: the force on the finger, in 10 N
    observation  finger (m) and its speed (m/s), box (m) and its speed (m/s), goal (m); also the coordinates
    reward       -|goal - box| (m) per step
    start        finger -0.6, box in ±0.1, goal in 0.4 to 1.0, all at rest
    ends         the box is within 2 cm of the goal and slower than 5 cm/s; after 200 steps of 0.04 s (``TimeLimit``)
    ===========  =============================================================================

    The finger is a disc of 0.5 kg and 5 cm on a rail, without friction; the box has 1 kg, 0.4 m × 0.2 m, and the
    floor's friction on it is 0.3. A finger can push but not pull: what is pushed too far is lost.
    """

    metadata = {"render_modes": ["rgb_array"], "render_fps": 25}
    period = 0.04
    default_dt = 0.01
    start = ((-0.6, 0.0, -0.1, 0.0, 0.4), (-0.6, 0.0, 0.1, 0.0, 1.0))
    view = (-1.2, 1.8, -0.7, 1.3)

    def __init__(self, **options: Any) -> None:
        super().__init__(**options)
        self.action_space = box(1.0)
        self.observation_space = box(3.0, 20.0, 20.0, 20.0, 3.0)

    @classmethod
    def definition(cls) -> SceneDef:
        """Floor, a pole at the goal that nothing touches, finger and box."""
        floor = BodyDef("floor", "static", shapes=[HalfPlane((0.0, 1.0))], friction=0.3)
        goal = BodyDef("goal", "static", position=(0.7, 0.5 * POLE_HEIGHT), mask=0)
        goal.shapes = [Rectangle(0.02, POLE_HEIGHT)]
        finger = BodyDef("finger", position=(-0.6, 0.5 * HEIGHT), mass=0.5, friction=0.0, shapes=[Circle(RADIUS)])
        pushed = BodyDef("box", position=(0.0, 0.5 * HEIGHT), mass=1.0, friction=0.3)
        pushed.shapes = [Rectangle(WIDTH, HEIGHT)]
        limits = Limits(FINGER_LIMITS[0] + 0.6, FINGER_LIMITS[1] + 0.6)
        rail = JointDef("rail", ("world", "finger"), Prismatic(finger.position, (1.0, 0.0), limits))
        push = ControlDef("push", "joint_force", "rail")
        return SceneDef([floor, goal, finger, pushed], [rail], controls=[push], name="PushBox")

    def place(self, x: Array) -> tuple[Array, Array]:
        """Finger, box and goal at (finger, its speed, box, its speed, goal)."""
        finger, finger_speed, pushed, pushed_speed, goal = np.moveaxis(x, -1, 0)
        zero = np.zeros_like(finger)
        middle = np.full_like(finger, 0.5 * HEIGHT)
        pole = np.full_like(finger, 0.5 * POLE_HEIGHT)
        floor = [zero, zero, zero]
        q = [floor, [goal, pole, zero], [finger, middle, zero], [pushed, middle, zero]]
        v = [floor, floor, [finger_speed, zero, zero], [pushed_speed, zero, zero]]
        return stacked(q), stacked(v)

    def coordinates(self, q: Array, v: Array) -> Array:
        """(finger, its speed, box, its speed, goal)."""
        parts = [q[..., 2, 0], v[..., 2, 0], q[..., 3, 0], v[..., 3, 0], q[..., 1, 0]]
        return np.stack(parts, axis=-1)

    def controls(self, action: Array) -> Array:
        """The force, N."""
        return MAX_FORCE * action

    def observe(self, x: Array) -> Array:
        """The coordinates."""
        return x

    def reward(self, x: Array, action: Array, after: Array, terminated: npt.NDArray[np.bool_]) -> Array:
        """What is left to go."""
        return -np.abs(after[..., 4] - after[..., 2])

    def terminated(self, x: Array) -> npt.NDArray[np.bool_]:
        """Whether the box rests at the goal."""
        return (np.abs(x[..., 4] - x[..., 2]) < NEAR) & (np.abs(x[..., 3]) < SLOW)


def make_vec(num_envs: int = 1, **options: Any) -> VectorEnv:
    """Many of them side by side."""
    return VectorEnv(PushBoxEnv, num_envs, **options)

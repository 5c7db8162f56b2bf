"""The real system: Gymnasium's CartPole, with a force of any size instead of two."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt
from gymnasium.envs.classic_control.cartpole import CartPoleEnv

__all__ = ["MOST_STEPS", "RATES", "RealCartPole", "Trajectory", "random_trajectory"]

Array = npt.NDArray[np.float64]

MOST_STEPS = 1000
"""Of an episode, as in the paper."""


RATES = [1, 3]
"""Where a state has its rates."""


@dataclass(frozen=True)
class Trajectory:
    """An episode.

    Attributes
    ----------
    states : ndarray, shape (steps + 1, 4)
        Cart position (m), its speed (m/s), pole angle from upright (rad, clockwise), its rate (rad/s).
    actions : ndarray, shape (steps,)
        In [−1, 1], of the greatest force, 10 N.
    """

    states: Array
    actions: Array


class RealCartPole:
    """Gymnasium's own equations and integrator; an action in [−1, 1] scales the force of 10 N."""

    def __init__(self, seed: int) -> None:
        self._env = CartPoleEnv()
        self._force = self._env.force_mag
        self._seed: int | None = seed

    def reset(self) -> Array:
        """A start near upright, as Gymnasium draws it."""
        state, _ = self._env.reset(seed=self._seed)
        self._seed = None
        return self._exact(state)

    def step(self, action: float) -> tuple[Array, bool]:
        """The next state, and whether the episode has failed: beyond 12° or 2.4 m."""
        self._env.force_mag = self._force * abs(action)
        state, _, failed, _, _ = self._env.step(int(action > 0.0))  # type: ignore[no-untyped-call]
        return self._exact(state), failed

    def _exact(self, rounded: npt.NDArray[np.float32]) -> Array:
        """The state in double precision; what the environment returns is rounded to single."""
        return np.array(self._env.state if self._env.state is not None else rounded, dtype=np.float64)


def random_trajectory(real: RealCartPole, rng: np.random.Generator) -> Trajectory:
    """An episode of random actions, until it fails."""
    states, failed = [real.reset()], False
    actions: list[float] = []
    while not failed and len(actions) < MOST_STEPS:
        actions.append(float(rng.uniform(-1.0, 1.0)))
        state, failed = real.step(actions[-1])
        states.append(state)
    return Trajectory(np.array(states), np.array(actions))

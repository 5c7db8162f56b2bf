"""Many environments side by side, over all cores."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import gymnasium
import numpy as np
import numpy.typing as npt
from gymnasium.utils import seeding
from gymnasium.vector import AutoresetMode
from gymnasium.vector.utils import batch_space

from tangency import Batch
from tangency.gym.scene_env import Array, Frame, SceneEnv

__all__ = ["VectorEnv"]

Bools = npt.NDArray[np.bool_]


class VectorEnv(gymnasium.vector.VectorEnv[npt.NDArray[np.float32], npt.NDArray[np.float32], npt.NDArray[Any]]):
    """Copies of one environment, stepped together by a `tangency.Batch`.

    Environment i does what a single one does with the same seed and actions, to the same bits. An episode that
    ends is followed by a new one at the next step (``AutoresetMode.NEXT_STEP``), whose action, reward and flags
    are ignored, 0 and False.

    Parameters
    ----------
    env : subclass of SceneEnv
        What there are copies of.
    num_envs : int
        How many, at least 1.
    max_episode_steps : int, optional
        After how many steps an episode is truncated.
    **options
        Arguments of `env`; with ``render_mode="rgb_array"``, `render` gives one picture per copy.
    """

    metadata: dict[str, Any] = {"render_modes": ["rgb_array"], "autoreset_mode": AutoresetMode.NEXT_STEP}

    def __init__(
        self, env: type[SceneEnv], num_envs: int = 1, max_episode_steps: int | None = None, **options: Any
    ) -> None:
        if num_envs < 1:
            raise ValueError(f"num_envs is {num_envs}; give at least 1")
        self.single = env(**options)
        self.num_envs = num_envs
        self.max_episode_steps = max_episode_steps
        self.render_mode = self.single.render_mode
        self.metadata = {**env.metadata, **type(self).metadata}
        self.single_action_space = self.single.action_space
        self.single_observation_space = self.single.observation_space
        self.action_space = batch_space(self.single_action_space, num_envs)
        self.observation_space = batch_space(self.single_observation_space, num_envs)
        self.batch = Batch(self.single.scene, num_envs)
        self._x = self.single.coordinates(self.batch.q, self.batch.v)
        self._elapsed = np.zeros(num_envs, dtype=np.int64)
        self._over = np.zeros(num_envs, dtype=np.bool_)
        self._generators: list[np.random.Generator] = []
        self._seeds: list[int] = []

    @property  # type: ignore[misc]
    def np_random(self) -> tuple[np.random.Generator, ...]:  # type: ignore[override]
        """One generator per environment."""
        self._seed([None] * self.num_envs)
        return tuple(self._generators)

    @property
    def np_random_seed(self) -> tuple[int, ...]:  # type: ignore[override]
        """The seed of each generator."""
        self._seed([None] * self.num_envs)
        return tuple(self._seeds)

    def reset(
        self, *, seed: int | Sequence[int | None] | None = None, options: Mapping[str, Any] | None = None
    ) -> tuple[npt.NDArray[np.float32], dict[str, Any]]:
        """Starts an episode in every environment.

        Parameters
        ----------
        seed : int or sequence of int, optional
            Environment i has ``seed + i``, or its own.
        options : mapping, optional
            As for one environment: see `SceneEnv.draw_start`.
        """
        seeds = [seed + i for i in range(self.num_envs)] if isinstance(seed, int) else seed
        if seeds is not None and len(seeds) != self.num_envs:
            raise ValueError(f"there are {len(seeds)} seeds; give {self.num_envs}, one per environment")
        self._seed([None] * self.num_envs if seeds is None else seeds)
        every = np.arange(self.num_envs)
        self._start(every, options)
        self._elapsed[:], self._over[:] = 0, False
        return self._observations(), {}

    def step(
        self, actions: npt.ArrayLike
    ) -> tuple[npt.NDArray[np.float32], Array, Bools, Bools, dict[str, Any]]:
        """Acts for one period in every environment; the first step after an episode's end starts a new one.

        Raises
        ------
        ValueError
            If the actions have another shape than (num_envs, ...).
        tangency.StepError
            If a step of the physics cannot be solved; `failures` says where.
        """
        single, before, fresh = self.single, self._x, self._over
        bounded = single.clipped(actions, (self.num_envs, *single.action_space.shape))
        self.batch.advance(single.steps_per_action, single.controls(bounded))
        after = single.coordinates(self.batch.q, self.batch.v)
        self._x = single.bounded(after)
        self._put(np.flatnonzero(np.any(self._x != after, axis=-1)))
        self._start(np.flatnonzero(fresh))
        terminated = single.terminated(self._x)
        rewards = np.where(fresh, 0.0, single.reward(before, bounded, self._x, terminated))
        self._elapsed = np.where(fresh, 0, self._elapsed + 1)
        terminated = terminated & ~fresh
        limit = np.inf if self.max_episode_steps is None else self.max_episode_steps
        truncated = (self._elapsed >= limit) & ~fresh
        self._over = terminated | truncated
        return self._observations(), rewards, terminated, truncated, {}

    def render(self) -> tuple[Frame, ...] | None:
        """One picture per environment in the mode ``"rgb_array"``, uint8 of shape (height, width, 3)."""
        if self.render_mode is None:
            gymnasium.logger.warn('there are no pictures; make the environments with render_mode="rgb_array"')
            return None
        return tuple(self.single.picture(state) for state in zip(self.batch.q, self.batch.v))

    def __getstate__(self) -> dict[str, Any]:
        states = self.batch.q, self.batch.v
        return {**self.__dict__, "batch": states}

    def __setstate__(self, state: dict[str, Any]) -> None:
        self.__dict__.update(state)
        self.batch = Batch(self.single.scene, self.num_envs)
        self.batch.reset_to(*state["batch"])

    def _seed(self, seeds: Sequence[int | None]) -> None:
        """New generators where there is a seed or none yet."""
        if not self._generators:
            pairs = [seeding.np_random(seed) for seed in seeds]
            self._generators, self._seeds = [pair[0] for pair in pairs], [pair[1] for pair in pairs]
            return
        for i, seed in enumerate(seeds):
            if seed is not None:
                self._generators[i], self._seeds[i] = seeding.np_random(seed)

    def _start(self, which: npt.NDArray[np.intp], options: Mapping[str, Any] | None = None) -> None:
        """Draws starts of these environments."""
        for i in which:
            self._x[i] = self.single.draw_start(self._generators[i], options)
        self._put(which)

    def _put(self, which: npt.NDArray[np.intp]) -> None:
        """Puts these environments where their coordinates are."""
        if which.size:
            q, v = self.single.place(self._x[which])
            self.batch.reset_to(q, v, environments=which.tolist())

    def _observations(self) -> npt.NDArray[np.float32]:
        return self.single.observe(self._x).astype(np.float32)

"""What is measured: one-step errors and rewards against the number of random trajectories."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass

import numpy as np

from tangency.experiments.cartpole.controller import Controller, NetworkController, PhysicsController, episode
from tangency.experiments.cartpole.network import NetworkModel
from tangency.experiments.cartpole.physics import PhysicsModel
from tangency.experiments.cartpole.real import RATES, Array, RealCartPole, Trajectory, random_trajectory

__all__ = ["Point", "Setting", "points"]


@dataclass(frozen=True)
class Setting:
    """How much is measured."""

    counts: tuple[int, ...]
    """Numbers of trajectories to learn from."""
    seeds: int
    """Repetitions with other trajectories."""
    episodes: int
    """Controlled episodes per repetition."""
    rounds: int
    """Of the network's training."""


QUICK = Setting(counts=(1, 5), seeds=1, episodes=3, rounds=500)
FULL = Setting(counts=(1, 2, 3, 5, 10, 20, 50), seeds=3, episodes=20, rounds=3000)


@dataclass(frozen=True)
class Point:
    """A model that learned from so many trajectories."""

    model: str
    trajectories: int
    seed: int
    error: float
    """Root of the mean squared one-step error of the rates on other trajectories, in units of their spread."""
    rewards: tuple[int, ...]
    numbers: tuple[float, ...]
    """Cart mass (kg), pole mass (kg), half-length (m) that the physics learned."""


def one_step_error(predict: Callable[[Array, float], Array], test: list[Trajectory]) -> float:
    """Against trajectories that were not learned from."""
    errors, changes = [], []
    for it in test:
        for before, action, after in zip(it.states[:-1], it.actions, it.states[1:]):
            errors.append(predict(before, float(action)) - after)
            changes.append(after - before)
    relative = np.array(errors)[:, RATES] / np.array(changes)[:, RATES].std(axis=0)
    return float(np.sqrt((relative**2).mean()))


def rewards(controller: Callable[[], Controller], seed: int, episodes: int) -> tuple[int, ...]:
    """Of controlled episodes; starts are the same for every model."""
    return tuple(episode(RealCartPole(1000 * seed + k), controller()) for k in range(episodes))


def points(setting: Setting, tell: Callable[[str], None]) -> Iterator[Point]:
    """Both models, for every number of trajectories and every seed."""
    test_rng = np.random.default_rng(12345)
    test = [random_trajectory(RealCartPole(90_000 + k), test_rng) for k in range(10)]
    for seed in range(setting.seeds):
        rng = np.random.default_rng(seed)
        data = [random_trajectory(RealCartPole(500 * (seed + 1) + k), rng) for k in range(max(setting.counts))]
        for count in setting.counts:
            physics = PhysicsModel()
            physics.fit(data[:count])
            error = one_step_error(physics.predict, test)
            found = rewards(lambda physics=physics: PhysicsController(physics), seed, setting.episodes)  # type: ignore[misc]
            yield Point("physics", count, seed, error, found, tuple(float(x) for x in physics.numbers))
            network = NetworkModel(seed)
            network.fit(data[:count], setting.rounds)
            error = one_step_error(network.predict, test)
            found = rewards(lambda network=network: NetworkController(network), seed, setting.episodes)  # type: ignore[misc]
            yield Point("network", count, seed, error, found, ())
            tell(f"seed {seed}, {count} trajectories")

"""Control by iterative LQR over the next few frames, planned anew at every step.

The cost is the paper's, the squared pole angle, and a millionth of the squared action, without which the plan is
not unique.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Protocol

import numpy as np

import tangency
from tangency.experiments.cartpole.network import NetworkModel
from tangency.experiments.cartpole.physics import FORCE, PhysicsModel, state_of
from tangency.experiments.cartpole.real import MOST_STEPS, Array, RealCartPole

__all__ = ["Controller", "NetworkController", "PhysicsController", "episode"]


class Controller(Protocol):
    """What acts."""

    def action(self, state: Array) -> float:
        """The action in a state (4,), in [−1, 1]."""


EFFORT = 1e-6
"""Weight of the squared action beside that of the squared angle (rad²), 1."""


class _Receding:
    """Plans begin with the last plan, moved on by a step."""

    def __init__(self, horizon: int) -> None:
        self._guess = np.zeros((horizon, 1))

    def _first(self, plan: tangency.Plan) -> float:
        self._guess = np.vstack([plan.controls[1:], plan.controls[-1:]])
        return float(plan.controls[0, 0])


def _best(search: Callable[[], tangency.Plan]) -> tangency.Plan:
    """The plan, or the best one so far where the search was ended."""
    try:
        return search()
    except tangency.PlanError as error:
        if error.plan is None:
            raise
        return error.plan


class PhysicsController(_Receding):
    """Through the engine, with the numbers that were learned."""

    def __init__(self, model: PhysicsModel, horizon: int = 5) -> None:
        super().__init__(horizon)
        self._scene, self._length = model.scene(), float(model.numbers[2])
        self._cost = tangency.Quadratic.of_effort(12, 1, EFFORT / FORCE**2)
        self._cost.aim(5, 0.0, 1.0, 1.0)  # of (cart x y θ, pole x y θ | their rates)

    def action(self, state: Array) -> float:
        """See `Controller`."""
        at = state_of(self._scene, state, self._length)

        def search() -> tangency.Plan:
            guess, limit = self._guess, FORCE
            return tangency.plan(
                self._scene, self._cost, guess, state=at, lower=-limit, upper=limit, max_iterations=20, tolerance=1e-6
            )

        return self._first(_best(search)) / FORCE


class NetworkController(_Receding):
    """Through the network, with the same planner and cost."""

    def __init__(self, model: NetworkModel, horizon: int = 5) -> None:
        super().__init__(horizon)
        self._model = model
        self._cost = tangency.Quadratic.of_effort(4, 1, EFFORT)
        self._cost.aim(2, 0.0, 1.0, 1.0)

    def action(self, state: Array) -> float:
        """See `Controller`."""

        def search() -> tangency.Plan:
            guess, limit = self._guess, 1.0
            return tangency.plan(
                self._model, self._cost, guess, state=state, lower=-limit, upper=limit, max_iterations=20, tolerance=1e-6
            )

        return self._first(_best(search))


def episode(real: RealCartPole, controller: Controller) -> int:
    """The reward: how many steps an episode lasts, at most 1000."""
    state = real.reset()
    for step in range(MOST_STEPS):
        state, failed = real.step(controller.action(state))
        if failed:
            return step + 1
    return MOST_STEPS

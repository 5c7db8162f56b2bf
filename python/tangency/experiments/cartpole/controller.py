"""Control by iterative LQR over the next few frames, planned anew at every step.

The cost is the paper's, the squared pole angle, and a millionth of the squared action, without which the plan is
not unique.
"""

from __future__ import annotations

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


def _planned(*arguments: object, **keywords: object) -> tangency.Plan:
    """The plan, or the best one where the search was ended."""
    try:
        return tangency.plan(*arguments, max_iterations=20, tolerance=1e-6, **keywords)  # type: ignore[arg-type]
    except tangency.PlanError as error:
        best = getattr(error, "plan", None)
        if best is None:
            raise
        return best  # type: ignore[no-any-return]


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
        plan = _planned(self._scene, self._cost, self._guess, state=at, lower=-FORCE, upper=FORCE)
        return self._first(plan) / FORCE


class NetworkController(_Receding):
    """Through the network, with the same planner and cost."""

    def __init__(self, model: NetworkModel, horizon: int = 5) -> None:
        super().__init__(horizon)
        self._model = model
        self._cost = tangency.Quadratic.of_effort(4, 1, EFFORT)
        self._cost.aim(2, 0.0, 1.0, 1.0)

    def action(self, state: Array) -> float:
        """See `Controller`."""
        plan = _planned(self._model, self._cost, self._guess, state=state, lower=-1.0, upper=1.0)
        return self._first(plan)


def episode(real: RealCartPole, controller: Controller) -> int:
    """The reward: how many steps an episode lasts, at most 1000."""
    state = real.reset()
    for step in range(MOST_STEPS):
        state, failed = real.step(controller.action(state))
        if failed:
            return step + 1
    return MOST_STEPS

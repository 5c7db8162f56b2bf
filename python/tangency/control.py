"""Costs of motions, for the planner."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

__all__ = ["Quadratic"]

Array = npt.NDArray[np.float64]


@dataclass
class Quadratic:
    """Half the weighted squares of how far states and controls are from a target.

    ::

        l   = ½ (x − x*)ᵀ Q (x − x*) + ½ (u − u*)ᵀ R (u − u*)        l_T = ½ (x − x*)ᵀ Q_T (x − x*)

    Attributes
    ----------
    target : ndarray, shape (states,)
        x*, in the order of `Scene.coordinates`.
    rest : ndarray, shape (channels,)
        u*.
    state, last : ndarray, shape (states, states)
        Q and Q_T, symmetric.
    control : ndarray, shape (channels, channels)
        R, symmetric and positive definite.
    """

    target: Array
    rest: Array
    state: Array
    control: Array
    last: Array

    @classmethod
    def of_effort(cls, states: int, channels: int, effort: float) -> Quadratic:
        """A cost of the control alone, R = `effort` times the identity, and target zero."""
        zeros = np.zeros((states, states))
        rest, control = np.zeros(channels), effort * np.eye(channels)
        return cls(np.zeros(states), rest, zeros, control, zeros.copy())

    def aim(self, place: int, target: float, running: float, last: float) -> None:
        """Sets the target of one coordinate, and its weights during the motion and at its end."""
        self.target[place] = target
        self.state[place, place] = running
        self.last[place, place] = last

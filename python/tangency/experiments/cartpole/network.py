"""The baseline: a network of two layers of 100 that learns the same steps.

::

    s⁺ = s + σ ∘ (W₃ tanh(W₂ tanh(W₁ z + b₁) + b₂) + b₃),      z = ((s, a) − mean)/spread
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import torch

from tangency.experiments.cartpole.real import Array, Trajectory

__all__ = ["NetworkModel"]


class NetworkModel:
    """A network; `states` and `controls`, `step` and `linearise` are what the planner asks for."""

    states = 4
    controls = 1

    def __init__(self, seed: int, width: int = 100) -> None:
        torch.manual_seed(seed)
        self._layers = torch.nn.Sequential(
            torch.nn.Linear(5, width), torch.nn.Tanh(), torch.nn.Linear(width, width), torch.nn.Tanh(),
            torch.nn.Linear(width, 4),
        ).double()  # fmt: skip

    def fit(self, data: Sequence[Trajectory], rounds: int = 2000) -> float:
        """Adam on the one-step errors, in units of their spread; the last loss."""
        before = np.concatenate([it.states[:-1] for it in data])
        after = np.concatenate([it.states[1:] for it in data])
        actions = np.concatenate([it.actions for it in data])
        inputs = np.column_stack([before, actions])
        self._mean, self._spread = inputs.mean(axis=0), inputs.std(axis=0) + 1e-9
        self._scale = (after - before).std(axis=0) + 1e-9
        z = torch.tensor((inputs - self._mean) / self._spread)
        target = torch.tensor((after - before) / self._scale)
        search = torch.optim.Adam(self._layers.parameters(), lr=3e-3)
        schedule = torch.optim.lr_scheduler.CosineAnnealingLR(search, rounds)
        for _ in range(rounds):
            search.zero_grad()
            loss = ((self._layers(z) - target) ** 2).mean()
            loss.backward()
            search.step()
            schedule.step()
        linear = [layer for layer in self._layers if isinstance(layer, torch.nn.Linear)]
        self._weights = [layer.weight.detach().numpy().copy() for layer in linear]
        self._biases = [layer.bias.detach().numpy().copy() for layer in linear]
        return float(loss.item())

    def _forward(self, state: Array, action: Array) -> tuple[Array, Array, Array]:
        z = (np.concatenate([state, action]) - self._mean) / self._spread
        first = np.tanh(self._weights[0] @ z + self._biases[0])
        second = np.tanh(self._weights[1] @ first + self._biases[1])
        return state + self._scale * (self._weights[2] @ second + self._biases[2]), first, second

    def step(self, state: Array, action: Array) -> Array:
        """The state after a step; shapes (4,) and (1,)."""
        return self._forward(state, action)[0]

    def linearise(self, state: Array, action: Array) -> tuple[Array, Array]:
        """A = ∂s⁺/∂s (4, 4) and B = ∂s⁺/∂a (4, 1)."""
        _, first, second = self._forward(state, action)
        inner = (1.0 - first**2)[:, None] * (self._weights[0] / self._spread)
        outer = self._weights[2] @ ((1.0 - second**2)[:, None] * (self._weights[1] @ inner))
        jacobian = self._scale[:, None] * outer
        return np.eye(4) + jacobian[:, :4], jacobian[:, 4:]

    def predict(self, state: Array, action: float) -> Array:
        """As `step`."""
        return self.step(state, np.array([action]))

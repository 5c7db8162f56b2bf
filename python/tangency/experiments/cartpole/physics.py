"""The model: a cart and a pole in the engine, whose masses and length are learned.

The pole's centre is l from the hinge, and its inertia that of a uniform rod of length 2 l::

    q = (x, 0, 0 | x + l sin θ, l cos θ, −θ)        I = m l²/3        anchor on the pole = (0, −l)

(θ clockwise from upright, as Gymnasium counts it; angles of the engine are counter-clockwise.)
"""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
import torch

import tangency
import tangency.torch
from tangency.experiments.cartpole.real import RATES, Array, Trajectory

__all__ = ["FORCE", "INTERVAL", "PhysicsModel"]

FORCE = 10.0
"""Of action 1, N."""

INTERVAL = 0.02
"""Of a step, s."""


def scene(cart_mass: float, pole_mass: float, length: float) -> tangency.Scene:
    """Cart and pole, upright; `length` is l, half the pole's."""
    cart = tangency.BodyDef("cart", shapes=[tangency.Rectangle(0.5, 0.3)], mass=cart_mass)
    rod = tangency.Rectangle(0.04, 2.0 * length)
    inertia = pole_mass * length**2 / 3.0
    pole = tangency.BodyDef("pole", position=(0.0, length), shapes=[rod], mass=pole_mass, inertia=inertia)
    rail = tangency.JointDef("rail", ("world", "cart"), tangency.Prismatic((0.0, 0.0), (1.0, 0.0)))
    hinge = tangency.JointDef("hinge", ("cart", "pole"), tangency.Revolute((0.0, 0.0)))
    push = tangency.ControlDef("push", "force_x", "cart")
    return tangency.Scene(
        tangency.SceneDef([cart, pole], [rail, hinge], controls=[push], gravity=(0.0, -9.8), dt=INTERVAL, name="Cartpole")
    )


class PhysicsModel(torch.nn.Module):
    """Masses and half-length, each as exp of a parameter, so that they stay positive."""

    def __init__(self, cart_mass: float = 0.5, pole_mass: float = 0.5, length: float = 1.0) -> None:
        super().__init__()
        start = torch.tensor([cart_mass, pole_mass, length], dtype=torch.float64)
        self.logs = torch.nn.Parameter(start.log())
        self._scene = scene(1.0, 1.0, 1.0)

    @property
    def numbers(self) -> Array:
        """Cart mass (kg), pole mass (kg), half-length (m)."""
        found: Array = self.logs.detach().exp().numpy()
        return found

    def forward(self, states: torch.Tensor, actions: torch.Tensor) -> torch.Tensor:
        """The states after a step: (batch, 4) from (batch, 4) and (batch,)."""
        cart_mass, pole_mass, length = self.logs.exp()
        q, v = self._poses(states, length)
        values = {
            "mass:cart": cart_mass,
            "mass:pole": pole_mass,
            "inertia:pole": pole_mass * length**2 / 3.0,
            "anchor_b.y:hinge": -length,
        }
        q, v = tangency.torch.step(self._scene, q, v, FORCE * actions[:, None], values)
        return torch.stack([q[:, 0, 0], v[:, 0, 0], -q[:, 1, 2], -v[:, 1, 2]], dim=1)

    @staticmethod
    def _poses(states: torch.Tensor, length: torch.Tensor) -> tuple[torch.Tensor, torch.Tensor]:
        x, speed, angle, rate = states.unbind(dim=1)
        sin, cos, zero = angle.sin(), angle.cos(), torch.zeros_like(x)
        cart = torch.stack([x, zero, zero], dim=1)
        pole = torch.stack([x + length * sin, length * cos, -angle], dim=1)
        cart_v = torch.stack([speed, zero, zero], dim=1)
        pole_v = torch.stack([speed + length * cos * rate, -length * sin * rate, -rate], dim=1)
        return torch.stack([cart, pole], dim=1), torch.stack([cart_v, pole_v], dim=1)

    def fit(self, data: Sequence[Trajectory], rounds: int = 60) -> list[float]:
        """Gradient descent (L-BFGS) on the one-step errors of the rates, in units of their spread; the losses.

        Places tell nothing more: Gymnasium moves them by the rates before a step, the engine by those after it.
        """
        before = torch.tensor(np.concatenate([it.states[:-1] for it in data]))
        after = torch.tensor(np.concatenate([it.states[1:] for it in data]))
        actions = torch.tensor(np.concatenate([it.actions for it in data]))
        spread = (after - before).std(dim=0)[RATES]
        search = torch.optim.LBFGS([self.logs], max_iter=rounds, line_search_fn="strong_wolfe", tolerance_change=1e-14)
        losses: list[float] = []

        def loss() -> torch.Tensor:
            search.zero_grad()
            value: torch.Tensor = (((self(before, actions) - after)[:, RATES] / spread) ** 2).mean()
            value.backward()  # type: ignore[no-untyped-call]
            losses.append(value.item())
            return value

        search.step(loss)  # type: ignore[no-untyped-call]
        return losses

    def predict(self, state: Array, action: float) -> Array:
        """The state after a step; shape (4,)."""
        with torch.no_grad():
            found: Array = self(torch.tensor(state)[None], torch.tensor([action]))[0].numpy()
            return found

    def scene(self) -> tangency.Scene:
        """The scene with the numbers learned."""
        return scene(*(float(number) for number in self.numbers))


def state_of(scene: tangency.Scene, state: Array, length: float) -> tangency.State:
    """The engine's state for (x, ẋ, θ, θ̇)."""
    x, speed, angle, rate = state
    sin, cos = math.sin(angle), math.cos(angle)
    q = np.array([[x, 0.0, 0.0], [x + length * sin, length * cos, -angle]])
    v = np.array([[speed, 0.0, 0.0], [speed + length * cos * rate, -length * sin * rate, -rate]])
    return tangency.State(q, v)

"""The model of the paper's figure 2: an encoder per disc, physics or a network in its place, and a decoder."""

from __future__ import annotations

from typing import Protocol

import torch
from torch import Tensor, nn

import tangency
import tangency.torch
from tangency.experiments.billiards.data import AHEAD, CHANNELS
from tangency.experiments.billiards.table import Table

__all__ = ["Decoder", "Encoder", "Model", "NetworkStep", "PhysicsStep", "scene"]

VGG11 = (64, "M", 128, "M", 256, 256, "M", 512, 512, "M", 512, 512)
"""Convolutions (their channels) and pools of VGG-11 but the last pool (Simonyan & Zisserman 2015)."""


def scene(table: Table) -> tangency.Scene:
    """The table in the engine: walls without friction, everything elastic, impacts at their own time."""
    normals = {"left": (1.0, 0.0), "right": (-1.0, 0.0), "bottom": (0.0, 1.0), "top": (0.0, -1.0)}
    offsets = {"left": 0.0, "right": -1.0, "bottom": 0.0, "top": -1.0}
    walls = [
        tangency.BodyDef(name, "static", shapes=[tangency.HalfPlane(n, offsets[name])], friction=0.0, restitution=1.0)
        for name, n in normals.items()
    ]
    places = [(0.5 + 0.25 * (k - 1), 0.5) for k in range(table.discs)]
    discs = [
        tangency.BodyDef(f"disc{k}", position=at, shapes=[tangency.Circle(table.radius)], friction=0.0, restitution=1.0)
        for k, at in enumerate(places)
    ]
    return tangency.Scene(
        tangency.SceneDef(
            [*discs, *walls],
            gravity=(0.0, 0.0),
            dt=table.interval,
            stepping={"impact_resolved": {"max_impacts": 16}},
            name="Billiards",
        )
    )


class Step(Protocol):
    """What takes the state ten frames ahead: (batch, discs, 4) to (batch, discs, 4)."""

    def __call__(self, states: Tensor) -> Tensor: ...


class PhysicsStep(nn.Module):
    """The engine."""

    def __init__(self, table: Table) -> None:
        super().__init__()
        self._scene, self._discs = scene(table), table.discs

    def forward(self, states: Tensor) -> Tensor:
        """See `Step`."""
        batch = states.shape[0]
        walls = states.new_zeros(batch, len(self._scene.bodies) - self._discs, 3)
        still = states.new_zeros(batch, self._discs, 1)
        q = torch.cat([torch.cat([states[..., :2], still], dim=-1), walls], dim=1)
        v = torch.cat([torch.cat([states[..., 2:], still], dim=-1), walls], dim=1)
        q, v = tangency.torch.rollout(self._scene, AHEAD, q0=q, v0=v)
        return torch.cat([q[:, -1, : self._discs, :2], v[:, -1, : self._discs, :2]], dim=-1)


class NetworkStep(nn.Module):
    """The baseline: two layers of 100 in the place of the physics."""

    def __init__(self, table: Table, width: int = 100) -> None:
        super().__init__()
        size = 4 * table.discs
        self._layers = nn.Sequential(
            nn.Linear(size, width), nn.ReLU(), nn.Linear(width, width), nn.ReLU(), nn.Linear(width, size)
        )

    def forward(self, states: Tensor) -> Tensor:
        """See `Step`."""
        change: Tensor = self._layers(states.flatten(1)).view_as(states)
        return states + change


class Encoder(nn.Module):
    """State of each disc from what is seen of it: VGG-11 of some width, and two layers."""

    def __init__(self, table: Table, size: int, width: float) -> None:
        super().__init__()
        layers: list[nn.Module] = []
        channels = CHANNELS
        for entry in VGG11:
            if isinstance(entry, int):
                out = max(8, round(entry * width))
                layers += [nn.Conv2d(channels, out, 3, padding=1), nn.BatchNorm2d(out), nn.ReLU()]
                channels = out
            else:
                layers.append(nn.MaxPool2d(2))
        self._features = nn.Sequential(*layers)
        flat = channels * (size // 16) ** 2
        hidden = max(32, round(4096 * width / 4))
        self._head = nn.Sequential(nn.Flatten(), nn.Linear(flat, hidden), nn.ReLU(), nn.Linear(hidden, 4))
        self._radius, self._speed = table.radius, table.greatest_speed

    def forward(self, inputs: Tensor) -> Tensor:
        """(batch, discs, 4) from uint8 (batch, discs, 13, size, size)."""
        batch, discs = inputs.shape[:2]
        found = self._head(self._features(inputs.flatten(0, 1).float() / 127.5 - 1.0)).view(batch, discs, 4)
        # Places between the walls, whatever the network says: the engine cannot answer for what is outside.
        place = self._radius + (1.0 - 2.0 * self._radius) * torch.sigmoid(found[..., :2])
        return torch.cat([place, 2.0 * self._speed * torch.tanh(found[..., 2:])], dim=-1)


class Decoder(nn.Module):
    """A frame from the places of all discs: the mirrored network."""

    def __init__(self, table: Table, size: int, width: float) -> None:
        super().__init__()
        self._side = size // 16
        widths = [max(8, round(entry * width)) for entry in reversed(VGG11) if isinstance(entry, int)]
        self._head = nn.Sequential(
            nn.Linear(2 * table.discs, 128), nn.ReLU(), nn.Linear(128, widths[0] * self._side**2), nn.ReLU()
        )
        layers: list[nn.Module] = []
        channels = widths[0]
        remaining = iter(widths[1:])
        for entry in list(reversed(VGG11))[1:]:
            if isinstance(entry, int):
                out = next(remaining)
                layers += [nn.Conv2d(channels, out, 3, padding=1), nn.BatchNorm2d(out), nn.ReLU()]
                channels = out
            else:
                layers.append(nn.Upsample(scale_factor=2, mode="nearest"))
        self._features = nn.Sequential(*layers, nn.Conv2d(channels, 3, 3, padding=1))

    def forward(self, states: Tensor) -> Tensor:
        """RGB in 0 … 1, (batch, 3, size, size), from (batch, discs, 4)."""
        flat = self._head(2.0 * states[..., :2].flatten(1) - 1.0)
        picture: Tensor = torch.sigmoid(self._features(flat.view(flat.shape[0], -1, self._side, self._side)))
        return picture


class Model(nn.Module):
    """Frames in, state, state later, frame later out."""

    def __init__(self, table: Table, step: nn.Module, size: int, width: float) -> None:
        super().__init__()
        self.encoder, self.step, self.decoder = Encoder(table, size, width), step, Decoder(table, size, width)

    def forward(self, inputs: Tensor) -> tuple[Tensor, Tensor, Tensor]:
        """(states, states later, frames later)."""
        states = self.encoder(inputs)
        later = self.step(states)
        return states, later, self.decoder(later)

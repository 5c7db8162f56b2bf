"""Training, with labels for some samples and frames for all.

::

    L = L_enc + L_phys + L_dec       where states are known,        L = L_dec       where only frames are
    L_enc = ‖s − s*‖²/σ²             of the state at the last frame seen
    L_phys = ‖x − x*‖²/σ²            of the places ten frames later
    L_dec = ‖frame − frame*‖²        of the pixels ten frames later

(de Avila Belbute-Peres et al. 2018, equations 4 to 6), each a mean over its numbers.
"""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
import torch
from torch import Tensor, nn

import tangency
from tangency.experiments.billiards.data import Samples
from tangency.experiments.billiards.model import Model

__all__ = ["Curve", "Training", "evaluate", "train"]

DECODER_WEIGHT = 10.0
"""Of the pixels' loss beside those of states."""


@dataclass(frozen=True)
class Training:
    """How long, and how."""

    epochs: int
    batch: int = 64
    rate: float = 1e-3
    seed: int = 0


@dataclass(frozen=True)
class Curve:
    """What came of a training.

    Attributes
    ----------
    validation : list of float
        Mean squared error of places ten frames later (sides²), as training goes on.
    pixels : list of float
        The same of the pixels.
    skipped : int
        Batches that the engine could not answer for.
    seconds : float
        How long it took.
    """

    validation: list[float]
    pixels: list[float]
    skipped: int
    seconds: float


def losses(model: Model, samples: Samples, labelled: Tensor) -> Tensor:
    """The loss of a batch, of which `labelled` (bool) have labels."""
    states, later, frames = model(samples.inputs)
    loss = DECODER_WEIGHT * nn.functional.mse_loss(frames, samples.frames.float() / 255.0)
    if labelled.any():
        loss = loss + nn.functional.mse_loss(states[labelled], samples.states[labelled])
        loss = loss + nn.functional.mse_loss(later[labelled][..., :2], samples.later[labelled][..., :2])
    return loss


def evaluate(model: Model, samples: Samples, batch: int = 250) -> tuple[float, float]:
    """Mean squared errors of places and of pixels, ten frames later."""
    model.eval()
    places, pixels, count = 0.0, 0.0, 0
    with torch.no_grad():
        for which in torch.split(torch.arange(len(samples)), batch):
            part = samples.part(which)
            _, later, frames = model(part.inputs)
            places += len(part) * nn.functional.mse_loss(later[..., :2], part.later[..., :2]).item()
            pixels += len(part) * nn.functional.mse_loss(frames, part.frames.float() / 255.0).item()
            count += len(part)
    return places / count, pixels / count


def train(
    model: Model,
    samples: Samples,
    labelled: Tensor,
    validation: Samples,
    training: Training,
    tell: Callable[[str], None],
) -> Curve:
    """Adam over one cycle of rates; every batch mixes samples with labels and without, as they come.

    Validated some twenty times, at the ends of epochs.
    """
    rng = np.random.default_rng(training.seed)
    search = torch.optim.Adam(model.parameters(), lr=training.rate)
    steps = training.epochs * (len(samples) // training.batch)
    schedule = torch.optim.lr_scheduler.OneCycleLR(search, 2.0 * training.rate, total_steps=steps)
    curve: list[tuple[float, float]] = []
    skipped, started = 0, time.monotonic()
    for epoch in range(training.epochs):
        model.train()
        order = torch.from_numpy(rng.permutation(len(samples)))
        for which in torch.split(order, training.batch):
            if len(which) < training.batch:
                continue
            try:
                loss = losses(model, samples.part(which), labelled[which])
                search.zero_grad()
                loss.backward()  # type: ignore[no-untyped-call]
            except (tangency.StepError, tangency.GradientError):
                skipped += 1
                continue
            nn.utils.clip_grad_norm_(model.parameters(), 1.0)
            search.step()
            schedule.step()
        if (epoch + 1) % max(1, training.epochs // 20) and epoch + 1 < training.epochs:
            continue
        curve.append(evaluate(model, validation))
        tell(f"epoch {epoch + 1}: places {curve[-1][0]:.2e}, pixels {curve[-1][1]:.2e}")
    places, pixels = ([float(it[k]) for it in curve] for k in range(2))
    return Curve(places, pixels, skipped, time.monotonic() - started)

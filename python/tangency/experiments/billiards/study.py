"""What is compared: physics and network, with few labels and many, with frames that have none and without."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass

import torch
from torch import nn

from tangency.experiments.billiards.data import Samples, samples
from tangency.experiments.billiards.model import Model, NetworkStep, PhysicsStep
from tangency.experiments.billiards.table import Table
from tangency.experiments.billiards.train import Curve, Training, evaluate, train

__all__ = ["FULL", "MEDIUM", "QUICK", "Run", "Setting", "runs"]


@dataclass(frozen=True)
class Setting:
    """How large the comparison is."""

    discs: tuple[int, ...]
    trials: tuple[int, int, int]
    """For training, validation and test."""
    shares: tuple[float, ...]
    """Of the training samples that have labels."""
    epochs: int
    size: int
    """Of the pictures, pixels."""
    width: float
    """Of the networks, as a share of VGG-11's."""

    @property
    def runs(self) -> int:
        """How many trainings there are."""
        return len(self.discs) * sum(2 if share == 1.0 else 4 for share in self.shares)


QUICK = Setting(discs=(1,), trials=(512, 128, 128), shares=(1.0,), epochs=20, size=32, width=0.0625)
MEDIUM = Setting((1, 3), (2000, 300, 300), (1.0, 0.25, 0.1, 0.02), epochs=20, size=32, width=0.125)
FULL = Setting((1, 3), (8000, 1000, 1000), (1.0, 0.25, 0.1, 0.02), epochs=60, size=64, width=0.25)


@dataclass(frozen=True)
class Run:
    """One training and what came of it."""

    discs: int
    step: str
    """`physics` or `network`."""
    labelled: int
    """Samples with labels."""
    unlabelled: int
    """Samples that have frames only."""
    curve: Curve
    test: float
    """Mean squared error of places ten frames later, sides², on the test samples."""
    test_pixels: float
    model: Model


def runs(setting: Setting, tell: Callable[[str], None]) -> Iterator[Run]:
    """All trainings, those of most labels first."""
    for discs in setting.discs:
        table = Table(discs=discs)
        sets = [samples(table, count, setting.size, seed) for seed, count in enumerate(setting.trials)]
        for share in setting.shares:
            labelled = round(share * setting.trials[0])
            with_others = [True, False] if labelled < setting.trials[0] else [True]
            for step in ("physics", "network"):
                for others in with_others:
                    yield _run(setting, table, sets, step, labelled, others, tell)


def _run(
    setting: Setting,
    table: Table,
    sets: list[Samples],
    step: str,
    labelled: int,
    others: bool,
    tell: Callable[[str], None],
) -> Run:
    training, validation, test = sets
    mask = torch.arange(len(training)) < labelled
    part = training if others else training.part(mask)
    torch.manual_seed(0)
    middle: nn.Module = PhysicsStep(table) if step == "physics" else NetworkStep(table)
    model = Model(table, middle, setting.size, setting.width)
    name = f"{table.discs} discs, {step}, {labelled} labels{'' if others else ' alone'}"
    # As many steps of descent, however few samples there are.
    epochs = round(setting.epochs * len(training) / len(part))
    settings = Training(epochs=epochs, batch=min(64, len(part)))
    curve = train(model, part, mask[: len(part)], validation, settings, lambda what: tell(f"{name}: {what}"))
    places, pixels = evaluate(model, test)
    return Run(table.discs, step, labelled, len(part) - labelled, curve, places, pixels, model)

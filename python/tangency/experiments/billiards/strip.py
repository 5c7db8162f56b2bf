"""A strip of predicted frames, as the paper's figure 3."""

from __future__ import annotations

import numpy as np
import torch
from matplotlib.figure import Figure

from tangency.experiments.billiards.data import samples
from tangency.experiments.billiards.study import Run, Setting
from tangency.experiments.billiards.table import Table

__all__ = ["strip"]

SHOWN = 4
"""Samples."""


def strip(setting: Setting, found: list[Run]) -> Figure:
    """Last frame seen, the frame ten later, and what the models that learned from most labels paint."""
    discs = max(run.discs for run in found)
    models = {run.step: run.model for run in found if run.discs == discs and run.unlabelled == 0 and not _less(run, found)}
    data = samples(Table(discs=discs), SHOWN, setting.size, seed=3)
    columns = {"ten frames later": data.frames.numpy()}
    for step, model in models.items():
        with torch.no_grad():
            columns[step] = np.rint(255.0 * model.eval()(data.inputs)[2].numpy()).astype(np.uint8)
    seen = data.inputs[:, :, 6:9].amax(dim=1).numpy()
    columns = {"last frame seen": seen, **columns}
    page = Figure(figsize=(1.6 * len(columns), 1.6 * SHOWN), layout="constrained")
    grid = page.subplots(SHOWN, len(columns), squeeze=False)
    for column, (name, pictures) in enumerate(columns.items()):
        grid[0][column].set_title(name, fontsize="small")
        for row, picture in enumerate(pictures):
            grid[row][column].imshow(np.moveaxis(picture, 0, -1), interpolation="nearest")
            grid[row][column].set_axis_off()
    return page


def _less(run: Run, found: list[Run]) -> bool:
    """Whether others of its kind learned from more labels."""
    return any(it.labelled > run.labelled for it in found if (it.discs, it.step) == (run.discs, run.step))

"""``python -m tangency.experiments.identification``: what numbers a motion tells, and how surely.

Friction and restitution of a block that slides, bounces off a wall and slides back; all points of a polygon from how it
tumbles over a floor. Both from poses with noise, by least squares through the engine, with error bars that are checked by
repeating everything.
"""

from __future__ import annotations

import argparse
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.figure import Figure
from tqdm import tqdm

from tangency.experiments.identification.fit import Array, Estimate, estimate, observe
from tangency.experiments.identification.scenes import BLOCK, POLYGON, Case
from tangency.experiments.report import Report, markdown_table


def main(given: Sequence[str] | None = None) -> None:
    """Runs the experiment and writes its page."""
    parser = argparse.ArgumentParser(prog="python -m tangency.experiments.identification", description=__doc__)
    parser.add_argument("--quick", action="store_true", help="20 repetitions instead of 1000")
    parser.add_argument("--out", type=Path, default=Path("out/identification"), help="folder of the page")
    arguments = parser.parse_args(given)
    repetitions = 20 if arguments.quick else 1000
    command = "python -m tangency.experiments.identification" + (" --quick" if arguments.quick else "")
    report = Report(arguments.out, "System identification", command)
    found = {case.name: _repeat(case, repetitions) for case in (BLOCK, POLYGON)}
    rows = [row for case in (BLOCK, POLYGON) for row in _rows(case, found[case.name])]
    report.table("numbers", rows)
    report.figure("figure", figure(found))
    print(report.page(paragraphs(rows, found, repetitions)))


def _repeat(case: Case, repetitions: int) -> list[Estimate]:
    """Estimates from so many observations of the same motion."""
    seeds = tqdm(range(repetitions), unit="fit", desc=case.name)
    return [estimate(case, observe(case, np.random.default_rng(seed))) for seed in seeds]


def _errors(case: Case, found: list[Estimate]) -> Array:
    """Errors in units of the error bars: (repetitions, unknown)."""
    return np.array([(it.values - case.truth) / it.deviations for it in found])


def _rows(case: Case, found: list[Estimate]) -> list[dict[str, Any]]:
    errors = _errors(case, found)
    values = np.array([it.values for it in found])
    bars = np.array([it.deviations for it in found])
    return [
        {
            "number": name,
            "true": f"{true:.5f}",
            "first guess": f"{guess:.5f}",
            "mean estimate": f"{values[:, k].mean():.5f}",
            "error bar": f"{bars[:, k].mean():.5f}",
            "spread of estimates": f"{values[:, k].std():.5f}",
            "within 1 bar": f"{(np.abs(errors[:, k]) < 1).mean():.1%}",
            "within 2 bars": f"{(np.abs(errors[:, k]) < 2).mean():.1%}",
        }
        for k, (name, true, guess) in enumerate(zip(case.unknown, case.truth, case.guess, strict=True))
    ]


def figure(found: dict[str, list[Estimate]]) -> Figure:
    """The true polygon, the first guess and the estimates; and all errors in units of their bars."""
    page = Figure(figsize=(9.0, 3.6), layout="constrained")
    left, right = page.subplots(1, 2)
    outlines = [(POLYGON.guess, "C1", "first guess"), (POLYGON.truth, "black", "true")]
    for it in found["polygon"][:20]:
        _outline(left, it.values, "C0", None, 0.3)
    for points, colour, name in outlines:
        _outline(left, np.array(points), colour, name, 1.0)
    left.plot([], [], color="C0", label="20 estimates")
    left.set(aspect="equal", xlabel="x, m", ylabel="y, m")
    left.legend(fontsize="small")
    for case in (BLOCK, POLYGON):
        errors = _errors(case, found[case.name]).ravel()
        right.hist(errors, bins=np.linspace(-4, 4, 41), density=True, histtype="step", label=case.name)
    at = np.linspace(-4, 4, 200)
    right.plot(at, np.exp(-0.5 * at**2) / np.sqrt(2 * np.pi), "k:", label="normal distribution")
    right.set(xlabel="error in units of its bar", ylabel="density")
    right.legend(fontsize="small")
    return page


def _outline(axes: Any, values: Array, colour: str, name: str | None, alpha: float) -> None:
    points = values.reshape(-1, 2)
    closed = np.vstack([points, points[:1]])
    axes.plot(closed[:, 0], closed[:, 1], color=colour, label=name, alpha=alpha)


def paragraphs(rows: list[dict[str, Any]], found: dict[str, list[Estimate]], repetitions: int) -> list[str]:
    """The page's text."""
    chi = {name: np.mean([it.chi_squared for it in estimates]) for name, estimates in found.items()}
    return [
        "A block slides over a floor at 3 m/s, bounces off a wall and slides back until friction stops it; seen every "
        "10 ms with noise of 2 mm and 5 mrad. What are friction and restitution? And a quadrilateral is thrown on a floor, "
        "tumbles over all its points and comes to rest; seen with noise of 1 mm and 3 mrad. Where are its points (its mass, "
        "inertia and centre known)?",
        "Both by Levenberg and Marquardt's least squares through the forward derivatives of accurate steps, in which impacts "
        "and the end of sliding are located. Error bars are those of the linearised problem, the roots of the diagonal of "
        "(JᵀJ)⁻¹; whether they are right is seen by doing everything again with other noise.",
        "![Estimated polygons, and the distribution of errors](figure.svg)",
        markdown_table(rows),
        f"Over {repetitions} repetitions; error bars that are right hold 68.3 % of the errors once and 95.4 % twice. Squared "
        f"residuals per degree of freedom: {chi['block']:.3f} (block), {chi['polygon']:.3f} (polygon); 1 where model and "
        "noise explain everything that is seen. The paper identifies masses alone (section 4.1, our chain-mass experiment).",
    ]


if __name__ == "__main__":
    main()

"""``python -m tangency.experiments.billiards``: the paper's section 4.2, billiards from video.

Three frames go in; a network per ball finds where it is and how fast; physics takes the balls ten frames ahead; a network
paints that frame. With labels for some of the samples and nothing but frames for the others, is it worth to have the
physics inside?
"""

from __future__ import annotations

import argparse
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

from matplotlib.figure import Figure
from tqdm import tqdm

from tangency.experiments.billiards.study import FULL, MEDIUM, QUICK, Run, Setting, runs
from tangency.experiments.billiards.strip import strip
from tangency.experiments.report import Report, markdown_table

SETTINGS = {"quick": QUICK, "medium": MEDIUM, "full": FULL}


def main(given: Sequence[str] | None = None) -> None:
    """Runs the experiment and writes its page."""
    parser = argparse.ArgumentParser(prog="python -m tangency.experiments.billiards", description=__doc__)
    parser.add_argument("--setting", choices=SETTINGS, default="full", help="how large (default: full)")
    parser.add_argument("--quick", action="store_const", const="quick", dest="setting", help="the same as --setting quick")
    parser.add_argument("--discs", type=int, choices=(1, 2, 3), help="this many balls only")
    parser.add_argument("--out", type=Path, default=Path("out/billiards"), help="folder of the page")
    arguments = parser.parse_args(given)
    setting: Setting = SETTINGS[arguments.setting]
    command = f"python -m tangency.experiments.billiards --setting {arguments.setting}"
    if arguments.discs is not None:
        setting, command = replace(setting, discs=(arguments.discs,)), f"{command} --discs {arguments.discs}"
    report = Report(arguments.out, "Billiards from video", command)
    progress = tqdm(total=setting.runs, unit="training")
    found: list[Run] = []
    for run in runs(setting, progress.set_postfix_str):
        found.append(run)
        progress.update()
        report.table("runs", [_row(it) for it in found])
        report.table("curves", [row for it in found for row in _curve(it)])
    progress.close()
    report.figure("labels", labels(found))
    report.figure("frames", strip(setting, found))
    print(report.page(paragraphs(setting, found)))


def _row(run: Run) -> dict[str, Any]:
    return {
        "discs": run.discs,
        "step": run.step,
        "labelled": run.labelled,
        "unlabelled": run.unlabelled,
        "validation": f"{run.curve.validation[-1]:.6e}",
        "test": f"{run.test:.6e}",
        "test_pixels": f"{run.test_pixels:.6e}",
        "skipped_batches": run.curve.skipped,
        "seconds": f"{run.curve.seconds:.1f}",
    }


def _curve(run: Run) -> list[dict[str, Any]]:
    rows = enumerate(zip(run.curve.validation, run.curve.pixels, strict=True))
    head = {"discs": run.discs, "step": run.step, "labelled": run.labelled, "unlabelled": run.unlabelled}
    return [{**head, "evaluation": k, "places": f"{x:.6e}", "pixels": f"{p:.6e}"} for k, (x, p) in rows]


def labels(found: list[Run]) -> Figure:
    """Validation loss against the number of labelled samples, as the paper's figure 4."""
    counts = sorted({run.discs for run in found})
    page = Figure(figsize=(4.5 * len(counts), 3.4), layout="constrained")
    for axes, discs in zip(page.subplots(1, len(counts), squeeze=False)[0], counts, strict=True):
        for step, colour in (("physics", "C0"), ("network", "C1")):
            for others, style in ((True, "o-"), (False, "s--")):
                chosen = [
                    run
                    for run in found
                    if (run.discs, run.step) == (discs, step) and (others or run.unlabelled == 0)
                    and (not others or run.unlabelled > 0 or run.labelled == max(it.labelled for it in found))
                ]  # fmt: skip
                xs = [run.labelled for run in chosen]
                ys = [run.curve.validation[-1] for run in chosen]
                what = "labels and frames" if others else "labels alone"
                axes.plot(xs, ys, style, color=colour, label=f"{step}, {what}")
        axes.set(xscale="log", yscale="log", xlabel="labelled samples", title=f"{discs} ball{'s' if discs > 1 else ''}")
        axes.set_ylabel("squared error of places after 10 frames")
    page.axes[0].legend(fontsize="small")
    return page


def _best(found: list[Run], discs: int, step: str, labelled: int, others: bool) -> Run | None:
    for run in found:
        if (run.discs, run.step, run.labelled) == (discs, step, labelled) and (run.unlabelled > 0) == others:
            return run
    return None


def verdicts(found: list[Run]) -> list[str]:
    """What the paper expects, and whether it came out."""
    lines = []
    for run in found:
        if run.step != "physics":
            continue
        others = run.unlabelled > 0
        network = _best(found, run.discs, "network", run.labelled, others)
        if network is not None:
            better = "beats" if run.test < network.test else "does not beat"
            kind = "labels and frames" if others else "labels alone"
            lines.append(
                f"- {run.discs} discs, {run.labelled} labels, {kind}: physics {better} the network "
                f"({run.test:.1e} against {network.test:.1e})."
            )
        alone = _best(found, run.discs, "physics", run.labelled, False) if others else None
        if alone is not None:
            better = "better" if run.test < alone.test else "not better"
            lines.append(
                f"- {run.discs} discs, {run.labelled} labels, physics: with frames {better} than without "
                f"({run.test:.1e} against {alone.test:.1e})."
            )
    return lines


def paragraphs(setting: Setting, found: list[Run]) -> list[str]:
    """The page's text."""
    count, validation, test = setting.trials
    return [
        "Three frames of balls on a table go in. A network for each ball, of the shape of VGG-11, sees what is masked out "
        "of them by its colour, and the optical flow between them, and says where the ball is and how fast; the engine "
        "takes all balls ten frames ahead; a mirrored network paints that frame. Losses are those of de Avila "
        "Belbute-Peres et al. 2018, equations 4 to 6: state, state ten frames later and pixels for samples with labels, "
        "pixels alone for the others. In the baseline two layers of 100 stand in the place of the physics.",
        f"The data comes from an event-driven table of its own, which shares nothing with the engine: {count} trials for "
        f"training, {validation} for validation and {test} for test, {setting.size} × {setting.size} pixels; networks have "
        f"{setting.width:g} of VGG-11's channels. The paper used a pretrained network for the flow, whose weights cannot be "
        "had; OpenCV's dense inverse search stands in for it.",
        "![Validation loss against the number of labelled samples](labels.svg)",
        "![Frames seen, the frame ten later, and what physics and network predict](frames.svg)",
        markdown_table([_row(run) for run in found]),
        "What the paper expects: physics beats the network in every regime, and at an equal number of labels, frames "
        "without labels help.",
        "\n".join(verdicts(found)),
    ]


if __name__ == "__main__":
    main()

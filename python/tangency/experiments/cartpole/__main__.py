"""``python -m tangency.experiments.cartpole``: the paper's section 4.3, its Cartpole.

A model that is the engine with unknown masses and length learns from a few random trajectories of Gymnasium's CartPole,
and iterative LQR through it keeps the pole up; a network learns the same and is planned through alike.
"""

from __future__ import annotations

import argparse
from collections.abc import Sequence
from dataclasses import asdict
from pathlib import Path
from statistics import mean
from typing import Any

from matplotlib.figure import Figure
from tqdm import tqdm

from tangency.experiments.cartpole.study import FULL, QUICK, Point, points
from tangency.experiments.report import Report, markdown_table

TRUE = (1.0, 0.1, 0.5)


def main(given: Sequence[str] | None = None) -> None:
    """Runs the experiment and writes its page."""
    parser = argparse.ArgumentParser(prog="python -m tangency.experiments.cartpole", description=__doc__)
    parser.add_argument("--quick", action="store_true", help="a few minutes less: fewer trajectories and episodes")
    parser.add_argument("--out", type=Path, default=Path("out/cartpole"), help="folder of the page")
    arguments = parser.parse_args(given)
    command = "python -m tangency.experiments.cartpole" + (" --quick" if arguments.quick else "")
    report = Report(arguments.out, "Cartpole", command)
    setting = QUICK if arguments.quick else FULL
    progress = tqdm(total=len(setting.counts) * setting.seeds, unit="setting")

    def tell(what: str) -> None:
        progress.set_postfix_str(what)
        progress.update()

    found = list(points(setting, tell))
    progress.close()
    report.table("points", [_row(point) for point in found])
    report.figure("figure", figure(found))
    print(report.page(paragraphs(found)))


def _row(point: Point) -> dict[str, Any]:
    row = asdict(point)
    row["rewards"] = " ".join(map(str, point.rewards))
    row["numbers"] = " ".join(f"{number:.5f}" for number in point.numbers)
    return row


def _mean_reward(found: list[Point]) -> float:
    return mean(reward for point in found for reward in point.rewards)


def _groups(found: list[Point], model: str) -> dict[int, list[Point]]:
    groups: dict[int, list[Point]] = {}
    for point in found:
        if point.model == model:
            groups.setdefault(point.trajectories, []).append(point)
    return groups


def figure(found: list[Point]) -> Figure:
    """One-step error and reward against the number of trajectories, as the paper's figure 5."""
    page = Figure(figsize=(9.0, 3.4), layout="constrained")
    left, right = page.subplots(1, 2)
    for model, colour in (("physics", "C0"), ("network", "C1")):
        groups = _groups(found, model)
        counts = list(groups)
        left.plot(counts, [mean(it.error for it in group) for group in groups.values()], "o-", color=colour, label=model)
        right.plot(counts, [_mean_reward(group) for group in groups.values()], "o-", color=colour, label=model)
    left.set(xscale="log", yscale="log", xlabel="trajectories of random actions", ylabel="one-step error of the rates (spreads)")
    right.set(xscale="log", xlabel="trajectories of random actions", ylabel="reward (of 1000)", ylim=(0, 1050))
    left.legend()
    return page


def paragraphs(found: list[Point]) -> list[str]:
    """The page's text."""
    rows = []
    physics, network = _groups(found, "physics"), _groups(found, "network")
    for count, group in physics.items():
        other = network[count]
        numbers = [mean(point.numbers[k] for point in group) for k in range(3)]
        rows.append(
            {
                "trajectories": count,
                "physics: error": f"{mean(point.error for point in group):.1e}",
                "reward": f"{_mean_reward(group):.0f}",
                "cart, pole, half-length": ", ".join(f"{number:.4f}" for number in numbers),
                "network: error": f"{mean(point.error for point in other):.1e}",
                "reward ": f"{_mean_reward(other):.0f}",
            }
        )
    return [
        "Gymnasium's CartPole with a force of any size up to 10 N and episodes of at most 1000 steps, as in the paper's "
        "section 4.3. The model is the engine with three unknowns, the masses of cart and pole and the pole's length; they "
        "are learned from trajectories of random actions by gradient descent through the engine (L-BFGS on one-step "
        "errors of the rates, from 0.5 kg, 0.5 kg and 1 m). Iterative LQR over 5 frames with the squared pole angle as cost then acts. "
        "The baseline is a network of two layers of 100 that learns the same steps and is planned through alike.",
        "![One-step error and reward against the number of trajectories](figure.svg)",
        markdown_table(rows),
        f"Errors are those of the rates, in units of the spread of a step, on trajectories that were not learned from; "
        f"rewards are means over {len(found[0].rewards)} episodes and {len({point.seed for point in found})} repetitions. "
        f"The true numbers are {TRUE[0]}, {TRUE[1]} and {TRUE[2]}. Rates alone are learned from and compared because "
        "Gymnasium moves places by the rates before a step (explicit Euler) and the engine by those after it: the two "
        "differ by dt² times the acceleration whatever the numbers.",
    ]


if __name__ == "__main__":
    main()

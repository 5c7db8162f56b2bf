"""``python -m tangency.experiments.breakout``: the paper's section 4.3, its Breakout.

A model that is the engine with unknown speeds, drag and delay of the paddle learns from frames of random play, and
iterative LQR through it plays Atari's game from the frames alone.
"""

from __future__ import annotations

import argparse
from pathlib import Path
from statistics import mean
from typing import Any

from matplotlib.figure import Figure
from tqdm import tqdm

from tangency.experiments.breakout.game import HIGHEST
from tangency.experiments.breakout.study import FULL, QUICK, Point, Setting, points
from tangency.experiments.report import Report, markdown_table

HUMAN = 31
"""The level that the paper gives for people."""


def main() -> None:
    """Runs the experiment and writes its page."""
    parser = argparse.ArgumentParser(prog="python -m tangency.experiments.breakout", description=__doc__)
    parser.add_argument("--quick", action="store_true", help="fewer, shorter games and less experience")
    parser.add_argument("--out", type=Path, default=Path("out/breakout"), help="folder of the page")
    arguments = parser.parse_args()
    command = "python -m tangency.experiments.breakout" + (" --quick" if arguments.quick else "")
    report = Report(arguments.out, "Breakout", command)
    setting = QUICK if arguments.quick else FULL
    progress = tqdm(total=(len(setting.counts) + 3) * setting.games, unit="game")

    def tell(what: str) -> None:
        progress.set_postfix_str(what)
        progress.update()

    found = list(points(setting, tell))
    progress.close()
    report.table("points", [_row(point) for point in found])
    report.figure("figure", figure(found))
    print(report.page(paragraphs(found, setting)))


def _row(point: Point) -> dict[str, Any]:
    it = point.numbers
    return {
        "player": point.player,
        "experience": point.experience,
        "error": "" if point.error is None else f"{point.error:.5f}",
        "left": "" if it is None else f"{it.left:.5f}",
        "right": "" if it is None else f"{it.right:.5f}",
        "drag": "" if it is None else f"{it.drag:.5f}",
        "delay": "" if it is None else it.delay,
        "scores": " ".join(map(str, point.scores)),
        "frames": " ".join(map(str, point.frames)),
        "lives": " ".join(map(str, point.lives)),
    }


def figure(found: list[Point]) -> Figure:
    """Scores against frames of experience, as the paper's figure 6."""
    page = Figure(figsize=(6.4, 4.0), layout="constrained")
    axes = page.subplots()
    taught = [point for point in found if point.player == "planner"]
    for point in taught:
        axes.plot([point.experience] * len(point.scores), point.scores, ".", color="C0", alpha=0.3)
    counts = [point.experience for point in taught]
    axes.plot(counts, [mean(point.scores) for point in taught], "o-", color="C0", label="planner, mean of the games")
    for name, colour in (("follower", "C1"), ("untaught", "C4"), ("random", "C2")):
        level = next(mean(point.scores) for point in found if point.player == name)
        axes.axhline(level, color=colour, linestyle="--", label=f"{name} ({level:.0f})")
    axes.axhline(HUMAN, color="0.4", linestyle=":", label=f"human, after the paper ({HUMAN})")
    axes.set(xscale="log", yscale="symlog", ylim=(0, 1200), xlabel="frames of random play", ylabel="score")
    ticks = [0, 1, 3, 10, 30, 100, 300, HIGHEST]
    axes.set_yticks(ticks, [str(tick) for tick in ticks])
    axes.legend(fontsize="small", loc="center right")
    return page


def paragraphs(found: list[Point], setting: Setting) -> list[str]:
    """The page's text."""
    rows = [
        {
            "player": point.player,
            "frames of experience": point.experience or "",
            "mean score": f"{mean(point.scores):.0f}",
            "least … greatest": f"{min(point.scores)} … {max(point.scores)}",
            "frames played": f"{mean(point.frames):.0f}",
            "ended by the frame limit": sum(frames >= setting.most_frames for frames in point.frames),
            "speed left, right": "" if point.numbers is None else f"{point.numbers.left:.2f}, {point.numbers.right:.2f}",
            "drag": "" if point.numbers is None else f"{point.numbers.drag:.2f}",
            "delay": "" if point.numbers is None else point.numbers.delay,
            "error (px)": "" if point.error is None else f"{point.error:.2f}",
        }
        for point in found
    ]
    return [
        "Atari's Breakout in the Arcade Learning Environment, as in the paper's section 4.3 and figure 6. Players see "
        "the frames alone: filters of colour find paddle, ball and bricks; the ball's velocity is that of its last two "
        "places. The model is a scene of ball, walls and paddle in pixels and frames, elastic and without friction. "
        "How the paddle moves is learned from random play by gradient descent (Adam) through the engine: its speeds "
        "to the left and right (pixels per frame), its drag, and of 0, 1 and 2 frames the delay that explains the play "
        "best. Then iterative LQR over 5 frames chooses each action, with the paper's cost: the squared distance of "
        "paddle and ball while the ball falls, and of paddle and middle otherwise. The sign of the first planned push is "
        "the action, or none if the push is less than half a full one.",
        "![Score against frames of experience](figure.svg)",
        markdown_table(rows),
        f"Each player plays the same {setting.games} games of at most {setting.most_frames} frames "
        f"({setting.most_frames / 3600:.1f} minutes of the game), no frame skipped and no action repeated; games begin "
        f"after 0 to 30 idle frames. {HIGHEST} is the most that there is: two walls of bricks. A dot of the figure is "
        "a game. The experience is one stretch of random play, of which the smaller amounts are the beginnings. "
        "`random` draws an action every four frames; `follower` moves towards the ball's column, without a model; "
        "`untaught` is the planner with the numbers that learning starts from.",
        "What differs from the paper. The paddle of this game has inertia and acts a frame late, so that its speed alone "
        "is too little: drag and delay are learned too. The planner aims at a place of the paddle that is drawn for every "
        "fall of the ball, up to 35 % of its width from the middle: whoever always meets the ball with the middle "
        "may end in a flight that repeats and hits no brick, as the follower does. The paper's human level is a line; the deep "
        "networks that it compares with were not trained here. How the ball leaves the paddle, faster after some "
        "hits and steeper near the ends, is not in the model; no plan looks that far.",
    ]


if __name__ == "__main__":
    main()

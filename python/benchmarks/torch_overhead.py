"""What PyTorch adds to a rollout and its gradient.

The chain hit by a ball, 300 steps; the loss is the sum of squares of all poses, differentiated by the mass of the
links and the initial state. Prints the best and the median time of each way, in milliseconds.
"""

from __future__ import annotations

import argparse
import time
from collections.abc import Callable
from pathlib import Path

import numpy as np
import torch

import tangency
import tangency.torch

SCENE = tangency.Scene.load(Path(__file__).parents[2] / "scenes" / "chain_and_ball.toml")
STATE = SCENE.initial_state
STEPS = SCENE.steps
MASS = "mass:links"


def with_numpy() -> None:
    """The engine alone, from Python."""
    run = tangency.rollout(SCENE.with_values({MASS: 0.7}), STEPS, state=(STATE.q, STATE.v))
    gradient = run.gradient(q=2 * run.q, wrt=[MASS])
    _ = gradient.q0, gradient.v0, gradient.values


def loss(mass: torch.Tensor, q0: torch.Tensor, v0: torch.Tensor) -> torch.Tensor:
    q, _ = tangency.torch.rollout(SCENE, STEPS, q0=q0, v0=v0, values={MASS: mass})
    return q.square().sum()


def with_torch(of: Callable[..., torch.Tensor], batch: int | None = None) -> Callable[[], None]:
    shape = () if batch is None else (batch,)
    mass = torch.full(shape, 0.7, dtype=torch.float64, requires_grad=True)
    q0, v0 = (torch.tensor(x).expand(*shape, -1, -1).clone().requires_grad_() for x in STATE[:2])

    def run() -> None:
        of(mass, q0, v0).backward()  # type: ignore[no-untyped-call]

    return run


def by_steps(mass: torch.Tensor, q0: torch.Tensor, v0: torch.Tensor) -> torch.Tensor:
    total, q, v = q0.square().sum(), q0, v0
    for _ in range(STEPS):
        q, v = tangency.torch.step(SCENE, q, v, values={MASS: mass})
        total = total + q.square().sum()
    return total


def times(run: Callable[[], None], repeats: int) -> tuple[float, float]:
    run()
    spent = []
    for _ in range(repeats):
        start = time.perf_counter()
        run()
        spent.append(1e3 * (time.perf_counter() - start))
    return min(spent), float(np.median(spent))


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--repeats", type=int, default=50)
    parser.add_argument("--batch", type=int, default=64)
    parser.add_argument("--compile", action="store_true", help="with torch.compile, too (takes a while)")
    options = parser.parse_args()
    ways = {"NumPy API": with_numpy, "tangency.torch.rollout": with_torch(loss)}
    if options.compile:
        ways["the same, torch.compile"] = with_torch(torch.compile(loss, fullgraph=True, backend="aot_eager"))
    ways["tangency.torch.step, 300 times"] = with_torch(by_steps)
    ways[f"tangency.torch.rollout, batch of {options.batch}"] = with_torch(loss, options.batch)
    print(f"{'forward and backward':42}{'best, ms':>10}{'median':>10}")
    for name, run in ways.items():
        best, median = times(run, max(options.repeats // (10 if "batch" in name or "step" in name else 1), 3))
        print(f"{name:42}{best:10.3f}{median:10.3f}")


if __name__ == "__main__":
    main()

"""What do the links of a chain weigh? Learned from watching the chain being hit by a ball, with PyTorch.

Prints loss and mass as they go, and saves a plot if matplotlib is there.
"""

import argparse
from pathlib import Path

import torch

import tangency
import tangency.torch

SCENES = Path(__file__).parents[2] / "scenes"


def learn(updates: int, guess: float = 1.4, steps: int = 60) -> tuple[list[float], list[float]]:
    """Losses and masses of all updates; the true mass is the scene's own."""
    scene = tangency.Scene.load(SCENES / "chain_and_ball.toml")
    observed, _ = tangency.torch.rollout(scene, steps)

    chain = tangency.torch.Rollout(scene.with_values({"mass:links": guess}), steps, learn=["mass:links"])
    optimizer = torch.optim.Adam(chain.parameters(), lr=0.05)
    losses, masses = [], []
    for _ in range(updates):
        optimizer.zero_grad()
        q, _ = chain()
        loss = (q - observed)[..., :2].square().mean()
        loss.backward()
        losses.append(loss.item())
        masses.append(chain.values()["mass:links"].item())
        optimizer.step()
    return losses, masses


def plot(masses: list[float], file: Path) -> None:
    from matplotlib import pyplot

    figure, axes = pyplot.subplots()
    axes.plot(masses)
    axes.axhline(0.7, color="black", linestyle=":")  # the true one
    axes.set(xlabel="update", ylabel="mass of a link")
    file.parent.mkdir(exist_ok=True)
    figure.savefig(file)
    print(f"plot: {file}")


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--updates", type=int, default=100)
    parser.add_argument("--plot", type=Path, default=Path("out/chain_mass.png"))
    options = parser.parse_args()
    losses, masses = learn(options.updates)
    print("update        loss      mass")
    for k in [*range(0, options.updates - 1, 10), options.updates - 1]:
        print(f"{k:6} {losses[k]:11.3e} {masses[k]:9.5f}")
    try:
        plot(masses, options.plot)
    except ImportError:
        print("no plot: install matplotlib")

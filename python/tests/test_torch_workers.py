"""Rollouts in the workers of data loaders, forked and spawned."""

import os

import numpy as np
import pytest

import tangency

torch = pytest.importorskip("torch")

import tangency.torch  # noqa: E402

BALL = tangency.BodyDef("ball", position=(0, 0.5), restitution=0.5, shapes=[tangency.Circle(0.1)])
FLOOR = tangency.BodyDef("floor", "static", shapes=[tangency.HalfPlane((0, 1))], restitution=0.5)
SCENE = tangency.Scene(tangency.SceneDef([BALL, FLOOR], dt=0.01))
STEPS = 50


def heights(batch):
    """Where the ball is at the end for gravity 5 and 6 and so on, and the derivative.

    In forward mode: backward passes PyTorch itself refuses in a process whose parent made some before it forked.
    """
    gravity = -torch.arange(5.0, 5.0 + batch, dtype=torch.float64)

    def height(gravity):
        q, _ = tangency.torch.rollout(SCENE, STEPS, values={"gravity.y": gravity})
        return q[..., -1, 0, 1]

    given = gravity if batch > 1 else gravity[0]
    return torch.stack(torch.func.jvp(height, (given,), (torch.ones_like(given),))).reshape(2, batch)


class Drops(torch.utils.data.Dataset):
    """Single runs and batches, made where they are asked for."""

    def __init__(self):
        self.scene = SCENE

    def __len__(self):
        return 6

    def __getitem__(self, k):
        alone, batch = heights(1), heights(4)
        assert self.scene == SCENE and torch.equal(alone[:, 0], batch[:, 0])
        return batch, os.getpid()


@pytest.mark.filterwarnings("ignore:.*fork.*:DeprecationWarning")
# PyTorch's own, at the first use of forward mode.
@pytest.mark.filterwarnings("ignore:.*torch.jit.*:FutureWarning", "ignore:.*torch.jit.*:DeprecationWarning")
@pytest.mark.parametrize("method", ["fork", "spawn"])
def test_data_loader(method):
    if method not in torch.multiprocessing.get_all_start_methods():
        pytest.skip(f"this system does not {method}")
    expected = heights(4)  # The parent's threads are there, too, before it forks.
    loader = torch.utils.data.DataLoader(Drops(), batch_size=1, num_workers=2, multiprocessing_context=method)
    processes = set()
    for batch, process in loader:
        assert np.array_equal(batch[0], expected)
        processes |= set(process.tolist())
    assert len(processes) == 2 and os.getpid() not in processes

"""The experiment's own billiard table, against closed forms and what stays constant."""

import numpy as np
import pytest

from tangency.experiments.billiards.frames import frame, masks
from tangency.experiments.billiards.table import Table


def test_a_head_on_meeting_exchanges_velocities():
    table = Table(discs=2, radius=0.1, interval=0.1)
    trial = table.run(np.array([[0.2, 0.5], [0.7, 0.5]]), np.array([[1.0, 0.0], [0.0, 0.0]]), 5)
    np.testing.assert_allclose(trial.x[:, 0, 0], [0.2, 0.3, 0.4, 0.5, 0.5], atol=1e-15)
    np.testing.assert_allclose(trial.v[-1], [[0.0, 0.0], [1.0, 0.0]], atol=1e-15)


def test_a_disc_alone_moves_as_its_unfolded_path():
    """Reflections at walls unfold to a straight line in a chain of mirrored boxes."""
    table = Table(discs=1, radius=0.1, interval=0.37)
    x0, v = np.array([0.31, 0.62]), np.array([1.13, -0.71])
    trial = table.run(x0[None], v[None], 20)
    room = 1.0 - 2.0 * table.radius
    free = (x0 - table.radius + np.outer(0.37 * np.arange(20), v)) % (2.0 * room)
    expected = table.radius + np.where(free > room, 2.0 * room - free, free)
    np.testing.assert_allclose(trial.x[:, 0], expected, atol=1e-12)


def test_an_oblique_meeting_keeps_momentum_and_turns_along_the_centres():
    table = Table(discs=2, radius=0.1, interval=0.3)
    x = np.array([[0.3, 0.5], [0.6, 0.6]])
    v = np.array([[1.0, 0.0], [0.0, 0.0]])
    trial = table.run(x, v, 2)
    # They touch with their centres 0.2 apart, 0.1 of it across the motion: n = (√3, 1)/2.
    np.testing.assert_allclose(trial.v[1], [[0.25, -np.sqrt(3) / 4], [0.75, np.sqrt(3) / 4]], atol=1e-14)


@pytest.mark.parametrize("discs", [1, 3])
def test_energy_is_kept_and_nothing_overlaps(discs):
    table, rng = Table(discs=discs), np.random.default_rng(discs)
    for _ in range(30):
        trial = table.run(*table.start(rng), 40)
        energy = (trial.v**2).sum(axis=(1, 2))
        np.testing.assert_allclose(energy, energy[0], rtol=1e-12)
        apart = np.linalg.norm(trial.x[:, :, None] - trial.x[:, None], axis=-1) + np.eye(discs)
        assert apart.min() > 2 * table.radius - 1e-12
        assert trial.x.min() > table.radius - 1e-12 and trial.x.max() < 1 - table.radius + 1e-12


def test_backwards_in_time_it_returns():
    table, rng = Table(), np.random.default_rng(5)
    x, v = table.start(rng)
    there = table.run(x, v, 30)
    back = table.run(there.x[-1], -there.v[-1], 30)
    np.testing.assert_allclose(back.x[-1], x, atol=1e-9)


def test_pictures_show_each_disc_in_its_place():
    x = np.array([[0.25, 0.7], [0.6, 0.3], [0.8, 0.8]])
    shares = masks(frame(x, 0.1, 64), 3)
    at = (np.arange(64) + 0.5) / 64
    for center, share in zip(x, shares):
        assert share.sum() / 64**2 == pytest.approx(np.pi * 0.1**2, rel=0.01)
        found = (share.sum(axis=0) @ at, share.sum(axis=1) @ at[::-1]) / share.sum()
        np.testing.assert_allclose(found, center, atol=1e-3)

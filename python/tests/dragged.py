"""A scene for the tests of layers, and inputs near its own."""

import numpy as np
import torch

import tangency


def dragged() -> tangency.Scene:
    """A box that slides on a floor and drags a rod behind it: contact, friction and a joint; one control."""
    floor = tangency.BodyDef("floor", "static", shapes=[tangency.HalfPlane((0, 1))], friction=0.4)
    box = tangency.BodyDef("box", position=(0, 0.1), velocity=(1.5, 0), shapes=[tangency.Rectangle(0.4, 0.2)])
    bar = tangency.Capsule((-0.3, 0), (0.3, 0), 0.03)
    rod = tangency.BodyDef("rod", position=(-0.5, 0.13), angle=0.2, shapes=[bar])
    hinge = tangency.JointDef("hinge", ("box", "rod"), tangency.Revolute((-0.2, 0.1)))
    push = tangency.ControlDef("push", "force_x", "box")
    return tangency.Scene(tangency.SceneDef([floor, box, rod], [hinge], controls=[push], dt=0.01, duration=0.2))


SCENE = dragged()
STEPS = 6
NAMES = ("mass:box", "friction:floor", "gravity.y")


def inputs(batch=None, dtype=torch.float64):
    """q0, v0, controls and values near those of the scene, all with a batch or without."""
    random = np.random.default_rng(1)
    q, v, _ = SCENE.initial_state
    shape = () if batch is None else (batch,)

    def near(x, size):
        return torch.tensor(x + size * random.standard_normal((*shape, *np.shape(x))), dtype=dtype)

    # What is pressed into the floor or apart from it touches or not: velocities and forces vary, poses do not.
    moving = np.array([[0.0], [1.0], [1.0]])
    v0 = torch.as_tensor(v + moving * random.standard_normal((*shape, 1, 1)) * [0.1, 0, 0], dtype=dtype)
    q0 = torch.as_tensor(np.broadcast_to(q, (*shape, *q.shape)).copy(), dtype=dtype)
    values = [near(SCENE.value(name), 0.01) for name in NAMES]
    return q0, v0, near(np.zeros((STEPS, 1)), 0.5), *values

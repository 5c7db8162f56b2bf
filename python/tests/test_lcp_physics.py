"""Scenes of lcp-physics: its conventions, and bodies that only look like its own."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest

import tangency as tg
from tangency import lcp_physics as lcp

S = 100.0  # pixels per metre


class Tensor:
    """What a tensor of PyTorch shows to someone who only wants its numbers."""

    def __init__(self, values: Any) -> None:
        self.values = np.asarray(values, dtype=np.float64)

    def detach(self) -> Tensor:
        return self

    def cpu(self) -> Any:
        return self.values

    def __array__(self, *_: Any, **__: Any) -> Any:
        raise RuntimeError("Can't call numpy() on Tensor that requires grad. Use tensor.detach().numpy() instead.")

    def __float__(self) -> float:
        return float(self.values)

    def __getitem__(self, key: Any) -> Tensor:
        return Tensor(self.values[key])


class Geom:
    def __init__(self) -> None:
        self.no_contact: set[Geom] = set()


class Body:
    def __init__(self, pose: Any, **attributes: Any) -> None:
        self.p, self.v, self.mass = Tensor(pose), Tensor([0, 0, 0]), Tensor(1)
        self.restitution, self.fric_coeff = Tensor(0.5), Tensor(0.9)
        self.forces: list[Any] = []
        self.geom = Geom()
        self.__dict__.update(attributes)


class Hull(Body): ...


class Rect(Hull): ...


class Circle(Body): ...


class ExternalForce:
    def __init__(self, force: Any) -> None:
        self.force, self.multiplier = force, Tensor(100.0)


class Gravity(ExternalForce):
    def __init__(self, g: float) -> None:
        super().__init__(lambda t: None)
        self.multiplier = Tensor(g)


class Constraint:
    def __init__(self, body1: Body, body2: Body | None = None, **attributes: Any) -> None:
        self.body1, self.body2 = body1, body2
        self.__dict__.update(attributes)


class Joint(Constraint): ...


class FixedJoint(Constraint): ...


class XConstraint(Constraint): ...


class YConstraint(Constraint): ...


class RotConstraint(Constraint): ...


class TotalConstraint(Constraint): ...


def body(definition: tg.SceneDef, k: int) -> tg.BodyDef:
    found = definition.bodies[k]
    assert isinstance(found, tg.BodyDef)
    return found


def test_vectors_there_and_back() -> None:
    there = np.array([0.5, 300.0, 100.0])
    assert lcp.to_tangency(there, S).tolist() == [3, -1, -0.5]
    assert lcp.wrench_to_tangency([7e4, 100, 200], S).tolist() == [1, -2, -7]
    random = np.random.default_rng(7).normal(size=(4, 5, 3))
    np.testing.assert_allclose(lcp.from_tangency(lcp.to_tangency(random, S), S), random, rtol=1e-15)
    np.testing.assert_allclose(lcp.wrench_from_tangency(lcp.wrench_to_tangency(random, S), S), random, rtol=1e-15)
    # The library keeps the velocities of all bodies in one flat vector.
    np.testing.assert_array_equal(lcp.to_tangency(random[0].ravel()), lcp.to_tangency(random[0]))
    np.testing.assert_array_equal(lcp.to_tangency(Tensor(random)), lcp.to_tangency(random))
    for wrong in (1.0, np.zeros(4), np.zeros((3, 2))):
        with pytest.raises(ValueError, match=r"vectors have shape .*; give \(\.\.\., 3\)"):
            lcp.to_tangency(wrong)


def test_power_is_the_same_in_both() -> None:
    """Wrench times velocity, up to the square of the scale, and the kinetic energy of a body."""
    wrench, velocity = np.random.default_rng(8).normal(size=(2, 3))
    here = lcp.wrench_to_tangency(wrench, S) @ lcp.to_tangency(velocity, S)
    assert here == pytest.approx(wrench @ velocity / S**2, rel=1e-14)


def test_bodies_that_look_like_the_librarys() -> None:
    turned = 0.3
    rotation = np.array([[math.cos(turned), -math.sin(turned)], [math.sin(turned), math.cos(turned)]])
    triangle = np.array([[-20.0, -10.0], [40.0, -10.0], [-20.0, 20.0]])
    bodies = [
        Circle([0.1, 150, 100], rad=Tensor(20), v=Tensor([0.5, 30, -10]), mass=Tensor(2), restitution=Tensor(0.25)),
        Rect([turned, 300, 400], dims=Tensor([60, 20]), fric_coeff=Tensor(0.5)),
        Hull([turned, 500, 200], verts=[Tensor(rotation @ point) for point in triangle]),
    ]
    definition = lcp.scene_def(bodies, [TotalConstraint(bodies[1])], dt=0.01, eps=0.2, pixels_per_meter=S)
    disc, box, hull = (body(definition, k) for k in range(3))
    assert (disc.name, box.name, hull.name) == ("circle 0", "rect 1", "hull 2")
    assert (disc.kind, box.kind, hull.kind) == ("dynamic", "static", "dynamic")
    assert (disc.position, disc.angle, disc.mass, disc.restitution) == ((1.5, -1.0), -0.1, 2.0, 0.25)
    assert (disc.velocity, disc.angular_velocity, disc.friction) == ((0.3, 0.1), -0.5, 0.9)
    assert list(disc.shapes) == [tg.Circle(0.2)]
    assert list(box.shapes) == [tg.Rectangle(0.6, 0.2)]
    assert (box.angle, box.friction) == (-turned, 0.5)
    (polygon,) = hull.shapes
    assert isinstance(polygon, tg.Polygon)
    np.testing.assert_allclose(np.asarray(list(map(list, polygon.points))), triangle * [1, -1] / S, atol=1e-15)
    assert definition.contact_model == {"velocity": {"contact_distance": 0.002}}
    assert definition.stabilisation == {"joints": "none", "contacts": "post"}
    scene = tg.Scene(definition)
    np.testing.assert_allclose(scene.initial_state.q, lcp.to_tangency([b.p.values for b in bodies], S), atol=1e-15)
    # Inertia as the library has it: m r²/2, and of a triangle m (a² + b² + c²)/36.
    assert scene.mass[0].tolist() == pytest.approx([2, 2, 2 * 0.2**2 / 2], rel=1e-12)
    sides = 0.6**2 + 0.3**2 + (0.6**2 + 0.3**2)
    assert scene.mass[2, 2] == pytest.approx(sides / 36, rel=1e-12)


def test_friction_of_a_pair_is_the_mean_and_some_pass_through_each_other() -> None:
    bodies = [Circle([0, 100 * k, 0], rad=10, fric_coeff=0.2 * k) for k in range(3)]
    bodies[0].geom.no_contact.add(bodies[2].geom)
    bodies[2].geom.no_contact.add(bodies[0].geom)
    pairs = lcp.scene_def(bodies).pairs
    names = [f"circle {k}" for k in range(3)]
    expected = [
        tg.PairDef((names[0], names[1]), friction=0.1),
        tg.PairDef((names[0], names[2]), collide=False),
        tg.PairDef((names[1], names[2]), friction=(0.2 + 0.4) / 2),
    ]
    assert list(pairs) == expected


def test_constraints() -> None:
    bodies = [Circle([0, 100 * k, 50], rad=10) for k in range(3)]
    bodies[0].geom.no_contact.add(bodies[1].geom)
    bodies[1].geom.no_contact.add(bodies[0].geom)
    constraints = [
        Joint(bodies[0], bodies[1], pos=Tensor([50, 60])),
        Joint(bodies[0], None, pos=Tensor([0, 0])),
        FixedJoint(bodies[1], bodies[2]),
        XConstraint(bodies[0]),
        YConstraint(bodies[0]),
        RotConstraint(bodies[0]),
    ]
    assert list(lcp.scene_def(bodies, constraints, pixels_per_meter=S).joints) == [
        tg.JointDef("joint 0", ("circle 0", "circle 1"), tg.Revolute((0.5, -0.6)), collide=False),
        tg.JointDef("joint 1", ("world", "circle 0"), tg.Revolute((0, 0)), collide=True),
        tg.JointDef("fixedjoint 2", ("circle 1", "circle 2"), tg.Weld((1, -0.5)), collide=True),
        tg.JointDef("xconstraint 3", ("world", "circle 0"), tg.Lock(x=True), collide=True),
        tg.JointDef("yconstraint 4", ("world", "circle 0"), tg.Lock(y=True), collide=True),
        tg.JointDef("rotconstraint 5", ("world", "circle 0"), tg.Lock(rotation=True), collide=True),
    ]


def test_gravity_and_forces_in_time() -> None:
    """A body of 2 kg that falls with g, one with g/2 that is pushed for three steps, and one that floats."""
    push = ExternalForce(lambda t: Tensor([0, 200, 0]) if t < 0.25 else Tensor([0, 0, 0]))
    bodies = [Circle([0, 1000 * k, 0], rad=10, mass=2) for k in range(3)]
    bodies[0].forces = [Gravity(100)]
    bodies[1].forces = [Gravity(50), push]
    definition = lcp.scene_def(bodies, dt=0.1, duration=1.0, pixels_per_meter=S)
    assert list(definition.forces) == [tg.ForceDef("circle 1", (2.0, 0.0), 0.0, 0.0, 2 * 0.1 + 0.1)]
    run = tg.rollout(tg.Scene(definition))
    v = lcp.from_tangency(run.v[-1], S)
    np.testing.assert_allclose(v, [[0, 0, 100], [0, 30, 50], [0, 0, 0]], atol=1e-10)


def test_a_world() -> None:
    class World:
        bodies = [Circle([0, 0, 0], rad=10), Circle([0, 100, 0], rad=10)]
        joints = [(Joint(bodies[0], bodies[1], pos=Tensor([50, 0])), 0, 1)]
        dt, eps, tol, fric_dirs, post_stab, strict_no_pen = 0.02, 0.5, 1e-6, 2, True, True

    definition = lcp.scene_def_of_world(World(), pixels_per_meter=S, duration=2.0)
    assert (definition.dt, definition.duration) == (0.02, 2.0)
    assert definition.contact_model == {"velocity": {"contact_distance": 0.005}}
    assert definition.stabilisation == {"joints": "post", "contacts": "post"}
    assert len(definition.joints) == 1


def test_what_is_refused() -> None:
    disc, other = Circle([0, 0, 0], rad=10), Circle([0, 15, 0], rad=10)
    with pytest.raises(ValueError, match=r"bodies penetrate by 5 px at the start, more than tol = 1e-06 px"):
        lcp.scene_def([disc, other])
    assert len(lcp.scene_def([disc, other], strict_no_penetration=False).bodies) == 2
    with pytest.raises(ValueError, match="fric_dirs is 4; in the plane there are 2"):
        lcp.scene_def([disc], fric_dirs=4)
    with pytest.raises(ValueError, match="Geom is none of Circle, ExternalForce, FixedJoint"):
        lcp.scene_def([Geom()])
    with pytest.raises(ValueError, match="a constraint holds a Circle that is not among the bodies"):
        lcp.scene_def([disc], [XConstraint(other)])
    with pytest.raises(ValueError, match=r"a pose or velocity has shape \(4,\)"):
        lcp.Circle([1, 2, 3, 4], 1.0)


def test_classes_with_the_librarys_names() -> None:
    """A script that was written for the library: a pendulum in pixels, and a ball under its own thrust."""
    pivot, bob = lcp.Rect((300, 50), (20, 20)), lcp.Rect((0.1, 310, 110), (20, 60), mass=2)
    ball = lcp.Circle((100, 120), 15, vel=(40, 0))
    hull = lcp.Hull((500, 500), [(0, 0), (30, 0), (30, 60), (0, 60)])
    bob.add_force(lcp.Gravity(g=100))
    bob.add_no_contact(pivot)
    ball.add_force(lcp.ExternalForce(lambda t: (0, 1, 0), multiplier=5))
    assert hull.p.tolist() == pytest.approx([0, 515, 530])
    assert np.stack(hull.verts).tolist() == [[-15, -30], [15, -30], [15, 30], [-15, 30]]
    joints = [lcp.TotalConstraint(pivot), lcp.Joint(bob, pivot, (300, 75)), lcp.XConstraint(hull)]
    definition = lcp.scene_def([pivot, bob, ball, hull], joints, post_stab=True, pixels_per_meter=S, duration=1.0)
    scene = tg.Scene(definition)
    assert scene.value("gravity.y") == -1.0
    run = tg.rollout(scene)
    assert scene.joint_drift(run.last) < 1e-6
    np.testing.assert_allclose(run.v[-1, 2], [0.4 + 0.05 * 1.0, 0, 0], atol=1e-12)
    assert run.q[-1, 3].tolist() == run.q[0, 3].tolist()
    # Right of the hinge on the screen, the bob swings clockwise: ω⁺ = dt g d/(I/m + l²) > 0, v = ω × r.
    spin = 100 / 30 * 10 / ((20**2 + 60**2) / 12 + 10**2 + 35**2)
    np.testing.assert_allclose(lcp.from_tangency(run.v[1, 1], S), [spin, -35 * spin, 10 * spin], rtol=1e-10)

"""Scenes and vectors of lcp-physics (de Avila Belbute-Peres et al., NeurIPS 2018) for this engine.

That library draws on a screen: y points down, lengths are pixels, and the angle comes first. With s pixels per
metre, what is (θ, x, y) and (τ, fx, fy) there is here

::

    pose      (x/s, −y/s, −θ)          the same for velocities
    wrench    (fx/s, −fy/s, −τ/s²)     N, N, N·m from kg·px/s² and kg·px²/s²

`scene_def` takes bodies and constraints of the library itself (anything with the same attributes does), or of the
classes here, which have the same names and arguments. What differs between the two engines is in
``docs/migration-lcp-physics.md``.

>>> from tangency import Scene, lcp_physics, rollout
>>> ball = lcp_physics.Circle((300, 100), 20, restitution=0.5)
>>> ball.add_force(lcp_physics.Gravity(g=100))
>>> floor = lcp_physics.Rect((300, 400), (600, 20))
>>> scene = Scene(lcp_physics.scene_def([ball, floor], [lcp_physics.TotalConstraint(floor)], pixels_per_meter=100))
>>> scene.bodies
('circle 0', 'rect 1')
>>> run = rollout(scene, steps=60)
>>> lcp_physics.from_tangency(run.q[0, 0], pixels_per_meter=100) + 0.0  # where the ball began
array([  0., 300., 100.])
"""

from tangency.lcp_physics.parts import (
    Circle,
    ExternalForce,
    FixedJoint,
    Gravity,
    Hull,
    Joint,
    Rect,
    RotConstraint,
    TotalConstraint,
    XConstraint,
    YConstraint,
)
from tangency.lcp_physics.reading import scene_def, scene_def_of_world
from tangency.lcp_physics.vectors import from_tangency, to_tangency, wrench_from_tangency, wrench_to_tangency

__all__ = [
    "Circle",
    "ExternalForce",
    "FixedJoint",
    "Gravity",
    "Hull",
    "Joint",
    "Rect",
    "RotConstraint",
    "TotalConstraint",
    "XConstraint",
    "YConstraint",
    "from_tangency",
    "scene_def",
    "scene_def_of_world",
    "to_tangency",
    "wrench_from_tangency",
    "wrench_to_tangency",
]

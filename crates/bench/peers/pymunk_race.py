"""pymunk (Chipmunk): impulses by Gauss–Seidel with warm starts, positions by Baumgarte's method.

Friction and restitution of a pair are products, so each body gets the square root. The floor is a thick
segment. Overlaps up to `collision_slop` stay by design: 0.1 by default, in metres here.
"""

import math

import pymunk

from race import anything, race


class World:
    def __init__(self, heat, iterations, slop):
        self.dt = heat.dt
        self.space = space = pymunk.Space()
        space.gravity, space.iterations, space.collision_slop = heat.gravity, iterations, slop
        self.bodies = [self._body(body) for body in heat.bodies]
        for joint in heat.joints:
            a = space.static_body if joint.a is None else self.bodies[joint.a]
            b = self.bodies[joint.b]
            if joint.kind == "revolute":
                held = [pymunk.PivotJoint(a, b, joint.anchor)]
            else:
                far = 1e4
                ends = [tuple(p + s * far * d for p, d in zip(joint.anchor, joint.axis)) for s in (-1, 1)]
                local = b.world_to_local(joint.anchor)
                held = [pymunk.GrooveJoint(a, b, *ends, local), pymunk.GearJoint(a, b, 0.0, 1.0)]
            for constraint in held:
                constraint.collide_bodies = False
            space.add(*held)

    def _body(self, given):
        if not given.dynamic:
            body = self.space.static_body
            shape = pymunk.Segment(body, (-1e3, -1.0), (1e3, -1.0), 1.0)
        else:
            body = pymunk.Body(given.mass, given.inertia)
            body.position, body.angle = given.position, given.angle
            body.velocity, body.angular_velocity = given.velocity, given.rate
            self.space.add(body)
            if given.shape is None:
                return body
            if given.shape[0] == "circle":
                shape = pymunk.Circle(body, given.shape[1])
            else:
                shape = pymunk.Poly.create_box(body, given.shape[1:])
        shape.friction, shape.elasticity = math.sqrt(given.friction), math.sqrt(given.restitution)
        self.space.add(shape)
        return body

    def run(self, steps):
        step, dt = self.space.step, self.dt
        for _ in range(steps):
            step(dt)

    def poses(self):
        return [(*body.position, body.angle) for body in self.bodies]


def engine(iterations, slop):
    name = f"pymunk {pymunk.version}, {iterations} it., slop {slop}"
    return name, lambda heat: World(heat, iterations, slop), anything


if __name__ == "__main__":
    race([engine(10, 0.1), engine(10, 0.0), engine(100, 0.0)])

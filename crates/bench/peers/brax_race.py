"""Brax, its generalized pipeline, on the model of mjcf.py, compiled for the processor. See compiled.py."""

import math

import jax.numpy as jnp
from brax.generalized import pipeline
from brax.io import mjcf as brax_mjcf

import mjcf
from compiled import Compiled, accepts
from race import race


def engine(heat):
    xml = mjcf.model(heat)
    if not heat.touches:  # it wants a shape to look at
        xml = xml.replace("<worldbody>", '<worldbody><geom size="0.01" contype="0" conaffinity="0"/>')
    system = brax_mjcf.loads(xml)
    act = jnp.zeros(system.act_size())
    last = heat.last(system.qd_size())
    first = lambda q, v: pipeline.init(system, q, v)
    return system, first, lambda state: pipeline.step(system, state, act), lambda state: state.q[last]


class World(Compiled):
    engine = staticmethod(engine)

    def initial(self):
        return jnp.array(self.model.init_q, float)

    def coordinates(self, state):
        return state.q, state.qd

    def poses(self):
        found, link = [], 0
        origins = {joint.b: joint.anchor for joint in self.heat.joints}
        for index, body in enumerate(self.heat.bodies):
            if not body.dynamic:
                found.append((*body.position, body.angle))
                continue
            at, turn = self.state.x.pos[link], self.state.x.rot[link]
            link += 1
            angle = -2.0 * math.atan2(turn[2], turn[0])
            origin = origins.get(index, body.position)
            dx, dy = body.position[0] - origin[0], body.position[1] - origin[1]
            c, s = math.cos(angle), math.sin(angle)
            found.append((float(at[0]) + c * dx - s * dy, float(at[2]) + s * dx + c * dy, body.angle + angle))
        return found


if __name__ == "__main__":
    race([("brax generalized", World, accepts)])

"""Brax, its generalized pipeline, on the model of mjcf.py: compiled for the processor, in double precision.

A run is one compiled loop over its steps; compiling does not count. The gradient is reverse mode by the
initial velocities and positions.
"""

import functools
import math

import jax

jax.config.update("jax_enable_x64", True)

import jax.numpy as jnp
from brax.generalized import pipeline
from brax.io import mjcf as brax_mjcf

import mjcf
from race import race


@functools.cache
def compiled(xml, touches, steps):
    """The system, and the run and its gradient as compiled functions of (q, qd)."""
    if not touches:  # it wants a shape to look at
        xml = xml.replace("<worldbody>", '<worldbody><geom size="0.01" contype="0" conaffinity="0"/>')
    system = brax_mjcf.loads(xml)
    act = jnp.zeros(system.act_size())

    def run(q, qd):
        state = pipeline.init(system, q, qd)
        return jax.lax.scan(lambda s, _: (pipeline.step(system, s, act), None), state, None, length=steps)[0]

    last = system.qd_size() - 3 if touches else system.qd_size() - 1
    gradient = jax.value_and_grad(lambda q, qd: run(q, qd).q[last], argnums=(0, 1))
    return system, jax.jit(run), jax.jit(gradient)


class World:
    def __init__(self, heat):
        self.heat, self.key = heat, (mjcf.model(heat), heat.touches)
        system = compiled(*self.key, 5)[0]
        self.start = jnp.array(system.init_q, float), jnp.array(mjcf.velocities(heat))
        self.state, self.places = self.start, None

    def prepare(self, steps):
        jax.block_until_ready(compiled(*self.key, steps)[1](*self.start).q)

    def run(self, steps):
        state = compiled(*self.key, 5 if steps == 1 else steps)[1](*self.state)
        self.state, self.places = (state.q.block_until_ready(), state.qd), state.x

    def value_and_gradient(self, steps):
        jax.block_until_ready(compiled(*self.key, steps)[2](*self.start))

    def poses(self):
        found, link = [], 0
        origins = {joint.b: joint.anchor for joint in self.heat.joints}
        for index, body in enumerate(self.heat.bodies):
            if not body.dynamic:
                found.append((*body.position, body.angle))
                continue
            at, turn = self.places.pos[link], self.places.rot[link]
            link += 1
            angle = -2.0 * math.atan2(turn[2], turn[0])
            origin = origins.get(index, body.position)
            dx, dy = body.position[0] - origin[0], body.position[1] - origin[1]
            c, s = math.cos(angle), math.sin(angle)
            found.append((float(at[0]) + c * dx - s * dy, float(at[2]) + s * dx + c * dy, body.angle + angle))
        return found


def accepts(heat):
    """Small scenes at the finer step; stacks compile for minutes."""
    return bool(heat.gradient_steps) and not heat.scene.startswith("stack")


if __name__ == "__main__":
    race([("brax generalized", World, accepts)])

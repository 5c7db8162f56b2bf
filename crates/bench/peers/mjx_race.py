"""MuJoCo XLA (mujoco-mjx): the model of mjcf.py on JAX, compiled for the processor, in double precision.

A run is one compiled loop over its steps; compiling does not count. The gradient is reverse mode by the
initial velocities and positions.
"""

import functools
import math

import jax

jax.config.update("jax_enable_x64", True)

import jax.numpy as jnp
import mujoco
from mujoco import mjx

import mjcf
from race import race


@functools.cache
def compiled(xml, steps):
    """The model, and the run and its gradient as compiled functions of (qpos, qvel)."""
    model = mujoco.MjModel.from_xml_string(xml)
    there = mjx.put_model(model)

    def run(q, v):
        data = mjx.make_data(there).replace(qpos=q, qvel=v)
        return jax.lax.scan(lambda d, _: (mjx.step(there, d), None), data, None, length=steps)[0]

    last = model.nv - 3 if model.ngeom else model.nv - 1
    gradient = jax.value_and_grad(lambda q, v: run(q, v).qpos[last], argnums=(0, 1))
    return model, jax.jit(run), jax.jit(gradient)


class World:
    def __init__(self, heat):
        # The solver's loop over iterations has a fixed length, so that it can be differentiated.
        self.heat, self.xml = heat, mjcf.model(heat, 'iterations="1" ls_iterations="4"')
        model = compiled(self.xml, 5)[0]
        self.start = jnp.array(model.qpos0), jnp.array(mjcf.velocities(heat))
        self.model, self.state = model, self.start

    def prepare(self, steps):
        jax.block_until_ready(compiled(self.xml, steps)[1](*self.start).qpos)

    def run(self, steps):
        steps = 5 if steps == 1 else steps
        data = compiled(self.xml, steps)[1](*self.state)
        self.state = data.qpos.block_until_ready(), data.qvel

    def value_and_gradient(self, steps):
        jax.block_until_ready(compiled(self.xml, steps)[2](*self.start))

    def poses(self):
        data = mujoco.MjData(self.model)
        data.qpos[:] = self.state[0]
        mujoco.mj_kinematics(self.model, data)
        mujoco.mj_comPos(self.model, data)
        found = []
        for body in self.heat.bodies:
            if not body.dynamic:
                found.append((*body.position, body.angle))
                continue
            index = self.model.body(body.name).id
            at, turn = data.xipos[index], data.xmat[index].reshape(3, 3)
            found.append((at[0], at[2], body.angle + math.atan2(turn[2, 0], turn[0, 0])))
        return found


def accepts(heat):
    """Small scenes at the finer step; stacks compile for minutes."""
    return bool(heat.gradient_steps) and not heat.scene.startswith("stack")


if __name__ == "__main__":
    race([("mujoco-mjx", World, accepts)])

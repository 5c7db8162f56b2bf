"""MuJoCo XLA (mujoco-mjx): the model of mjcf.py on JAX, compiled for the processor. See compiled.py."""

import jax.numpy as jnp
import mujoco
from mujoco import mjx

import mjcf
from compiled import Compiled, accepts
from race import race


def engine(heat):
    # The solver's loop over iterations has a fixed length, so that it can be differentiated.
    xml = mjcf.model(heat, 'iterations="1" ls_iterations="4"')
    model = mujoco.MjModel.from_xml_string(xml)
    there, last = mjx.put_model(model), heat.last(model.nv)
    first = lambda q, v: mjx.make_data(there).replace(qpos=q, qvel=v)
    return model, first, lambda data: mjx.step(there, data), lambda data: data.qpos[last]


class World(Compiled):
    engine = staticmethod(engine)

    def initial(self):
        return jnp.array(self.model.qpos0)

    def coordinates(self, data):
        return data.qpos, data.qvel

    def poses(self):
        data = mujoco.MjData(self.model)
        data.qpos[:] = self.now[0]
        return mjcf.poses(self.heat, self.model, data)


if __name__ == "__main__":
    race([("mujoco-mjx", World, accepts)])

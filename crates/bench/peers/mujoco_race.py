"""MuJoCo: soft contacts solved by Newton's method, joints in reduced coordinates. See mjcf.py.

The gradient is by all states, in reverse over its finite-difference transition matrices (mjd_transitionFD).
"""

import mujoco
import numpy as np

import mjcf
from race import anything, race


class World:
    gradient_note = "gradient by the initial state, from finite differences of every step"

    def __init__(self, heat):
        self.heat = heat
        self.model = mujoco.MjModel.from_xml_string(mjcf.model(heat))
        self.data = mujoco.MjData(self.model)
        self.data.qvel[:] = mjcf.velocities(heat)
        mujoco.mj_forward(self.model, self.data)

    def run(self, steps):
        mujoco.mj_step(self.model, self.data, nstep=steps)

    def poses(self):
        return mjcf.poses(self.heat, self.model, self.data)

    def value_and_gradient(self, steps):
        nv = self.model.nv
        tape = []
        for _ in range(steps):
            A = np.zeros((2 * nv, 2 * nv))
            mujoco.mjd_transitionFD(self.model, self.data, 1e-6, True, A, None, None, None)
            tape.append(A)
            mujoco.mj_step(self.model, self.data)
        bar = np.zeros(2 * nv)
        bar[self.heat.last(nv)] = 1.0
        for A in reversed(tape):
            bar = A.T @ bar
        return bar


if __name__ == "__main__":
    race([(f"mujoco {mujoco.__version__}", World, anything)])

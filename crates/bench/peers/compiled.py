"""Worlds of engines on JAX: a run is one compiled loop over its steps, in double precision.

Compiling does not count. The gradient is reverse mode by the initial positions and velocities.
"""

import functools

import jax

jax.config.update("jax_enable_x64", True)

import jax.numpy as jnp

import mjcf


@functools.cache
def _functions(engine, heat, steps):
    """The model, and as compiled functions of (q, v) the run and its value with gradient."""
    model, first, step, place = engine(heat)

    def run(q, v):
        return jax.lax.scan(lambda state, _: (step(state), None), first(q, v), None, length=steps)[0]

    gradient = jax.value_and_grad(lambda q, v: place(run(q, v)), argnums=(0, 1))
    return model, jax.jit(run), jax.jit(gradient)


class Compiled:
    """A world. A class derived from this has `engine`, a function of a heat that returns the model, how a state
    is made of (q, v), how a state steps, and the coordinate of a state whose gradient is asked for; `initial()`,
    the first q; and `coordinates(state)`, its (q, v).
    """

    gradient_note = "gradient by the initial state"

    def __init__(self, heat):
        self.heat = heat
        self.model = self._functions(5)[0]
        self.start = self.initial(), jnp.array(mjcf.velocities(heat))
        self.now, self.state = self.start, None

    def _functions(self, steps):
        return _functions(type(self).engine, self.heat, steps)

    def prepare(self, steps):
        jax.block_until_ready(self.coordinates(self._functions(steps)[1](*self.start)))

    def run(self, steps):
        # The race warms up by one step: five are compiled anyway.
        self.state = self._functions(5 if steps == 1 else steps)[1](*self.now)
        self.now = jax.block_until_ready(self.coordinates(self.state))

    def value_and_gradient(self, steps):
        jax.block_until_ready(self._functions(steps)[2](*self.start))


def accepts(heat):
    """Small scenes at the finer step; stacks compile for minutes."""
    return bool(heat.gradient_steps) and not heat.scene.startswith("stack")

"""Runs of scenes, single steps and complementarity problems as pure functions of JAX.

>>> import jax, jax.numpy as jnp, tangency, tangency.jax
>>> ball = tangency.BodyDef("ball", position=(0, 1), shapes=[tangency.Circle(0.1)], restitution=0.5)
>>> floor = tangency.BodyDef("floor", "static", shapes=[tangency.HalfPlane((0, 1))], restitution=0.5)
>>> scene = tangency.Scene(tangency.SceneDef([ball, floor], dt=0.005, stepping={"accurate": {}}))
>>> def height(start):
...     q, v = tangency.jax.rollout(scene, 150, values={"position.y:ball": start})
...     return q[-1, 0, 1]
>>> value, slope = jax.jit(jax.value_and_grad(height))(1.0)
>>> print(f"{value:.3f} {slope:.3f}")
0.268 0.626

Transformations
    `jit`, `vmap` (one call of the engine for the whole batch, over all cores), `grad`, `jvp`, `vjp`, `jacfwd`,
    `jacrev`, `linearize`, `checkpoint`, `scan`, in any order. Forward mode runs the engine's tangents, reverse mode
    its gradients. Second derivatives (`hessian`, `grad` of `grad`) raise NotImplementedError.

Precision
    The engine computes in float64. Results have the type of the arrays that go in: float32 unless
    ``jax.config.update("jax_enable_x64", True)``.

Memory
    The last runs are kept so that a value and its derivative at the same point are one run, not two; results never
    depend on it. See `keep_tapes`.

Errors
    Shapes and names are checked when a function is traced. What the engine refuses (`StepError`, `SceneError`, ...)
    is raised as such outside `jit`; under `jit` XLA wraps it in `jax.errors.JaxRuntimeError`, whose text ends with
    the engine's message.

Forks
    JAX does not survive `os.fork` (it warns, and hangs): start workers that use it by
    ``multiprocessing.get_context("spawn")``. A forked child may go on with the rest of the package.
"""

from tangency.jax.lcp import solve_lcp
from tangency.jax.runs import rollout, step
from tangency.jax.tapes import keep_tapes

__all__ = ["keep_tapes", "rollout", "solve_lcp", "step"]

"""What JAX adds to a run and its gradient: the scene `chain_and_ball`, 300 steps, Σ q² by masses and the start.

    python python/benchmarks/jax_overhead.py
"""

from __future__ import annotations

import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np

import tangency
import tangency.jax

SCENE = Path(__file__).parents[2] / "scenes" / "chain_and_ball.toml"
STEPS, REPEATS, BATCH = 300, 200, 16
NAME = "mass:links"


def best_ms(call: Callable[[Any], Any], points: list[Any]) -> float:
    """Least time of a call, ms, over points that are all new to it."""
    times = []
    for point in points:
        start = time.perf_counter()
        jax.block_until_ready(call(point))
        times.append(1e3 * (time.perf_counter() - start))
    return min(times)


def main() -> None:
    jax.config.update("jax_enable_x64", True)
    scene = tangency.Scene.load(SCENE)
    q0, v0, _ = scene.initial_state

    def plain(mass: float) -> Any:
        run = tangency.rollout(scene.with_values({NAME: float(mass)}), STEPS, state=(q0, v0))
        q = run.q
        gradient = run.gradient(q=2 * q, wrt=[NAME])
        return np.sum(q**2), gradient.q0, gradient.v0, gradient[NAME]

    def plain_batch(masses: Any) -> Any:
        batch = tangency.Batch(scene, BATCH)
        batch.set(NAME, masses)
        runs = batch.rollout(STEPS)
        q = runs.q
        gradient = runs.gradient(q=2 * q, wrt=[NAME])
        return np.sum(q**2, axis=(1, 2, 3)), gradient.q0, gradient.v0, gradient[NAME]

    def loss(q0: jax.Array, v0: jax.Array, mass: jax.Array) -> jax.Array:
        q, _ = tangency.jax.rollout(scene, STEPS, q0=q0, v0=v0, values={NAME: mass})
        return jnp.sum(q**2)

    gradient = jax.value_and_grad(loss, argnums=(0, 1, 2))
    jitted = jax.jit(gradient)
    batched = jax.jit(jax.vmap(gradient, (None, None, 0)))
    masses = np.random.default_rng(0).uniform(0.6, 0.8, REPEATS + 2)
    batches = [jnp.asarray(masses[k : k + BATCH]) for k in range(0, REPEATS - BATCH, BATCH)]

    # Once to compile.
    jitted(q0, v0, masses[0]), gradient(q0, v0, masses[0]), batched(q0, v0, 0.9 * batches[0])
    rows = [
        ("NumPy API", best_ms(plain, list(masses[2:]))),
        ("jit(value_and_grad)", best_ms(lambda m: jitted(q0, v0, m), list(masses[2:] + 0.01))),
        ("value_and_grad without jit", best_ms(lambda m: gradient(q0, v0, m), list(masses[2:] + 0.02))),
        (f"NumPy API, batch, one of {BATCH}", best_ms(plain_batch, batches) / BATCH),
        (f"jit(vmap(value_and_grad)), one of {BATCH}", best_ms(lambda m: batched(q0, v0, m), batches) / BATCH),
    ]
    print(f"{'value and gradient of ' + str(STEPS) + ' steps':38} {'ms':>8} {'ratio':>7}")
    for name, ms in rows:
        print(f"{name:38} {ms:8.3f} {ms / rows[0][1]:7.2f}")


if __name__ == "__main__":
    main()

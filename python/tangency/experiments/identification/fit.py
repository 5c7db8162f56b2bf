"""Least squares by Levenberg and Marquardt, through the engine's forward derivatives, and error bars.

::

    r(p) = (y(p) − y)/σ,   J = ∂r/∂p          (JᵀJ + λ diag JᵀJ) δ = −Jᵀ r,   λ up where |r| does not fall
    cov = (JᵀJ)⁻¹                             at the minimum, for noise of known σ (Gauss 1823)

The first part of the motion is fitted first, then more of it: after impacts a wrong number moves all that follows, and a
search that begins with the whole motion ends where some other impact happens.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

import tangency
from tangency.experiments.identification.scenes import Case

__all__ = ["Estimate", "estimate", "observe"]

Array = npt.NDArray[np.float64]

PARTS = (0.25, 0.4, 0.55, 0.7, 0.85, 1.0)
"""Of the motion that are fitted one after the other."""

ROUNDS = 30
"""At most, per part."""


@dataclass(frozen=True)
class Estimate:
    """Numbers with their standard deviations, and how well they explain what was seen.

    Attributes
    ----------
    values, deviations : ndarray, shape (unknown,)
    chi_squared : float
        |r|² per degree of freedom: 1 but for chance where model and noise are right.
    """

    values: Array
    deviations: Array
    chi_squared: float


def observe(case: Case, rng: np.random.Generator) -> Array:
    """Poses of the body, with noise: (steps, 3)."""
    run = tangency.rollout(case.scene, case.steps)
    seen: Array = run.q[1:, case.scene.body(case.body)]
    return seen + rng.normal(size=seen.shape) * case.noise


def estimate(case: Case, seen: Array) -> Estimate:
    """The numbers that explain what was seen."""
    values = np.array(case.guess)
    for part in PARTS:
        values, residual, jacobian = _minimum(case, values, seen[: round(part * case.steps)])
    freedom = residual.size - values.size
    covariance = np.linalg.inv(jacobian.T @ jacobian)
    return Estimate(values, np.sqrt(np.diag(covariance)), float(residual @ residual) / freedom)


def _minimum(case: Case, values: Array, seen: Array) -> tuple[Array, Array, Array]:
    """Values, residual and Jacobian where |r|² is least."""
    damping, now = 1e-3, _linearised(case, values, seen)
    if now is None:
        raise RuntimeError(f"{case.name}: the first guess cannot be simulated")
    for _ in range(ROUNDS):
        residual, jacobian = now
        square = jacobian.T @ jacobian
        # A vertex that has not touched yet tells nothing: it stays where it is.
        scale = np.maximum(np.diag(square), 1e-9 * square.max())
        step = -np.linalg.solve(square + damping * np.diag(scale), jacobian.T @ residual)
        then = _linearised(case, values + step, seen)
        if then is not None and then[0] @ then[0] < residual @ residual:
            settled = residual @ residual - then[0] @ then[0] < 1e-9 * (residual @ residual)
            values, now, damping = values + step, then, max(damping / 5.0, 1e-12)
            if settled:
                break
        else:
            damping *= 5.0
            if damping > 1e8:
                break
    return values, *now


def _linearised(case: Case, values: Array, seen: Array) -> tuple[Array, Array] | None:
    """Residual and Jacobian; none where the scene cannot have these numbers, or cannot be simulated with them."""
    body = case.scene.body(case.body)
    try:
        scene = case.scene.with_values(dict(zip(case.unknown, map(float, values), strict=True)))
        run = tangency.rollout(scene, len(seen))
        columns = [run.tangent(values={name: 1.0})[0][1:, body] for name in case.unknown]
    except (tangency.SceneError, tangency.StepError, tangency.GradientError):
        return None
    residual = ((run.q[1:, body] - seen) / case.noise).ravel()
    return residual, np.stack([(column / case.noise).ravel() for column in columns], axis=1)

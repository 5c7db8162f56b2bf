"""Linear complementarity problems against hand calculation."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import tangency as tg

BACKENDS = tg.backends()


@pytest.mark.parametrize("backend", BACKENDS)
def test_both_active(backend: Any) -> None:
    """z = −M⁻¹ q, and dz/dq = −M⁻¹."""
    found = tg.solve_lcp([[2, 1], [1, 2]], [-5, -6], backend=backend)
    np.testing.assert_allclose(found.z, [4 / 3, 7 / 3], atol=1e-12)
    np.testing.assert_allclose(found.w, 0, atol=1e-12)
    np.testing.assert_allclose(found.jacobian(), [[-2 / 3, 1 / 3], [1 / 3, -2 / 3]], atol=1e-12)
    assert (found.active, found.weak, found.is_regular) == ([0, 1], [], True)
    assert found.residual < 1e-12


@pytest.mark.parametrize("backend", BACKENDS)
def test_one_active(backend: Any) -> None:
    found = tg.solve_lcp([[2, 1], [1, 2]], [-1, 3], backend=backend)
    np.testing.assert_allclose(found.z, [0.5, 0], atol=1e-12)
    np.testing.assert_allclose(found.w, [0, 3.5], atol=1e-12)
    np.testing.assert_allclose(found.jacobian(), [[-0.5, 0.0], [0.0, 0.0]], atol=1e-12)
    assert found.active == [0]


def test_free_unknowns() -> None:
    """The first unknown may be negative: z₀ = −q₀/2 = −2, and then w₁ = 1 − 2 z₀ … is above zero."""
    found = tg.solve_lcp([[2, 0], [-1, 1]], [4, 1], free=1)
    np.testing.assert_allclose(found.z, [-2, 0], atol=1e-12)
    np.testing.assert_allclose(found.w, [0, 3], atol=1e-12)
    assert found.active == [0]


def test_weak_complementarity_is_told() -> None:
    found = tg.solve_lcp(np.eye(2), [0, -1])
    assert (found.weak, found.active, found.is_regular) == ([0], [1], False)


@pytest.mark.parametrize("backend", BACKENDS)
def test_without_a_solution(backend: Any) -> None:
    with pytest.raises(tg.SolveError):
        tg.solve_lcp([[0.0]], [-1.0], backend=backend)


def test_without_a_derivative() -> None:
    """The two unknowns share one equation: z is not unique."""
    found = tg.solve_lcp([[1, 1], [1, 1]], [-1, -1])
    assert found.z.sum() == pytest.approx(1, abs=1e-9)
    if len(found.active) == 2:
        with pytest.raises(tg.GradientError, match="depend on each other"):
            found.jacobian()


def test_a_random_problem_and_its_derivatives() -> None:
    """A matrix that is not symmetric but positive definite: one solution, differentiable."""
    random = np.random.default_rng(6)
    n = 8
    a, b = random.normal(size=(2, n, n))
    m, q = a @ a.T + np.eye(n) + (b - b.T), random.normal(size=n)
    found = tg.solve_lcp(m, q)
    assert 0 < len(found.active) < n
    np.testing.assert_allclose(found.w, m @ found.z + q, atol=1e-12)
    assert (found.z >= 0).all() and (found.w >= -1e-12).all()
    assert abs(found.z @ found.w) < 1e-12

    bar, dm, dq = random.normal(size=n), random.normal(size=(n, n)), random.normal(size=n)
    m_bar, q_bar = found.vjp(bar)
    dz = found.jvp(dm, dq)
    assert (m_bar * dm).sum() + q_bar @ dq == pytest.approx(bar @ dz, rel=1e-12)
    np.testing.assert_allclose(found.jvp(q=dq), found.jacobian() @ dq, atol=1e-13)
    np.testing.assert_allclose(found.jvp(dm) + found.jvp(q=dq), dz, atol=1e-13)
    h = 1e-6
    plus, minus = (tg.solve_lcp(m + s * dm, q + s * dq).z for s in (h, -h))
    np.testing.assert_allclose((plus - minus) / (2 * h), dz, rtol=1e-6, atol=1e-8)

"""Complementarity problems as functions of JAX."""

import numpy as np
import pytest

import tangency

jax = pytest.importorskip("jax")
import jax.numpy as jnp  # noqa: E402
from jax.test_util import check_grads  # noqa: E402

from tangency.jax import solve_lcp  # noqa: E402

M = np.array([[3.0, 1.0, 0.0], [-1.0, 2.0, 0.5], [0.0, 1.0, 4.0]])
Q = np.array([-2.0, -1.0, 3.0])


@pytest.fixture(autouse=True)
def float64():
    jax.config.update("jax_enable_x64", True)
    yield
    jax.config.update("jax_enable_x64", False)


def test_one_unknown():
    """z = max(0, −q/m)."""
    z = jax.jit(lambda m, q: solve_lcp([[m]], [q])[0])
    for m, q in [(2.0, -3.0), (2.0, 3.0)]:
        np.testing.assert_allclose(z(m, q), max(0.0, -q / m), atol=1e-9)
        active = float(q < 0)
        np.testing.assert_allclose(jax.grad(z, (0, 1))(m, q), [active * q / m**2, -active / m], atol=1e-9)


def test_derivatives_are_those_of_the_numpy_api_and_finite_differences():
    solution = tangency.solve_lcp(M, Q)
    assert np.array_equal(solve_lcp(M, Q), solution.z)
    jacobian = solution.jacobian()
    for way in (jax.jacfwd, jax.jacrev):
        np.testing.assert_allclose(way(solve_lcp, 1)(M, Q), jacobian, atol=1e-14)
    matrix, q = jax.vjp(solve_lcp, M, Q)[1](jnp.array([1.0, 2.0, 3.0]))
    wanted = solution.vjp([1.0, 2.0, 3.0])
    np.testing.assert_allclose(matrix, wanted[0], atol=1e-14)
    np.testing.assert_allclose(q, wanted[1], atol=1e-14)
    check_grads(solve_lcp, (M, Q), order=1, modes=("fwd", "rev"), eps=1e-5, atol=1e-6, rtol=1e-6)


def test_free_unknowns_solve_equations():
    found = solve_lcp(M, Q, free=3)
    np.testing.assert_allclose(found, np.linalg.solve(M, -Q), atol=1e-9)
    jacobian = jax.jacrev(lambda q: solve_lcp(M, q, free=3))(Q)
    np.testing.assert_allclose(jacobian, -np.linalg.inv(M), atol=1e-9)


def test_batches_are_loops():
    constants = Q + 0.1 * np.arange(6.0).reshape(2, 3)
    found = jax.vmap(solve_lcp, (None, 0))(M, constants)
    assert np.array_equal(found, [tangency.solve_lcp(M, q).z for q in constants])
    gradient = jax.jit(jax.vmap(jax.grad(lambda m, q: solve_lcp(m, q)[1]), (None, 0)))(M, constants)
    wanted = [tangency.solve_lcp(M, q).vjp([0.0, 1.0, 0.0])[0] for q in constants]
    np.testing.assert_allclose(gradient, wanted, atol=1e-14)


def test_what_does_not_fit_is_refused():
    with pytest.raises(ValueError, match=r"q has shape \(1, 3\); give \(n,\)"):
        solve_lcp(M, Q[None])
    with pytest.raises(ValueError, match=r"matrix has shape \(2, 3\); give \(n, n\) = \(3, 3\)"):
        solve_lcp(M[:2], Q)
    with pytest.raises(tangency.SolveError):
        solve_lcp([[-1.0]], [-1.0])

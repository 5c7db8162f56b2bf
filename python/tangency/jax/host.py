"""Maps that NumPy computes, with both their derivatives, as functions of JAX.

Two primitives: `value`, which is f, and `linear`, which is its derivative, linear in its second argument and with a
known transpose. So forward mode calls the host's `tangent`, reverse mode its `cotangent`, and nobody forms a Jacobian.
(`pure_callback` inside `custom_vjp` would have no forward mode; `jax.custom_derivatives.linear_call` cannot be
batched.) Where arrays are known the host is called at once, so that its exceptions are what the user sees; where they
are traced, by `pure_callback`.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial
from typing import Any, Union

import jax
import jax.numpy as jnp
import numpy as np
import numpy.typing as npt
from jax.extend.core import Primitive
from jax.interpreters import ad, batching, mlir

from tangency.jax.tapes import Array, HostMap, tape_of

__all__ = ["ArrayLike", "array", "call", "halves", "pack"]

ArrayLike = Union[jax.Array, npt.ArrayLike]


def array(what: str, given: ArrayLike, names: str, shape: tuple[int, ...]) -> jax.Array:
    """What was given as an array of real numbers; refuses another shape than `shape`, whose dimensions are `names`."""
    found = jnp.asarray(given)
    if found.shape != shape:
        wanted = names if shape == () else f"{names} = {shape}"
        raise ValueError(f"{what} has shape {found.shape}; give {wanted}")
    if jnp.issubdtype(found.dtype, jnp.complexfloating):
        raise ValueError(f"{what} is complex; give real numbers")
    return found


@jax.jit
def pack(parts: Sequence[jax.Array]) -> jax.Array:
    """Arrays as one vector of the floating type that holds them all."""
    dtype = jnp.result_type(float, *parts)
    return jnp.concatenate([jnp.zeros(0, dtype), *(part.ravel().astype(dtype) for part in parts)])


@partial(jax.jit, static_argnums=1)
def halves(y: jax.Array, shape: tuple[int, ...]) -> tuple[jax.Array, jax.Array]:
    """The two halves of a vector as arrays of this shape."""
    first, second = jnp.split(y, 2)
    return first.reshape(shape), second.reshape(shape)


def call(host: HostMap, x: jax.Array) -> jax.Array:
    """f(x), (out,), of x, (in,), in the type of x; float64 inside."""
    y: jax.Array = _value.bind(x, host=host)
    return y


def _rows(x: Any) -> Array:
    """An array as vectors of float64, (all leading axes, last axis)."""
    x = np.asarray(x)
    count = int(np.prod(x.shape[:-1]))  # -1 would not do where vectors are empty
    return np.ascontiguousarray(x, np.float64).reshape(count, x.shape[-1])


def _like(x: Any, rows: Array, size: int) -> Any:
    """Rows of length `size` with the leading axes and the type of x."""
    return rows.reshape(*x.shape[:-1], size).astype(x.dtype, copy=False)


# value(x) = f(x). Leading axes are batches.
_value: Any = Primitive("tangency_value")


def _value_on_host(x: Any, *, host: HostMap) -> Any:
    return _like(x, tape_of(host, _rows(x)).value(), host.out)


def _value_abstract(x: Any, *, host: HostMap) -> Any:
    return jax.core.ShapedArray((*x.shape[:-1], host.out), x.dtype)


def _value_jvp(primals: Any, tangents: Any, *, host: HostMap) -> Any:
    (x,), (v,) = primals, tangents
    return _value.bind(x, host=host), _linear.bind(x, v, host=host, transposed=False)


def _value_batch(args: Any, axes: Any, *, host: HostMap) -> Any:
    return _value.bind(jnp.moveaxis(args[0], axes[0], 0), host=host), 0


# linear(x, v) = J(x) v, or J(x)ᵀ v if transposed. Leading axes are batches, in x as long as in v, or 1.
_linear: Any = Primitive("tangency_linear")


def _linear_on_host(x: Any, v: Any, *, host: HostMap, transposed: bool) -> Any:
    points = _rows(x)
    places = np.arange(len(points)).reshape(x.shape[:-1])
    places = np.broadcast_to(places, v.shape[:-1]).ravel()
    tape = tape_of(host, points)
    found = tape.cotangent(places, _rows(v)) if transposed else tape.tangent(places, _rows(v))
    return _like(v, found, found.shape[-1])


def _linear_abstract(x: Any, v: Any, *, host: HostMap, transposed: bool) -> Any:
    size = x.shape[-1] if transposed else host.out
    return jax.core.ShapedArray((*v.shape[:-1], size), v.dtype)


def _linear_jvp(primals: Any, tangents: Any, **params: Any) -> Any:
    (x, v), (dx, dv) = primals, tangents
    if type(dx) is not ad.Zero:
        raise NotImplementedError(
            "tangency.jax has first derivatives only; for second ones take finite differences of gradients"
        )
    return _linear.bind(x, v, **params), _linear.bind(x, dv, **params)


def _linear_transpose(w: Any, x: Any, v: Any, *, host: HostMap, transposed: bool) -> Any:
    if type(w) is ad.Zero:
        return None, ad.Zero(v.aval)
    return None, _linear.bind(x, w, host=host, transposed=not transposed)


def _linear_batch(args: Any, axes: Any, **params: Any) -> Any:
    (x, v), (x_axis, v_axis) = args, axes
    count = x.shape[x_axis] if v_axis is None else v.shape[v_axis]
    x = jnp.expand_dims(x, 0) if x_axis is None else jnp.moveaxis(x, x_axis, 0)
    v = jnp.broadcast_to(v, (count, *v.shape)) if v_axis is None else jnp.moveaxis(v, v_axis, 0)
    return _linear.bind(x, v, **params), 0


def _define(primitive: Any, on_host: Any, abstract: Any) -> None:
    """What a primitive does with arrays that are known, and with traced ones."""

    def known(*arrays: Any, **params: Any) -> Any:
        return jnp.asarray(on_host(*arrays, **params))

    def traced(*arrays: Any, **params: Any) -> Any:
        return jax.pure_callback(partial(on_host, **params), abstract(*arrays, **params), *arrays)

    primitive.def_impl(known)
    primitive.def_abstract_eval(abstract)
    mlir.register_lowering(primitive, mlir.lower_fun(traced, multiple_results=False))


_define(_value, _value_on_host, _value_abstract)
ad.primitive_jvps[_value] = _value_jvp
batching.primitive_batchers[_value] = _value_batch

_define(_linear, _linear_on_host, _linear_abstract)
ad.primitive_jvps[_linear] = _linear_jvp
ad.primitive_transposes[_linear] = _linear_transpose
batching.primitive_batchers[_linear] = _linear_batch

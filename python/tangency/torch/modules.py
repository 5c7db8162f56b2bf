"""Scenes as modules, whose parameters are numbers of the scene."""

from __future__ import annotations

from collections.abc import Sequence

import torch
from torch import Tensor

from tangency._native import Scene
from tangency.torch.layers import rollout
from tangency.backend import Backend

__all__ = ["Rollout"]


class Rollout(torch.nn.Module):
    """Runs of a scene whose numbers are learned.

    Parameters are called as in the scene, with ``/`` for ``.`` (which PyTorch keeps for modules within modules):
    ``"mass:links"``, ``"position/y:ball"``. To keep a number in its range, use
    `torch.nn.utils.parametrize.register_parametrization` with that name.

    Parameters
    ----------
    scene : Scene
        Its numbers are the initial values.
    steps : int, optional
        By default as many as the controls have, or else as the scene's own duration has.
    learn : sequence of str
        Names of numbers of the scene.
    backend, kappa
        As of `rollout`.
    dtype, device : optional
        Of the parameters; by default PyTorch's.

    Raises
    ------
    SceneError
        Where the scene has no such number.

    Examples
    --------
    >>> import tangency, tangency.torch
    >>> scene = tangency.Scene.load("scenes/chain_and_ball.toml")
    >>> chain = tangency.torch.Rollout(scene, 60, learn=["mass:links"])
    >>> [(name, round(mass.item(), 3)) for name, mass in chain.named_parameters()]
    [('mass:links', 0.7)]
    >>> q, v = chain()
    >>> q.shape
    torch.Size([61, 11, 3])
    """

    def __init__(
        self,
        scene: Scene,
        steps: int | None = None,
        learn: Sequence[str] = (),
        *,
        backend: Backend = "ipm",
        kappa: float | None = None,
        dtype: torch.dtype | None = None,
        device: torch.device | str | None = None,
    ) -> None:
        super().__init__()
        if isinstance(learn, str):
            raise TypeError(f"learn is {learn!r}; give a list of names")
        self._scene, self._steps, self._backend, self._kappa = scene, steps, backend, kappa
        self._names = {name: name.replace(".", "/") for name in learn}
        for name, attribute in self._names.items():
            number = torch.tensor(scene.value(name), dtype=dtype or torch.get_default_dtype(), device=device)
            self.register_parameter(attribute, torch.nn.Parameter(number))

    def values(self) -> dict[str, Tensor]:
        """The numbers, by their names in the scene."""
        return {name: getattr(self, attribute) for name, attribute in self._names.items()}

    def forward(
        self, q0: Tensor | None = None, v0: Tensor | None = None, controls: Tensor | None = None
    ) -> tuple[Tensor, Tensor]:
        """Runs the scene with its numbers as they are; all states, as of `rollout`."""
        return rollout(
            self._scene,
            self._steps,
            q0=q0,
            v0=v0,
            controls=controls,
            values=self.values(),
            backend=self._backend,
            kappa=self._kappa,
        )

    def scene(self) -> Scene:
        """The scene with the numbers as they are."""
        return self._scene.with_values({name: value.item() for name, value in self.values().items()})

    def extra_repr(self) -> str:
        """What `repr` tells beside the class."""
        return f"{self._scene!r}, steps={self._steps}, learn={list(self._names)}"

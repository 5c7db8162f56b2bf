"""Tangency in PyTorch: rollouts, steps and complementarity problems as layers of a network.

>>> import torch, tangency, tangency.torch
>>> block = tangency.BodyDef("block", position=(0, 0.1), friction=0.5, shapes=[tangency.Rectangle(0.4, 0.2)])
>>> floor = tangency.BodyDef("floor", "static", friction=0.5, shapes=[tangency.HalfPlane((0, 1))])
>>> scene = tangency.Scene(tangency.SceneDef([block, floor], dt=0.001, duration=1.2))
>>> v0 = torch.zeros(2, 3, dtype=torch.float64, requires_grad=True)
>>> pushed = v0 + torch.tensor([[3.0, 0.0, 0.0], [0.0, 0.0, 0.0]])
>>> q, v = tangency.torch.rollout(scene, v0=pushed)
>>> q[-1, 0, 0].backward()  # where the block stops: v² / (2 μ g), and its derivative v / (μ g)
>>> print(f"{q[-1, 0, 0]:.2f} {v0.grad[0, 0]:.2f}")
0.92 0.61

Everything has exact first derivatives, in reverse and forward mode (`torch.func` too); second ones are refused.
Functions work under `torch.compile` with ``fullgraph=True``, as opaque operators whose derivatives make the run
again; without it, the tape is kept.
"""

from tangency.torch.layers import rollout, solve_lcp, step
from tangency.torch.modules import Rollout

__all__ = ["Rollout", "rollout", "solve_lcp", "step"]

"""Environments for Gymnasium.

Importing this module registers ``Tangency/CartPole-v0``, ``Tangency/Pendulum-v0``, ``Tangency/Acrobot-v0`` and
``Tangency/PushBox-v0``:

>>> import gymnasium
>>> import tangency.gym
>>> env = gymnasium.make("Tangency/CartPole-v0")
>>> observation, info = env.reset(seed=1)
>>> envs = gymnasium.make_vec("Tangency/CartPole-v0", num_envs=64)  # a `VectorEnv`, over all cores

``gymnasium.make("tangency.gym:Tangency/CartPole-v0")`` imports it by itself. Own environments are subclasses of
`SceneEnv`; ``VectorEnv(MyEnv, 64)`` steps many of them side by side.
"""

from __future__ import annotations

import gymnasium

from tangency.gym.acrobot import AcrobotEnv
from tangency.gym.cart_pole import CartPoleEnv
from tangency.gym.pendulum import PendulumEnv
from tangency.gym.push_box import PushBoxEnv
from tangency.gym.scene_env import SceneEnv
from tangency.gym.vector_env import VectorEnv

__all__ = ["AcrobotEnv", "CartPoleEnv", "PendulumEnv", "PushBoxEnv", "SceneEnv", "VectorEnv"]


def _register(name: str, module: str, max_episode_steps: int) -> None:
    if f"Tangency/{name}-v0" not in gymnasium.registry:
        gymnasium.register(
            f"Tangency/{name}-v0",
            entry_point=f"tangency.gym.{module}:{name}Env",
            vector_entry_point=f"tangency.gym.{module}:make_vec",
            max_episode_steps=max_episode_steps,
        )


_register("CartPole", "cart_pole", 500)
_register("Pendulum", "pendulum", 200)
_register("Acrobot", "acrobot", 500)
_register("PushBox", "push_box", 200)

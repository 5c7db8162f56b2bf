"""Environments: Gymnasium's own checks, the equations of motion, and vectors against single environments."""

from __future__ import annotations

import copy
import doctest
import math
import pickle
import runpy
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

gymnasium = pytest.importorskip("gymnasium")

from gymnasium.utils.env_checker import check_env  # noqa: E402

import tangency.gym  # noqa: E402
from tangency import BodyDef, Circle, ControlDef, SceneDef, StepError  # noqa: E402
from tangency.gym import AcrobotEnv, CartPoleEnv, PendulumEnv, PushBoxEnv, SceneEnv, VectorEnv  # noqa: E402
from tangency.gym.scene_env import box  # noqa: E402

ENVS = [CartPoleEnv, PendulumEnv, AcrobotEnv, PushBoxEnv]
NAMES = ["CartPole", "Pendulum", "Acrobot", "PushBox"]

every_env = pytest.mark.parametrize("env_class", ENVS, ids=NAMES)
every_name = pytest.mark.parametrize("name", NAMES)


def cart_pole_acceleration(x, action):
    """ẍ and θ̈ as in ``CartPole-v1`` (Florian 2007, eqs. 23 and 24, without friction)."""
    _, _, angle, rate = x
    mass, pole, half = 1.1, 0.1, 0.5
    across = (10.0 * action + pole * half * rate**2 * math.sin(angle)) / mass
    turn = 9.8 * math.sin(angle) - math.cos(angle) * across
    turn /= half * (4.0 / 3.0 - pole * math.cos(angle) ** 2 / mass)
    return across - pole * half * turn * math.cos(angle) / mass, turn


def pendulum_acceleration(x, action):
    """θ̈ as in ``Pendulum-v1``."""
    return (15.0 * math.sin(x[0]) + 3.0 * 2.0 * action,)


def acrobot_acceleration(x, action):
    """θ̈₁ and θ̈₂ as in ``Acrobot-v1`` (Sutton and Barto, the book's equations)."""
    first, second, rate, bending = x
    mass, length, half, inertia, g = 1.0, 1.0, 0.5, 1.0, 9.8
    d1 = mass * half**2 + mass * (length**2 + half**2 + 2 * length * half * math.cos(second)) + 2 * inertia
    d2 = mass * (half**2 + length * half * math.cos(second)) + inertia
    phi2 = mass * half * g * math.cos(first + second - math.pi / 2)
    phi1 = -mass * length * half * bending**2 * math.sin(second)
    phi1 -= 2 * mass * length * half * bending * rate * math.sin(second)
    phi1 += (mass * half + mass * length) * g * math.cos(first - math.pi / 2) + phi2
    bend = action + d2 / d1 * phi1 - mass * length * half * rate**2 * math.sin(second) - phi2
    bend /= mass * half**2 + inertia - d2**2 / d1
    return -(d2 * bend + phi1) / d1, bend


SYSTEMS = [
    (CartPoleEnv, (0.1, 0.2, 0.15, -0.4), [1, 3], cart_pole_acceleration),
    (CartPoleEnv, (-1.0, -0.5, 2.0, 3.0), [1, 3], cart_pole_acceleration),
    (PendulumEnv, (2.5, -1.5), [1], pendulum_acceleration),
    (AcrobotEnv, (0.7, -1.1, 0.8, 1.7), [2, 3], acrobot_acceleration),
]


@pytest.mark.parametrize(("env_class", "x", "rates", "acceleration"), SYSTEMS)
@pytest.mark.parametrize("action", [0.0, 0.7, -1.0])
def test_accelerations_are_those_of_the_classic_environments(env_class, x, rates, acceleration, action):
    def by_a_step(steps):
        env = env_class(dt=env_class.period / steps, stepping={"accurate": {}})
        env.reset(options={"x": x})
        env.simulator.step(env.controls(np.array([action])))
        change = env.coordinates(env.simulator.q, env.simulator.v) - x
        return change[rates] / env.scene.dt

    extrapolated = 2.0 * by_a_step(1000) - by_a_step(500)
    assert extrapolated == pytest.approx(acceleration(x, action), rel=1e-5, abs=1e-5)


def exactly(acceleration, x, rates, time):
    """Free motion by Runge and Kutta's method in small steps; positions come before their rates."""
    places = [place for place in range(len(x)) if place not in rates]

    def slope(x):
        change = np.zeros(len(x))
        change[places] = x[rates]
        change[rates] = acceleration(x, 0.0)
        return change

    x, h = np.array(x), time / 2000
    for _ in range(2000):
        k1 = slope(x)
        k2 = slope(x + 0.5 * h * k1)
        k3 = slope(x + 0.5 * h * k2)
        x = x + h / 6 * (k1 + 2 * k2 + 2 * k3 + slope(x + h * k3))
    return x


@pytest.mark.parametrize(("env_class", "x", "rates", "acceleration"), SYSTEMS)
def test_accurate_free_motion_is_that_of_the_equations(env_class, x, rates, acceleration):
    env = env_class(dt=env_class.period / 20, stepping={"accurate": {}})
    env.reset(options={"x": x})
    actions = round(0.4 / env.period)
    for _ in range(actions):
        env.step([0.0])
    found = env.coordinates(env.simulator.q, env.simulator.v)
    assert found == pytest.approx(exactly(acceleration, x, rates, 0.4), rel=0, abs=1e-6)


@pytest.mark.parametrize(("env_class", "x", "rates", "acceleration"), SYSTEMS)
def test_default_steps_are_of_first_order(env_class, x, rates, acceleration):
    def off(dt):
        env = env_class(dt=dt)
        env.reset(options={"x": x})
        env.step([0.0])
        end = exactly(acceleration, x, rates, env.period)
        return np.linalg.norm(env.coordinates(env.simulator.q, env.simulator.v) - end)

    dt = env_class.default_dt
    assert 1.8 < off(dt) / off(dt / 2) < 2.2


def test_pendulum_rewards_are_those_of_the_classic_one():
    env = PendulumEnv()
    env.reset(options={"x": (3 * math.pi / 2, 2.0)})
    _, reward, *_ = env.step([0.5])
    assert reward == pytest.approx(-((math.pi / 2) ** 2 + 0.1 * 4.0 + 0.001 * 1.0), rel=1e-12)


def test_rates_are_limited():
    env = PendulumEnv()
    env.reset(options={"x": (math.pi / 2, 8.0)})
    observation, *_ = env.step([1.0])
    assert observation[2] == 8.0
    assert env.state.v[0, 2] == 8.0
    for _ in range(40):
        observation, *_ = env.step([1.0])
        assert env.observation_space.contains(observation)


def test_episodes_end():
    env = CartPoleEnv()
    inside, outside = [(2.39, 0, 0, 0), (0, 0, 0.2, 0)], [(2.41, 0, 0, 0), (0, 0, -0.22, 0)]
    for x, over in [(x, False) for x in inside] + [(x, True) for x in outside]:
        env.reset(options={"x": x})
        assert env.step([0.0])[2] is over
    acrobot = AcrobotEnv()
    for x, over, reward in [((math.pi, 0, 0, 0), True, 0.0), ((0, 0, 0, 0), False, -1.0)]:
        acrobot.reset(options={"x": x})
        assert acrobot.step([0.0])[1:3] == (reward, over)


def test_a_box_slides_as_friction_lets_it():
    """v²/(2 μ g) from where it is let go; the finger stays behind."""
    env = PushBoxEnv(dt=0.001)
    env.reset(options={"x": (-0.6, 0.0, 0.0, 1.5, 3.0)})
    for _ in range(25):
        env.step([0.0])
    assert env.state.q[3, 0] == pytest.approx(1.5**2 / (2 * 0.3 * 9.81), abs=1e-3)
    assert env.state.v[3, 0] == pytest.approx(0.0, abs=1e-9)


def test_a_finger_pushes_the_box_home():
    env = PushBoxEnv()
    x, _ = env.reset(seed=3)
    rewards = []
    for _ in range(200):
        finger, finger_speed, place, speed, goal = x
        # Brake so that friction stops the box at the goal: its speed there is √(2 μ g left).
        wanted = min(0.5, 0.8 * math.sqrt(2 * 0.3 * 9.81 * max(goal - place - 0.01, 0.0)))
        x, reward, terminated, _, _ = env.step([4.0 * (wanted - finger_speed) + (0.3 if wanted > 0.1 else 0.0)])
        rewards.append(reward)
        if terminated:
            break
    assert terminated
    assert abs(x[4] - x[2]) < 0.02
    assert rewards == sorted(rewards)


@every_name
def test_gymnasium_finds_nothing_wrong(name):
    env = gymnasium.make(f"Tangency/{name}-v0", render_mode="rgb_array")
    check_env(env.unwrapped)
    assert gymnasium.spec(f"Tangency/{name}-v0").max_episode_steps == {"Pendulum": 200, "PushBox": 200}.get(name, 500)
    assert type(env.unwrapped) is ENVS[NAMES.index(name)]


def test_names_import_the_module_by_themselves():
    script = "import gymnasium; print(gymnasium.make('tangency.gym:Tangency/PushBox-v0').unwrapped)"
    found = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, check=True)
    assert "PushBoxEnv" in found.stdout


def test_the_documentation_is_right():
    assert doctest.testmod(tangency.gym).failed == 0


def test_the_example_balances(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    example = Path(__file__).parents[2] / "examples" / "python" / "balance.py"
    runpy.run_path(str(example), run_name="__main__")
    time, place, angle, _ = map(float, capsys.readouterr().out.splitlines()[10].split())
    assert time == 4.5
    assert abs(place) < 0.05
    assert abs(angle) < 1.0


@every_env
def test_pictures_have_their_size_and_move(env_class):
    env = env_class(render_mode="rgb_array")
    env.reset(seed=0)
    width, height = env.frame_size
    before = env.render()
    assert before.dtype == np.uint8
    assert before.shape == (height, width, 3)
    assert tuple(before[0, 0]) == (255, 255, 255)
    for _ in range(20):
        env.step([1.0])
    assert (env.render() != before).any()


@every_env
def test_runs_are_reproducible_and_copies_go_on_alike(env_class):
    def run(env, steps):
        return [env.step([math.sin(k)])[:3] for k in range(steps)]

    def same(a, b):
        return all(np.array_equal(x[0], y[0]) and x[1:] == y[1:] for x, y in zip(a, b, strict=True))

    env, other = env_class(), env_class()
    env.reset(seed=11), other.reset(seed=11)
    assert same(run(env, 20), run(other, 20))
    copies = [copy.deepcopy(env), pickle.loads(pickle.dumps(env))]
    going_on = run(env, 20)
    start = env.reset()[0]
    for twin in copies:
        assert same(run(twin, 20), going_on)
        assert np.array_equal(twin.reset()[0], start)


@every_name
def test_a_vector_does_what_single_environments_do(name):
    """Bit by bit, through ends of episodes."""
    options = {"num_envs": 6, "max_episode_steps": 40}
    vector = gymnasium.make_vec(f"Tangency/{name}-v0", vectorization_mode="vector_entry_point", **options)
    single = gymnasium.make_vec(f"Tangency/{name}-v0", vectorization_mode="sync", **options)
    assert isinstance(vector, VectorEnv)
    assert vector.metadata["autoreset_mode"] is gymnasium.vector.AutoresetMode.NEXT_STEP
    assert vector.observation_space == single.observation_space
    assert vector.action_space == single.action_space
    assert np.array_equal(vector.reset(seed=7)[0], single.reset(seed=7)[0])
    generator = np.random.default_rng(2)
    ended = 0
    for _ in range(130):
        actions = generator.uniform(-1.0, 1.0, (6, 1)).astype(np.float32)
        found, expected = vector.step(actions)[:4], single.step(actions)[:4]
        for a, b in zip(found, expected, strict=True):
            assert a.dtype == b.dtype
            assert np.array_equal(a, b)
        ended += int(np.sum(found[2] | found[3]))
    assert ended >= 18
    assert vector.np_random_seed == single.np_random_seed
    vector.close(), single.close()


def test_vectors_take_seeds_options_and_refuse_what_does_not_fit():
    envs = VectorEnv(CartPoleEnv, 3, render_mode="rgb_array", values={"mass:pole": 0.3})
    assert envs.single.scene.value("mass:pole") == 0.3
    first, _ = envs.reset(seed=[4, 5, 6])
    assert np.array_equal(first[1], CartPoleEnv().reset(seed=5)[0])
    placed, _ = envs.reset(options={"x": (0.5, 0.0, 0.1, 0.0)})
    assert np.allclose(placed, [[0.5, 0.0, 0.1, 0.0]] * 3)
    assert [picture.shape for picture in envs.render()] == [(400, 600, 3)] * 3
    with pytest.raises(ValueError, match=r"2 seeds; give 3"):
        envs.reset(seed=[1, 2])
    with pytest.raises(ValueError, match=r"action has shape \(3,\); give \(3, 1\)"):
        envs.step(np.zeros(3))
    with pytest.raises(ValueError, match="num_envs is 0"):
        VectorEnv(CartPoleEnv, 0)


def test_copies_of_vectors_go_on_alike():
    envs = VectorEnv(PendulumEnv, 4, max_episode_steps=12)
    envs.reset(seed=1)
    for _ in range(10):
        envs.step(np.ones((4, 1)))
    twins = [copy.deepcopy(envs), pickle.loads(pickle.dumps(envs))]
    for _ in range(10):
        found = envs.step(-np.ones((4, 1)))
        for twin in twins:
            for a, b in zip(found[:4], twin.step(-np.ones((4, 1)))[:4], strict=True):
                assert np.allclose(a, b, rtol=0, atol=1e-12)


def test_wrong_input_is_refused():
    env = CartPoleEnv()
    env.reset()
    with pytest.raises(ValueError, match=r"action has shape \(2,\); give \(1,\)"):
        env.step([0.0, 1.0])
    with pytest.raises(StepError):
        env.step([math.nan])
    with pytest.raises(ValueError, match="unknown options"):
        env.reset(options={"y": 1.0})
    with pytest.raises(ValueError, match=r'option "x" has shape \(3,\); give \(4,\)'):
        env.reset(options={"x": (0.0, 0.0, 0.0)})
    with pytest.raises(ValueError, match='"low" .* is above "high"'):
        env.reset(options={"low": 0.1})
    with pytest.raises(ValueError, match="divides the 0.02 s"):
        CartPoleEnv(dt=0.015)
    with pytest.raises(ValueError, match="render_mode is 'human'"):
        CartPoleEnv(render_mode="human")
    with pytest.raises(TypeError, match="colour"):
        CartPoleEnv(colour="red")


def test_bounds_of_the_start_may_be_given():
    env = CartPoleEnv()
    starts = [env.reset(seed=k, options={"low": 0.1, "high": (0.1, 0.2, 0.3, 0.1)})[0] for k in range(20)]
    low, high = np.min(starts, axis=0), np.max(starts, axis=0)
    assert (low >= np.float32(0.1)).all()
    assert high[0] == high[3] == np.float32(0.1)
    assert 0.15 < high[1] <= 0.2 < high[2] <= 0.3


class Falling(SceneEnv):
    """What a user would write: a ball that a force holds up."""

    period, default_dt = 0.1, 0.01
    start = ((1.0, 0.0), (1.0, 0.0))
    view = (-1.0, 1.0, 0.0, 2.0)

    def __init__(self, **options):
        super().__init__(**options)
        self.action_space, self.observation_space = box(1.0), box(10.0, 10.0)

    @classmethod
    def definition(cls):
        ball = BodyDef("ball", position=(0.0, 1.0), mass=1.0, shapes=[Circle(0.1)])
        return SceneDef([ball], controls=[ControlDef("lift", "force_y", "ball")])

    def place(self, x):
        zero = np.zeros_like(x[..., 0])
        part = [np.stack([zero, x[..., k], zero], axis=-1)[..., None, :] for k in (0, 1)]
        return part[0], part[1]

    def coordinates(self, q, v):
        return np.stack([q[..., 0, 1], v[..., 0, 1]], axis=-1)

    def controls(self, action):
        return 9.81 * (1.0 + action)

    def observe(self, x):
        return x

    def reward(self, x, action, after, terminated):
        return after[..., 0]


def test_own_environments_work_alone_and_side_by_side():
    env, envs = Falling(), VectorEnv(Falling, 2)
    env.reset(), envs.reset()
    assert env.step([0.0])[1] == pytest.approx(1.0, abs=1e-12)
    rewards = envs.step(np.array([[0.0], [-1.0]]))[1]
    assert rewards == pytest.approx([1.0, 1.0 - 9.81 * 0.01 * 0.1 * 11 / 2], abs=1e-12)
    assert not envs.step(np.zeros((2, 1)))[2].any()

"""A cart balances a pole by the gains of a linear-quadratic regulator.

The planner linearises the scene about the upright pole; far from the end of its horizon its gains are
those of the regulator. They bring the cart home from 1 m away with the pole leaning 6°, and hold it there
against pushes at random.
Writes balance.png, a strip of pictures, and balance.gif (needs Pillow).
"""

import numpy as np

import tangency
from tangency.gym import CartPoleEnv
from tangency.gym.cart_pole import MAX_FORCE

STEPS = 250


def regulator(env: CartPoleEnv) -> tangency.Plan:
    """Gains that hold the cart at 0 and the pole upright."""
    upright = tangency.State(*env.place(np.zeros(4)))
    states = len(env.scene.coordinates())  # (x, y, angle) of cart and pole, then their velocities
    cost = tangency.Quadratic.of_effort(states, 1, effort=0.03)
    cart, pole_angle = 0, 5
    cost.aim(cart, 0.0, running=1.0, last=1.0)
    cost.aim(pole_angle, 0.0, running=10.0, last=10.0)
    return tangency.plan(env.scene, cost, np.zeros((300, 1)), state=upright)


def main() -> None:
    env = CartPoleEnv(dt=0.02, render_mode="rgb_array")
    plan = regulator(env)
    generator = np.random.default_rng(1)
    observation, _ = env.reset(options={"x": (1.0, 0.0, np.radians(-6.0), 0.0)})
    frames = []
    print("  t, s    x, m   θ, deg   push, N")
    for k in range(STEPS):
        force = plan.feedback(0, env.scene.coordinates(env.state))
        if k % 25 == 0:
            x, _, angle, _ = observation
            print(f"{k * env.period:6.2f} {x:7.3f} {np.degrees(angle):8.3f} {force[0]:9.3f}")
        frames.append(env.render())
        push = force + generator.normal(0.0, 0.5)
        observation, _, fallen, _, _ = env.step(push / MAX_FORCE)
        assert not fallen
    save(frames)


def save(frames: list) -> None:
    try:
        from PIL import Image
    except ModuleNotFoundError:
        print("no pictures: Pillow is not installed")
        return
    images = [Image.fromarray(frame) for frame in frames]
    Image.fromarray(np.hstack(frames[:: STEPS // 5])).save("balance.png")
    images[0].save("balance.gif", save_all=True, append_images=images[2::2], duration=40, loop=0)


if __name__ == "__main__":
    main()

"""How must a ball be thrown to be at a place in the air after it has bounced?

Gradient descent with `jax.grad` through the bounce; prints what it found beside the closed form.
"""

import jax
import jax.numpy as jnp

import tangency
import tangency.jax

jax.config.update("jax_enable_x64", True)

RADIUS, RESTITUTION, G = 0.1, 0.8, 9.81
START, GOAL, TIME = jnp.array([0.0, 1.1]), jnp.array([3.0, 0.7]), 1.0


def throw_scene() -> tangency.Scene:
    """A ball above a floor, in steps that find the impact."""
    floor = tangency.BodyDef("floor", "static", shapes=[tangency.HalfPlane((0, 1))])
    ball = tangency.BodyDef("ball", position=START.tolist(), shapes=[tangency.Circle(RADIUS)])
    pair = tangency.PairDef(("floor", "ball"), friction=0.0, restitution=RESTITUTION)
    definition = tangency.SceneDef([floor, ball], pairs=[pair], dt=0.01, duration=TIME, gravity=(0, -G))
    definition.stepping = {"accurate": {}}
    return tangency.Scene(definition)


def place(scene: tangency.Scene, velocity: jax.Array) -> jax.Array:
    """Where the ball is at the end, m."""
    values = {"velocity.x:ball": velocity[0], "velocity.y:ball": velocity[1]}
    q, _ = tangency.jax.rollout(scene, values=values)
    return q[-1, scene.body("ball"), :2]


def closed_form(velocity: jax.Array) -> jax.Array:
    """The same: down to the floor, and up again with the part of the speed that restitution leaves."""
    impact = jnp.sqrt(velocity[1] ** 2 + 2 * G * (START[1] - RADIUS))
    rest = TIME - (velocity[1] + impact) / G
    return jnp.array([START[0] + velocity[0] * TIME, RADIUS + RESTITUTION * impact * rest - G * rest**2 / 2])


def descend(scene: tangency.Scene, velocity: jax.Array, rate: float = 0.5, steps: int = 90) -> jax.Array:
    """Follows the gradient of the squared distance, with momentum; prints every tenth step."""
    change = jnp.zeros(2)
    loss = jax.jit(jax.value_and_grad(lambda velocity: jnp.sum((place(scene, velocity) - GOAL) ** 2)))
    for k in range(steps + 1):
        value, gradient = loss(velocity)
        if k % 10 == 0:
            print(f"{k:3}: thrown at ({velocity[0]:.6f}, {velocity[1]:.6f}) m/s: {value**0.5:.1e} m from the goal")
        change = 0.7 * change - rate * gradient
        velocity = velocity + change
    return velocity


if __name__ == "__main__":
    scene = throw_scene()
    found = descend(scene, jnp.array([1.0, 0.0]))
    print(f"simulated   {place(scene, found)} m\nclosed form {closed_form(found)} m\ngoal        {GOAL} m")
    assert jnp.allclose(closed_form(found), GOAL, atol=1e-6)

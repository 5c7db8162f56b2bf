"""A box slides into a wall and back: where it ends, over friction and restitution; and fits, from many guesses.

Tasks of Ray on this machine's cores; scenes and runs go to the workers as they are (they pickle to plain bytes).
"""

import numpy as np
import ray

import tangency

WIDTH, SPEED, TO_WALL, G = 0.4, 4.0, 1.0, 9.81
NAMES = ("friction:*", "restitution:elastic")


def wall_scene() -> tangency.Scene:
    """A box on a floor, on its way to a wall at x = 0."""
    half, elastic = WIDTH / 2, ["elastic"]
    floor = tangency.BodyDef("floor", "static", shapes=[tangency.HalfPlane((0, 1))])
    wall = tangency.BodyDef("wall", "static", shapes=[tangency.HalfPlane((-1, 0))], groups=elastic)
    box = tangency.BodyDef("box", shapes=[tangency.Rectangle(WIDTH, WIDTH)], groups=elastic)
    box.position, box.velocity = (-TO_WALL - half, half), (SPEED, 0)
    smooth = tangency.PairDef(("wall", "box"), friction=0.0)
    return tangency.Scene(
        tangency.SceneDef(
            [floor, wall, box], pairs=[smooth], dt=0.01, duration=6, gravity=(0, -G), stepping={"accurate": {}}
        )
    )


def closed_form(friction: np.ndarray, restitution: np.ndarray) -> np.ndarray:
    """Where the box ends, m, if it comes to the wall: what friction leaves of v² is e² times as much after it."""
    return -WIDTH / 2 - restitution**2 * (SPEED**2 / (2 * friction * G) - TO_WALL)


def ends(scene: tangency.Scene, friction: float, restitutions: np.ndarray) -> np.ndarray:
    """Where the box ends, m, for one friction and many restitutions: one batch."""
    batch = tangency.Batch(scene, len(restitutions))
    for name, values in zip(NAMES, (friction, restitutions)):
        batch.set(name, values)
    batch.reset()
    return batch.rollout().q[:, -1, scene.body("box"), 0]


def watched(scene: tangency.Scene, point: np.ndarray) -> tangency.Rollout:
    """A run with this friction and restitution."""
    return tangency.rollout(scene.with_values(dict(zip(NAMES, point))))


def fit(scene: tangency.Scene, seen: np.ndarray, guess: np.ndarray, rounds: int = 12) -> tuple[float, np.ndarray]:
    """Friction and restitution that explain where the box was, by damped Gauss-Newton; and how badly, m."""

    def miss(point: np.ndarray) -> tuple[tangency.Rollout, np.ndarray]:
        run = watched(scene, point)
        return run, run.q[:, scene.body("box"), 0] - seen

    run, error = miss(guess)
    for _ in range(rounds):
        columns = [run.tangent(values={name: 1.0})[0][:, scene.body("box"), 0] for name in NAMES]
        change = np.linalg.lstsq(np.stack(columns, axis=1), -error)[0]
        for scale in 0.5 ** np.arange(8):
            point = np.clip(guess + scale * change, 0.02, 0.98)
            trial, missed = miss(point)
            if missed @ missed < error @ error:
                guess, run, error = point, trial, missed
                break
    return float(np.abs(error).max()), guess


def sweep(scene: tangency.Scene, frictions: np.ndarray, restitutions: np.ndarray) -> np.ndarray:
    """`ends` for all frictions, (frictions, restitutions): a task each."""
    shared, task = ray.put(scene), ray.remote(ends)
    return np.stack(ray.get([task.remote(shared, friction, restitutions) for friction in frictions]))


def fits(scene: tangency.Scene, seen: np.ndarray, guesses: np.ndarray) -> list[tuple[float, np.ndarray]]:
    """`fit` from all guesses, the best one first: a task each."""
    shared, task = ray.put(scene), ray.remote(fit)
    return sorted(ray.get([task.remote(shared, seen, guess) for guess in guesses]), key=lambda found: found[0])


def main() -> None:
    # One core per task: within a task, batches take one thread.
    ray.init(num_cpus=2, include_dashboard=False, runtime_env={"env_vars": {"RAYON_NUM_THREADS": "1"}})
    scene, frictions, restitutions = wall_scene(), np.linspace(0.1, 0.5, 5), np.linspace(0.0, 1.0, 6)
    table = sweep(scene, frictions, restitutions)
    print("where the box ends, m\nfriction" + "".join(f"   e = {e:.1f}" for e in restitutions))
    for friction, row in zip(frictions, table):
        print(f"{friction:8.1f}" + "".join(f"{x:10.4f}" for x in row))
    exact = closed_form(frictions[:, None], restitutions)
    print(f"largest distance from the closed form: {np.abs(table - exact).max():.1e} m\n")

    seen = watched(scene, np.array([0.3, 0.7])).q[:, scene.body("box"), 0]
    for error, (friction, restitution) in fits(scene, seen, np.random.default_rng(0).uniform(0.1, 0.9, (8, 2))):
        print(f"friction {friction:.6f}, restitution {restitution:.6f}: off by up to {error:.1e} m")
    ray.shutdown()


if __name__ == "__main__":
    main()

"""The scenes of the race for engines with Python bindings: reading, timing, errors, and the CSV.

`tangency bench --export race.json` writes the scenes. An engine's script gives `race` a function that
builds a world from a `Heat`; a world has `run(steps)` and `poses()`, the (x, y, angle) of every body's
centre of mass in the definition's order, and may have `value_and_gradient(steps)`, whose `gradient_note` says
what the gradient is by.
"""

import argparse
import csv
import json
import math
import statistics
import time
from dataclasses import dataclass

COLUMNS = [
    "engine", "scene", "dt", "steps", "us_per_step", "us_lower", "us_upper", "us_least", "penetration",
    "drift", "residual", "factorisations", "iterations", "gradient", "gradient_us", "note",
]


@dataclass
class Body:
    """A body with one shape at most: ("circle", r), ("rectangle", w, h), ("half_plane",) or None."""

    name: str
    dynamic: bool
    position: tuple
    angle: float
    velocity: tuple
    rate: float
    mass: float
    inertia: float
    friction: float
    restitution: float
    shape: tuple | None


@dataclass
class Joint:
    """A hinge at a world point, or a rail through it along an axis. `a` is None for the world."""

    kind: str
    a: int | None
    b: int
    anchor: tuple
    axis: tuple | None


class Heat:
    """A scene with its time step and number of steps."""

    def __init__(self, entry):
        self.scene, self.dt, self.steps = entry["scene"], entry["dt"], entry["steps"]
        self.gradient_steps = entry["gradient_steps"]
        definition = entry["definition"]
        self.gravity = tuple(definition["gravity"])
        self.bodies = [_body(body) for body in definition["bodies"]]
        names = {body.name: index for index, body in enumerate(self.bodies)}
        self.joints = [_joint(joint, names) for joint in definition["joints"]]

    @property
    def touches(self):
        """Whether anything can touch."""
        return any(body.shape for body in self.bodies)

    def last(self, size):
        """Which of an engine's `size` coordinates is the last body's x, or its joint's."""
        return size - (3 if self.touches else 1)


def _body(given):
    shape, mass, inertia = None, given["mass"], given["inertia"]
    for kind, numbers in (given["shapes"][0].items() if given["shapes"] else ()):
        if kind == "circle":
            shape = ("circle", numbers["radius"])
            inertia = inertia or 0.5 * (mass or 0.0) * numbers["radius"] ** 2
        elif kind == "rectangle":
            width, height = numbers["width"], numbers["height"]
            shape = ("rectangle", width, height)
            inertia = inertia or (mass or 0.0) * (width**2 + height**2) / 12
        else:
            assert kind == "half_plane" and numbers["normal"] == [0.0, 1.0] and numbers["offset"] == 0.0
            shape = ("half_plane",)
    return Body(
        given["name"], given["kind"] == "dynamic", tuple(given["position"]), given["angle"],
        tuple(given["velocity"]), given["angular_velocity"], mass, inertia, given["friction"],
        given["restitution"], shape,
    )


def _joint(given, names):
    (kind, numbers), = given["kind"].items()
    assert kind in ("revolute", "prismatic"), kind
    a, b = (names.get(name) for name in given["bodies"])
    return Joint(kind, a, b, tuple(numbers["anchor"]), numbers.get("axis"))


def _place(pose, point):
    """The world point of a point in a body's frame."""
    x, y, angle = pose
    c, s = math.cos(angle), math.sin(angle)
    return x + c * point[0] - s * point[1], y + s * point[0] + c * point[1]


def _local(pose, point):
    x, y, angle = pose
    c, s = math.cos(angle), math.sin(angle)
    dx, dy = point[0] - x, point[1] - y
    return c * dx + s * dy, c * dy - s * dx


def drift(heat, poses):
    """The largest error of a joint's point, m; of a rail, across it, and its angle, rad."""
    start = [(*body.position, body.angle) for body in heat.bodies]
    worst = 0.0
    for joint in heat.joints:
        end = _place(poses[joint.b], _local(start[joint.b], joint.anchor))
        origin = joint.anchor
        if joint.a is not None:
            origin = _place(poses[joint.a], _local(start[joint.a], joint.anchor))
        gap = (end[0] - origin[0], end[1] - origin[1])
        if joint.kind == "revolute":
            worst = max(worst, abs(gap[0]), abs(gap[1]))
        else:  # on the world
            across = gap[1] * joint.axis[0] - gap[0] * joint.axis[1]
            worst = max(worst, abs(across), abs(poses[joint.b][2] - start[joint.b][2]))
    return worst


def _corners(pose, shape):
    half = 0.5 * shape[1], 0.5 * shape[2]
    signs = ((-1, -1), (1, -1), (1, 1), (-1, 1))
    return [_place(pose, (half[0] * i, half[1] * j)) for i, j in signs]


def _overlap(a, b):
    """How deep two convex polygons overlap, along the axis of least overlap; negative apart."""
    least = math.inf
    for polygon in (a, b):
        for (x0, y0), (x1, y1) in zip(polygon[:2], polygon[1:3]):
            nx, ny = y1 - y0, x0 - x1
            length = math.hypot(nx, ny)
            one = [(x * nx + y * ny) / length for x, y in a]
            two = [(x * nx + y * ny) / length for x, y in b]
            least = min(least, max(one) - min(two), max(two) - min(one))
            if least < 0.0:
                return least
    return least


def penetration(heat, poses):
    """The deepest penetration of discs and rectangles into the floor, and of rectangles, m."""
    worst, boxes = 0.0, []
    for body, pose in zip(heat.bodies, poses):
        if body.shape and body.shape[0] == "circle":
            worst = max(worst, body.shape[1] - pose[1])
        elif body.shape and body.shape[0] == "rectangle":
            corners = _corners(pose, body.shape)
            worst = max(worst, -min(y for _, y in corners))
            boxes.append((corners, pose, math.hypot(*body.shape[1:])))
    for k, (a, at, reach) in enumerate(boxes):
        for b, other, _ in boxes[k + 1:]:
            if math.hypot(at[0] - other[0], at[1] - other[1]) < reach:
                worst = max(worst, _overlap(a, b))
    return worst


def _timed(work):
    start = time.perf_counter()
    work()
    return time.perf_counter() - start


def _samples(build, steps, options):
    """Times per step of several rounds; building does not count, short runs are repeated."""
    times = []
    for _ in range(options.rounds):
        total, repeats = 0.0, 0
        while repeats == 0 or total < options.sample:
            world = build()
            total += _timed(lambda: world.run(steps))
            repeats += 1
        times.append(total / repeats / steps)
    return times


def _measure(name, heat, build, options):
    row = dict.fromkeys(COLUMNS, "")
    row.update(engine=name, scene=heat.scene, dt=heat.dt)
    make = lambda: build(heat)
    world, steps, spent = make(), 0, 0.0
    pen, joint = 0.0, 0.0
    world.run(1)  # compiles, where that is needed
    world = make()
    while steps < heat.steps and spent < options.cap:
        spent += _timed(lambda: world.run(5))
        steps += 5
        poses = world.poses()
        if not all(math.isfinite(number) for pose in poses for number in pose):
            row["note"] = f"not finite after {steps} steps"
            return row
        pen, joint = max(pen, penetration(heat, poses)), max(joint, drift(heat, poses))
    if hasattr(world, "prepare"):
        world.prepare(steps)
    times = _samples(make, steps, options)
    quartiles = statistics.quantiles(times, n=4, method="inclusive") if len(times) > 1 else times * 3
    micro = [1e6 * seconds for seconds in (quartiles[1], quartiles[0], quartiles[2], min(times))]
    row.update(zip(COLUMNS[4:8], micro))
    row.update(steps=steps, penetration=pen, drift=joint)
    if heat.gradient_steps:
        row.update(_gradient(make, heat.gradient_steps, options))
    return row


def _gradient(make, steps, options):
    world = make()
    if not hasattr(world, "value_and_gradient"):
        return {"note": "no gradient"}
    try:
        if hasattr(world, "prepare"):
            world.prepare(steps)
        world.value_and_gradient(steps)
    except Exception as refusal:  # whatever the engine raises
        return {"note": f"gradient refused: {refusal}".splitlines()[0][:120]}
    value = min(_samples(make, steps, options)) * steps
    both = min(_timed(lambda w=make(): w.value_and_gradient(steps)) for _ in range(3))
    return {"gradient": both / value, "gradient_us": 1e6 * both, "note": world.gradient_note}


def race(engines):
    """Runs engines, a list of (name, build, accepts), on the exported scenes; writes a CSV file."""
    parser = argparse.ArgumentParser()
    parser.add_argument("scenes", help="written by `tangency bench --export`")
    # Not to stdout: some libraries print there while they are imported.
    parser.add_argument("out", help="the CSV file to write")
    parser.add_argument("--rounds", type=int, default=7)
    parser.add_argument("--sample", type=float, default=0.02, help="shortest sample, s")
    parser.add_argument("--cap", type=float, default=1.0, help="longest run, s")
    options = parser.parse_args()
    with open(options.scenes, encoding="utf-8") as file:
        heats = [Heat(entry) for entry in json.load(file)]
    with open(options.out, "w", encoding="utf-8", newline="") as file:
        writer = csv.DictWriter(file, COLUMNS)
        writer.writeheader()
        for heat in heats:
            for name, build, accepts in engines:
                if accepts(heat):
                    writer.writerow(_measure(name, heat, build, options))
                    file.flush()


def anything(_heat):
    """Accepts every scene."""
    return True

"""Differentiable physics of rigid bodies in the plane.

>>> import tangency
>>> ball = tangency.BodyDef("ball", position=(0, 1), shapes=[tangency.Circle(0.1)], restitution=0.5)
>>> floor = tangency.BodyDef("floor", "static", shapes=[tangency.HalfPlane((0, 1))], restitution=0.5)
>>> scene = tangency.Scene(tangency.SceneDef([ball, floor], dt=0.005, stepping={"accurate": {}}))
>>> run = tangency.rollout(scene, steps=150)
>>> height = run.q[-1, scene.body("ball"), 1]
>>> gradient = run.gradient(q=[[0, 1, 0], [0, 0, 0]])  # of the height at the end
>>> print(f"{height:.6f} {gradient['position.y:ball']:.6f}")
0.268348 0.626339

Arrays are float64 and in SI units; poses are (x, y, angle), angles counter-clockwise in radians. Work is done
without the interpreter's lock, and that of batches over all cores (`RAYON_NUM_THREADS` says how many).
"""

from tangency._native import (
    Batch,
    Gradient,
    GradientBatch,
    GradientError,
    GradientReport,
    Impulse,
    LcpSolution,
    Plan,
    PlanError,
    Rollout,
    Rollouts,
    Scene,
    SceneError,
    Simulator,
    SolveError,
    StepError,
    StepJacobian,
    backends,
    plan,
    rollout,
    solve_lcp,
)
from tangency.control import Quadratic
from tangency.definitions import (
    BodyDef,
    Capsule,
    Circle,
    ControlDef,
    Distance,
    ForceDef,
    HalfPlane,
    JointDef,
    Limits,
    Lock,
    Motor,
    PairDef,
    Polygon,
    Prismatic,
    Rectangle,
    Revolute,
    SceneDef,
    Slot,
    Softness,
    Spring,
    Weld,
)
from tangency.state import State

__all__ = [
    "Batch",
    "BodyDef",
    "Capsule",
    "Circle",
    "ControlDef",
    "Distance",
    "ForceDef",
    "Gradient",
    "GradientBatch",
    "GradientError",
    "GradientReport",
    "HalfPlane",
    "Impulse",
    "JointDef",
    "LcpSolution",
    "Limits",
    "Lock",
    "Motor",
    "PairDef",
    "Plan",
    "PlanError",
    "Polygon",
    "Prismatic",
    "Quadratic",
    "Rectangle",
    "Revolute",
    "Rollout",
    "Rollouts",
    "Scene",
    "SceneDef",
    "SceneError",
    "Simulator",
    "Slot",
    "Softness",
    "SolveError",
    "Spring",
    "State",
    "StepError",
    "StepJacobian",
    "Weld",
    "backends",
    "plan",
    "rollout",
    "solve_lcp",
]

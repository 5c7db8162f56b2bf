"""A scene as a model of MuJoCo, in the plane y = 0: our (x, y) is its (x, z), counter-clockwise about −y.

Free bodies have two slides and a hinge; jointed bodies hang in a tree of hinges and slides, so that joints
hold exactly. Discs are spheres, boxes are 1 m deep, the floor is a plane. There is no coefficient of
restitution: contacts are the softest springs and dampers that the default `solref` makes, and e = 0.
"""

import math

import mujoco


def model(heat, options="", geoms=""):
    """The XML of a scene."""
    children, holding = {}, {joint.b: joint for joint in heat.joints}
    for index, body in enumerate(heat.bodies):
        if body.dynamic:
            parent = holding[index].a if index in holding else None
            children.setdefault(parent, []).append(index)
    parts = []
    if any(not body.dynamic for body in heat.bodies):
        floor = next(body for body in heat.bodies if not body.dynamic)
        parts.append(
            f'<geom type="plane" size="1000 1000 1" friction="{floor.friction} 0 0" condim="3" {geoms}/>'
        )
    # Without recursion: chains are deep.
    stack = [(index, (0.0, 0.0)) for index in reversed(children.get(None, []))]
    while stack:
        item = stack.pop()
        if item is None:
            parts.append("</body>")
            continue
        index, origin = item
        opening, at = _open(heat, index, holding.get(index), origin, geoms)
        parts.append(opening)
        stack.append(None)
        stack.extend((child, at) for child in reversed(children.get(index, [])))
    gravity = f"{heat.gravity[0]} 0 {heat.gravity[1]}"
    return (
        f'<mujoco><compiler angle="radian" inertiafromgeom="false" autolimits="true"/>'
        f'<option timestep="{heat.dt!r}" gravity="{gravity}" {options}/>'
        f'<worldbody>{"".join(parts)}</worldbody></mujoco>'
    )


def _open(heat, index, joint, origin, geoms):
    """The start of a body's element, its frame parallel to the world's at the start; and where that is."""
    body = heat.bodies[index]
    at = body.position if joint is None else joint.anchor
    place = f"{at[0] - origin[0]!r} 0 {at[1] - origin[1]!r}"
    center = f"{body.position[0] - at[0]!r} 0 {body.position[1] - at[1]!r}"
    inertia = " ".join([repr(body.inertia)] * 3)
    if joint is None:
        joints = (
            '<joint type="slide" axis="1 0 0"/><joint type="slide" axis="0 0 1"/>'
            '<joint type="hinge" axis="0 -1 0"/>'
        )
    elif joint.kind == "revolute":
        joints = '<joint type="hinge" axis="0 -1 0"/>'
    else:
        joints = f'<joint type="slide" axis="{joint.axis[0]} 0 {joint.axis[1]}"/>'
    shape = ""
    if body.shape:
        kind, *size = body.shape
        numbers = repr(size[0]) if kind == "circle" else f"{size[0] / 2!r} 0.5 {size[1] / 2!r}"
        kind = "sphere" if kind == "circle" else "box"
        shape = f'<geom type="{kind}" size="{numbers}" friction="{body.friction} 0 0" condim="3" {geoms}/>'
    text = (
        f'<body name="{body.name}" pos="{place}">'
        f'<inertial pos="{center}" mass="{body.mass!r}" diaginertia="{inertia}"/>{joints}{shape}'
    )
    return text, at


def poses(heat, model, data):
    """The pose (x, y, angle) of every body's centre of mass, from MuJoCo's data."""
    mujoco.mj_kinematics(model, data)
    mujoco.mj_comPos(model, data)
    found = []
    for body in heat.bodies:
        if not body.dynamic:
            found.append((*body.position, body.angle))
            continue
        index = model.body(body.name).id
        at, turn = data.xipos[index], data.xmat[index].reshape(3, 3)
        found.append((at[0], at[2], body.angle + math.atan2(turn[2, 0], turn[0, 0])))
    return found


def velocities(heat):
    """Initial velocities in the model's order: three per free body, none for jointed ones."""
    jointed = {joint.b for joint in heat.joints}
    found = []
    for index, body in enumerate(heat.bodies):
        if body.dynamic:
            found.extend([0.0] if index in jointed else [*body.velocity, body.rate])
    return found

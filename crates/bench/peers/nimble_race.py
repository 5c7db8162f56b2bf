"""nimblephysics: a spatial engine in reduced coordinates, contacts as complementarity problems, gradients by
its analytical Jacobians through PyTorch.

Free bodies have a planar joint in the plane of x and y; discs are balls, boxes and the floor 1 m deep.
"""

import math

import nimblephysics as nimble
import numpy as np
import torch

from race import race


class World:
    gradient_note = "gradient by the initial state"

    def __init__(self, heat):
        self.heat, self.world = heat, nimble.simulation.World()
        self.world.setGravity([*heat.gravity, 0.0])
        self.world.setTimeStep(heat.dt)
        holding = {joint.b: joint for joint in heat.joints}
        self.nodes, self.origins, tree = {}, {}, nimble.dynamics.Skeleton()
        for index, body in enumerate(heat.bodies):
            if not body.dynamic:
                self._floor(body)
            elif index in holding:
                self._jointed(tree, index, holding[index])
            else:
                self._free(index, body)
        if tree.getNumBodyNodes():
            self.world.addSkeleton(tree)

    def _inertia(self, node, body, offset):
        node.setInertia(nimble.dynamics.Inertia(body.mass, np.array([*offset, 0.0]), np.eye(3) * body.inertia))

    def _shape(self, node, body, size):
        geometry = nimble.dynamics.SphereShape(size[0]) if len(size) == 1 else nimble.dynamics.BoxShape(size)
        shape = node.createShapeNode(geometry)
        shape.createCollisionAspect()
        node.setFrictionCoeff(body.friction)
        node.setRestitutionCoeff(body.restitution)
        return shape

    def _floor(self, body):
        skeleton = nimble.dynamics.Skeleton()
        joint, node = skeleton.createWeldJointAndBodyNodePair()
        at = nimble.math.Isometry3()
        at.set_translation([0.0, -0.5, 0.0])
        joint.setTransformFromParentBodyNode(at)
        self._shape(node, body, [1000.0, 1.0, 1.0])
        self.world.addSkeleton(skeleton)

    def _free(self, index, body):
        skeleton = nimble.dynamics.Skeleton()
        joint, node = skeleton.createPlanarJointAndBodyNodePair()
        joint.setXYPlane()
        self._inertia(node, body, (0.0, 0.0))
        kind, *size = body.shape
        self._shape(node, body, size if kind == "circle" else [*size, 1.0])
        self.nodes[index], self.origins[index] = node, body.position
        skeleton.setPositions(np.array([*body.position, body.angle]))
        skeleton.setVelocities(np.array([*body.velocity, body.rate]))
        self.world.addSkeleton(skeleton)

    def _jointed(self, tree, index, given):
        body, parent = self.heat.bodies[index], self.nodes.get(given.a)
        if given.kind == "revolute":
            joint, node = tree.createRevoluteJointAndBodyNodePair(parent)
            joint.setAxis([0.0, 0.0, 1.0])
        else:
            joint, node = tree.createPrismaticJointAndBodyNodePair(parent)
            joint.setAxis([*given.axis, 0.0])
        origin = self.origins.get(given.a, (0.0, 0.0))
        at = nimble.math.Isometry3()
        at.set_translation([given.anchor[0] - origin[0], given.anchor[1] - origin[1], 0.0])
        joint.setTransformFromParentBodyNode(at)
        self._inertia(node, body, [p - q for p, q in zip(body.position, given.anchor)])
        self.nodes[index], self.origins[index] = node, given.anchor

    def run(self, steps):
        step = self.world.step
        for _ in range(steps):
            step()

    def poses(self):
        found = []
        for index, body in enumerate(self.heat.bodies):
            if not body.dynamic:
                found.append((*body.position, body.angle))
                continue
            place = self.nodes[index].getWorldTransform()
            turn, at = place.rotation(), place.translation()
            angle = math.atan2(turn[1, 0], turn[0, 0])
            start = body.angle if index not in {j.b for j in self.heat.joints} else 0.0
            offset = [p - q for p, q in zip(body.position, self.origins[index])]
            x = at[0] + turn[0, 0] * offset[0] + turn[0, 1] * offset[1]
            y = at[1] + turn[1, 0] * offset[0] + turn[1, 1] * offset[1]
            found.append((x, y, angle + body.angle - start))
        return found

    def value_and_gradient(self, steps):
        start = torch.tensor(self.world.getState(), requires_grad=True)
        state, action = start, torch.zeros(self.world.getActionSize(), dtype=start.dtype)
        for _ in range(steps):
            state = nimble.timestep(self.world, state, action)
        state[self.heat.last(self.world.getNumDofs())].backward()
        return start.grad


def accepts(heat):
    """The four small scenes at the finer step."""
    return bool(heat.gradient_steps)


if __name__ == "__main__":
    race([("nimblephysics", World, accepts)])

"""The geometry of the robots that comparisons use."""

import math

import numpy

PI = math.pi
# alpha, a, d of each joint; alpha and a as they lead to the joint (Craig).
ROBOTS = {
    "ur10e": [
        (0, 0, 0.1807),
        (PI / 2, 0, 0),
        (0, -0.6127, 0),
        (0, -0.57155, 0.17415),
        (PI / 2, 0, 0.11985),
        (-PI / 2, 0, 0.11655),
    ],
    "panda": [
        (0, 0, 0.333),
        (-PI / 2, 0, 0),
        (PI / 2, 0, 0.316),
        (PI / 2, 0.0825, 0),
        (-PI / 2, -0.0825, 0.384),
        (PI / 2, 0, 0),
        (PI / 2, 0.088, 0.107),
    ],
}


def build_model(joints):
    """Pinocchio's model of such a chain, with bodies of some inertia."""
    import pinocchio

    model, parent = pinocchio.Model(), 0
    for number, (alpha, a, d) in enumerate(joints):
        rotation = pinocchio.AngleAxis(alpha, numpy.array([1.0, 0.0, 0.0])).toRotationMatrix()
        origin = numpy.array([a, 0.0, 0.0]) + rotation @ numpy.array([0.0, 0.0, d])
        placement = pinocchio.SE3(rotation, origin)
        parent = model.addJoint(parent, pinocchio.JointModelRZ(), placement, f"joint_{number}")
        model.appendBodyToJoint(parent, pinocchio.Inertia.Random(), pinocchio.SE3.Identity())
    return model

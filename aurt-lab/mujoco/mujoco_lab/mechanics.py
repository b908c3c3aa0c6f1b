"""Effects of bodies, springs and gears, for which the engine has words of its own."""

import numpy as np

from . import laws, rigid_body
from .effect import Effect, each


def felt_inertia(robot, joint):
    """What the joint would have to accelerate at home without its rotor, the others held, kg m2."""
    n = robot.joints
    a = np.zeros((1, n))
    a[0, joint] = 1.0
    home = robot.home_rad[None]
    still = np.zeros((1, n))
    return float(rigid_body.torque(robot.mdh, np.zeros(3), robot.standard_parameters(), home, still, a)[0, joint])


class Payload(Effect):
    identifier, family, presence, takes, whole_arm = "payload", "I", "later", "all", True

    def draw(self, random):
        self.com = [float(x) for x in random.uniform([-0.06, -0.06, 0.03], [0.06, 0.06, 0.15])]
        self.radius = float(random.uniform(0.02, 0.06))
        self.unit_kg, self.high = 0.15 * float(self.robot.mass_kg.sum()) / 10, 50.0

    def install(self, build):
        build.payload = (float(self.size[0]) * self.unit_kg, self.com, self.radius)

    def parameters(self):
        return [("mass_kg", [float(self.size[0]) * self.unit_kg]), ("link", [float(self.robot.joints - 1)])]


class BaseTilt(Effect):
    identifier, family, presence, takes, whole_arm = "base_tilt", "I", "either", "all", True

    def draw(self, random):
        direction = random.uniform(0, 2 * np.pi)
        self.roll, self.pitch = 0.04 * float(np.cos(direction)), 0.04 * float(np.sin(direction))
        self.high = 12.0

    def install(self, build):
        roll, pitch = self.size[0] * self.roll, self.size[0] * self.pitch
        about_x = np.array([[1, 0, 0], [0, np.cos(roll), -np.sin(roll)], [0, np.sin(roll), np.cos(roll)]])
        about_y = np.array([[np.cos(pitch), 0, np.sin(pitch)], [0, 1, 0], [-np.sin(pitch), 0, np.cos(pitch)]])
        build.gravity_m_s2 = (about_x @ about_y).T @ build.gravity_m_s2

    def parameters(self):
        return [("roll_rad", [float(self.size[0]) * self.roll]), ("pitch_rad", [float(self.size[0]) * self.pitch])]


class Spring(Effect):
    identifier, family, presence, takes = "spring", "P", "either", "one"

    def draw(self, random):
        j = self.joints[0]
        self.rest = float(self.robot.home_rad[j] + random.uniform(-1, 1) * self.robot.reach_rad[j])
        self.unit, self.high = 4.0 * float(self.noise()), 100.0

    def install(self, build):
        j = self.joints[0]
        build.stiffness_nm_rad[j], build.rest_rad[j] = self.size[0] * self.unit, self.rest

    def parameters(self):
        return [("stiffness_nm_rad", [float(self.size[0]) * self.unit]), ("rest_rad", [self.rest])]


class TorqueRipple(Effect):
    identifier, family, takes = "torque_ripple", "P", "one"

    def draw(self, random):
        self.order = float(np.exp(random.uniform(np.log(5), np.log(110))))
        if random.uniform() < 0.5:
            self.order = float(round(self.order))
        self.phase, self.overtone = float(random.uniform(0, 2 * np.pi)), float(random.uniform(0, 0.4))
        self.unit, self.high = 1.5 * float(self.noise()), 20.0

    def install(self, build):
        build.laws.append(laws.Ripple(self.joints[0], self.size[0] * self.unit, self.order, self.phase, self.overtone))

    def parameters(self):
        return [("order", [self.order]), ("amplitude_nm", [float(self.size[0]) * self.unit])]


class RotorInertia(Effect):
    identifier, family, geared = "rotor_inertia", "I", False

    @classmethod
    def suits(cls, robot, joint):
        return not rigid_body.absorbed_rotors(robot.mdh, robot.gravity_m_s2, [joint])

    def draw(self, random):
        self.unit = 0.3 * self.robot.torque_noise_nm[self.joints]
        self.high = 40.0

    def install(self, build):
        build.armature_kg_m2[self.joints] += self.size * self.unit

    def parameters(self):
        return [("inertia_kg_m2", each(self, self.size * self.unit))]


class JointElasticity(Effect):
    """A gear that yields; the encoder is on the motor. A size of 1 is a resonance at about 9 Hz."""

    identifier, family, geared, takes = "joint_elasticity", "P", True, "one"

    @classmethod
    def suits(cls, robot, joint):
        # A link far lighter than its rotor hardly loads the gear.
        return felt_inertia(robot, joint) > 0.15 * robot.rotor_kg_m2[joint]

    def draw(self, random):
        link, self.ratio = felt_inertia(self.robot, self.joints[0]), float(random.uniform(0.03, 0.15))
        self.link_kg_m2 = link
        self.unit = link * (2 * np.pi * 9.0) ** 2
        # Between 3.5 Hz, which no controller would bear, and 60 Hz.
        self.low, self.high = 0.02, 6.5

    def values(self):
        stiffness = self.unit / float(self.size[0])
        return stiffness, 2 * self.ratio * float(np.sqrt(stiffness * self.link_kg_m2))

    def install(self, build):
        build.compliant[self.joints[0]] = (*self.values(), None)

    def parameters(self):
        stiffness, damping = self.values()
        return [("stiffness_nm_rad", [stiffness]), ("damping_nm_s", [damping])]


class Backlash(JointElasticity):
    """Play between flanks, which are limits of the gear's own joint."""

    identifier, presence = "backlash", "either"

    def draw(self, random):
        self.unit, self.low, self.high = 0.002, 0.02, 15.0
        self.damping = 0.3 * float(felt_inertia(self.robot, self.joints[0]))

    def install(self, build):
        build.compliant[self.joints[0]] = (0.0, self.damping, float(self.size[0]) * self.unit)

    def parameters(self):
        return [("gap_rad", [float(self.size[0]) * self.unit])]


class ExternalContact(Effect):
    identifier, family, presence, takes, whole_arm = "external_contact", "X", "later", "all", True

    def draw(self, random):
        length = random.uniform(1.5, 5.0)
        start = random.uniform(0.15, 0.85) * (self.duration_s - length - 2) + 1
        self.window_s = [float(start), float(start + length)]
        self.link = int(random.integers(self.robot.joints - 4, self.robot.joints))
        direction = random.standard_normal(3)
        self.force = [float(x) for x in 5.0 * direction / np.linalg.norm(direction)]
        self.high = 60.0

    def install(self, build):
        build.push = (self.link, self.size[0] * np.array(self.force), self.window_s)

    def parameters(self):
        return [("link", [float(self.link)])]


EFFECTS = [Payload, BaseTilt, Spring, TorqueRipple, RotorInertia, JointElasticity, Backlash, ExternalContact]

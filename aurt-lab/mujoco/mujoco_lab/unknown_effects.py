"""Physics that no vocabulary has."""

from . import laws
from .effect import Effect


class FluidDrag(Effect):
    """The arm moves in a dense fluid: drag of whole links with the square of their speed."""

    identifier, family, takes, whole_arm = "fluid_drag", "V", "all", True

    def draw(self, random):
        self.unit, self.high = 40.0, 200.0

    def install(self, build):
        build.density_kg_m3 = float(self.size[0]) * self.unit


class SwingingMass(Effect):
    """A mass that swings on a cardan joint at the flange."""

    identifier, family, takes, whole_arm = "swinging_mass", "I", "all", True

    def draw(self, random):
        self.length, self.unit = float(random.uniform(0.1, 0.25)), 0.01 * float(self.robot.mass_kg.sum())
        self.damping, self.high = float(random.uniform(0.01, 0.05)), 20.0

    def install(self, build):
        mass = float(self.size[0]) * self.unit
        build.swinging = (mass, self.length, self.damping * mass * self.length)


class CableAngle(Effect):
    """Friction of one joint that grows where another joint stands at a certain angle."""

    identifier, family, takes = "angle_of_another_joint", "C", "pair"

    def draw(self, random):
        self.joint, self.other = self.joints
        self.joints = [self.joint]
        self.centre = float(self.robot.home_rad[self.other] + random.uniform(-0.4, 0.4) * self.robot.reach_rad[self.other])
        self.width = float(random.uniform(0.15, 0.35))
        self.unit, self.high = 3 * float(self.robot.torque_noise_nm[self.joint]), 20.0

    def install(self, build):
        level = build.coulomb_nm[self.joint]
        build.laws.append(laws.AngleOfAnother(
            self.joint, self.other, level, self.size[0] * self.unit, self.centre, self.width))


class WanderingTorque(Effect):
    """A torque that drifts by chance."""

    identifier, family, takes = "wandering_torque", "X", "one"

    def draw(self, random):
        self.time_s, self.seed = float(random.uniform(0.5, 3.0)), int(random.integers(2 ** 31))
        self.unit = float(self.noise())

    def install(self, build):
        build.laws.append(laws.Wander(self.joints[0], self.size[0] * self.unit, self.time_s, self.seed))


class Bursts(Effect):
    """Dry friction that rises at chance instants."""

    identifier, family, takes = "friction_bursts", "F", "one"

    def draw(self, random):
        self.every_s, self.seed = float(random.uniform(2.0, 6.0)), int(random.integers(2 ** 31))
        self.unit, self.high = 2 * float(self.noise()), 20.0

    def install(self, build):
        j = self.joints[0]
        build.laws.append(laws.Bursts(j, build.coulomb_nm[j], self.size[0] * self.unit, self.every_s, self.seed))


class MagnetWell(Effect):
    """A narrow well of torque at one angle."""

    identifier, family, takes = "magnet_well", "P", "one"

    def draw(self, random):
        j = self.joints[0]
        self.centre = float(self.robot.home_rad[j] + random.uniform(-0.3, 0.3) * self.robot.reach_rad[j])
        self.width = float(random.uniform(0.05, 0.15))
        self.unit, self.high = 3 * float(self.noise()), 30.0

    def install(self, build):
        build.laws.append(laws.Magnet(self.joints[0], self.size[0] * self.unit, self.centre, self.width))


EFFECTS = [FluidDrag, SwingingMass, CableAngle, WanderingTorque, Bursts, MagnetWell]

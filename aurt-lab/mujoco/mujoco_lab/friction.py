"""Effects of friction."""

import numpy as np

from . import laws
from .effect import Effect, each


class Coulomb(Effect):
    identifier, family, hides = "coulomb", "F", "coulomb"

    def draw(self, random):
        self.unit_nm = 1.2 * self.robot.torque_noise_nm[self.joints]
        self.high = np.maximum(2.5 * self.robot.coulomb_nm[self.joints], 5 * self.unit_nm) / self.unit_nm

    def install(self, build):
        build.coulomb_nm[self.joints] = self.size * self.unit_nm

    def parameters(self):
        return [("coulomb_nm", each(self, self.size * self.unit_nm))]


class Viscous(Effect):
    identifier, family, hides = "viscous", "V", "viscous"

    def draw(self, random):
        self.unit_nm_s = 2.0 * self.robot.torque_noise_nm[self.joints]
        self.high = 20.0

    def install(self, build):
        build.viscous_nm_s[self.joints] = self.size * self.unit_nm_s

    def parameters(self):
        return [("viscous_nm_s", each(self, self.size * self.unit_nm_s))]


class CoulombAsymmetry(Effect):
    identifier, family, presence = "coulomb_asymmetry", "F", "either"

    def draw(self, random):
        self.mean_nm = self.robot.coulomb_nm[self.joints]
        self.unit_nm = self.robot.torque_noise_nm[self.joints] * random.choice([-1.0, 1.0], len(self.joints))
        self.high = 0.95 * self.mean_nm / np.abs(self.unit_nm)

    def install(self, build):
        for j, mean, half in zip(self.joints, self.mean_nm, self.size * self.unit_nm):
            build.laws.append(laws.DirectedLevel(j, mean + half, mean - half))

    def parameters(self):
        half = self.size * self.unit_nm
        return [("coulomb_pos_nm", each(self, self.mean_nm + half)), ("coulomb_neg_nm", each(self, self.mean_nm - half))]


class ViscousAsymmetry(Effect):
    identifier, family, presence = "viscous_asymmetry", "V", "either"

    def draw(self, random):
        self.mean_nm_s = self.robot.viscous_nm_s[self.joints]
        self.unit_nm_s = 2 * self.robot.torque_noise_nm[self.joints] * random.choice([-1.0, 1.0], len(self.joints))
        self.high = 0.95 * self.mean_nm_s / np.abs(self.unit_nm_s)

    def install(self, build):
        for j, half in zip(self.joints, self.size * self.unit_nm_s):
            build.laws.append(laws.DirectedSlope(j, half))

    def parameters(self):
        half = self.size * self.unit_nm_s
        return [("viscous_pos_nm_s", each(self, self.mean_nm_s + half)),
                ("viscous_neg_nm_s", each(self, self.mean_nm_s - half))]


class ViscousNonlinear(Effect):
    identifier, family = "viscous_nonlinear", "V"

    def draw(self, random):
        # Below 1 lubricant thins, above 1 it thickens; near 1 there is nothing to see.
        self.power = random.uniform(0.35, 0.7) if random.uniform() < 0.7 else random.uniform(1.8, 2.8)
        self.unit_nm = 3.0 * self.robot.torque_noise_nm[self.joints]
        self.high = 60.0

    def install(self, build):
        for j, size in zip(self.joints, self.size * self.unit_nm):
            build.laws.append(laws.BentSlope(j, size, self.power))


class Stribeck(Effect):
    identifier, family = "stribeck", "F"

    def draw(self, random):
        self.speed_rad_s = np.exp(random.uniform(np.log(0.02), np.log(0.12), len(self.joints)))
        self.exponent = random.uniform(0.5, 2.0)
        self.unit_nm = 2.0 * self.robot.torque_noise_nm[self.joints]
        self.high = 2.0 * self.robot.coulomb_nm[self.joints] / self.unit_nm

    def install(self, build):
        for j, excess, speed in zip(self.joints, self.size * self.unit_nm, self.speed_rad_s):
            build.laws.append(laws.StribeckLevel(j, self.robot.coulomb_nm[j], excess, speed, self.exponent))

    def parameters(self):
        return [("half_speed_rad_s", each(self, self.speed_rad_s * np.log(2.0) ** (1.0 / self.exponent))),
                ("static_nm", each(self, self.robot.coulomb_nm[self.joints] + self.size * self.unit_nm))]


class Presliding(Effect):
    identifier, family = "presliding_hysteresis", "H"

    def draw(self, random):
        self.unit_rad = np.full(len(self.joints), 0.02)
        self.low, self.high = 0.01, 20.0
        self.kind = "maxwell_slip" if random.uniform() < 0.6 else "dahl"
        self.power = random.uniform(0.6, 2.0)
        elements = random.integers(3, 8)
        self.shares = random.dirichlet(np.full(elements, 3.0))
        self.spread = np.exp(random.uniform(-1.6, 0.6, elements))

    def install(self, build):
        for j, distance in zip(self.joints, self.size * self.unit_rad):
            level = self.robot.coulomb_nm[j]
            build.coulomb_nm[j] = 0.0
            if self.kind == "dahl":
                build.laws.append(laws.Dahl(j, level, distance, self.power))
            else:
                build.laws.append(laws.Bristles(j, level * self.shares, distance * self.spread))


class LoadDependent(Effect):
    identifier, family = "load_dependent_friction", "L"

    def draw(self, random):
        self.unit = 0.08
        self.high = 12.0

    def install(self, build):
        for j, c in zip(self.joints, self.size * self.unit):
            build.laws.append(laws.LoadLevel(j, self.robot.coulomb_nm[j], c, c))

    def parameters(self):
        return [("load_coefficient", each(self, self.size * self.unit))]


class DriveEfficiency(Effect):
    identifier, family = "drive_efficiency", "L"

    def draw(self, random):
        self.unit, self.high = 0.12, 7.0
        self.other = random.uniform(-0.2, 0.35)
        self.more_driven = bool(random.uniform() < 0.4)

    def _both(self):
        high = self.size * self.unit
        low = high * max(self.other, 0.0)
        return (low, high) if self.more_driven else (high, low)

    def install(self, build):
        for j, driving, driven in zip(self.joints, *self._both()):
            build.laws.append(laws.LoadLevel(j, self.robot.coulomb_nm[j], driving, driven))

    def parameters(self):
        driving, driven = self._both()
        return [("driving", each(self, driving)), ("driven", each(self, driven))]


class Temperature(Effect):
    identifier, family, slow = "temperature_dependent_friction", "V", True

    def draw(self, random):
        self.unit, self.high = 0.2, 4.5
        self.time_s, self.first = random.uniform(6.0, 35.0), random.uniform(0.0, 0.3)

    def install(self, build):
        for j, fall in zip(self.joints, self.size * self.unit):
            build.laws.append(laws.WarmFriction(
                j, self.robot.coulomb_nm[j], self.robot.viscous_nm_s[j], fall, self.time_s, self.first))


class FrictionLevelChanged(Effect):
    identifier, family, presence = "friction_level_changed", "F", "later"

    def draw(self, random):
        n = len(self.joints)
        self.sign = random.choice([-1.0, 1.0, 1.0], n)
        self.coulomb_share, self.viscous_share = random.uniform(0.5, 1.0, n), random.uniform(0.2, 1.0, n)
        self.unit = 0.2
        self.high = np.where(self.sign < 0, 4.2, 15.0)

    def install(self, build):
        change = self.sign * self.size * self.unit
        build.coulomb_nm[self.joints] *= 1 + change * self.coulomb_share
        build.viscous_nm_s[self.joints] *= 1 + change * self.viscous_share


class Coupling(Effect):
    identifier, family, takes = "joint_coupling_friction", "C", "pair"

    def draw(self, random):
        self.joint, self.partner = self.joints
        self.joints = sorted(self.joints)
        self.ratio = float(random.choice([-1.0, 1.0]) * np.exp(random.uniform(np.log(0.2), np.log(3.0))))
        noise = min(self.robot.torque_noise_nm[self.joint], self.robot.torque_noise_nm[self.partner])
        self.coulomb, self.viscous, self.inertia = (
            noise * float(x) for x in (random.uniform(0.7, 1.5), random.uniform(0.3, 1.0), random.uniform(0.005, 0.03)))
        self.high = 20.0

    def install(self, build):
        s = float(self.size[0])
        build.tendon = (self.joint, self.partner, self.ratio, s * self.coulomb, s * self.viscous, s * self.inertia)

    def parameters(self):
        s = float(self.size[0])
        return [("partner", [float(self.partner)]), ("ratio", [self.ratio]), ("inertia_kg_m2", [s * self.inertia]),
                ("viscous_nm_s", [s * self.viscous]), ("coulomb_nm", [s * self.coulomb])]


EFFECTS = [Coulomb, Viscous, CoulombAsymmetry, ViscousAsymmetry, ViscousNonlinear, Stribeck, Presliding, LoadDependent,
           DriveEfficiency, Temperature, FrictionLevelChanged, Coupling]

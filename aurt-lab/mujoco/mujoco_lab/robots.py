"""Arms: geometry, bodies, drives and noise. They resemble the robots of their names; no value is copied from a maker.

A table of modified Denavit-Hartenberg parameters has one row (alpha, a, d) per joint; row j holds d_j and the alpha_j, a_j
that lead to joint j + 1. Masses, lengths and friction are drawn around typical values for every case.
"""

from dataclasses import dataclass, field

import numpy as np

PI2 = np.pi / 2


@dataclass
class Robot:
    """An arm as it is built. All torques in Nm and speeds in rad/s on the joint's side of the gear."""

    name: str
    mdh: np.ndarray  # (n, 3): alpha in rad, a in m, d in m
    gravity_m_s2: np.ndarray
    mass_kg: np.ndarray
    com_m: np.ndarray  # (n, 3), link frames
    inertia_kg_m2: np.ndarray  # (n, 3, 3) about the centres of mass, axes of the link frames
    coulomb_nm: np.ndarray
    viscous_nm_s: np.ndarray
    rotor_kg_m2: np.ndarray
    torque_noise_nm: np.ndarray
    torque_constant_nm_per_a: np.ndarray
    speed_rad_s: np.ndarray
    acceleration_rad_s2: np.ndarray
    home_rad: np.ndarray
    reach_rad: np.ndarray  # largest distance of motions from home
    ampere: bool
    geared: bool = True
    encoder_noise_rad: float = 1e-5
    armature_kg_m2: np.ndarray = field(default=None)

    @property
    def joints(self):
        return len(self.mass_kg)

    def standard_parameters(self):
        """10 n values, link after link {XX XY XZ YY YZ ZZ mX mY mZ m} about the link frames' origins."""
        rows = []
        for m, c, inertia in zip(self.mass_kg, self.com_m, self.inertia_kg_m2):
            at_origin = inertia + m * (c @ c * np.eye(3) - np.outer(c, c))
            rows += [at_origin[0, 0], at_origin[0, 1], at_origin[0, 2], at_origin[1, 1], at_origin[1, 2],
                     at_origin[2, 2], *(m * c), m]
        return np.array(rows)


# name: (table, gravity, masses, link radii, coulomb, viscous, rotors, noise, constants, speed, acceleration, home, reach, A?)
_ARMS = {
    "ur5e": (
        [(PI2, 0, 0.163), (0, -0.425, 0), (0, -0.392, 0), (PI2, 0, 0.133), (-PI2, 0, 0.1), (0, 0, 0.1)],
        [0.0, 6.937, -6.937], [3.7, 8.3, 2.6, 1.3, 1.3, 0.4], [0.07, 0.06, 0.05, 0.04, 0.04, 0.035],
        [6.0, 7.0, 5.0, 1.7, 1.8, 1.4], [8.0, 8.0, 5.5, 1.7, 1.9, 1.5], [0.8, 0.8, 0.6, 0.12, 0.12, 0.12],
        [0.8, 0.9, 0.7, 0.18, 0.18, 0.17], [11.0, 11.5, 10.5, 9.3, 9.1, 9.0],
        [2.4, 2.2, 2.4, 3.0, 3.0, 3.0], [13.0, 12.0, 13.0, 19.0, 19.0, 19.0],
        [0.2, -1.4, 0.9, -1.1, 0.5, 0.0], [1.8, 1.0, 1.2, 1.6, 1.6, 2.0], True),
    "ur10e": (
        [(PI2, 0, 0.181), (0, -0.613, 0), (0, -0.572, 0), (PI2, 0, 0.174), (-PI2, 0, 0.12), (0, 0, 0.117)],
        [0.0, 0.0, -9.81], [7.2, 13.5, 4.2, 2.0, 2.0, 0.6], [0.09, 0.08, 0.06, 0.05, 0.05, 0.045],
        [13.0, 14.0, 8.5, 3.0, 3.2, 2.8], [13.0, 14.0, 8.0, 2.9, 3.0, 2.7], [3.0, 3.0, 1.7, 0.4, 0.4, 0.4],
        [1.6, 1.7, 1.1, 0.4, 0.4, 0.38], [12.0, 12.0, 10.0, 10.5, 10.5, 10.5],
        [1.8, 1.6, 2.0, 2.6, 2.6, 2.6], [9.0, 8.0, 10.0, 15.0, 15.0, 15.0],
        [0.0, -1.2, 1.2, -0.7, 0.6, 0.3], [1.7, 0.8, 1.1, 1.5, 1.5, 2.0], True),
    "tx40": (
        [(-PI2, 0, 0.32), (0, 0.225, 0), (PI2, 0, 0.035), (-PI2, 0, 0.225), (PI2, 0, 0), (0, 0, 0.065)],
        [0.0, 0.0, -9.81], [6.5, 5.4, 4.0, 2.2, 0.8, 0.3], [0.08, 0.06, 0.055, 0.045, 0.035, 0.03],
        [7.0, 8.0, 6.2, 2.4, 2.8, 1.9], [8.0, 5.6, 2.1, 1.2, 1.8, 0.7], [0.34, 0.36, 0.1, 0.04, 0.045, 0.012],
        [1.6, 1.5, 0.8, 0.3, 0.3, 0.2], [9.0, 9.0, 7.0, 4.5, 4.5, 4.0],
        [3.4, 2.8, 3.4, 4.5, 4.5, 5.0], [26.0, 24.0, 28.0, 50.0, 50.0, 55.0],
        [0.0, -0.4, 1.3, 0.2, 0.5, 0.0], [2.0, 1.1, 1.0, 2.0, 1.4, 2.5], False),
    "panda": (
        [(-PI2, 0, 0.333), (PI2, 0, 0), (PI2, 0.083, 0.316), (-PI2, -0.083, 0), (PI2, 0, 0.384), (PI2, 0.088, 0),
         (0, 0, 0.107)],
        [0.0, 0.0, -9.81], [4.6, 3.0, 3.1, 3.3, 2.0, 1.5, 0.8], [0.07, 0.065, 0.06, 0.055, 0.05, 0.045, 0.04],
        [0.6, 0.7, 0.55, 0.6, 0.4, 0.35, 0.3], [0.7, 0.8, 0.6, 0.7, 0.4, 0.35, 0.3],
        [0.6, 0.6, 0.55, 0.55, 0.2, 0.2, 0.18], [0.14, 0.16, 0.13, 0.14, 0.07, 0.06, 0.06],
        [7.0, 7.0, 7.0, 7.0, 3.5, 3.5, 3.5], [1.8, 1.7, 1.8, 1.8, 2.2, 2.2, 2.3], [6.0, 5.5, 6.0, 6.0, 8.0, 8.0, 9.0],
        [0.0, -0.3, 0.0, -1.7, 0.0, 1.6, 0.4], [1.7, 1.0, 1.6, 0.9, 1.7, 1.0, 1.7], False),
}
NAMES = tuple(_ARMS)
# Encoder noise of the laboratories that this world stands for, rad.
ENCODER_NOISE_RAD = (1e-6, 2e-5)
SPREAD = 0.3


def next_origins(mdh):
    """Origin of joint j + 1 in the frame of link j, m; for the last link, the flange."""
    points = []
    for j, (alpha, a, _) in enumerate(mdh):
        d = mdh[j + 1][2] if j + 1 < len(mdh) else 0.06
        points.append([a, -np.sin(alpha) * d, np.cos(alpha) * d])
    return np.array(points)


def draw(name, random, geared):
    """An arm of a name with values of its own; its rotors geared, or as discs of the links."""
    if name not in _ARMS:
        raise ValueError(f"no robot `{name}` here; known: {', '.join(NAMES)}")
    (mdh, gravity, mass, radius, coulomb, viscous, rotor, noise, constant, speed, acceleration, home, reach,
     ampere) = _ARMS[name]
    n = len(mass)

    def about(values, spread=SPREAD):
        return np.array(values, float) * random.uniform(1 - spread, 1 + spread, n)

    table = np.array(mdh, float)
    table[:, 1:] *= np.round(random.uniform(0.93, 1.07, (n, 2)), 3)
    mass, radius, rotor = about(mass), about(radius), about(rotor)
    ends = next_origins(table)
    com = ends * random.uniform(0.3, 0.6, (n, 1)) + random.uniform(-0.4, 0.4, (n, 3)) * radius[:, None]
    inertia = np.zeros((n, 3, 3))
    for j in range(n):
        # Second moments of a rod to the next joint with a round cross-section, turned a little out of its axes.
        spread = np.outer(ends[j], ends[j]) / 12 + np.diag(radius[j] ** 2 * random.uniform(0.3, 0.6, 3))
        turn, _ = np.linalg.qr(np.eye(3) + 0.15 * random.standard_normal((3, 3)))
        spread = turn @ spread @ turn.T
        inertia[j] = mass[j] * (np.trace(spread) * np.eye(3) - spread)
        if not geared:
            inertia[j] += rotor[j] * np.diag([0.5, 0.5, 1.0])
    return Robot(
        name, table, np.array(gravity), mass, com, inertia, about(coulomb), about(viscous), rotor, about(noise),
        np.array(constant) * np.round(random.uniform(0.95, 1.05, n), 2), np.array(speed), np.array(acceleration),
        np.array(home), np.array(reach), ampere, geared,
        float(np.exp(random.uniform(*np.log(ENCODER_NOISE_RAD)))), rotor if geared else np.zeros(n))

"""Motions within an arm's limits, and the control that follows them."""

from dataclasses import dataclass

import numpy as np

from . import rigid_body

GRID_S = 1e-3


def _ease(x):
    """From 0 to 1 with two derivatives that vanish at both ends."""
    x = np.clip(x, 0, 1)
    return x ** 3 * (10 - 15 * x + 6 * x * x)


@dataclass
class Motion:
    """A desired path on a grid of 1 ms, (samples, n), and the torque that the controller feeds forward."""

    duration_s: float
    q_rad: np.ndarray
    v_rad_s: np.ndarray
    a_rad_s2: np.ndarray
    forward_nm: np.ndarray = None

    def at(self, t):
        return _between(self.q_rad, t)

    def control(self, t, servo):
        """Set points of the position servos, whose velocity term they contain, and the torque fed forward."""
        position_nm_rad, velocity_nm_s, _ = servo
        ahead = _between(self.v_rad_s, t) * (velocity_nm_s / position_nm_rad)
        return np.hstack([self.at(t) + ahead, _between(self.forward_nm, t)])


def _between(series, t):
    place = t / GRID_S
    k = np.minimum(np.round(place, 6).astype(int), len(series) - 2)
    share = np.round(place - k, 6)[:, None]
    return series[k] * (1 - share) + series[k + 1] * share


def _finished(robot, q, share, duration_s):
    """Scales a path about its start so that speed, acceleration and reach keep the share of the limits."""
    v, a = np.gradient(q, GRID_S, axis=0), np.gradient(np.gradient(q, GRID_S, axis=0), GRID_S, axis=0)
    away = q - robot.home_rad
    factor = share / np.maximum.reduce([
        np.abs(v).max(0) / robot.speed_rad_s, np.abs(a).max(0) / robot.acceleration_rad_s2,
        np.abs(away).max(0) / robot.reach_rad, np.full(robot.joints, 1e-9)])
    return Motion(duration_s, robot.home_rad + away * factor, v * factor, a * factor)


def waves(robot, duration_s, random):
    """Sines of frequencies that have no common period, from rest to rest."""
    t = np.arange(0, duration_s + 0.5 * GRID_S, GRID_S)
    top_hz, terms = random.uniform(0.6, 1.2), random.integers(5, 12)
    q = np.zeros((len(t), robot.joints))
    for j in range(robot.joints):
        for f in np.exp(random.uniform(np.log(0.1), np.log(top_hz), terms)):
            q[:, j] += random.normal() / (f + 0.5) * np.sin(2 * np.pi * (f * t + random.uniform()))
        q[:, j] -= q[0, j]
    q *= (_ease(t / 1.5) * _ease((duration_s - t) / 1.5))[:, None]
    return _finished(robot, robot.home_rad + q, random.uniform(0.5, 0.8), duration_s)


def slow(robot, duration_s, random):
    """Slow motion of nearly constant speeds with many reversals, through which a joint goes without a rest."""
    t = np.arange(0, duration_s + 0.5 * GRID_S, GRID_S)
    q = np.zeros((len(t), robot.joints))
    for j in range(robot.joints):
        v = np.zeros(len(t))
        start, place, before, sign = random.uniform(0.1, 0.6), 0.0, 0.0, random.choice([-1.0, 1.0])
        while start < duration_s - 1.0:
            speed, length = random.uniform(0.05, 0.3), random.uniform(0.8, 3.0)
            if abs(place + sign * speed * length) > 0.5 * robot.reach_rad[j]:
                sign = -np.sign(place)
            ramp = random.uniform(0.04, 0.15)
            v += (sign * speed - before) * _ease((t - start) / ramp)
            before, place = sign * speed, place + sign * speed * length
            start, sign = start + length, -sign if random.uniform() < 0.8 else sign
        q[:, j] = np.cumsum(v * _ease((duration_s - t) / 0.3)) * GRID_S
    q = robot.home_rad + q
    v = np.gradient(q, GRID_S, axis=0)
    return Motion(duration_s, q, v, np.gradient(v, GRID_S, axis=0))


def poses(robot, duration_s, random):
    """From pose to pose, with rests."""
    t = np.arange(0, duration_s + 0.5 * GRID_S, GRID_S)
    q, here, start = np.tile(robot.home_rad, (len(t), 1)), robot.home_rad, random.uniform(0.2, 0.5)
    share = random.uniform(0.45, 0.75)
    while True:
        there = robot.home_rad + robot.reach_rad * random.uniform(-0.8, 0.8, robot.joints)
        way = np.abs(there - here)
        length = max((1.9 * way / (share * robot.speed_rad_s)).max(),
                     np.sqrt(5.8 * way / (share * robot.acceleration_rad_s2)).max())
        if start + length > duration_s - 0.2:
            break
        q += _ease((t - start) / length)[:, None] * (there - here)
        here, start = there, start + length + random.uniform(0.2, 0.7)
    v = np.gradient(q, GRID_S, axis=0)
    return Motion(duration_s, q, v, np.gradient(v, GRID_S, axis=0))


def servo(robot, random):
    """Gains of position and velocity per joint, the drives' lag, and how much the controller knows of the arm."""
    still = np.zeros((robot.joints, robot.joints))
    home = np.tile(robot.home_rad, (robot.joints, 1))
    mass = rigid_body.torque(robot.mdh, np.zeros(3), robot.standard_parameters(), home, still, np.eye(robot.joints))
    felt = 1 / np.diag(np.linalg.inv(0.5 * (mass + mass.T) + np.diag(robot.armature_kg_m2)))
    rate, damping = 2 * np.pi * np.exp(random.uniform(np.log(15), np.log(60))), random.uniform(0.5, 1.0)
    spread = random.uniform(0.8, 1.2, robot.joints)
    gains = felt * (rate * spread) ** 2, 2 * damping * felt * rate * spread, random.uniform(5e-4, 2e-3)
    return gains, random.uniform(0.9, 1.0)


def feed_forward(robot, motion, known):
    """The controller's own model of the arm, right up to the factor `known`."""
    q, v, a = motion.q_rad[::4], motion.v_rad_s[::4], motion.a_rad_s2[::4]
    torque = rigid_body.torque(robot.mdh, robot.gravity_m_s2, known * robot.standard_parameters(), q, v, a)
    torque += known * (robot.armature_kg_m2 * a + robot.viscous_nm_s * v + robot.coulomb_nm * np.tanh(v / 0.02))
    rows, coarse = np.arange(len(motion.q_rad)), np.arange(len(torque)) * 4
    motion.forward_nm = np.stack([np.interp(rows, coarse, column) for column in torque.T], 1)

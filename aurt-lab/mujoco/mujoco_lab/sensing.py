"""Sensors, what is wrong with them, and the rows that a logger writes."""

from dataclasses import dataclass

import numpy as np

from .effect import Effect, each


@dataclass
class Instrument:
    """The sensors of an arm."""

    gain_error: np.ndarray
    offset_nm: np.ndarray
    limit_nm: np.ndarray
    encoder_offset_rad: np.ndarray
    delay_s: float = 0.0
    missing: float = 0.0
    repeated: float = 0.0
    held: float = 0.0

    @staticmethod
    def of(robot):
        n = robot.joints
        return Instrument(np.zeros(n), np.zeros(n), np.full(n, np.inf), np.zeros(n))

    def shown(self, time_s, torque_nm, at_s):
        """What the sensors show of a torque if they have no noise: later by the delay, gain, offset, limit."""
        late = at_s - self.delay_s
        torque = np.stack([np.interp(late, time_s, u) for u in torque_nm.T], 1)
        return self.limited(torque / (1 + self.gain_error) + self.offset_nm)

    def limited(self, torque_nm):
        return np.clip(torque_nm, -self.limit_nm, self.limit_nm)


def log(robot, instrument, trace, settings, random):
    """Time, angles and measured torques in Nm with noise, row by row as they are written."""
    t = np.arange(int(trace.time_s[-1] * settings["rate_hz"] + 1e-6) + 1) / settings["rate_hz"]
    noise_rad = robot.encoder_noise_rad * random.standard_normal((len(t), robot.joints))
    q = _smooth(trace, t) + instrument.encoder_offset_rad + noise_rad
    u = instrument.shown(trace.time_s, trace.torque_nm, t)
    # Noise is that of the current, before the converter's limit.
    u = instrument.limited(u + robot.torque_noise_nm * random.standard_normal(u.shape))
    fate = random.uniform(size=len(t))
    held = np.flatnonzero(fate < instrument.held)
    for k in held[held > 0]:
        q[k], u[k] = q[k - 1], u[k - 1]
    fate -= instrument.held
    count = np.ones(len(t), int)
    count[(fate >= 0) & (fate < instrument.missing)] = 0
    fate -= instrument.missing
    count[(fate >= 0) & (fate < instrument.repeated)] = 2
    count[[0, -1]] = 1
    return np.repeat(t, count), np.repeat(q, count, 0), np.repeat(u, count, 0)


def _smooth(trace, t):
    """Cubic between the engine's steps, from angles and velocities."""
    h = trace.time_s[1] - trace.time_s[0]
    place = np.minimum(t / h, len(trace.time_s) - 1.000001)
    k = np.minimum(np.round(place, 6).astype(int), len(trace.time_s) - 2)
    x = np.round(place - k, 6)[:, None]
    q0, q1 = trace.q_rad[k], trace.q_rad[k + 1]
    v0, v1 = h * trace.v_rad_s[k], h * trace.v_rad_s[k + 1]
    return (q0 * (1 + 2 * x) + v0 * x) * (1 - x) ** 2 + (q1 * (3 - 2 * x) + v1 * (x - 1)) * x ** 2


def csv(robot, t, q, u):
    """The text of a recording: currents in A, or torques in Nm."""
    measured, name = (u / robot.torque_constant_nm_per_a, "actual_current") if robot.ampere else (u, "torque")
    n = robot.joints
    head = ",".join(["timestamp", *(f"actual_q_{j}" for j in range(n)), *(f"{name}_{j}" for j in range(n))])
    form = ",".join(["%.4f", *["%.8f"] * n, *["%.5f"] * n])
    return head + "\n" + "\n".join(form % tuple(row) for row in np.column_stack([t, q, measured]).tolist()) + "\n"


class CurrentOffset(Effect):
    identifier, family, presence = "current_offset", "D", "either"

    def draw(self, random):
        self.unit = self.robot.torque_noise_nm[self.joints] * random.choice([-1.0, 1.0], len(self.joints))

    def sense(self, instrument):
        instrument.offset_nm[self.joints] += self.size * self.unit

    def parameters(self):
        return [("offset", each(self, self.size * self.unit))]


class EncoderOffset(Effect):
    """The zero of an encoder that was lost after the calibration; of joints whose torque depends on it."""

    identifier, family, presence, takes = "encoder_offset", "D", "later", "one"

    @classmethod
    def suits(cls, robot, joint):
        return 0 < joint < robot.joints - 1

    def draw(self, random):
        self.unit, self.high = np.full(len(self.joints), random.choice([-0.01, 0.01])), 20.0

    def sense(self, instrument):
        instrument.encoder_offset_rad[self.joints] += self.size * self.unit

    def parameters(self):
        return [("offset_rad", each(self, self.size * self.unit))]


class TorqueConstant(Effect):
    identifier, family, presence = "torque_constant", "D", "either"

    def draw(self, random):
        self.unit, self.sign = 0.08, random.choice([-1.0, 1.0], len(self.joints))
        self.high = np.where(self.sign < 0, 5.0, 10.0)

    def sense(self, instrument):
        instrument.gain_error[self.joints] += self.size * self.unit * self.sign

    def parameters(self):
        return [("gain_error", each(self, self.size * self.unit * self.sign))]


class TimeDelay(Effect):
    identifier, family, presence, takes, whole_arm = "time_delay", "D", "either", "all", True

    def draw(self, random):
        self.unit, self.low, self.high = float(random.choice([-1.0, 1.0, 1.0])) * 0.006, 0.1, 12.0

    def sense(self, instrument):
        instrument.delay_s = float(self.size[0]) * self.unit

    def parameters(self):
        return [("delay_s", [float(self.size[0]) * self.unit])]


class Saturation(Effect):
    """The limit falls from the largest torque of the joint as the size grows."""

    identifier, family, presence, takes = "saturation", "D", "either", "one"
    peak_nm = None

    def draw(self, random):
        self.low, self.high = 0.05, 14.0

    def limit(self):
        return float(self.peak_nm[self.joints[0]]) / (1 + 0.25 * float(self.size[0]))

    def sense(self, instrument):
        instrument.limit_nm[self.joints[0]] = self.limit()

    def parameters(self):
        return [("limit", [self.limit()])]


class DroppedSamples(Effect):
    identifier, family, presence, takes, whole_arm = "dropped_samples", "Q", "either", "all", True

    def draw(self, random):
        self.parts = random.dirichlet([2.0, 1.0, 1.0])
        self.unit, self.high = 0.03, 6.0

    def sense(self, instrument):
        share = float(self.size[0]) * self.unit * self.parts
        instrument.missing, instrument.repeated, instrument.held = (float(x) for x in share)

    def parameters(self):
        return [("share", [float(self.size[0]) * self.unit])]


EFFECTS = [CurrentOffset, EncoderOffset, TorqueConstant, TimeDelay, Saturation, DroppedSamples]

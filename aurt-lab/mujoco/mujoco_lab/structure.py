"""The experiment's own structure - rigid bodies, Coulomb and viscous friction, rotors - fitted by least squares."""

from dataclasses import dataclass

import numpy as np

from . import rigid_body

# Every how many steps of 1 ms a sample is used.
THINNING = 20
# Below this the engine's dry friction is a slope and its torque anything up to its level, rad/s.
AT_REST_RAD_S = 4e-3
# Preprocessing of recordings: multiples of f_dyn at which positions and both sides of the equation are filtered.
F_DYN_HZ, POSITION_MULTIPLE, PARALLEL_MULTIPLE = 10.0, 5.0, 2.0


@dataclass
class Structure:
    """Which terms the experiment has, per joint."""

    robot: object
    coulomb: np.ndarray
    viscous: np.ndarray
    rotors: list

    @staticmethod
    def of(robot, hidden):
        n = robot.joints
        coulomb, viscous = np.ones(n, bool), np.ones(n, bool)
        for joint, term in hidden:
            (coulomb if term == "coulomb" else viscous)[joint] = False
        rotors = []
        if robot.geared:
            absorbed = rigid_body.absorbed_rotors(robot.mdh, robot.gravity_m_s2, range(n))
            rotors = [j for j in range(n) if j not in absorbed]
        return Structure(robot, coulomb, viscous, rotors)

    def columns(self, q, v, a):
        """(samples, n, coefficients)."""
        robot, n = self.robot, self.robot.joints
        rigid = rigid_body.regressor(robot.mdh, robot.gravity_m_s2, q, v, a)
        own = np.zeros((len(q), n, 3 * n))
        for j in range(n):
            if self.coulomb[j]:
                own[:, j, 3 * j] = np.sign(v[:, j])
            if self.viscous[j]:
                own[:, j, 3 * j + 1] = v[:, j]
            if j in self.rotors:
                own[:, j, 3 * j + 2] = a[:, j]
        return np.concatenate([rigid, own], 2)

    def predicted(self, coefficients, q, v, a):
        """Torque (samples, n) of fitted coefficients, without columns."""
        robot, n = self.robot, self.robot.joints
        rigid, own = coefficients[: 10 * n], coefficients[10 * n :].reshape(n, 3)
        torque = rigid_body.torque(robot.mdh, robot.gravity_m_s2, rigid, q, v, a)
        return torque + own[:, 0] * np.sign(v) + own[:, 1] * v + own[:, 2] * a

    def fit(self, samples, weights=None):
        """Coefficients of least length for samples (columns, torques, used), joints weighted."""
        weights = 1 / self.robot.torque_noise_nm if weights is None else weights
        normal, right = 0.0, 0.0
        for columns, torque, used in samples:
            rows = (columns * weights[:, None])[used]
            normal, right = normal + rows.T @ rows, right + rows.T @ (torque * weights)[used]
        scale = np.sqrt(np.maximum(np.diag(normal), 1e-30))
        values, vectors = np.linalg.eigh(normal / np.outer(scale, scale))
        # Squares of singular values: what lies below 1e-11 of the largest is not determined.
        kept = values > 1e-11 * values[-1]
        basis = vectors[:, kept]
        return basis @ ((basis.T @ (right / scale)) / values[kept]) / scale


class NoiseFree:
    """Samples of a trace as noise-free sensors show them."""

    def __init__(self, structure, trace, instrument, window_s=None):
        t = trace.time_s
        kept = np.arange(0, len(t), THINNING)
        if window_s is not None:
            kept = kept[(t[kept] >= window_s[0]) & (t[kept] <= window_s[1])]
        v = trace.v_rad_s[kept]
        self.columns = structure.columns(trace.q_rad[kept] + instrument.encoder_offset_rad, v, trace.a_rad_s2[kept])
        self.torque = instrument.shown(t, trace.torque_nm, t[kept])
        self.used = np.abs(v) > AT_REST_RAD_S
        self.noise = structure.robot.torque_noise_nm

    def parts(self):
        return self.columns, self.torque, self.used

    def left_over(self, coefficients):
        """Mean square of what coefficients leave, over the noise's variance, per joint."""
        left = (self.torque - self.columns @ coefficients) / self.noise
        return (left ** 2 * self.used).sum(0) / np.maximum(self.used.sum(0), 1)


def _low_pass(series, cutoff_hz, rate_hz, order=4):
    """Butterworth filter forward and backward, as the square of its magnitude; odd reflection at both ends."""
    pad = min(len(series) - 1, int(3 * rate_hz / cutoff_hz) + 10)
    ends = 2 * series[:1] - series[pad:0:-1], 2 * series[-1:] - series[-2 : -pad - 2 : -1]
    padded = np.concatenate([ends[0], series, ends[1]])
    f = np.fft.rfftfreq(len(padded), 1 / rate_hz)
    warped = np.tan(np.pi * np.minimum(f, 0.4999 * rate_hz) / rate_hz) / np.tan(np.pi * cutoff_hz / rate_hz)
    filtered = np.fft.irfft(np.fft.rfft(padded, axis=0) / (1 + warped ** (2 * order))[:, None], len(padded), axis=0)
    return filtered[pad : pad + len(series)]


class Processed:
    """A logged recording with an even clock, filtered and differentiated."""

    def __init__(self, structure, t, q, u):
        rate = (len(t) - 1) / (t[-1] - t[0])
        even = t[0] + np.arange(len(t)) / rate
        first = np.concatenate([[True], np.diff(t) > 0])
        q, u = (np.stack([np.interp(even, t[first], x[first]) for x in series.T], 1) for series in (q, u))
        q = _low_pass(q, min(POSITION_MULTIPLE * F_DYN_HZ, 0.4 * rate), rate)
        self.rate, self.structure, self.measured = rate, structure, u
        self.q, self.v = q, np.gradient(q, 1 / rate, axis=0)
        self.a = np.gradient(self.v, 1 / rate, axis=0)
        self.every = max(1, int(0.8 * rate / (4 * F_DYN_HZ)))
        self.cutoff = PARALLEL_MULTIPLE * F_DYN_HZ

    def rows(self):
        """Columns of doubly filtered motion, thinned: close enough to filtered columns for a fit."""
        q, v, a, u = (_low_pass(x, self.cutoff, self.rate)[:: self.every] for x in (self.q, self.v, self.a, self.measured))
        return self.structure.columns(q, v, a), u, np.abs(v) > AT_REST_RAD_S

    def residual_rms_nm(self, coefficients):
        left = self.measured - self.structure.predicted(coefficients, self.q, self.v, self.a)
        return np.sqrt((_low_pass(left, self.cutoff, self.rate)[:: self.every] ** 2).mean(0))

"""Laws of friction and torque for which the engine has no word; they act between its steps.

A law sets the level of the engine's own dry friction on its joint (`loss`), or a torque on it (`applied`), from the state
that the last step reached. `load` is what the joint transmits: all its torques less that of its rotor's acceleration.
"""

from math import copysign, exp, sin, sqrt, tanh

import numpy as np


class Law:
    """A law on one joint; states begin anew with every recording."""

    wants_load = False

    def __init__(self, joint):
        self.joint = joint

    def begin(self, model, step_s):
        self.step_s = step_s
        return self

    def act(self, t, q, v, load, loss, applied):
        raise NotImplementedError


class StribeckLevel(Law):
    """coulomb + excess exp(-|v / speed|^exponent)."""

    def __init__(self, joint, coulomb, excess, speed, exponent):
        super().__init__(joint)
        self.values = coulomb, excess, speed, exponent

    def act(self, t, q, v, load, loss, applied):
        coulomb, excess, speed, exponent = self.values
        loss[self.joint] = coulomb + excess * exp(-((abs(v[self.joint]) / speed) ** exponent))


class DirectedLevel(Law):
    """One level for each direction."""

    def __init__(self, joint, forward, back):
        super().__init__(joint)
        self.forward, self.back = forward, back

    def act(self, t, q, v, load, loss, applied):
        loss[self.joint] = self.forward if v[self.joint] > 0 else self.back


class LoadLevel(Law):
    """coulomb + (driving or driven) |load|, by the sign of the power that the joint passes on."""

    wants_load = True

    def __init__(self, joint, coulomb, driving, driven):
        super().__init__(joint)
        self.values = coulomb, driving, driven

    def act(self, t, q, v, load, loss, applied):
        coulomb, driving, driven = self.values
        tau = load[self.joint]
        loss[self.joint] = coulomb + (driving if tau * v[self.joint] > 0 else driven) * abs(tau)


class WarmFriction(Law):
    """All friction times 1 - fall w, where the warmth w goes from its first value to 1 with a time constant."""

    def __init__(self, joint, coulomb, viscous, fall, time_s, first):
        super().__init__(joint)
        self.values = coulomb, viscous, fall, time_s, first

    def act(self, t, q, v, load, loss, applied):
        coulomb, viscous, fall, time_s, first = self.values
        warm = fall * (1 - (1 - first) * exp(-t / time_s))
        loss[self.joint] = coulomb * (1 - warm)
        applied[self.joint] = viscous * warm * v[self.joint]


class DirectedSlope(Law):
    """Viscous friction that is steeper forward by what it is flatter back."""

    def __init__(self, joint, half):
        super().__init__(joint)
        self.half = half

    def act(self, t, q, v, load, loss, applied):
        applied[self.joint] = -self.half * abs(v[self.joint])


class BentSlope(Law):
    """size ((|v| + v0)^power - v0^power) sgn v."""

    def __init__(self, joint, size, power):
        super().__init__(joint)
        self.size, self.power = size, power

    def act(self, t, q, v, load, loss, applied):
        speed = v[self.joint]
        applied[self.joint] = -copysign(self.size * ((abs(speed) + 0.02) ** self.power - 0.02 ** self.power), speed)


class Bristles(Law):
    """Elements in parallel, each stiff until it slips at its share of the level (Maxwell slip)."""

    def __init__(self, joint, levels_nm, distances_rad):
        super().__init__(joint)
        self.levels = np.asarray(levels_nm)
        self.stiffness = self.levels / np.asarray(distances_rad)

    def begin(self, model, step_s):
        self.force, self.last = np.zeros(len(self.levels)), None
        return super().begin(model, step_s)

    def act(self, t, q, v, load, loss, applied):
        here = float(q[self.joint])
        moved = 0.0 if self.last is None else here - self.last
        self.last = here
        self.force = np.minimum(np.maximum(self.force + self.stiffness * moved, -self.levels), self.levels)
        applied[self.joint] = -float(self.force.sum())


class Dahl(Law):
    """dF/dq = stiffness |1 - F/level sgn v|^power sgn(1 - F/level sgn v)."""

    def __init__(self, joint, level_nm, distance_rad, power):
        super().__init__(joint)
        self.values = level_nm, level_nm / distance_rad, power

    def begin(self, model, step_s):
        self.force, self.last = 0.0, None
        return super().begin(model, step_s)

    def act(self, t, q, v, load, loss, applied):
        level, stiffness, power = self.values
        here = float(q[self.joint])
        moved = 0.0 if self.last is None else here - self.last
        self.last = here
        pieces = 1 + int(abs(moved) * stiffness / (0.1 * level))
        for _ in range(min(pieces, 40)):
            left = 1 - self.force / level * (1 if moved > 0 else -1)
            self.force += stiffness * copysign(abs(left) ** power, left) * moved / pieces
        applied[self.joint] = -self.force


class Ripple(Law):
    """amplitude (sin(order q + phase) + overtone sin(2 order q + phase)) against the drive."""

    def __init__(self, joint, amplitude, order, phase, overtone):
        super().__init__(joint)
        self.values = amplitude, order, phase, overtone

    def act(self, t, q, v, load, loss, applied):
        amplitude, order, phase, overtone = self.values
        angle = order * q[self.joint]
        applied[self.joint] = -amplitude * (sin(angle + phase) + overtone * sin(2 * angle + phase))


class AngleOfAnother(Law):
    """Dry friction that grows where another joint stands at a certain angle, as of a cable that is bent there."""

    def __init__(self, joint, other, coulomb, excess, centre, width):
        super().__init__(joint)
        self.values = other, coulomb, excess, centre, width

    def act(self, t, q, v, load, loss, applied):
        other, coulomb, excess, centre, width = self.values
        loss[self.joint] = coulomb + excess * exp(-(((q[other] - centre) / width) ** 2))


class Wander(Law):
    """A torque that drifts by chance and forgets itself with a time constant."""

    def __init__(self, joint, size, time_s, seed):
        super().__init__(joint)
        self.values = size, time_s
        self.random = np.random.default_rng(seed)

    def begin(self, model, step_s):
        size, time_s = self.values
        self.keep = exp(-step_s / time_s)
        self.kick = size * sqrt(1 - self.keep ** 2)
        self.drawn, self.place, self.torque = self.random.standard_normal(200_000), 0, 0.0
        self.torque = size * self.drawn[-1]
        return super().begin(model, step_s)

    def act(self, t, q, v, load, loss, applied):
        self.torque = self.keep * self.torque + self.kick * self.drawn[self.place % len(self.drawn)]
        self.place += 1
        applied[self.joint] = self.torque


class Bursts(Law):
    """Dry friction that rises for a while at chance instants, as of dirt in a bearing."""

    def __init__(self, joint, coulomb, excess, every_s, seed):
        super().__init__(joint)
        self.values = coulomb, excess, every_s
        self.random = np.random.default_rng(seed)

    def begin(self, model, step_s):
        self.on, self.until = False, 0.0
        return super().begin(model, step_s)

    def act(self, t, q, v, load, loss, applied):
        coulomb, excess, every_s = self.values
        if t >= self.until:
            self.on = not self.on
            self.until = t + self.random.exponential(every_s * (0.35 if self.on else 0.65)) + 0.05
        loss[self.joint] = coulomb + (excess if self.on else 0.0)


class Magnet(Law):
    """A narrow well that draws the joint to an angle."""

    def __init__(self, joint, size, centre, width):
        super().__init__(joint)
        self.values = size, centre, width

    def act(self, t, q, v, load, loss, applied):
        size, centre, width = self.values
        off = (q[self.joint] - centre) / width
        applied[self.joint] = -1.65 * size * off * exp(-0.5 * off * off) * tanh(10 * t)

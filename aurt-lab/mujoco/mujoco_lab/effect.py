"""What every effect has: joints, a size for each or one for all, and what it does to the arm or to its sensors."""

import numpy as np


class Effect:
    """An effect of a certain size. Subclasses say what a size of 1 is, within which bounds it lies, and what it does."""

    identifier = ""
    family = ""
    # "structural": the experiment lacks it; "later": it came after calibration; "either".
    presence = "structural"
    # True: the rotors are geared; False: they are discs of the links; None: either.
    geared = None
    # "few": one or two joints, a size each; "one"; "pair"; "all".
    takes = "few"
    # Terms of the experiment that the effect stands for, and that the experiment leaves out.
    hides = None
    whole_arm = False
    window_s = None
    slow = False

    def __init__(self, robot, joints, random, duration_s):
        self.robot, self.joints, self.random, self.duration_s = robot, list(joints), random, duration_s
        self.size = np.ones(len(self.joints) if self.takes == "few" else 1)
        self.low, self.high = 1e-4, 1e4
        self.draw(random)

    @classmethod
    def suits(cls, robot, joint):
        return True

    def draw(self, random):
        """Draws everything but the size."""

    def noise(self, i=0):
        return self.robot.torque_noise_nm[self.joints[i]]

    def scale(self, factors):
        """Multiplies the sizes, one factor each, within the bounds."""
        self.size = np.clip(self.size * factors, self.low, self.high)

    def install(self, build):
        """Changes the arm."""

    def sense(self, instrument):
        """Changes the sensors."""

    def parameters(self):
        """Canonical names with one value, or one per joint."""
        return []

    def fields(self):
        """Everything that the effect drew, for the sealed truth."""
        plain = (int, float, str, bool)
        found = {k: v for k, v in vars(self).items() if isinstance(v, plain)}
        found |= {k: np.asarray(v).tolist() for k, v in vars(self).items() if isinstance(v, (list, tuple, np.ndarray))}
        for name in ("low", "high", "duration_s"):
            found.pop(name, None)
        return found


def each(effect, values):
    return [float(v) for v in np.broadcast_to(values, len(effect.joints))]

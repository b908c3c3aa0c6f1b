"""Simulated laboratories for next-proof.py: an arm, its first short recording, one effect, and what the experiment says of them.

`clean` and `rough` are simulated by `aurt simulate`, `mujoco` by another engine (aurt-lab/mujoco, which needs its requirements), `servo` by
`aurt-lab`.
"""

import csv
import json
import math
import pathlib
import random
import subprocess
import sys

ARMS = {
    "ur10e": {
        "mdh": "pi/2,0,0.1807\n0,-0.6127,0\n0,-0.57155,0\npi/2,0,0.17415\n-pi/2,0,0.11985\n0,0,0.11655\n",
        "coulomb": [12.0, 14.0, 8.5, 3.6, 4.1, 3.1], "viscous": [13.5, 13.0, 8.5, 3.2, 3.4, 2.6],
        "noise": [1.6, 1.9, 1.1, 0.32, 0.32, 0.32], "home": [0.0, -1.55, 0.5, -1.5, 0.3, 0.0],
        "constants": [11.976, 11.976, 9.839, 10.763, 10.763, 10.763], "loaded": [1, 2]},
    "panda": {
        "mdh": "-pi/2,0,0.333\npi/2,0,0\npi/2,0.0825,0.316\n-pi/2,-0.0825,0\npi/2,0,0.384\npi/2,0.088,0\n0,0,0.107\n",
        "coulomb": [0.55, 0.55, 0.4, 0.5, 0.32, 0.25, 0.3], "viscous": [0.6, 0.6, 0.45, 0.5, 0.3, 0.22, 0.25],
        "noise": [0.15, 0.2, 0.15, 0.15, 0.06, 0.06, 0.035], "home": [0.0, -0.4, 0.0, -1.7, 0.0, 1.7, 0.6],
        "constants": None, "loaded": [1, 3]},
}
# Effects that need the load of a joint, and the size of the others over the noise of the measured torque.
OF_LOAD = ("load_dependent_friction", "drive_efficiency", "torque_constant")
EFFECTS = ("stribeck", "viscous_nonlinear", "coulomb_asymmetry", "viscous_asymmetry", "current_offset", "presliding_hysteresis",
           "spring", "torque_ripple", *OF_LOAD)
SIZES = (1.0, 6.0)
RATE_HZ = 200.0


def run(*command):
    """The finished process; exit status 1 means that something was found."""
    done = subprocess.run([str(word) for word in command], capture_output=True, text=True)
    if done.returncode > 1:
        raise RuntimeError(f"{' '.join(map(str, command))}\n{done.stdout}\n{done.stderr}")
    return done


def ease(x):
    """The step from 0 to 1 with vanishing velocity and acceleration at both ends."""
    x = min(max(x, 0.0), 1.0)
    return x ** 3 * (10.0 - 15.0 * x + 6.0 * x * x)


def first_motion(kind, home, duration_s, rng):
    """A short, narrow or slow motion of a kind that people record; a function of time, from rest to rest."""
    n, narrow = len(home), [rng.uniform(0.2, 0.8) for _ in home]
    if kind == "joint by joint":
        # Each joint there and back in its turn; the others rest.
        slot_s = duration_s / n
        away = lambda j, t: ease((t - j * slot_s) / (0.45 * slot_s)) - ease((t - (j + 0.5) * slot_s) / (0.45 * slot_s))
    elif kind == "two poses":
        # Between two poses, always in the same time.
        move_s, rest_s = rng.uniform(1.2, 2.5), rng.uniform(0.1, 0.5)
        sides = [rng.choice((-1.0, 1.0)) for _ in home]
        moves = int((duration_s - 0.5) / (move_s + rest_s))
        away = lambda j, t: sides[j] * sum((-1.0) ** k * ease((t - 0.3 - k * (move_s + rest_s)) / move_s) for k in range(moves))
    elif kind == "one sine":
        # One frequency for each joint.
        hz = [rng.uniform(0.08, 0.25) for _ in home]
        away = lambda j, t: ease(0.5 * t) * ease(0.5 * (duration_s - t)) * math.sin(2.0 * math.pi * hz[j] * t)
    else:
        # To and fro at one speed: a triangle whose corners are rounded.
        hz = [rng.uniform(0.06, 0.2) for _ in home]
        away = lambda j, t: ease(0.5 * t) * ease(0.5 * (duration_s - t)) * math.asin(0.95 * math.sin(2.0 * math.pi * hz[j] * t)) / 1.26
    return lambda t: [home[j] + narrow[j] * away(j, t) for j in range(n)]


def beginning(position, duration_s):
    """A motion that comes to rest after so many seconds: in the last of them its time slows down to a stop."""
    late = lambda x: x ** 4 * (2.5 - 3.0 * x + x * x)
    return lambda t: position(t - late(min(max(t - duration_s + 1.0, 0.0), 1.0)))


MOTIONS = ("joint by joint", "two poses", "one sine", "one speed")


def write_motion(file, duration_s, position):
    rows = [[f"{k / RATE_HZ:.4f}", *(f"{q:.8f}" for q in position(k / RATE_HZ))] for k in range(int(duration_s * RATE_HZ) + 1)]
    header = ["time", *(f"q_{j}" for j in range(len(rows[0]) - 1))]
    file.write_text("".join(",".join(row) + "\n" for row in [header, *rows]))


def write_limits(file, rows):
    rows = [["lower_rad", "upper_rad", "velocity_rad_s", "acceleration_rad_s2"], *rows]
    file.write_text("".join(",".join(map(str, row)) + "\n" for row in rows))


class Simulated:
    """The worlds `clean` and `rough`: AURT's simulator. Rough are the noise, the encoders, the clock, the servo and the experiment.

    The background of `rough` is what its experiments do not say: weak effects on all joints, and rows that the logger lost.
    """

    def __init__(self, program, robot, folder, rough, rng):
        self.program, self.robot, self.folder, self.rough, self.arm = program, robot, folder, rough, ARMS[robot]
        self.home, self.noise, self.constants = self.arm["home"], self.arm["noise"], self.arm["constants"]
        self.gravity, self.mdh = [0.0, 0.0, -9.81], "alpha,a,d\n" + self.arm["mdh"]
        self.background, self.head, self.memory = [], [], (0.0, 1.0)
        jitter = missing = 0.0
        if rough:
            log = lambda low, high: math.exp(rng.uniform(math.log(low), math.log(high)))
            step, white = math.tau / 2 ** rng.randint(14, 19), log(1e-6, 3e-5)
            jitter, missing = rng.uniform(0.0, 0.05), rng.uniform(0.0, 3e-3)
            self.memory = rng.uniform(0.1, 0.5), log(0.01, 1.0)
            self.head += [f"[controller]\nbandwidth_hz = {log(8, 50):.2f}\ndamping_ratio = {rng.uniform(0.4, 1.0):.2f}",
                          f"feed_forward = {rng.uniform(0.7, 1.0):.2f}\nfriction_feed_forward = {rng.uniform(0.0, 0.8):.2f}"]
            self.head += [f"[[drive]]\njoint = {j}\nencoder_resolution_rad = {step}\nencoder_noise_rad = {white}"
                          for j in range(len(self.home))]
            self.background = [name for name in ("stribeck", "load_dependent_friction", "presliding_hysteresis") if rng.random() < 0.5]
        self.logger = [f"[logger]\nrate_hz = {RATE_HZ}\nclock_jitter_s = {jitter / RATE_HZ}\ntime_decimals = 6",
                       f"[logger.faults]\nmissing_share = {missing}"]

    def conceal(self, name, sizes, rng):
        joints = self.arm["loaded"] if name in OF_LOAD else range(len(self.home))
        self.effect, self.joint = name, rng.choice(list(joints))
        self.background = [other for other in self.background if other != name]
        self.tables = [self.fields(name, self.joint, rng.uniform(*sizes), rng)]
        self.tables += [self.fields(other, j, rng.uniform(0.05, 0.25), rng) for other in self.background for j in range(len(self.home))]
        self.background += ["dropped_samples"] if self.rough else []

    def fields(self, name, j, size, rng):
        torque, coulomb, viscous, sign = size * self.noise[j], self.arm["coulomb"][j], self.arm["viscous"][j], rng.choice((-1, 1))
        share = min(size / SIZES[1], 1.0)
        values = {
            "stribeck": lambda: {"excess_nm": [1.5 * torque], "coulomb_nm": [coulomb], "stribeck_velocity_rad_s": rng.uniform(0.03, 0.15),
                                 "exponent": rng.uniform(1.0, 2.0)},
            "viscous_nonlinear": lambda: {"bend_nm": [0.3 * share * viscous], "slope_nm_s": [viscous], "reference_rad_s": [1.0],
                                          "onset": 0.1},
            "coulomb_asymmetry": lambda: {"half_difference_nm": [0.5 * sign * min(torque, 1.8 * coulomb)], "mean_nm": [coulomb]},
            "viscous_asymmetry": lambda: {"half_difference_nm_s": [sign * min(torque, 0.9 * viscous)], "mean_nm_s": [viscous]},
            "current_offset": lambda: {"offset_nm": [0.5 * sign * torque]},
            "presliding_hysteresis": lambda: {"distance_rad": [0.06 * share], "model": "masing", "damping_share": 0.0},
            "load_dependent_friction": lambda: {"load_coefficient": [0.15 * share]},
            "drive_efficiency": lambda: {"driving": [0.2 * share], "driven": [0.01]},
            "torque_constant": lambda: {"gain_error": [0.12 * sign * share]},
            "spring": lambda: {"stiffness_nm_rad": 2.0 * torque, "rest_rad": self.home[j] + rng.uniform(-0.5, 0.5)},
            "torque_ripple": lambda: {"order": math.exp(rng.uniform(1.1, 4.6)), "amplitude_nm": torque, "phase_rad": rng.uniform(0.0, 6.28),
                                      "overtone": 0.2},
        }[name]()
        where = "joint" if name in ("spring", "torque_ripple") else "joints"
        return {"name": name, where: j if where == "joint" else [j], **values}

    def limits(self):
        done = run(self.program, "excite", "--robot", self.robot, "--duration-s", "10", "--tries", "1", "--seed", "1", "--json", "--out",
                   self.folder / "unused_motion.csv")
        columns = ("lower_rad", "upper_rad", "velocity_rad_s", "acceleration_rad_s2")
        return [[joint[column] for column in columns] for joint in json.loads(done.stdout)["limits"]]

    def record(self, name, seed):
        tables = ["[[effect]]\n" + "\n".join(f"{key} = {json.dumps(value)}" for key, value in table.items()) for table in self.tables]
        scenario = self.folder / f"{name}.toml"
        scenario.write_text("\n".join([f'robot = "{self.robot}"\nseed = {seed}\n[motion]\nkind = "recorded"\nfile = "{name}_motion.csv"',
                                       *self.logger, *self.head, *tables]) + "\n")
        file = self.folder / f"{name}.csv"
        run(self.program, "simulate", "--quiet", "--scenario", scenario, "--out", file)
        if self.rough:
            self.colour(file, seed)

    def colour(self, file, seed):
        """Adds first-order Gauss-Markov noise to the measurement."""
        rng, (share, time_s) = random.Random(seed), self.memory
        rows = list(csv.reader(file.open()))
        n = len(self.home)
        keep = math.exp(-1.0 / (RATE_HZ * time_s))
        sigma = [share * noise / (self.constants[j] if self.constants else 1.0) for j, noise in enumerate(self.noise)]
        slow = [s * rng.gauss(0.0, 1.0) for s in sigma]
        for row in rows[1:]:
            slow = [keep * value + s * math.sqrt(1.0 - keep * keep) * rng.gauss(0.0, 1.0) for value, s in zip(slow, sigma)]
            row[-n:] = [f"{float(value) + extra:.5f}" for value, extra in zip(row[-n:], slow)]
        file.write_text("".join(",".join(row) + "\n" for row in rows))


class MuJoCo:
    """The world `mujoco`: another engine, an arm of its own for each case.

    The torque of a row acts from its instant to the next step's, 1 ms later: all of its recordings have a delay of -0.5 ms.
    """

    background = ["time_delay"]

    def __init__(self, program, robot, folder, rng):
        sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "aurt-lab" / "mujoco"))
        import numpy
        from mujoco_lab import arm, motions, requests, robots, sensing
        self.folder, self.numpy, self.arm, self.motions, self.kinds, self.sensing = folder, numpy, arm, motions, requests.KINDS, sensing
        self.random = numpy.random.default_rng(rng.randrange(2 ** 31))
        self.built = robots.draw(robot, self.random, True)
        self.servo, self.known = motions.servo(self.built, self.random)
        self.home, self.noise = self.built.home_rad.tolist(), self.built.torque_noise_nm.tolist()
        self.constants = self.built.torque_constant_nm_per_a.tolist() if self.built.ampere else None
        self.gravity = self.built.gravity_m_s2.tolist()
        self.mdh = "alpha,a,d\n" + "".join(",".join(map(repr, row)) + "\n" for row in self.built.mdh.tolist())
        self.loaded = ARMS[robot]["loaded"]

    def conceal(self, name, sizes, rng):
        self.effect, self.joint = name, rng.choice(self.loaded if name in OF_LOAD else list(range(len(self.home))))
        self.law = self.kinds[name](self.built, [self.joint], self.random, 10.0)
        self.law.scale(rng.uniform(*sizes) * 0.5)

    def limits(self):
        b = self.built
        rows = zip(b.home_rad - b.reach_rad, b.home_rad + b.reach_rad, b.speed_rad_s, b.acceleration_rad_s2)
        return [list(map(float, row)) for row in rows]

    def record(self, name, seed):
        np = self.numpy
        rows = list(csv.reader((self.folder / f"{name}_motion.csv").open()))
        table = np.array(rows[1:], float)
        t, q = table[:, 0] - table[0, 0], table[:, 1:1 + len(self.home)]
        fine = np.arange(0.0, t[-1], self.motions.GRID_S)
        k = np.minimum(np.searchsorted(t, fine, side="right") - 1, len(t) - 2)
        step = (t[k + 1] - t[k])[:, None]
        x, slope = (fine - t[k])[:, None] / step, np.gradient(q, t, axis=0)
        q = (q[k] * (1 + 2 * x) + step * slope[k] * x) * (1 - x) ** 2 + (q[k + 1] * (3 - 2 * x) + step * slope[k + 1] * (x - 1)) * x ** 2
        v = np.gradient(q, self.motions.GRID_S, axis=0)
        motion = self.motions.Motion(float(fine[-1]), q, v, np.gradient(v, self.motions.GRID_S, axis=0))
        self.motions.feed_forward(self.built, motion, self.known)
        build, instrument = self.arm.Build.of(self.built), self.sensing.Instrument.of(self.built)
        self.law.install(build)
        self.law.sense(instrument)
        trace = self.arm.run(build, self.servo, motion)
        rows = self.sensing.log(self.built, instrument, trace, {"rate_hz": RATE_HZ}, np.random.default_rng(seed))
        (self.folder / f"{name}.csv").write_text(self.sensing.csv(self.built, *rows))


class Servo:
    """The world `servo` of `aurt-lab`: commands and positions at 50 Hz."""

    background, joint, period_s = [], None, 0.02

    def __init__(self, program, folder, seed, rng):
        self.program, self.folder = pathlib.Path(program).resolve().with_name("aurt-lab"), folder
        folder.mkdir(parents=True, exist_ok=True)
        (folder / "plan.toml").write_text(f'[singles]\nstrengths = ["{rng.choice(("weak", "medium", "strong"))}"]\n')
        run(self.program, "conceal", "--world", "servo", "--plan", folder / "plan.toml", "--seed", seed, "--cases", folder / "cases",
            "--sealed", folder / "sealed")
        self.truth = rng.choice(sorted((folder / "sealed").glob("*.json")))
        self.case, self.effect = folder / "cases" / self.truth.stem, json.loads(self.truth.read_text())["effects"][0]["effect"]
        rows = [list(map(float, row)) for row in csv.reader((self.case / "recording_1.csv").read_text().splitlines()[1:])]
        self.commands, self.duration_s = [row[1:1 + len(row) // 2] for row in rows], rows[-1][0]
        write_limits(folder / "limits.csv", map(self.limits, zip(*self.commands)))

    def limits(self, command):
        """As `aurt next` takes them from commands."""
        slopes = lambda series: [(b - a) / self.period_s for a, b in zip(series, series[1:])]
        return min(command), max(command), max(map(abs, slopes(command))), max(map(abs, slopes(slopes(command))))

    def first(self, t):
        return self.commands[min(round(t / self.period_s), len(self.commands) - 1)]

    def record(self, name, seed):
        for k, role in enumerate(("calibration", "validation")):
            run(self.program, "record", "--truth", self.truth, "--motion", self.folder / f"{name}_motion.csv", "--seed", 2 * seed + k,
                "--out", self.folder / f"{name}_{role}.csv")

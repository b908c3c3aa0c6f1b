"""Servo arms for next-proof.py: cases of the world `servo`, of which one recording is fitted and one is held out.

What is added is recorded twice by `aurt-lab record`: once to be fitted, once to be held out.
"""

import csv
import json
import math
import pathlib
import re

from next_proof_worlds import run

EFFECTS = ("time_delay", "dead_band", "coulomb", "stribeck", "load_dependent_friction", "payload", "speed_limit", "saturation",
           "torque_constant")
CLAIMS = ("missing", "given_wrong")
OVER_S = 0.02


class Servos:
    """The methods of a case in which an arm of servos differs from one that records torques."""

    # What `aurt next` takes from the recordings.
    has_limits = False

    def __init__(self, program, _world, _sizes, folder, rng):
        self.program, self.folder, self.robot, self.joint, self.motion = program, folder, "servo_arm", None, "commands"
        self.lab = pathlib.Path(program).resolve().with_name("aurt-lab")
        self.effect, strength, self.seed = rng.choice(EFFECTS), rng.choice(("weak", "medium", "strong")), rng.randrange(2 ** 31)
        folder.mkdir(parents=True, exist_ok=True)
        (folder / "plan.toml").write_text(f'[singles]\neffects = ["{self.effect}"]\nstrengths = ["{strength}"]\ntrials = 1\n')
        run(self.lab, "conceal", "--world", "servo", "--plan", folder / "plan.toml", "--seed", self.seed, "--cases", folder / "cases",
            "--sealed", folder / "sealed")
        [self.truth] = (folder / "sealed").glob("*.json")
        self.case = folder / "cases" / self.truth.stem
        self.rows = list(csv.reader((self.case / "recording_1.csv").open()))
        self.joints, self.duration_s = (len(self.rows[0]) - 1) // 2, 12.0
        series = [[float(row[1 + j]) for row in self.rows[1:]] for j in range(self.joints)]
        (folder / "limits.csv").write_text("lower_rad,upper_rad,velocity_rad_s,acceleration_rad_s2\n" +
                                           "".join(",".join(map(str, self.limits(one))) + "\n" for one in series))

    @staticmethod
    def limits(command, rate_hz=50.0):
        """As `aurt next` takes them from commands."""
        over = round(OVER_S * rate_hz)
        speeds = [(b - a) / OVER_S for a, b in zip(command, command[over:])]
        changes = [abs(b - a) / OVER_S for a, b in zip(speeds, speeds[over:])]
        return min(command), max(command), max(map(abs, speeds)), max(changes)

    def experiment(self, *recordings):
        """The case's experiment, with what was added among the fitted recordings and, once more, among those held out."""
        text = (self.case / "experiment.toml").read_text()
        columns = re.search(r"columns = \{.*?\}", text).group()
        added = recordings[1:]
        listed = lambda first, again: ", ".join(f'{{ file = "{name}", {columns} }}' for name in
                                                [first, *(f"../../{name}_{again}.csv" for name in added)])
        head = text.split("[recordings]")[0]
        file = self.case / f"experiment_{recordings[-1]}.toml"
        file.write_text(f'{head}[recordings]\ncalibration = [{listed("recording_1.csv", "fitted")}]\n'
                        f'validation = [{listed("recording_4.csv", "held_out")}]\n')
        return file

    def verdict(self, *recordings):
        out = self.folder / f"verdict_{recordings[-1]}"
        run(self.program, "diagnose", "--quiet", self.experiment(*recordings), "--out", out)
        return json.loads((out / "verdict.json").read_text())

    def judged(self, verdict):
        own, others = self.claims(verdict)
        if own and not others and not own[0]["alternatives"]:
            return "right"
        return "wrong" if others and not own and not any(other["alternatives"] for other in others) else "open"

    def claims(self, verdict):
        claims = [one for one in verdict["structures"] if one["answer"] in CLAIMS]
        return [one for one in claims if one["id"] == self.effect], [one for one in claims if one["id"] != self.effect]

    def doubt(self, verdict):
        own, others = self.claims(verdict)
        if self.judged(verdict) == "right":
            return None
        if any(one["alternatives"] for one in own) or any(self.effect in other["alternatives"] for other in others):
            return "rivals"
        if own or others:
            return None
        better = [one for one in verdict["structures"] if one["id"] == self.effect and one["evidence"]["gain_nats_per_s"] > 0.0]
        return "indicated" if any(one["objection"] in ("chance", "reduction", "size") for one in better) else None

    def stated(self, plan):
        subjects = lambda doubt: [doubt[key]["effect"] for key in ("claimed", "rival", "subject") if key in doubt]
        own = [one for one in plan["open"] if self.effect in subjects(one["doubt"])]
        columns = {"planned": "planned", "generic": "multi_sine", "again": "recorded_again"}
        return {way: min((one[column]["settled"] for one in own), default=0.0) for way, column in columns.items()}

    def excite(self, common, out):
        run(self.program, "excite", "--robot", self.case / "robot.urdf", "--gravity", 0, 0, -9.81, *common, "--tries", "100",
            "--seed", self.seed % 1000, "--out", out)

    def first_again(self, added_s, file):
        last_s = added_s or math.inf
        rows = [row[:1 + self.joints] for row in self.rows[1:] if float(row[0]) <= last_s]
        header = ["time", *(f"q_{j}" for j in range(self.joints))]
        file.write_text("".join(",".join(row) + "\n" for row in [header, *rows]))

    def record(self, name, seed):
        for k, again in enumerate(("fitted", "held_out")):
            run(self.lab, "record", "--truth", self.truth, "--motion", self.folder / f"{name}_motion.csv", "--seed", 2 * seed + k,
                "--out", self.folder / f"{name}_{again}.csv")

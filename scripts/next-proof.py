#!/usr/bin/env python3
"""How often `aurt next` decides what a diagnosis leaves open, on simulated robots whose truth is known.

Every case is a UR10e with one effect, recorded in one short motion of the kind that people record. Where the diagnosis leaves a
doubt in which the truth takes part, three recordings of equal length are added to it, each by itself: the motion that `aurt next`
plans, a multi-sine with the smallest condition number (`aurt excite`), and another motion of the first's kind. The diagnosis of both
recordings is right if it names the effect without an alternative, wrong if it names the rival in its place, else still open.

    python3 scripts/next-proof.py --aurt target/release/aurt --seed 1 --cases 40 --out next-proof
"""

import argparse
import collections
import json
import pathlib
import random
import subprocess

MDH = "alpha,a,d\npi/2,0,0.1807\n0,-0.6127,0\n0,-0.57155,0\npi/2,0,0.17415\n-pi/2,0,0.11985\n0,0,0.11655\n"
ROW_OF = {"planned": "the motion that `aurt next` plans", "generic": "a multi-sine of `aurt excite`", "again": "another motion of the first's kind"}
CONSTANTS = [11.976, 11.976, 9.839, 10.763, 10.763, 10.763]
FRICTION = [18.0, 18.0, 10.0, 4.0, 4.0, 4.0]


def effects(rng, joint):
    """One effect of a size that short recordings leave doubts about."""
    size = FRICTION[joint]
    share = rng.uniform(0.1, 0.4)
    return rng.choice([
        {"name": "stribeck", "excess_nm": [share * size], "coulomb_nm": [size], "stribeck_velocity_rad_s": rng.uniform(0.02, 0.2),
         "exponent": rng.uniform(1.0, 2.0)},
        {"name": "viscous_nonlinear", "bend_nm": [0.4 * share * size], "slope_nm_s": [size], "reference_rad_s": [1.0], "onset": 0.1},
        {"name": "coulomb_asymmetry", "half_difference_nm": [0.5 * share * size], "mean_nm": [size]},
        {"name": "current_offset", "offset_nm": [0.5 * share * size]},
        {"name": "load_dependent_friction", "load_coefficient": [0.3 * share]},
        {"name": "viscous_asymmetry", "half_difference_nm_s": [0.4 * share * size], "mean_nm_s": [size]},
        {"name": "presliding_hysteresis", "distance_rad": [rng.uniform(0.01, 0.05)], "model": "masing", "damping_share": 0.0},
    ])


def run(*command):
    done = subprocess.run([str(word) for word in command], capture_output=True, text=True)
    if done.returncode > 1:
        raise SystemExit(f"{' '.join(map(str, command))}\n{done.stdout}\n{done.stderr}")
    return done


class Case:
    def __init__(self, program, folder, rng):
        self.program, self.folder = program, folder
        self.joint = rng.randrange(6)
        self.effect = effects(rng, self.joint)
        self.seed = rng.randrange(2**31)
        self.duration_s = rng.uniform(12.0, 25.0)
        self.motion = rng.choice(["multi_sine", "point_to_point"])
        folder.mkdir(parents=True)
        (folder / "mdh.csv").write_text(MDH)

    def record(self, name, motion, seed):
        fields = [f"robot = \"ur10e\"\nseed = {seed}\n[motion]"]
        fields += [f"{key} = {json.dumps(value)}" for key, value in motion.items()]
        fields += ["[logger]\nrate_hz = 250", "[[effect]]", f"joints = [{self.joint}]"]
        fields += [f"{key} = {json.dumps(value)}" for key, value in self.effect.items()]
        scenario = self.folder / f"{name}.toml"
        scenario.write_text("\n".join(fields) + "\n")
        run(self.program, "simulate", "--quiet", "--scenario", scenario, "--out", self.folder / f"{name}.csv")

    def first(self):
        kinds = {
            "multi_sine": {"kind": "multi_sine", "duration_s": self.duration_s, "harmonics": 6, "top_hz": 0.8, "share": 0.6},
            "point_to_point": {"kind": "point_to_point", "duration_s": self.duration_s, "share": 0.5, "rest_s": 0.3},
        }
        return kinds[self.motion]

    def experiment(self, *recordings):
        listed = ", ".join(f'"{name}.csv"' for name in recordings)
        file = self.folder / f"experiment_{recordings[-1]}.toml"
        file.write_text(
            f'schema = 1\n[robot]\nmdh = "mdh.csv"\ngravity_m_s2 = [0.0, 0.0, -9.81]\ntorque_constants_nm_per_a = {CONSTANTS}\n[joint_dynamics]\ncoulomb = {{ model = '
            f'"constant" }}\nhysteresis = {{ model = "sign" }}\nviscous = {{ model = "polynomial", powers = [1] }}\n[[arm_terms]]\n'
            f'model = "rotor_inertia"\njoints = [0, 1, 2, 3, 4, 5]\n[recordings]\ncalibration = [{listed}]\n[preprocess]\n'
            "f_dyn_hz = 8.0\n")
        return file

    def verdict(self, *recordings):
        out = self.folder / f"verdict_{recordings[-1]}"
        run(self.program, "diagnose", "--quiet", "--verdict-only", self.experiment(*recordings), "--out", out)
        return json.loads((out / "verdict.json").read_text())

    def judged(self, verdict):
        own = [e for e in verdict["effects"] if e["effect"] == self.effect["name"] and self.joint in e["joints"]]
        others = [e for e in verdict["effects"] if e not in own and self.joint in e["joints"]]
        if own and not own[0]["alternatives"] and not others:
            return "right"
        return "wrong" if others and not own and not any(e["alternatives"] for e in others) else "open"

    def doubtful(self, plan):
        """The doubts of a plan in which the truth takes part."""
        def about(subject):
            return subject["effect"] == self.effect["name"] and self.joint in subject["joints"]
        subjects = lambda doubt: [doubt[k] for k in ("claimed", "rival", "subject") if k in doubt]
        return [o for o in plan["open"] if o["doubt"]["kind"] != "absorbed" and any(map(about, subjects(o["doubt"])))]


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--aurt", default="target/release/aurt")
    parser.add_argument("--seed", type=int, required=True)
    parser.add_argument("--cases", type=int, default=40)
    parser.add_argument("--out", type=pathlib.Path, required=True)
    arguments = parser.parse_args()
    rng = random.Random(arguments.seed)
    table = {way: collections.Counter() for way in ROW_OF}
    expected, doubtful, kinds = [], 0, collections.Counter()
    for k in range(arguments.cases):
        case = Case(arguments.aurt, arguments.out / f"case_{k:03}", random.Random(rng.random()))
        motion = case.first()
        case.record("first", motion, case.seed)
        planned, generic = case.folder / "planned_motion.csv", case.folder / "generic_motion.csv"
        done = run(case.program, "excite", "--robot", "ur10e", "--duration-s", f"{case.duration_s:.1f}", "--tries", "100", "--json",
                   "--seed", case.seed % 1000, "--out", generic)
        limits = json.loads(done.stdout)["limits"]
        columns = ["lower_rad", "upper_rad", "velocity_rad_s", "acceleration_rad_s2"]
        rows = [columns] + [[str(joint[column]) for column in columns] for joint in limits]
        (case.folder / "limits.csv").write_text("".join(",".join(row) + "\n" for row in rows))
        done = run(case.program, "next", case.experiment("first"), "--json", "--limits", case.folder / "limits.csv",
                   "--duration-s", f"{case.duration_s:.1f}", "--out", planned)
        plan = json.loads(done.stdout)
        open_ones = case.doubtful(plan)
        kinds[(case.effect["name"], case.judged(case.verdict("first")))] += 1
        if not open_ones or not planned.is_file():
            continue
        doubtful += 1
        expected.append(min(o["planned"]["settled"] for o in open_ones))
        case.record("planned", {"kind": "recorded", "file": planned.name}, case.seed + 1)
        case.record("generic", {"kind": "recorded", "file": generic.name}, case.seed + 1)
        case.record("again", motion, case.seed + 2)
        row = {}
        for way in table:
            row[way] = case.judged(case.verdict("first", way))
            table[way][row[way]] += 1
        print(case.folder.name, case.effect["name"], case.joint, f"{expected[-1]:.2f}", row, flush=True)
    print(f"\n{arguments.cases} cases, {doubtful} with a doubt about the truth; expected to be settled by the planned motion: "
          f"{sum(expected):.1f}\n")
    print("| recorded beside the first | right | still open | wrong |\n|---|---|---|---|")
    for way, counts in table.items():
        print(f"| {ROW_OF[way]} | {counts['right']} | {counts['open']} | {counts['wrong']} |")


if __name__ == "__main__":
    main()

#!/usr/bin/env python3
"""How often `aurt next` decides what a diagnosis leaves open, on simulated robots whose truth is known.

Every case is an arm with one effect, recorded once in a short, narrow or slow motion of the kind that people have. It is open if the
truth takes part in a claim with alternatives, or is indicated or not decidable on a joint of which nothing is claimed. To an open
case three recordings of equal length are added, each by itself: the motion that `aurt next` plans, a multi-sine with the smallest
condition number (`aurt excite`) within the same limits, and the first motion again. The diagnosis of both recordings is right if it
names the effect without an alternative and nothing else on its joint, wrong if it names only others there without alternatives, else
still open. A constant torque while a joint moves has two names, `current_offset` and `coulomb_asymmetry`.

    python3 scripts/next-proof.py --aurt target/release/aurt --world clean --seed 1 --cases 40 --out next-proof
    python3 scripts/next-proof.py --collect next-proof next-proof-rough
"""

import argparse
import collections
import json
import pathlib
import random

import next_proof_worlds as worlds

WAYS = {"planned": "the motion that `aurt next` plans", "generic": "a multi-sine of `aurt excite`", "again": "the first motion again"}
CONSTANTS = ("current_offset", "coulomb_asymmetry")
F_DYN_HZ = 6.0


class Case:
    """An arm with a concealed effect, and its experiments."""

    def __init__(self, program, world, folder, rng):
        self.program, self.folder = program, folder
        folder.mkdir(parents=True, exist_ok=True)
        self.robot = rng.choice(sorted(worlds.ARMS))
        if world == "mujoco":
            self.lab = worlds.MuJoCo(program, self.robot, folder, rng)
        else:
            self.lab = worlds.Simulated(program, self.robot, folder, world == "rough", rng)
        self.lab.conceal(rng.choice(worlds.EFFECTS), rng)
        self.seed, self.duration_s, self.motion = rng.randrange(2 ** 31), rng.uniform(12.0, 20.0), rng.choice(worlds.MOTIONS)
        (folder / "mdh.csv").write_text(self.lab.mdh)
        rows = [["lower_rad", "upper_rad", "velocity_rad_s", "acceleration_rad_s2"], *self.lab.limits()]
        (folder / "limits.csv").write_text("".join(",".join(map(str, row)) + "\n" for row in rows))
        worlds.write_motion(folder / "first_motion.csv", self.duration_s,
                            worlds.first_motion(self.motion, self.lab.home, self.duration_s, rng))
        (folder / "again_motion.csv").write_bytes((folder / "first_motion.csv").read_bytes())
        self.lab.record("first", self.seed)

    def experiment(self, *recordings):
        listed = ", ".join(f'"{name}.csv"' for name in recordings)
        constants = f"torque_constants_nm_per_a = {self.lab.constants}\n" if self.lab.constants else ""
        file = self.folder / f"experiment_{recordings[-1]}.toml"
        file.write_text(
            f'schema = 1\n[robot]\nmdh = "mdh.csv"\ngravity_m_s2 = {self.lab.gravity}\n{constants}[joint_dynamics]\n'
            'coulomb = { model = "constant" }\nhysteresis = { model = "sign" }\nviscous = { model = "polynomial", powers = [1] }\n'
            f'[[arm_terms]]\nmodel = "rotor_inertia"\njoints = {list(range(len(self.lab.home)))}\n[recordings]\n'
            f"calibration = [{listed}]\n[preprocess]\nf_dyn_hz = {F_DYN_HZ}\n")
        return file

    def verdict(self, *recordings):
        out = self.folder / f"verdict_{recordings[-1]}"
        worlds.run(self.program, "diagnose", "--quiet", "--verdict-only", self.experiment(*recordings), "--out", out)
        return json.loads((out / "verdict.json").read_text())

    def is_truth(self, subject):
        subject = subject.get("finding", subject)
        same = (self.lab.effect,) if self.lab.effect not in CONSTANTS else CONSTANTS
        return subject["effect"] in same and self.lab.joint in subject["joints"]

    def claims(self, verdict):
        """Claims of the truth, and others on its joint; the background of `rough` and `mujoco` is neither right nor wrong."""
        own = [e for e in verdict["effects"] if self.is_truth(e)]
        others = [e for e in verdict["effects"]
                  if e not in own and self.lab.joint in e["joints"] and e["effect"] not in self.lab.background]
        return own, others

    def judged(self, verdict):
        own, others = self.claims(verdict)
        if own and not others and all(self.is_truth(own[0] | a) for a in own[0]["alternatives"]):
            return "right"
        return "wrong" if others and not own and not any(e["alternatives"] for e in others) else "open"

    def doubt(self, verdict):
        """How the truth is open after a diagnosis; none if it is not."""
        own, others = self.claims(verdict)
        if self.judged(verdict) == "right":
            return None
        is_named = lambda e: [self.is_truth(e | a) for a in e["alternatives"]]
        if any(not all(is_named(e)) for e in own) or any(any(is_named(e)) for e in others):
            return "rivals"
        if own or others:
            return None
        for kind, listed in (("indicated", "indications"), ("absorbed", "not_decidable")):
            if any(self.is_truth(subject) for subject in verdict.get(listed, [])):
                return kind
        return None

    def stated(self, plan):
        """The probabilities that `aurt next` states of the doubts in which the truth takes part: the smallest of each motion."""
        subjects = lambda doubt: [doubt[key] for key in ("claimed", "rival", "subject") if key in doubt]
        own = [o for o in plan["open"] if any(map(self.is_truth, subjects(o["doubt"])))]
        columns = {"planned": "planned", "generic": "multi_sine", "again": "recorded_again"}
        return {way: min((o[column]["settled"] for o in own), default=0.0) for way, column in columns.items()}

    def run(self):
        """The row of the table; none where nothing is open."""
        row = {"case": self.folder.name, "robot": self.robot, "effect": self.lab.effect, "joint": self.lab.joint, "motion": self.motion}
        try:
            before = self.verdict("first")
        except RuntimeError as refused:
            return row | {"first": str(refused).strip().splitlines()[-1], "doubt": None}
        kind = self.doubt(before)
        row |= {"first": self.judged(before), "doubt": kind}
        if kind is None:
            return row
        planned, generic = self.folder / "planned_motion.csv", self.folder / "generic_motion.csv"
        common = ["--limits", self.folder / "limits.csv", "--duration-s", f"{self.duration_s:.1f}", "--json"]
        plan = json.loads(worlds.run(self.program, "next", self.experiment("first"), *common, "--out", planned).stdout)
        (self.folder / "plan.json").write_text(json.dumps(plan, indent=1))
        worlds.run(self.program, "excite", "--mdh", self.folder / "mdh.csv", "--gravity", *self.lab.gravity, *common, "--tries", "100",
                   "--seed", self.seed % 1000, "--out", generic)
        row["stated"] = self.stated(plan)
        for k, way in enumerate(WAYS):
            if not (self.folder / f"{way}_motion.csv").is_file():
                row[way] = "open"
                continue
            self.lab.record(way, self.seed + 1 + k)
            row[way] = self.judged(self.verdict("first", way))
        return row


def table(rows):
    """The table of one world."""
    opened = [row for row in rows if row["doubt"]]
    kinds = collections.Counter(row["doubt"] for row in opened)
    text = f"{len(rows)} cases, {len(opened)} open: " + ", ".join(f"{count} {kind}" for kind, count in sorted(kinds.items())) + "\n\n"
    text += "| recorded beside the first | stated | right | still open | wrong |\n|---|---|---|---|---|\n"
    for way, words in WAYS.items():
        count = collections.Counter(row[way] for row in opened)
        stated = sum(row["stated"][way] for row in opened)
        text += f"| {words} | {stated:.1f} | {count['right']} | {count['open']} | {count['wrong']} |\n"
    return text


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--aurt", default="target/release/aurt")
    parser.add_argument("--world", choices=("clean", "rough", "mujoco"), default="clean")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--cases", type=int, default=40)
    parser.add_argument("--first", type=int, default=0, help="number of the first case")
    parser.add_argument("--out", type=pathlib.Path)
    parser.add_argument("--collect", type=pathlib.Path, nargs="+", help="print the tables of finished folders")
    arguments = parser.parse_args()
    for folder in arguments.collect or []:
        print(folder, table([json.loads(line) for line in (folder / "rows.jsonl").read_text().splitlines()]))
    if arguments.collect or not arguments.out:
        return
    rng, rows = random.Random(arguments.seed), []
    seeds = [rng.random() for _ in range(arguments.first + arguments.cases)]
    arguments.out.mkdir(parents=True, exist_ok=True)
    with (arguments.out / "rows.jsonl").open("a") as kept:
        for k, seed in enumerate(seeds[arguments.first:], arguments.first):
            rows.append(Case(arguments.aurt, arguments.world, arguments.out / f"case_{k:03}", random.Random(seed)).run())
            print(rows[-1], flush=True)
            kept.write(json.dumps(rows[-1]) + "\n")
            kept.flush()
    print("\n" + table(rows))


if __name__ == "__main__":
    main()

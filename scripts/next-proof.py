#!/usr/bin/env python3
"""How often `aurt next` decides what a diagnosis leaves open, on simulated robots whose truth is known.

Every case is an arm with one effect, recorded once in a short, narrow or slow motion of the kind that people have. It is open if the
truth takes part in a claim with alternatives, or is indicated or not decidable on a joint of which nothing is claimed. To an open
case three recordings are added, each by itself: the motion that `aurt next` plans, a multi-sine with the smallest condition number
(`aurt excite`) within the same limits, and the first motion again, each as long as the first or, with `--added-s`, so many seconds
(of the first motion the beginning); several lengths are tried one by one. The diagnosis of both recordings is right if it
names the effect without an alternative and nothing else on its joint, wrong if it names only others there without alternatives, else
still open. A constant torque while a joint moves has two names, `current_offset` and `coulomb_asymmetry`.

An arm of servos (`servo`) records commands: of a case one recording is fitted and one is held out, and what is added is recorded for both.

    python3 scripts/next-proof.py --aurt target/release/aurt --world clean --seed 1 --cases 40 --added-s 3 5 8 0 --out next-proof
    python3 scripts/next-proof.py --collect next-proof next-proof-rough
"""

import argparse
import collections
import json
import pathlib
import random
import re
import time

import next_proof_worlds as worlds

WAYS = {"planned": "the motion that `aurt next` plans", "generic": "a multi-sine of `aurt excite`", "again": "the first motion again"}
CONSTANTS = ("current_offset", "coulomb_asymmetry")
F_DYN_HZ = 6.0


class Case:
    """An arm with a concealed effect, and its experiments."""

    has_limits = True

    def __init__(self, program, world, sizes, folder, rng):
        self.program, self.folder = program, folder
        folder.mkdir(parents=True, exist_ok=True)
        self.robot = rng.choice(sorted(worlds.ARMS))
        if world == "mujoco":
            self.lab = worlds.MuJoCo(program, self.robot, folder, rng)
        else:
            self.lab = worlds.Simulated(program, self.robot, folder, world == "rough", rng)
        self.lab.conceal(rng.choice(worlds.EFFECTS), sizes, rng)
        self.seed, self.duration_s, self.motion = rng.randrange(2 ** 31), rng.uniform(12.0, 20.0), rng.choice(worlds.MOTIONS)
        (folder / "mdh.csv").write_text(self.lab.mdh)
        self.geometry = ["--mdh", folder / "mdh.csv", "--gravity", *self.lab.gravity]
        worlds.write_limits(folder / "limits.csv", self.lab.limits())
        self.first = worlds.first_motion(self.motion, self.lab.home, self.duration_s, rng)
        worlds.write_motion(folder / "first_motion.csv", self.duration_s, self.first)
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

    def run(self, lengths_s):
        """The row of the table; nothing is added where nothing is open."""
        row = {"case": self.folder.name, "robot": self.robot, "effect": self.lab.effect, "joint": self.lab.joint, "motion": self.motion}
        try:
            before = self.verdict("first")
        except RuntimeError as refused:
            return row | {"first": str(refused).strip().splitlines()[-1], "doubt": None}
        kind = self.doubt(before)
        row |= {"first": self.judged(before), "doubt": kind}
        if kind is None:
            return row
        row["added"] = {f"{added_s:g}": self.added(added_s) for added_s in lengths_s}
        return row

    def added(self, added_s):
        """What the diagnosis says with a recording of a length (0: that of the first) added, way by way."""
        duration_s = f"{added_s or self.duration_s:.1f}"
        name = lambda way: f"{way}_{duration_s}"
        motions = {way: self.folder / f"{name(way)}_motion.csv" for way in WAYS}
        common = ["--duration-s", duration_s, "--json", "--limits", self.folder / "limits.csv"]
        began_s = time.monotonic()
        plan = json.loads(worlds.run(self.program, "next", self.experiment("first"), *common[:5 if self.has_limits else 3],
                                     "--out", motions["planned"]).stdout)
        result = {"stated": self.stated(plan), "planning_s": round(time.monotonic() - began_s, 2)}
        (self.folder / f"plan_{duration_s}.json").write_text(json.dumps(plan, indent=1))
        worlds.run(self.program, "excite", *self.geometry, *common, "--tries", "100", "--seed", self.seed % 1000, "--out", motions["generic"])
        again = worlds.beginning(self.first, added_s) if added_s else self.first
        worlds.write_motion(motions["again"], added_s or self.duration_s, again)
        for k, way in enumerate(WAYS):
            result[way] = "open"
            if motions[way].is_file():
                self.lab.record(name(way), self.seed + 1 + k)
                result[way] = self.judged(self.verdict("first", name(way)))
        return result


class ServoCase(Case):
    """A servo arm with a concealed effect, of the lab's world `servo`."""

    has_limits = False

    def __init__(self, program, _world, _sizes, folder, rng):
        self.program, self.folder, self.robot, self.motion, self.seed = program, folder, "servo_arm", "commands", rng.randrange(2 ** 31)
        self.lab = worlds.Servo(program, folder, self.seed, rng)
        self.first, self.duration_s = self.lab.first, self.lab.duration_s
        self.geometry = ["--robot", self.lab.case / "robot.urdf", "--gravity", 0, 0, -9.81]

    def experiment(self, *recordings):
        text = (self.lab.case / "experiment.toml").read_text()
        columns = re.search(r"columns = \{.*?\}", text).group()
        roles = {"calibration": ["recording_1.csv"], "validation": ["recording_4.csv"]}
        for name in recordings[1:]:
            for role, files in roles.items():
                files.append(f"../../{name}_{role}.csv")
        listed = [f"{role} = [" + ", ".join(f'{{ file = "{name}", {columns} }}' for name in files) + "]" for role, files in roles.items()]
        file = self.lab.case / f"experiment_{recordings[-1]}.toml"
        file.write_text(text.split("[recordings]")[0] + "[recordings]\n" + "\n".join(listed) + "\n")
        return file

    def verdict(self, *recordings):
        """The structures of the verdict as effects of no joint."""
        structures = [one | {"effect": one["id"], "joints": [None], "alternatives": [{"effect": other} for other in one["alternatives"]]}
                      for one in super().verdict(*recordings)["structures"]]
        better = [one for one in structures if one["objection"] in ("chance", "reduction", "size") and one["evidence"]["gain_nats_per_s"] > 0.0]
        return {"effects": [one for one in structures if one["answer"] in ("missing", "given_wrong")], "indications": better}

    def is_truth(self, subject):
        return subject["effect"] == self.lab.effect


def table(rows):
    """The table of one world."""
    opened = [row for row in rows if row["doubt"]]
    kinds = collections.Counter(row["doubt"] for row in opened)
    text = f"{len(rows)} cases, {len(opened)} open: " + ", ".join(f"{count} {kind}" for kind, count in sorted(kinds.items())) + "\n\n"
    text += "| added, s | planned in s | " + " | ".join(f"{words}: stated, right, open, wrong" for words in WAYS.values()) + " |\n"
    text += "|---|---|---|---|---|\n"
    for length in opened[0]["added"] if opened else []:
        added = [row["added"][length] for row in opened]
        cells = [f"{max(one['planning_s'] for one in added):.0f} at most"]
        for way in WAYS:
            count = collections.Counter(one[way] for one in added)
            stated = sum(one["stated"][way] for one in added)
            cells.append(f"{stated:.1f}, {count['right']}, {count['open']}, {count['wrong']}")
        text += f"| {'as the first' if length == '0' else length} | " + " | ".join(cells) + " |\n"
    return text


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--aurt", default="target/release/aurt")
    parser.add_argument("--world", choices=("clean", "rough", "mujoco", "servo"), default="clean")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--cases", type=int, default=40)
    parser.add_argument("--added-s", type=float, nargs="+", default=[0.0], help="lengths of the added recordings; 0: that of the first")
    parser.add_argument("--sizes", type=float, nargs=2, default=worlds.SIZES, help="least and largest size of the effects over the noise")
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
            kind = ServoCase if arguments.world == "servo" else Case
            case = kind(arguments.aurt, arguments.world, arguments.sizes, arguments.out / f"case_{k:03}", random.Random(seed))
            rows.append(case.run(arguments.added_s))
            print(rows[-1], flush=True)
            kept.write(json.dumps(rows[-1]) + "\n")
            kept.flush()
    print("\n" + table(rows))


if __name__ == "__main__":
    main()

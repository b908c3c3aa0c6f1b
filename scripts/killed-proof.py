"""Proves in shards that are killed at random moments and started again until they are done, and compares what is there in the end,
file by file, with the proof that nobody disturbed.

    cargo build --release
    python3 scripts/killed-proof.py --program target/release/aurt-lab --hours 24 --out killed

`--hours` is the time that the recordings of all cases last together. A shard is killed (SIGKILL) after a time that is drawn for
each start, on average that of `--cases` cases and exponentially distributed, so that long cases end as well; every other time
with the diagnoses that it has started, else alone. All are started once more in the end. Prints the counts; exit status 1 if a
file is missing, is too many or differs, or if anything is left behind, 2 if a proof could not be made or nothing was killed.
"""

import argparse
import os
import pathlib
import random
import shutil
import signal
import subprocess
import sys
import time

WORLD = "clean"
RECORDINGS, DURATION_S = 5, 60.0
EFFECTS = ["payload", "base_tilt", "stribeck", "torque_constant", "external_contact"]
PLAN = """[recordings]
duration_s = {duration}
rate_hz = 125.0
[nulls]
robots = ["two_link"]
count = {nulls}
[singles]
robots = ["two_link"]
trials = {trials}
strengths = ["weak", "medium", "strong"]
effects = {effects}
"""


def refuse(message):
    """Ends with status 2."""
    print(message, file=sys.stderr)
    sys.exit(2)


def results(folder):
    """The files of a proof and what is in them."""
    return {str(path.relative_to(folder)): path.read_bytes() for path in sorted(folder.rglob("*")) if path.is_file()}


class Shard:
    """A part of the proof, started until it is done."""

    def __init__(self, command):
        self.command, self.starts = command, 0
        self.process, self.until = None, None

    def start(self, mean_s, draws):
        self.starts += 1
        self.process = subprocess.Popen(
            self.command, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, start_new_session=True
        )
        self.until = time.monotonic() + draws.expovariate(1 / mean_s)

    def is_done(self):
        """Whether it has come to its end by itself."""
        status = self.process.poll()
        if status is not None and status not in (0, 1):
            refuse(f"{' '.join(map(str, self.command))} ended with status {status}:\n{self.process.stderr.read().decode()}")
        return status is not None

    def kill(self):
        """With its diagnoses every other time."""
        if self.starts % 2:
            self.process.kill()
        else:
            os.killpg(self.process.pid, signal.SIGKILL)
        self.process.wait()


def run(command):
    """Runs a proof to its end."""
    if subprocess.run(command, stdout=subprocess.DEVNULL).returncode not in (0, 1):
        refuse(f"{' '.join(map(str, command))} failed")


def run_killed(commands, mean_s, draws):
    """Runs parts of a proof side by side, killed until they are done; how often."""
    shards, kills = [Shard(command) for command in commands], 0
    for shard in shards:
        shard.start(mean_s, draws)
    while shards:
        time.sleep(0.005)
        for shard in list(shards):
            if shard.is_done():
                shards.remove(shard)
            elif time.monotonic() > shard.until:
                shard.kill()
                kills += 1
                shard.start(mean_s, draws)
    return kills


def main():
    arguments = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    arguments.add_argument("--program", default="aurt-lab", help="the executable of aurt-lab; aurt is in the same folder")
    arguments.add_argument("--hours", type=float, default=24.0, help="time of the recordings of all cases")
    arguments.add_argument("--shards", type=int, default=4)
    arguments.add_argument("--cases", type=float, default=5.0, help="how many a shard makes before it is killed, on average")
    arguments.add_argument("--seed", type=int, default=1)
    arguments.add_argument("--out", type=pathlib.Path, required=True, help="folder that is made, and goes if nothing is wrong")
    options = arguments.parse_args()
    if options.out.exists():
        refuse(f"{options.out} exists; name a folder that does not")

    singles = 3 * len(EFFECTS)
    cases = round(options.hours * 3600 / (RECORDINGS * DURATION_S))
    trials = cases // (2 * singles)
    options.out.mkdir(parents=True)
    plan = options.out / "plan.toml"
    plan.write_text(PLAN.format(duration=DURATION_S, nulls=cases - trials * singles, trials=trials, effects=EFFECTS))
    proof = [options.program, "prove", "--world", WORLD, "--plan", plan, "--seed", str(options.seed), "--quiet"]

    begin = time.monotonic()
    undisturbed, together = options.out / "undisturbed", options.out / "together"
    run([*proof, "--out", undisturbed])
    mean_s = options.cases * options.shards * (time.monotonic() - begin) / cases
    hours = cases * RECORDINGS * DURATION_S / 3600
    print(f"undisturbed: {cases} cases, {hours:.1f} h of recordings, {time.monotonic() - begin:.0f} s", flush=True)

    begin = time.monotonic()
    parts = [options.out / f"part{k}" for k in range(1, options.shards + 1)]
    commands = [[*proof, "--shard", f"{k}/{options.shards}", "--out", part] for k, part in enumerate(parts, 1)]
    kills = run_killed(commands, mean_s, random.Random(options.seed))
    print(f"{options.shards} shards, killed {kills} times, {time.monotonic() - begin:.0f} s", flush=True)

    if kills == 0:
        refuse("no shard was killed, which shows nothing: more hours, or fewer cases")

    # What is younger than a second may be somebody's: nothing is left when all of them have looked once more.
    time.sleep(1.1)
    for command in commands:
        run(command)
    run([options.program, "prove", "--collect", *parts, "--out", together, "--quiet"])
    expected, found = results(undisturbed), results(together)
    different = [name for name in expected if expected[name] != found.get(name)]
    surplus = [name for name in found if name not in expected]
    left = [str(path) for part in parts for pattern in (".aurt-*", "cases/*") for path in part.rglob(pattern)]
    print(f"{len(expected)} files, {len(different)} missing or different, {len(surplus)} too many, {len(left)} left behind")
    for name in [*different, *surplus, *left][:20]:
        print(f"  {name}")
    if different or surplus or left:
        sys.exit(1)
    shutil.rmtree(options.out)


if __name__ == "__main__":
    main()

#!/usr/bin/env python3
"""Cases of the world `mujoco`: another engine's integrator, friction and actuators.

    python3 aurt-lab/mujoco/mujoco_world.py --plan PLAN.json --seed 7 --list
    python3 aurt-lab/mujoco/mujoco_world.py --plan PLAN.json --seed 7 --index 0 --count 5 --cases CASES --sealed SEALED

PLAN.json is a proof's plan. `--list` prints the requests that this world can fulfil, in the order of the cases, as JSON.
A case is a folder CASES/case_0001 as `aurt diagnose` reads it; its truth is SEALED/case_0001.json. The same plan, seed and
index give the same bytes, in any division of the work. Exit status: 0, or 2 with a line that says what is wrong.
"""

import argparse
import json
import os
import sys
from pathlib import Path

# One thread: cases are shared out over processes, and sums in another order would give other bytes.
for variable in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"):
    os.environ[variable] = "1"


class Refusal(Exception):
    """What is wrong with the call, and what to do."""


def read_plan(path):
    try:
        plan = json.loads(Path(path).read_text(encoding="utf-8"))
    except OSError as error:
        raise Refusal(f"{path}: cannot be read: {error.strerror}") from error
    except ValueError as error:
        raise Refusal(f"{path}: is no JSON: {error}") from error
    if not isinstance(plan, dict):
        raise Refusal(f"{path}: holds no plan (an object with recordings, singles, unknown_effects, pairs, nulls)")
    settings = {"duration_s": 30.0, "rate_hz": 500.0} | (plan.get("recordings") or {})
    if not 6.0 <= settings["duration_s"] <= 300.0:
        raise Refusal(f"{path}: recordings.duration_s is {settings['duration_s']}; 6 to 300 s are possible here")
    if not 20.0 <= settings["rate_hz"] <= 1000.0:
        raise Refusal(f"{path}: recordings.rate_hz is {settings['rate_hz']}; 20 to 1000 Hz are possible here")
    return plan, settings


def write(request, files, truth, cases, sealed):
    """The folder appears whole: files are written beside it and renamed."""
    folder, building = cases / request.name, cases / f".{request.name}.{os.getpid()}"
    building.mkdir(parents=True)
    for name, text in files.items():
        (building / name).write_text(text, encoding="utf-8")
    sealed.mkdir(parents=True, exist_ok=True)
    (sealed / f"{request.name}.json").write_text(truth, encoding="utf-8")
    if folder.exists():
        for old in folder.iterdir():
            old.unlink()
        folder.rmdir()
    building.rename(folder)


def main(arguments):
    parser = argparse.ArgumentParser(description="Cases of the world mujoco.")
    parser.add_argument("--plan", required=True, help="a proof's plan, JSON")
    parser.add_argument("--seed", required=True, type=int)
    parser.add_argument("--list", action="store_true", help="print the requests as JSON")
    parser.add_argument("--index", type=int, help="first case to make, counted from 0")
    parser.add_argument("--count", type=int, default=1, help="how many")
    parser.add_argument("--cases", type=Path, help="folder for the cases")
    parser.add_argument("--sealed", type=Path, help="folder for the truths")
    options = parser.parse_args(arguments)
    if options.seed < 0:
        raise Refusal(f"--seed is {options.seed}; it must not be negative")
    plan, settings = read_plan(options.plan)
    try:
        from mujoco_lab import arm, case, requests
    except ImportError as error:
        raise Refusal(f"{error.name} cannot be imported; install it with `pip install mujoco numpy`") from error
    try:
        asked = requests.requests(plan, options.seed)
    except requests.Unknown as error:
        raise Refusal(f"{options.plan}: {error}") from error
    if options.list:
        print(json.dumps([request.json() for request in asked], indent=1))
        return
    if options.index is None or options.cases is None or options.sealed is None:
        raise Refusal("--index, --cases and --sealed are needed to make cases; --list shows which there are")
    last = options.index + options.count
    if options.index < 0 or options.count < 1 or last > len(asked):
        raise Refusal(f"cases {options.index} to {last - 1} were asked for; the plan has {len(asked)}, counted from 0")
    for index in range(options.index, last):
        try:
            files, truth = case.make(asked[index], settings, options.seed, index)
        except arm.Divergence as error:
            raise Refusal(f"{asked[index].name} cannot be made: {error}") from error
        write(asked[index], files, truth, options.cases, options.sealed)
        print(asked[index].name, flush=True)


if __name__ == "__main__":
    sys.path.insert(0, str(Path(__file__).resolve().parent))
    try:
        main(sys.argv[1:])
    except Refusal as refusal:
        print(f"error: {refusal}", file=sys.stderr)
        sys.exit(2)

"""Follows many robots: `aurt track` of each, one after the other or as a job array of Slurm, and one table of them all.

    python3 scripts/fleet.py robots.csv --out fleet                      # every robot that has no result yet, and the table
    sbatch --array=0-11 --wrap 'python3 scripts/fleet.py robots.csv --out fleet --index $SLURM_ARRAY_TASK_ID'
    python3 scripts/fleet.py robots.csv --out fleet --table              # the table of what is there

`robots.csv` has the columns `name,experiment,model,recordings`, file names relative to it: the experiment of the unchanged
machine, its calibrated model, and a recording or a folder of recordings. Results are `fleet/NAME/track.json` and `report.html`; the
table is printed and written to `fleet/fleet.csv`, one line a robot: what has changed, since when, and the drift that is farthest from
zero against its interval in the latest recording. A result that is there is taken; `--again` makes it anew. Exit status 1 if something
has changed, 2 if a robot could not be followed.
"""

import argparse
import csv
import json
import pathlib
import shutil
import subprocess
import sys

COLUMNS = ["name", "experiment", "model", "recordings"]


def refuse(message):
    """Ends with status 2."""
    print(message, file=sys.stderr)
    sys.exit(2)


def robots(path):
    """The lines of the list, with file names as seen from here."""
    if not path.is_file():
        refuse(f"{path}: there is no such file; it lists the robots, with the columns {','.join(COLUMNS)}")
    with path.open(newline="", encoding="utf-8-sig") as file:
        table = csv.DictReader(file)
        missing = [c for c in COLUMNS if c not in (table.fieldnames or [])]
        if missing:
            refuse(f"{path}: lacks the column {', '.join(missing)}; it needs {','.join(COLUMNS)}")
        listed = list(table)
    names = [robot["name"] for robot in listed]
    for line, robot in enumerate(listed, 2):
        name = robot["name"]
        if not name or name in (".", "..") or "/" in name or names.count(name) > 1:
            refuse(f"{path}:{line}: `{name}` is no name of a folder of its own")
        for key in COLUMNS[1:]:
            robot[key] = path.parent / robot[key]
    return listed


def follow(aurt, robot, out, again):
    """Whether a robot's result is there in the end."""
    folder = out / robot["name"]
    if (folder / "track.json").exists() and not again:
        return True
    command = [aurt, "track", robot["experiment"], "--model", robot["model"], robot["recordings"], "--out", folder, "--quiet"]
    run = subprocess.run(command, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True)
    if run.returncode > 1 or run.returncode < 0:
        print(f"{robot['name']} could not be followed (status {run.returncode}):\n{run.stderr.rstrip()}", file=sys.stderr)
        return False
    return True


def row(robot, out):
    """A robot's line of the table."""
    path = out / robot["name"] / "track.json"
    if not path.exists():
        return {"robot": robot["name"], "recordings": 0, "alarms": "", "what": "no result", "since": "", "drift": ""}
    track = json.loads(path.read_text())
    what = [f"{a['parameter']} {'rose' if a['rose'] else 'fell'}" for a in track["alarms"]]
    since = [f"{pathlib.Path(a['since_recording']).name} at {a['since_s']:.0f} s" for a in track["alarms"]]
    drift = ""
    if track["recordings"]:
        latest = [
            (abs(d["value"]) / max(d["interval_95"][1] - d["value"], 1e-300), p, d)
            for p, d in zip(track["parameters"], track["recordings"][-1]["drift"])
            if d is not None and d.get("interval_95")
        ]
        if latest:
            _, parameter, d = max(latest, key=lambda found: found[0])
            low, high = d["interval_95"]
            drift = f"{parameter['name']} {d['value']:.3g} ({low:.3g} to {high:.3g}) {parameter['unit']}"
    return {
        "robot": robot["name"],
        "recordings": len(track["recordings"]),
        "alarms": len(what),
        "what": "; ".join(what),
        "since": since[0] if since else "",
        "drift": drift,
    }


def table(listed, out):
    """Prints and writes the table; whether something has changed, and whether a result is missing."""
    rows = [row(robot, out) for robot in listed]
    widths = {key: max(len(key), *(len(str(r[key])) for r in rows)) for key in rows[0]}
    for line in [{key: key for key in widths}, *rows]:
        print("  ".join(str(line[key]).ljust(width) for key, width in widths.items()).rstrip())
    part = out / ".fleet.csv.part"
    with part.open("w", newline="") as file:
        writer = csv.DictWriter(file, list(widths))
        writer.writeheader()
        writer.writerows(rows)
    part.replace(out / "fleet.csv")
    return any(r["alarms"] for r in rows), any(r["what"] == "no result" for r in rows)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("robots", type=pathlib.Path, help="list of the robots")
    parser.add_argument("--out", type=pathlib.Path, required=True, help="folder of the results")
    parser.add_argument("--index", type=int, help="only the robot of that number, from 0")
    parser.add_argument("--table", action="store_true", help="only the table")
    parser.add_argument("--again", action="store_true", help="also robots that have a result")
    parser.add_argument("--aurt", default=shutil.which("aurt") or "aurt", help="the program")
    arguments = parser.parse_args()
    listed = robots(arguments.robots)
    if not listed:
        refuse(f"{arguments.robots}: lists no robot")
    arguments.out.mkdir(parents=True, exist_ok=True)
    if arguments.index is not None:
        if not 0 <= arguments.index < len(listed):
            refuse(f"--index {arguments.index}: {arguments.robots} lists {len(listed)} robots, from 0")
        sys.exit(0 if follow(arguments.aurt, listed[arguments.index], arguments.out, arguments.again) else 2)
    if not arguments.table:
        for robot in listed:
            follow(arguments.aurt, robot, arguments.out, arguments.again)
    changed, missing = table(listed, arguments.out)
    sys.exit(2 if missing else int(changed))


if __name__ == "__main__":
    main()

"""Every fifth motion of so101.toml is held out in turn: `python examples/5-servo/folds.py aurt OUT`, with AURT_DATA set."""

import json
import pathlib
import subprocess
import sys

program, out = sys.argv[1], pathlib.Path(sys.argv[2])
text = pathlib.Path(__file__).with_name("so101.toml").read_text()
head = text[: text.index("[recordings]")]
motions = sorted(line for line in text.splitlines() if line.startswith("    { file"))
for fold in range(5):
    folder = out / str(fold)
    folder.mkdir(parents=True, exist_ok=True)
    parts = [motions[k] for k in range(len(motions)) if k % 5 != fold], motions[fold::5]
    lists = [f"{role} = [\n" + "\n".join(part) + "\n]\n" for role, part in zip(("calibration", "validation"), parts)]
    (folder / "experiment.toml").write_text(head + "[recordings]\n" + "".join(lists))
    said = subprocess.run(
        [program, "run", "experiment.toml", "--out", "results", "--json"], cwd=folder, capture_output=True, text=True
    )
    if said.returncode == 2:
        sys.exit(said.stdout + said.stderr)
    results = json.loads((folder / "results/metrics.json").read_text())
    held = [r for r in results["recordings"] if r["held_out"]]
    names = ", ".join(f"{pathlib.Path(r['recording']).stem} {1e3 * r['rms_all_joints']:.1f}" for r in held)
    print(f"fitted {1e3 * results['fitted_rms']:.1f}, held out {1e3 * results['held_out_rms']:.1f} mrad: {names}", flush=True)

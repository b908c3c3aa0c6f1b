"""AURT with the structure that every tool is told: rigid bodies, Coulomb and viscous friction, a load or coupling where there is one."""

import contextlib
import csv
import json
import os
import pathlib
import shutil
import subprocess
import tempfile

import numpy as np

from arm import SINGLE_DRIVES
from cases import ArmCase, Part
from result import Result
from signals import Skipped, bench_losses, data_folder, rows

NAME, CASES = "AURT", ArmCase
COEFFICIENTS = {
    "load_kg": "payload.m_",
    "coupling_kg_m2": "coupling.inertia_",
    "coupling_viscous": "coupling.viscous_",
    "coupling_coulomb": "coupling.coulomb_",
    "mass_kg": "m_0",
    "viscous": "F_v1_0",
    "coulomb": "F_C0_0",
    "offset": "current_offset.offset_0",
}


def program() -> str:
    """The program, named by the environment variable AURT or found on the path."""
    found = shutil.which(os.environ.get("AURT", "aurt"))
    if found is None:
        raise Skipped("the program aurt is not on the path; AURT names another one")
    return found


def version() -> str:
    """Version of the program."""
    return subprocess.run([program(), "--version"], capture_output=True, text=True, check=True).stdout.strip()


def call(*arguments: str | pathlib.Path) -> str:
    """Runs the program; status 1 says that it found something."""
    done = subprocess.run([program(), *map(str, arguments)], capture_output=True, text=True, check=False)
    if done.returncode > 1:
        raise Skipped(f"aurt {arguments[0]}: {(done.stderr.strip() or done.stdout.strip()).splitlines()[0]}")
    return done.stdout


def entry(case: ArmCase, part: Part, scratch: pathlib.Path) -> str:
    """An entry of `[recordings]`; losses are computed first."""
    file = data_folder() / part.file
    if not file.is_file():
        raise Skipped(f"{part.file} is absent")
    if part.file.startswith("dyno/"):
        file = scratch / file.name
        table = np.column_stack(bench_losses(part.file))
        np.savetxt(file, table, delimiter=",", header="time,q_0,torque_0", comments="")
    text = f'file = "{file}", window_s = [{part.begin_s}, {part.end_s}]'
    if case.columns:
        t, q, measured = case.columns
        text += f', unit = "Nm", columns = {{ time = "{t}", position = ["{q}"], measurement = ["{measured}"] }}'
    return f"{{ {text} }}"


def robot(case: ArmCase, scratch: pathlib.Path) -> str:
    """The tables `[robot]`, `[instrument]` and `[preprocess]`."""
    mdh = data_folder() / case.mdh
    if case.mdh in SINGLE_DRIVES:
        mdh = scratch / "drive.csv"
        mdh.write_text(f"type,alpha,a,d\n{SINGLE_DRIVES[case.mdh]},0,0,0\n")
    text = f'schema = 1\n[robot]\nmdh = "{mdh}"\ngravity_m_s2 = {list(case.gravity)}\n'
    if case.unit == "A":
        text += f"torque_constants_nm_per_a = {list(case.nm_per_unit)}\n"
    elif any(factor != 1.0 for factor in case.nm_per_unit):
        text += f"[instrument]\ngains = {[1 / factor for factor in case.nm_per_unit]}\n"
    return text + f"[preprocess]\nf_dyn_hz = {case.f_dyn_hz}\n"


def terms(case: ArmCase) -> str:
    """The physics that is declared beside friction."""
    text = ""
    if case.coupling:
        joint, partner = case.coupling
        text += f'[[arm_terms]]\nmodel = "coupling"\njoint = {joint}\npartner = {partner}\nratio = 1.0\n'
    if case.offset:
        text += '[[arm_terms]]\nmodel = "current_offset"\n'
    if case.load_link is not None:
        files = sorted({pathlib.Path(p.file).name for p in (*case.calibration, *case.held_out) if p.loaded})
        text += f'[[arm_terms]]\nmodel = "payload"\nlink = {case.load_link}\nrecordings = {json.dumps(files)}\n'
    return text


def recordings(case: ArmCase, scratch: pathlib.Path, **roles: tuple[Part, ...]) -> str:
    """The table `[recordings]`."""
    lines = (f"{role} = [{', '.join(entry(case, part, scratch) for part in parts)}]\n" for role, parts in roles.items())
    return "[recordings]\n" + "".join(lines)


def coefficients(case: ArmCase, out: pathlib.Path) -> dict[str, float]:
    """Estimates of what is known, from the table of coefficients."""
    with (out / "calibrated_parameters.csv").open() as file:
        found = {line["name"]: line["value"] for line in csv.DictReader(file) if line["value"]}
    values = {}
    for name in case.truth:
        matches = [float(value) for key, value in found.items() if key.startswith(COEFFICIENTS[name])]
        values |= {name: matches[0]} if matches else {}
    return values


def predictions(case: ArmCase, out: pathlib.Path) -> list[np.ndarray]:
    """Predicted torques of the held-out parts on the grid of `rows`."""
    found = []
    for part in case.held_out:
        file = out / f"predicted_{pathlib.Path(part.file).stem}.csv"
        numbers = np.loadtxt(file, delimiter=",", skiprows=1)
        stamps = numbers[:, 0] - numbers[0, 0]
        grid = rows(case, part).t
        found.append(np.column_stack([np.interp(grid, stamps, column) for column in numbers[:, 1:].T]))
    return found


@contextlib.contextmanager
def scratch_folder():
    """A folder that is removed afterwards."""
    with tempfile.TemporaryDirectory() as name:
        yield pathlib.Path(name)


def solve(case: ArmCase) -> Result:
    """Estimates and predictions of `aurt run`."""
    with scratch_folder() as scratch:
        file, out = scratch / "experiment.toml", scratch / "out"
        parts = recordings(case, scratch, calibration=case.calibration, validation=case.held_out)
        file.write_text(robot(case, scratch) + parts + terms(case))
        call("run", "--quiet", file, "--out", out)
        return Result(coefficients(case, out), predictions(case, out))

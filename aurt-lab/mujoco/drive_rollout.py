"""Rolls out a model of `aurt export mjcf drive_calibrated.json` in MuJoCo, and compares it with recordings and with AURT.

    python aurt-lab/mujoco/drive_rollout.py ROBOT.xml rollout_*.csv

The files are those of `aurt run`: time, q_simulated_j, q_j, command_j. Each line is the rms of q - q_measured over all joints
in 1e-3 rad: AURT, MuJoCo alone, MuJoCo with ROBOT_drive.py, and the rms between the last and AURT.
"""

import importlib.util
import pathlib
import sys

import mujoco
import numpy as np


def rollout(path, time, command, start, drives):
    """Positions at `time`, from rest at `start`; `drives` is the module of the exported script, or None."""
    model = mujoco.MjModel.from_xml_path(str(path))
    data = mujoco.MjData(model)
    data.qpos[:] = start
    count = model.nu
    data.ctrl[:] = command[0]
    state = drives.Drives(model, data, command[0]) if drives else None
    for k in range(0 if drives else count):
        samples = int(model.actuator_history[k, 0])
        if samples:
            mujoco.mj_initCtrlHistory(model, data, k, None, np.full((samples, 1), command[0, k]))
    text = mujoco.mj_name2id(model, mujoco.mjtObj.mjOBJ_TEXT, "command")
    holds = text >= 0 and bytes(model.text_data[model.text_adr[text] :][: model.text_size[text] - 1]) == b"hold"
    out = np.empty_like(command)
    out[0] = start
    for row in range(1, len(time)):
        steps = max(1, round((time[row] - time[row - 1]) / model.opt.timestep))
        for step in range(steps):
            share = 0.0 if holds else (step + 0.5) / steps
            now = command[row - 1] + share * (command[row] - command[row - 1])
            if state:
                state.step(model, data, now)
            else:
                data.ctrl[:] = now
            mujoco.mj_step(model, data)
        out[row] = data.qpos
    return out


def main(arguments):
    """Prints the table."""
    robot = pathlib.Path(arguments[0])
    script = robot.with_name(robot.stem + "_drive.py")
    drives = None
    if script.exists():
        spec = importlib.util.spec_from_file_location("drives", script)
        drives = importlib.util.module_from_spec(spec)
        spec.loader.exec_module(drives)
    sums, samples = np.zeros(4), 0
    print(f"{'aurt':>8} {'mujoco':>8} {'+ script':>8} {'apart':>8}  recording")
    for name in arguments[1:]:
        with open(name, encoding="utf-8") as file:
            header = file.readline().strip().split(",")
            table = np.loadtxt(file, delimiter=",")
        ours, measured, command = (table[:, [i for i, h in enumerate(header) if h.rsplit("_", 1)[0] == key]] for key in ("q_simulated", "q", "command"))
        plain = rollout(robot, table[:, 0], command, measured[0], None)
        whole = rollout(robot, table[:, 0], command, measured[0], drives) if drives else plain
        pairs = ((ours, measured), (plain, measured), (whole, measured), (whole, ours))
        squares = np.array([np.mean((a - b) ** 2) for a, b in pairs])
        sums, samples = sums + squares * len(table), samples + len(table)
        print(" ".join(f"{1e3 * v:8.2f}" for v in np.sqrt(squares)), "", pathlib.Path(name).name)
    print(" ".join(f"{1e3 * v:8.2f}" for v in np.sqrt(sums / samples)), "  all samples")


if __name__ == "__main__":
    main(sys.argv[1:])

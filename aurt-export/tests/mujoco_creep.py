"""How fast joints of a MuJoCo file creep, each loaded with half its friction loss beside its weight, at 1 ms a step.

python mujoco_creep.py machine.xml

prints the slowest and the fastest joint, rad/s or m/s: with MuJoCo's own settings of friction, and with those of the file.
"""

import sys

import mujoco
import numpy as np


def creep(model):
    """Mean speeds of the joints in the last of two seconds."""
    data = mujoco.MjData(model)
    model.opt.timestep = 1e-3
    before = None
    for step in range(2000):
        if step == 1000:
            before = data.qpos.copy()
        mujoco.mj_forward(model, data)
        data.qfrc_applied[:] = data.qfrc_bias - data.qfrc_passive + 0.5 * model.dof_frictionloss
        mujoco.mj_step(model, data)
    return np.abs(data.qpos - before)[model.dof_frictionloss > 0.0]


def main(path):
    as_written = mujoco.MjModel.from_xml_path(path)
    usual = mujoco.MjModel.from_xml_path(path)
    usual.dof_solref[:] = [0.02, 1.0]
    usual.dof_solimp[:] = [0.9, 0.95, 0.001, 0.5, 2.0]
    for model in (usual, as_written):
        speeds = creep(model)
        print(f"{speeds.min():.1e} {speeds.max():.1e}")


if __name__ == "__main__":
    main(sys.argv[1])

"""Arms that are let go without friction and torque: our simulation against MuJoCo's.

    pip install mujoco==4.0.0 numpy
    cargo build --release -p aurt-simulation --example releases
    python aurt-lab/mujoco/releases.py target/release/examples/releases

Both start from the same state and swing for 5 s. MuJoCo integrates by Runge-Kutta of order four in steps of 0.1 ms. Prints for
each robot the largest difference of a joint angle up to 1 s, 2 s and 5 s. Exit status 1 if one exceeds 1e-7 rad within
1 s: falling arms are chaotic, so that differences of rounding grow by orders of magnitude in seconds.
"""

import json
import subprocess
import sys

import mujoco
import numpy as np

STEP_S = 1e-4
TOLERANCE_RAD = 1e-7
UNTIL_S = (1.0, 2.0, 5.0)


def numbers(values):
    return " ".join(repr(float(value)) for value in values)


def mjcf(robot):
    """The arm as an MJCF model: rows of the table hold alpha and a of the way to the next joint."""
    lines = [
        "<mujoco><compiler angle='radian' inertiafromgeom='false' balanceinertia='false'/>",
        f"<option timestep='{STEP_S}' integrator='RK4' gravity='{numbers(robot['gravity_m_s2'])}'>",
        "<flag contact='disable'/></option><worldbody>",
    ]
    alpha, a = 0.0, 0.0
    for (next_alpha, next_a, d), body, rotor in zip(robot["mdh"], robot["bodies"], robot["rotor_inertia_kg_m2"]):
        place = [a, -np.sin(alpha) * d, np.cos(alpha) * d]
        xx, xy, xz, yy, yz, zz = body["inertia_at_com_kg_m2"]
        lines.append(
            f"<body pos='{numbers(place)}' quat='{numbers([np.cos(alpha / 2), np.sin(alpha / 2), 0, 0])}'>"
            f"<inertial pos='{numbers(body['com_m'])}' mass='{body['mass_kg']!r}' "
            f"fullinertia='{numbers([xx, yy, zz, xy, xz, yz])}'/><joint axis='0 0 1' armature='{rotor!r}'/>"
        )
        alpha, a = next_alpha, next_a
    lines += ["</body>" * len(robot["bodies"]), "</worldbody></mujoco>"]
    return "\n".join(lines)


def largest(robot):
    """Largest difference of joint angles at each of the times."""
    model = mujoco.MjModel.from_xml_string(mjcf(robot))
    data = mujoco.MjData(model)
    data.qpos, data.qvel = robot["start_rad"], robot["start_rad_s"]
    steps = round(robot["every_s"] / STEP_S)
    differences = []
    for row in robot["position_rad"]:
        differences.append(np.abs(np.array(row) - data.qpos).max())
        mujoco.mj_step(model, data, steps)
    return np.array(differences)


def main():
    run = subprocess.run([sys.argv[1]], capture_output=True, text=True, check=True)
    print(f"MuJoCo {mujoco.__version__}, RK4, steps of {STEP_S} s; largest difference of a joint angle in rad")
    print("| robot | swing | " + " | ".join(f"up to {until:.0f} s" for until in UNTIL_S) + " |")
    print("|---|---|" + "---|" * len(UNTIL_S))
    failed = False
    for name, robot in json.loads(run.stdout).items():
        differences = largest(robot)
        upto = [differences[: round(until / robot["every_s"]) + 1].max() for until in UNTIL_S]
        swing = np.ptp(np.array(robot["position_rad"]), axis=0).max()
        failed |= upto[0] > TOLERANCE_RAD
        print(f"| {name} | {swing:.1f} rad | " + " | ".join(f"{value:.1e}" for value in upto) + " |")
    sys.exit(1 if failed else 0)


if __name__ == "__main__":
    main()

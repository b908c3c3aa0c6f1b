"""What it costs to leave physics out of a model: the table of docs/export.md.

    python scripts/export_costs.py AURT

A UR10e with one effect more is simulated on two motions. The model is calibrated on the first, with the term that describes the
effect and without it, and judged on the second: root mean square of the error in Nm, on the joint that suffers most. Sizes are those that the simulator draws for a medium effect or machines of this kind have.
"""

import json
import subprocess
import sys
import tempfile
from pathlib import Path

MDH = "alpha,a,d\npi/2,0,0.1807\n0,-0.6127,0\n0,-0.57155,0\npi/2,0,0.17415\n-pi/2,0,0.11985\n0,0,0.11655\n"
FRICTION = {"coulomb": '{ model = "constant" }', "hysteresis": '{ model = "sign" }',
            "viscous": '{ model = "polynomial", powers = [1] }'}
DYNAMICS = "[joint_dynamics]\n" + "\n".join(f"{k} = {v}" for k, v in FRICTION.items())
OWN = '[[arm_terms]]\nmodel = "rotor_inertia"\n'

# What is left out; the effect of the simulation; the model that has it, as (joint dynamics, arm terms).
CASES = [
    ("friction that grows with the load, 0.1 Nm/Nm", 'name = "load_dependent_friction"\njoints = [1]\nload_coefficient = [0.1]',
     DYNAMICS.replace('"constant"', '"absolute"'), OWN),
    ("Stribeck effect, 8 Nm within 0.05 rad/s",
     'name = "stribeck"\njoints = [1]\nexcess_nm = [8.0]\ncoulomb_nm = [10.0]\nstribeck_velocity_rad_s = 0.05\nexponent = 1.0',
     DYNAMICS.replace('"constant"', '"stribeck"'), OWN),
    ("presliding over 10 mrad",
     'name = "presliding_hysteresis"\njoints = [1]\ndistance_rad = [0.01]\nmodel = "gms"\ndamping_share = 0.0',
     DYNAMICS.replace('"sign"', '"dahl"'), OWN),
    ("Coulomb friction of two sizes, ± 4 Nm, on an upright axis",
     'name = "coulomb_asymmetry"\njoints = [0]\nhalf_difference_nm = [4.0]\nmean_nm = [12.0]',
     DYNAMICS, OWN + '[[arm_terms]]\nmodel = "coulomb_asymmetric"\n'),
    ("offset of the current, 4 Nm, on an upright axis", 'name = "current_offset"\njoints = [0]\noffset_nm = [4.0]',
     DYNAMICS, OWN + '[[arm_terms]]\nmodel = "current_offset"\n'),
    ("the same on an axis that carries weight", 'name = "current_offset"\njoints = [1]\noffset_nm = [4.0]',
     DYNAMICS, OWN + '[[arm_terms]]\nmodel = "current_offset"\n'),
    ("spring, 20 Nm/rad", 'name = "spring"\njoint = 1\nstiffness_nm_rad = 20.0\nrest_rad = -1.0',
     DYNAMICS, OWN + '[[arm_terms]]\nmodel = "spring"\njoints = [1]\n'),
    ("rotors, as the robot has them", None, DYNAMICS, OWN),
    ("friction of drives that differs between driving and driven, 15 % and 3 % of the load",
     'name = "drive_efficiency"\njoints = [1]\ndriving = [0.15]\ndriven = [0.03]',
     DYNAMICS, OWN + '[[arm_terms]]\nmodel = "drive_efficiency"\njoints = [1]\n'),
    ("ripple, 4 Nm, 20 times a revolution",
     'name = "torque_ripple"\njoint = 1\norder = 20.0\namplitude_nm = 4.0\nphase_rad = 0.5\novertone = 0.0',
     DYNAMICS, OWN + '[[arm_terms]]\nmodel = "torque_ripple"\ncycles_per_revolution = 20.0\norders = [1]\njoints = [1]\n'),
]


def scenario(seed, effect):
    """A motion of half a minute with rotors of their own."""
    text = f'robot = "ur10e"\nrotors = "geared"\nseed = {seed}\n'
    text += '[motion]\nkind = "multi_sine"\nduration_s = 30.0\nharmonics = 8\ntop_hz = 0.8\nshare = 0.6\n'
    return text + (f"[[effect]]\n{effect}\n" if effect else "")


def experiment(dynamics, terms):
    """Calibrated on the one motion, judged on the other."""
    return (f'schema = 1\n[robot]\nmdh = "mdh.csv"\ngravity_m_s2 = [0.0, 0.0, -9.81]\n'
            f'torque_constants_nm_per_a = [11.976, 11.976, 9.839, 10.763, 10.763, 10.763]\n{dynamics}\n{terms}'
            '[recordings]\ncalibration = ["first.csv"]\nvalidation = ["second.csv"]\n[preprocess]\nf_dyn_hz = 5.0\n')


def run(program, *arguments):
    """Runs the program, which has to succeed."""
    done = subprocess.run([program, *map(str, arguments)], capture_output=True, text=True, check=False)
    if done.returncode not in (0, 1):
        sys.exit(done.stderr)


def errors(program, folder, dynamics, terms, out):
    """What `metrics.json` says of the second motion."""
    (folder / "e.toml").write_text(experiment(dynamics, terms))
    run(program, "run", folder / "e.toml", "--out", folder / out)
    recordings = json.loads((folder / out / "metrics.json").read_text())["recordings"]
    return recordings[-1]


def main(program):
    """Prints the table."""
    print("| left out | joint | error with it, Nm | without, Nm | |\n|---|---|---|---|---|")
    for name, effect, dynamics, terms in CASES:
        with tempfile.TemporaryDirectory() as place:
            folder = Path(place)
            (folder / "mdh.csv").write_text(MDH)
            for file, seed in (("first", 11), ("second", 12)):
                (folder / f"{file}.toml").write_text(scenario(seed, effect))
                run(program, "simulate", "--scenario", folder / f"{file}.toml", "--out", folder / f"{file}.csv")
            whole = errors(program, folder, dynamics, terms, "whole")
            plain = errors(program, folder, DYNAMICS, OWN if effect else "", "plain")
            a, b = ([v**0.5 for v in r["mse"]] for r in (whole, plain))
            joint = max(range(len(a)), key=lambda j: b[j] / a[j])
            grown = 100.0 * (b[joint] / a[joint] - 1.0)
            print(f"| {name} | {joint} | {a[joint]:.2f} | {b[joint]:.2f} | {grown:+.0f} % |", flush=True)


if __name__ == "__main__":
    main(sys.argv[1])

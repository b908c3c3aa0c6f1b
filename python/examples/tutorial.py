"""From arrays to a model, and from a model that is wrong to the physics that it lacks.

    pip install ./python pandas
    python python/examples/tutorial.py [FOLDER]

The arrays are of a simulated UR10e; from a real robot they come from its logger. Reports are written into FOLDER, if it is
named.
"""

import pathlib
import sys

import numpy

import aurt

# Torque per motor current of each drive, Nm/A. Without them a model is in amperes.
DRIVES = [11.976, 11.976, 9.839, 10.763, 10.763, 10.763]
MOTION = {"kind": "multi_sine", "duration_s": 15.0, "harmonics": 8, "top_hz": 1.0, "share": 0.6}


def logged(seed, **scenario):
    """What a logger has: stamps, and positions and currents with a row for each sample."""
    recording = aurt.simulate("ur10e", motion=MOTION, seed=seed, logger={"rate_hz": 125.0}, **scenario)
    return recording.t, recording.q, recording.current


def main():
    # 1. Arrays become recordings.
    t, q, current = logged(seed=1)
    monday = aurt.Recording(t, q, current=current, name="monday")
    t, q, current = logged(seed=2)
    tuesday = aurt.Recording(t, q, current=current, name="tuesday")
    print(monday)

    # 2. A robot by its name, and a model of it: rotors have inertia beyond that of the links.
    robot = aurt.Robot.by_name("ur10e")
    structure = robot.model(coulomb="absolute", arm_terms=["rotor_inertia"])
    model = aurt.calibrate(structure, monday, validation=tuesday, torque_constants_nm_per_a=DRIVES)
    print(model)
    held_out = model.errors
    held_out = held_out[held_out["role"] == "validation"]
    print("held out, error in % of the measurement while moving, by joint:", *(100 * held_out["moving_nrmse"]).round(1))

    # 3. Predictions stand at the stamps of the recording, so that residuals are a subtraction.
    residual = numpy.array(DRIVES) * tuesday.current - model.predict(tuesday)
    print("residual, Nm:", *numpy.sqrt((residual**2).mean(axis=0)).round(3))

    # 4. Torques of whole motions, at once.
    states = [numpy.random.default_rng(1).uniform(-1.0, 1.0, (100_000, 6)) for _ in range(3)]
    print("torques of 100 000 states:", model.torque(*states).shape)

    # 5. On Wednesday the arm carries 2 kg that nobody mentioned. What has changed?
    payload = {"name": "payload", "link": 5, "mass_kg": 2.0, "com_m": [0.02, -0.03, 0.08], "edges_m": [0.1, 0.1, 0.1]}
    t, q, current = logged(seed=3, effects=[payload])
    wednesday = aurt.Recording(t, q, current=current, name="wednesday")
    structure = robot.model(arm_terms=["rotor_inertia"])
    verdict = aurt.diagnose(structure, [monday, tuesday], target=wednesday, torque_constants_nm_per_a=DRIVES)
    print(verdict)
    assert "payload" in list(verdict.effects["effect"]), "the load was not found"

    # 6. The improved model has the payload, with its mass among the coefficients.
    parameters = verdict.model.parameters
    print(parameters[parameters["name"].str.startswith("payload")][["name", "unit", "value", "std_dev"]].to_string())

    if len(sys.argv) > 1:
        folder = pathlib.Path(sys.argv[1])
        model.report().save(folder / "calibration.html")
        verdict.report().save(folder / "diagnosis.html")
        model.save(folder / "rd_calibrated.json")


if __name__ == "__main__":
    main()

"""Time of the Python package's batched torques against Pinocchio's RNEA, in C++ and as a loop in Python, in the same run.

    pip install ./python pin==4.1.0 cmeel-eigen
    python aurt-lab/peers/batch_torque.py [--rounds 9] [--states 100000] [--compiler g++]

The robot is the UR10e by name with bodies of some inertia. All sides get the same states and the same bodies; torques that
differ by more than 1e-9 of the largest end the run. `rigid bodies` is `Robot.torque`, what RNEA computes; `with friction`
is `Model.torque` of a calibrated model, Coulomb and viscous friction included, and `load-dependent` one whose Coulomb
friction grows with the load. What counts is the time that the processor spent, over all threads of a process, so that
neither a second core nor other programs on the machine help anyone. Rounds go by turns.
"""

import argparse
import pathlib
import statistics
import subprocess
import tempfile
import time

import numpy
import pinocchio

import aurt
from machine import processor
from pinocchio_regressor import HERE, build_peer
from robots import ROBOTS


def bodies(joints):
    """Mass, centre of mass and inertia about it of each link, those of a machine that can exist."""
    random = numpy.random.default_rng(7)
    for _ in range(joints):
        radii = random.uniform(0.02, 0.2, 3)
        mass, centre = random.uniform(1.0, 8.0), random.uniform(-0.2, 0.2, 3)
        square = mass / 5.0 * radii**2
        inertia = numpy.diag([square[1] + square[2], square[0] + square[2], square[0] + square[1]])
        yield mass, centre, inertia


def standard_parameters(links):
    """XX XY XZ YY YZ ZZ mX mY mZ m of each link, inertia about the link frame's origin."""
    for mass, centre, inertia in links:
        about_origin = inertia + mass * (centre @ centre * numpy.eye(3) - numpy.outer(centre, centre))
        yield from about_origin[numpy.triu_indices(3)]
        yield from mass * centre
        yield mass


def model_of(joints, links):
    """Pinocchio's model of the same chain."""
    model, parent = pinocchio.Model(), 0
    for number, ((alpha, a, d), (mass, centre, inertia)) in enumerate(zip(joints, links)):
        rotation = pinocchio.AngleAxis(alpha, numpy.array([1.0, 0.0, 0.0])).toRotationMatrix()
        origin = numpy.array([a, 0.0, 0.0]) + rotation @ numpy.array([0.0, 0.0, d])
        parent = model.addJoint(parent, pinocchio.JointModelRZ(), pinocchio.SE3(rotation, origin), f"joint_{number}")
        model.appendBodyToJoint(parent, pinocchio.Inertia(mass, centre, inertia), pinocchio.SE3.Identity())
    return model


def timed(work):
    """Seconds that the processor spent, and what came out."""
    begun = time.process_time()
    result = work()
    return time.process_time() - begun, result


def calibrated(robot, **structure):
    """A model of the robot, from a simulated recording."""
    return aurt.calibrate(robot.model(**structure), aurt.simulate("ur10e", seed=1))


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--rounds", type=int, default=9)
    parser.add_argument("--states", type=int, default=100_000)
    parser.add_argument("--compiler", default="g++")
    parser.add_argument("--program", help="the C++ program, if it is built already")
    arguments = parser.parse_args()
    states = arguments.states
    chain, robot = ROBOTS["ur10e"], aurt.Robot.by_name("ur10e")
    links = list(bodies(len(chain)))
    parameters = numpy.array(list(standard_parameters(links)))
    model = model_of(chain, links)
    data = model.createData()
    random = numpy.random.default_rng(1)
    motion = [random.uniform(-reach, reach, (states, len(chain))) for reach in (3.0, 2.0, 10.0)]
    constant, loaded = calibrated(robot), calibrated(robot, coulomb="absolute")

    def loop():
        return numpy.array([pinocchio.rnea(model, data, *sample) for sample in zip(*motion)])

    ours = {
        "rigid bodies": lambda: robot.torque(*motion, parameters),
        "with friction": lambda: constant.torque(*motion),
        "load-dependent": lambda: loaded.torque(*motion),
    }
    times = {name: [] for name in ["Python loop", "C++", *ours]}
    with tempfile.TemporaryDirectory() as folder:
        peer = pathlib.Path(arguments.program or folder)
        if not peer.is_file():
            peer = build_peer(arguments.compiler, peer, "pinocchio_rnea")
        file = pathlib.Path(folder) / "states"
        with file.open("wb") as out:
            numpy.array([float(states)]).tofile(out)
            for values in motion:
                values.tofile(out)
        numbers = [str(v) for joint, (mass, centre, inertia) in zip(chain, links)
                   for v in (*joint, mass, *centre, *inertia[numpy.triu_indices(3)])]
        command = [peer, str(len(chain)), *numbers, file, "1"]
        for _ in range(arguments.rounds):
            printed = subprocess.run(command, check=True, stdout=subprocess.PIPE, text=True).stdout.split()
            times["C++"].append(1e-9 * float(printed[0]) * states)
            took, expected = timed(loop)
            times["Python loop"].append(took)
            for name, work in ours.items():
                took, torque = timed(work)
                times[name].append(took)
                if name == "rigid bodies":
                    off = max(abs(torque - expected).max(), abs(torque[0] - [float(v) for v in printed[1:]]).max())
                    assert off <= 1e-9 * abs(expected).max(), f"torques differ by {off} Nm"
    print(f"processor: {processor()}; Pinocchio {pinocchio.__version__}, -O3 -march=native; {states} states of the UR10e")
    print(f"{arguments.rounds} rounds by turns; ns for one state of the fastest round; ratios by round, median [smallest, largest]")
    for name, values in times.items():
        line = f"{name:15} {1e9 * min(values) / states:8.1f} ns"
        if name in ours:
            for other in ("Python loop", "C++"):
                ratios = [theirs / mine for theirs, mine in zip(times[other], values)]
                line += f"   {other} / this {statistics.median(ratios):6.1f} [{min(ratios):.1f}, {max(ratios):.1f}]"
        print(line)
    print(f"torques of the rigid bodies agree within {off:.1e} Nm of {abs(expected).max():.0f} Nm")


if __name__ == "__main__":
    main()

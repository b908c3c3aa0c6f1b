"""Random serial chains against Pinocchio: quantiles of the differences of torque, mass matrix and regressor.

    pip install pin==4.1.0
    cargo build --release -p aurt-rbd --example chains
    python aurt-lab/mujoco/urdf/random_chains.py target/release/examples/chains [--chains 1000] [--seed 1]

Each chain is a URDF file of 1 to 9 joints: axes, placements, masses, centres of mass and inertias (of bodies that can
be, from random principal moments) are drawn; one joint in five is prismatic, and one axis in three is parallel or at a
right angle to the link before. Both programs read the file; 100 random states of each chain are compared as in `compare.py`
(of each state relative to its largest entry), and the numbers of base parameters.

Prints quantiles over the chains of the largest difference of each. Exit status 1 if one exceeds what `compare.py` allows or a
number differs.
"""

import argparse
import json
import pathlib
import subprocess
import sys
import tempfile

import numpy as np
import pinocchio as pin

from compare import TOLERANCES, File, compare_chain

QUANTILES = (0.5, 0.95, 0.99, 1.0)


def numbers(values):
    return " ".join(repr(float(value)) for value in values)


def rotation(rng):
    """A random rotation."""
    matrix, _ = np.linalg.qr(rng.normal(size=(3, 3)))
    return matrix * np.sign(np.linalg.det(matrix))


def axis(rng):
    """A direction; one in three is one of the frame's own."""
    if rng.random() < 1 / 3:
        return np.eye(3)[rng.integers(3)] * rng.choice([-1.0, 1.0])
    direction = rng.normal(size=3)
    return direction / np.linalg.norm(direction)


def angles(rng):
    """Roll, pitch and yaw; one placement in three is by right angles."""
    if rng.random() < 1 / 3:
        return rng.integers(-1, 3, size=3) * np.pi / 2
    return rng.uniform(-3.0, 3.0, size=3)


def link(rng, name):
    """A link whose inertia is that of a body."""
    spread = rng.uniform(0.001, 0.2, size=3)
    turn = rotation(rng)
    mass = 10 ** rng.uniform(-1.0, 1.3)
    inertia = turn @ np.diag(mass * (spread.sum() - spread)) @ turn.T
    names = zip(("ixx", "ixy", "ixz", "iyy", "iyz", "izz"), inertia[np.triu_indices(3)])
    moments = " ".join(f'{key}="{float(value)!r}"' for key, value in names)
    return (
        f'<link name="{name}"><inertial><origin xyz="{numbers(rng.uniform(-0.3, 0.3, size=3))}" '
        f'rpy="{numbers(rng.uniform(-3.0, 3.0, size=3))}"/><mass value="{mass!r}"/><inertia {moments}/></inertial></link>'
    )


def chain(rng):
    """The text of a URDF file."""
    parts = ['<robot name="random"><link name="base"/>']
    parent = "base"
    for number in range(1, int(rng.integers(1, 10)) + 1):
        child = f"link_{number}"
        kind = "prismatic" if rng.random() < 0.2 else "revolute"
        parts.append(link(rng, child))
        parts.append(
            f'<joint name="joint_{number}" type="{kind}"><parent link="{parent}"/><child link="{child}"/>'
            f'<origin xyz="{numbers(rng.uniform(-0.6, 0.6, size=3))}" rpy="{numbers(angles(rng))}"/>'
            f'<axis xyz="{numbers(axis(rng))}"/><limit lower="-3" upper="3" velocity="3" effort="100"/></joint>'
        )
        parent = child
    return "".join([*parts, "</robot>"])


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("program")
    parser.add_argument("--chains", type=int, default=1000)
    parser.add_argument("--seed", type=int, default=1)
    arguments = parser.parse_args()
    rng = np.random.default_rng(arguments.seed)
    worst, joints, other, refused = [], [], [], []
    with tempfile.TemporaryDirectory() as place:
        folder = pathlib.Path(place)
        file = folder / "chain.urdf"
        for number in range(arguments.chains):
            file.write_text(chain(rng))
            run = subprocess.run([arguments.program, folder, file], capture_output=True, text=True, check=True)
            found = json.loads(run.stdout)
            read = [one for one in found.get("chains", []) if "number" in one]
            if len(read) != 1:
                refused.append(f"chain {number}: {found}")
                continue
            model = pin.buildModelFromUrdf(str(file))
            (*differences, rank), _ = compare_chain([model, None], File(file), read[0], folder)
            worst.append(differences)
            joints.append(len(read[0]["joints"]))
            if read[0]["base_parameters"] != rank:
                other.append(f"chain {number}: {read[0]['base_parameters']}, Pinocchio {rank}")
    worst = np.array(worst)
    print(f"{len(worst)} chains of {min(joints)} to {max(joints)} joints, 100 states each; Pinocchio {pin.__version__}")
    print("| quantile | torque | mass matrix | regressor | acceleration |\n|---|---|---|---|---|")
    for quantile in QUANTILES:
        row = " | ".join(f"{value:.1e}" for value in np.quantile(worst, quantile, axis=0))
        print(f"| {quantile:.0%} | {row} |")
    print(f"numbers of base parameters that differ: {len(other)}")
    for line in other + refused:
        print(f"- {line}")
    sys.exit(1 if (worst > TOLERANCES).any() or other or refused else 0)


if __name__ == "__main__":
    main()

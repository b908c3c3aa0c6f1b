"""Serial chains of URDF files, and all joints at once: torques, accelerations, mass matrices, regressors and numbers of base
parameters against Pinocchio.

    pip install pin==4.1.0 example-robot-data==6.0.0
    cargo build --release -p aurt-rbd --example chains
    python aurt-lab/mujoco/urdf/compare.py target/release/examples/chains            # all files of example-robot-data
    python aurt-lab/mujoco/urdf/compare.py target/release/examples/chains arm.urdf   # or those that are named

Prints one row per file: chains read and refused, the largest number of joints, the largest relative differences of
torque, mass matrix, regressor and acceleration over the states of all chains (of each state relative to its largest entry),
and chains whose number of base parameters differs. Exit status 1 if a difference exceeds 1e-12 (of regressors 1e-10, of
accelerations 1e-12 times the condition number of the mass matrix, to which they are known) or a number differs.

Pinocchio reads the same file; joints beside the chain rest at zero in its model as they do in ours. Its regressor
is in the parameters of its own link frames: ours is turned into these by the constant rotation between the two frames
of each joint.

Of chains with joints that follow others (`mimic`), torques and mass matrices are compared with those of Pinocchio's own model
of such joints, whose regressor it does not give: there its regressor Y of the model in which all joints move on their own is
taken, as G'Y with the multipliers G of the file.
"""

import collections
import json
import pathlib
import re
import subprocess
import sys
import tempfile
import xml.etree.ElementTree

import numpy as np
import pinocchio as pin

# Torque, mass matrix, regressor, acceleration.
TOLERANCES = np.array([1e-12, 1e-12, 1e-10, 1e-12])
STATES = 100


def robot_files():
    """The URDF files of example-robot-data."""
    prefix = pathlib.Path(pin.__file__).parents[4] / "share" / "example-robot-data" / "robots"
    return sorted(prefix.rglob("*.urdf"))


def to_ours(turn):
    """The 10 x 10 matrix from Pinocchio's dynamic parameters of a link to ours, XX XY XZ YY YZ ZZ mX mY mZ m."""
    matrix = np.zeros((10, 10))
    for column in range(10):
        m, hx, hy, hz, xx, xy, yy, xz, yz, zz = np.eye(10)[column]
        inertia = turn.T @ np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]]) @ turn
        first = turn.T @ np.array([hx, hy, hz])
        matrix[:, column] = [*inertia[np.triu_indices(3)], *first, m]
    return matrix


def relative(ours, theirs):
    """Largest difference, relative to the largest entry; of zeros, absolute."""
    size = np.abs(theirs).max()
    return np.abs(ours - theirs).max() / (size if size > 0.0 else 1.0)


def rank(matrix):
    """Numerical rank with columns of unit length."""
    length = np.linalg.norm(matrix, axis=0)
    kept = matrix[:, length > 1e-9 * length.max()]
    values = np.linalg.svd(kept / np.linalg.norm(kept, axis=0), compute_uv=False)
    return int((values > 1e-9).sum())


class File:
    """What a URDF file says of the joints that move."""

    def __init__(self, file):
        root = xml.etree.ElementTree.parse(file).getroot()
        self.above, self.mimic, below = {}, {}, collections.defaultdict(list)
        for element in root.findall("joint"):
            name, mimic = element.get("name"), element.find("mimic")
            moves = element.get("type") != "fixed"
            parent, child = (element.find(end).get("link") for end in ("parent", "child"))
            self.above[child] = (parent, name, moves)
            below[parent].append(child)
            if mimic is not None:
                values = float(mimic.get("multiplier", 1.0)), float(mimic.get("offset", 0.0))
                self.mimic[name] = (mimic.get("joint"), *values)
        # All joints that move, each after those that carry it.
        self.all, links = [], [link for link in below if link not in self.above]
        while links:
            link = links.pop()
            _, name, moves = self.above.get(link, (None, None, False))
            self.all += [name] * moves
            links += below[link][::-1]

    def path(self, tip):
        """The joints that move from the root to a link, or all."""
        if tip is None:
            return self.all
        joints = []
        while tip in self.above:
            tip, name, moves = self.above[tip]
            joints += [name] * moves
        return joints[::-1]

    def followed(self, joint):
        """What a joint follows in the end: the joint, multiplier and offset."""
        multiplier, offset = 1.0, 0.0
        while joint in self.mimic:
            joint, factor, constant = self.mimic[joint]
            multiplier, offset = multiplier * factor, offset + multiplier * constant
        return joint, multiplier, offset


def rest(model, file):
    """The posture of joints beside a chain: zero, and the offset of joints that follow another."""
    posture = pin.neutral(model)
    for name in file.mimic:
        if model.existJointName(name):
            posture[model.joints[model.getJointId(name)].idx_q] = file.followed(name)[2]
    return posture


def coupled_model(file):
    """Pinocchio's model with joints that follow others, if it can read them."""
    try:
        return pin.buildModelFromUrdf(str(file), mimic=True)
    except ValueError:
        return None


def compare_chain(models, file, chain, folder):
    """Largest relative differences of torque, mass matrix, regressor and acceleration, Pinocchio's number of base parameters,
    and whether the joints that follow others were multiplied here.

    The models are those of the whole robot, in which nothing but the chain moves: the chain's joints carry the same torques
    as if the others were fixed, and the columns of its links are the same. In the first all joints move on their own, in the
    second some follow others; where none of the chain does, the first is used throughout.
    """
    own, path = chain["joints"], file.path(chain["tip"])
    path = path[path.index(own[0]) :] if len(own) == len(path) else path
    n, m = len(own), len(path)
    assert m == len(chain["frames"]), "Pinocchio's file has another chain"
    couplings = np.zeros((m, n))
    offsets = np.zeros(m)
    for row, name in enumerate(path):
        joint, multiplier, offsets[row] = file.followed(name)
        couplings[row, own.index(joint)] = multiplier
    free = models[0]
    beside = any(file.followed(name)[0] in own for name in file.mimic if name not in path)
    coupled = models[1] if m > n and not beside else None if m > n else free
    if coupled is None:
        # Without a model in which nothing else moves: that of the joints that move on their own, multiplied.
        coupled, names, into_own = free, path, couplings
    else:
        names, into_own = own, np.eye(n)
    shift = offsets if into_own is couplings else 0.0
    data = [model.createData() for model in (free, coupled)]
    rests = [rest(free, file), rest(free, file) if coupled is free else pin.neutral(coupled)]
    joints = [[model.joints[model.getJointId(name)] for name in them] for model, them in ((free, path), (coupled, names))]
    velocities = [[joint.idx_v for joint in those] for those in joints]
    links = [free.getJointId(name) - 1 for name in path]
    into = [to_ours(np.array(frame)) for frame in chain["frames"]]
    numbers = np.fromfile(folder / f"{chain['number']}.f64").reshape(STATES, 5 * n + n * n + 10 * n * m)

    def states(which, q, qd, qdd):
        model = (free, coupled)[which]
        configuration, v, a = rests[which].copy(), np.zeros(model.nv), np.zeros(model.nv)
        for k, joint in enumerate(joints[which]):
            value = [q[k]] if joint.nq == 1 else [np.cos(q[k]), np.sin(q[k])]
            configuration[joint.idx_q : joint.idx_q + joint.nq] = value
            v[joint.idx_v], a[joint.idx_v] = qd[k], qdd[k]
        return model, data[which], configuration, v, a

    differences, stacked = [0.0] * 4, []
    for row in numbers:
        q, qd, qdd, torque, acceleration = row[: 5 * n].reshape(5, n)
        mass = row[5 * n : 5 * n + n * n].reshape(n, n)
        ours = row[5 * n + n * n :].reshape(n, m, 10)
        of = states(1, into_own @ q + shift, into_own @ qd, into_own @ qdd)
        theirs = into_own.T @ pin.rnea(*of)[velocities[1]]
        differences[0] = max(differences[0], relative(torque, theirs))
        # With joints that follow others Pinocchio 4.1 adds to what the last call left in the same data.
        theirs = pin.crba(coupled, coupled.createData(), of[2])
        theirs = np.triu(theirs) + np.triu(theirs, 1).T
        theirs = into_own.T @ theirs[np.ix_(velocities[1], velocities[1])] @ into_own
        differences[1] = max(differences[1], relative(mass, theirs))
        if n == free.nv and np.isfinite(acceleration).all():
            applied = np.zeros(n)
            applied[velocities[1]] = qdd
            known = np.linalg.cond(theirs)
            theirs = pin.aba(free, free.createData(), of[2], of[3], applied)[velocities[1]]
            differences[3] = max(differences[3], relative(acceleration, theirs) / max(known, 1.0))
        of = states(0, couplings @ q + offsets, couplings @ qd, couplings @ qdd)
        theirs = pin.computeJointTorqueRegressor(*of)
        theirs = theirs.reshape(free.nv, free.njoints - 1, 10)[velocities[0]][:, links]
        theirs = np.tensordot(couplings.T, theirs, axes=1)
        ours = np.stack([ours[:, link] @ into[link] for link in range(m)], axis=1)
        differences[2] = max(differences[2], relative(ours, theirs))
        stacked.append(theirs.reshape(n, 10 * m))
    return (*differences, rank(np.vstack(stacked))), into_own is couplings


def kind(reason):
    """A refusal without its place and names."""
    return re.sub(r"^[^ ]*: (joint [^:]*: )?", "", reason).split("(")[0].split(";")[0].split("joint ")[0].strip()


def written(program, file, folder):
    """What the program writes about a file, and where its numbers are."""
    if sys.argv[1] == "--written":
        folder = pathlib.Path(program)
        return json.loads((folder / "chains.json").read_text()), folder
    run = subprocess.run([program, folder, file], capture_output=True, text=True, check=True)
    return json.loads(run.stdout), pathlib.Path(folder)


def main():
    # `--written FOLDER FILE`: what the program has written about the file already, as the test of aurt-rbd does.
    program, *files = sys.argv[2:] if sys.argv[1] == "--written" else sys.argv[1:]
    files = [pathlib.Path(f) for f in files] or robot_files()
    failures, total, refusals = 0, collections.Counter(), collections.Counter()
    print("| file | chains | refused | joints | torque | mass matrix | regressor | acceleration | base parameters |")
    print("|---|---|---|---|---|---|---|---|---|")
    for file in files:
        with tempfile.TemporaryDirectory() as folder:
            found, numbers = written(program, file, folder)
            name = file.name
            if "refused" in found:
                print(f"| {name} | – | all | | | | | | {found['refused']} |", flush=True)
                refusals[kind(found["refused"])] += 1
                continue
            read = [chain for chain in found["chains"] if "number" in chain]
            refused = [chain["refused"] for chain in found["chains"] if "refused" in chain]
            refusals.update(kind(reason) for reason in refused)
            total.update(files=1, chains=len(read), refused=len(refused))
            if read:
                follow = any(len(chain["frames"]) > len(chain["joints"]) for chain in read)
                models = [pin.buildModelFromUrdf(str(file)), coupled_model(file) if follow else None]
                described = File(file)
            worst, other = np.zeros(4), []
            for chain in read:
                (*differences, rank_there), multiplied = compare_chain(models, described, chain, numbers)
                total["coupled"] += len(chain["frames"]) > len(chain["joints"])
                total["multiplied"] += multiplied
                worst = np.maximum(worst, differences)
                total["trees"] += chain["tip"] is None
                if chain["base_parameters"] != rank_there:
                    here = chain["base_parameters"] or chain["base_parameters_error"]
                    other.append(f"{chain['tip'] or 'all joints'}: {here}, Pinocchio {rank_there}")
            failures += (worst > TOLERANCES).any() or bool(other)
            counts = sorted({chain["base_parameters"] or 0 for chain in read})
            text = "; ".join(other) or ", ".join(map(str, counts))
            joints = max((len(chain["joints"]) for chain in read), default=0)
            print(
                f"| {name} | {len(read)} | {len(refused)} | {joints} | {' | '.join(f'{w:.0e}' for w in worst)} | {text} |",
                flush=True,
            )
    trees = f" ({total['trees']} of all joints at once)" if total["trees"] else ""
    print(f"\n{total['files']} files, {total['chains']} chains compared{trees}, {total['refused']} refused:")
    if total["coupled"]:
        print(f"{total['coupled']} chains with joints that follow others, {total['multiplied']} of them by the multipliers")
    for reason, count in refusals.most_common():
        print(f"- {count}: {reason}")
    sys.exit(1 if failures else 0)


if __name__ == "__main__":
    main()

"""Rigid bodies in numpy, many samples at once: forward kinematics, regressor and torque of serial arms.

Newton-Euler recursions (Khalil and Dombre, Modeling, Identification and Control of Robots, 2002, chapter 9), linear in the
standard parameters {XX XY XZ YY YZ ZZ mX mY mZ m} of each link in its own frame.
"""

import numpy as np

PARAMETERS = 10


def _placement(mdh, j):
    """Constant part of the transformation from link j - 1 to link j: rotation about x by alpha, origin."""
    alpha, a = (mdh[j - 1][0], mdh[j - 1][1]) if j else (0.0, 0.0)
    c, s, d = np.cos(alpha), np.sin(alpha), mdh[j][2]
    return np.array([[1, 0, 0], [0, c, -s], [0, s, c]]), np.array([a, -s * d, c * d])


def _turned(angle):
    """Rotations about z, (samples, 3, 3)."""
    c, s = np.cos(angle), np.sin(angle)
    turn = np.zeros((len(angle), 3, 3))
    turn[:, 0, 0], turn[:, 0, 1], turn[:, 1, 0], turn[:, 1, 1], turn[:, 2, 2] = c, -s, s, c, 1.0
    return turn


def link_frames(mdh, q):
    """Rotation (samples, n, 3, 3) and origin (samples, n, 3) of the link frames in the base, by plain products."""
    samples, n = q.shape
    rotation, origin = np.broadcast_to(np.eye(3), (samples, 3, 3)), np.zeros((samples, 3))
    rotations, origins = [], []
    for j in range(n):
        fixed, offset = _placement(mdh, j)
        origin = origin + rotation @ offset
        rotation = rotation @ fixed @ _turned(q[:, j])
        rotations.append(rotation)
        origins.append(origin)
    return np.stack(rotations, 1), np.stack(origins, 1)


def _motion(mdh, gravity, q, v, a):
    """Angular velocity, angular and linear acceleration of each link in its own frame, gravity as acceleration."""
    samples, n = q.shape
    w, dw = np.zeros((samples, 3)), np.zeros((samples, 3))
    acceleration = np.broadcast_to(-np.asarray(gravity, float), (samples, 3))
    z = np.array([0.0, 0.0, 1.0])
    links = []
    for j in range(n):
        fixed, offset = _placement(mdh, j)
        turn = fixed @ _turned(q[:, j])
        back = turn.transpose(0, 2, 1)
        arm = np.broadcast_to(offset, (samples, 3))
        at_origin = acceleration + np.cross(dw, arm) + np.cross(w, np.cross(w, arm))
        w_in, spin = _apply(back, w), v[:, j : j + 1] * z
        dw = _apply(back, dw) + a[:, j : j + 1] * z + np.cross(w_in, spin)
        w, acceleration = w_in + spin, _apply(back, at_origin)
        links.append((turn, offset, w, dw, acceleration))
    return links


def _apply(rotations, vectors):
    return (rotations @ vectors[:, :, None])[:, :, 0]


def _skew(u):
    out = np.zeros((len(u), 3, 3))
    out[:, 0, 1], out[:, 0, 2], out[:, 1, 2] = -u[:, 2], u[:, 1], -u[:, 0]
    return out - out.transpose(0, 2, 1)


def _inertia_columns(u):
    """The matrix L(u) with J u = L(u) {XX XY XZ YY YZ ZZ}."""
    out = np.zeros((len(u), 3, 6))
    x, y, z = u.T
    out[:, 0, 0], out[:, 0, 1], out[:, 0, 2] = x, y, z
    out[:, 1, 1], out[:, 1, 3], out[:, 1, 4] = x, y, z
    out[:, 2, 2], out[:, 2, 4], out[:, 2, 5] = x, y, z
    return out


def regressor(mdh, gravity, q, v, a):
    """Y (samples, n, 10 n) with torque = Y @ standard parameters."""
    samples, n = q.shape
    links = _motion(mdh, gravity, q, v, a)
    result = np.zeros((samples, n, PARAMETERS * n))
    for i in range(n):
        _, _, w, dw, acceleration = links[i]
        wrench = np.zeros((samples, 6, PARAMETERS))  # moment about the link's origin, then force
        spin = _skew(w)
        wrench[:, :3, :6] = _inertia_columns(dw) + spin @ _inertia_columns(w)
        wrench[:, :3, 6:9] = -_skew(acceleration)
        wrench[:, 3:, 6:9] = _skew(dw) + spin @ spin
        wrench[:, 3:, 9] = acceleration
        for j in range(i, -1, -1):
            result[:, j, PARAMETERS * i : PARAMETERS * (i + 1)] = wrench[:, 2]
            turn, offset = links[j][0], links[j][1]
            force, moment = turn @ wrench[:, 3:], turn @ wrench[:, :3]
            wrench = np.concatenate([moment + np.cross(offset[None, :, None], force, axis=1), force], 1)
    return result


def torque(mdh, gravity, standard, q, v, a):
    """Inverse dynamics (samples, n), Nm."""
    samples, n = q.shape
    links = _motion(mdh, gravity, q, v, a)
    moment, force = np.zeros((samples, 3)), np.zeros((samples, 3))
    result = np.zeros((samples, n))
    for j in range(n - 1, -1, -1):
        turn, offset, w, dw, acceleration = links[j]
        xx, xy, xz, yy, yz, zz, mx, my, mz, mass = standard[PARAMETERS * j : PARAMETERS * (j + 1)]
        inertia = np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])
        first = np.broadcast_to([mx, my, mz], (samples, 3))
        moment = moment + dw @ inertia + np.cross(w, w @ inertia) + np.cross(first, acceleration)
        force = force + mass * acceleration + np.cross(dw, first) + np.cross(w, np.cross(w, first))
        result[:, j] = moment[:, 2]
        force = (turn @ force[:, :, None])[:, :, 0]
        moment = (turn @ moment[:, :, None])[:, :, 0] + np.cross(offset, force)
    return result


def absorbed_rotors(mdh, gravity, rotors):
    """Those of the joints `rotors` whose column of acceleration the rigid bodies imitate exactly."""
    n = len(mdh)
    random = np.random.default_rng(0)
    q, v, a = random.uniform(-3, 3, (3, 40 * n, n))
    left = regressor(mdh, gravity, q, v, a).reshape(-1, PARAMETERS * n)
    u, s, _ = np.linalg.svd(left, full_matrices=False)
    basis = u[:, s > 1e-9 * s[0]]
    absorbed = []
    for j in rotors:
        column = np.zeros_like(a)
        column[:, j] = a[:, j]
        column = column.ravel() / np.linalg.norm(column)
        # 1e-6 lies far from rounding (1e-13) and from the smallest share that is not absorbed (1e-2).
        if np.linalg.norm(column - basis @ (basis.T @ column)) < 1e-6:
            absorbed.append(j)
    return absorbed

"""Masses of bodies that MuJoCo computes from shapes.

    pip install mujoco==4.0.0 && python make_shapes.py    # writes shapes_mujoco.json beside this file

Of each moving body of shapes.xml, for `inertiafromgeom` auto and true: mass, centre of mass, and inertia about it
along the axes of the body (xx, yy, zz, xy, xz, yz).
"""

import json
import pathlib

import mujoco
import numpy as np

HERE = pathlib.Path(__file__).parent
text = (HERE / "shapes.xml").read_text()
found = {"mujoco": mujoco.__version__}
for choice in ("auto", "true"):
    model = mujoco.MjModel.from_xml_string(text.replace("<compiler ", f'<compiler inertiafromgeom="{choice}" '))
    bodies = {}
    for body in range(2, model.nbody):
        turn = np.zeros(9)
        mujoco.mju_quat2Mat(turn, model.body_iquat[body])
        turn = turn.reshape(3, 3)
        inertia = turn @ np.diag(model.body_inertia[body]) @ turn.T
        bodies[model.body(body).name] = {
            "mass": model.body_mass[body],
            "com": list(model.body_ipos[body]),
            "inertia": [inertia[k] for k in [(0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2)]],
        }
    found[choice] = bodies
(HERE / "shapes_mujoco.json").write_text(json.dumps(found, indent=1) + "\n")

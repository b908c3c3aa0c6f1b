"""What `mujoco.sysid` makes of an MJCF file: `identified.py FILE.xml FOLDER`.

Writes random parameters of joints and bodies, `parameters.yaml`, and the file with what their modifiers set, `identified.xml`. The
modifiers' own model is not compiled: MuJoCo 4.0.0 ignores the inertia that `InertiaType.Pseudo` sets.
"""

import pathlib
import sys
import xml.etree.ElementTree

import mujoco
import numpy
from mujoco import sysid

FILE, FOLDER = sys.argv[1], pathlib.Path(sys.argv[2])
KINDS = [sysid.InertiaType.Pseudo, sysid.InertiaType.MassIpos, sysid.InertiaType.Mass]

spec = mujoco.MjSpec.from_file(FILE)
model = spec.compile()
random = numpy.random.default_rng(1)
parameters = sysid.ParameterDict()
document = xml.etree.ElementTree.parse(FILE)
for joint in document.findall("worldbody//joint"):
    for quantity in ("armature", "damping", "frictionloss"):
        parameter = sysid.Parameter(f"{joint.get('name')}_{quantity}", 1.0, 0.0, 10.0)
        parameter.value[0] = random.uniform(0.1, 1.0)
        parameter.frozen = joint.get("name") == "wrist"
        parameters.add(parameter)
        if not parameter.frozen:
            joint.set(quantity, repr(float(parameter.value[0])))
for place, body in enumerate(document.findall("worldbody//body[inertial]")):
    name, changed = body.get("name"), spec.copy()
    parameter = sysid.body_inertia_param(spec.copy(), model, name, inertia_type=KINDS[place % len(KINDS)])
    parameter.value = parameter.nominal * random.uniform(0.9, 1.1, parameter.shape)
    parameters.add(parameter)
    if parameter.inertia_type == sysid.InertiaType.Mass:
        # The modifier's array is refused by `MjsBody.mass`.
        sysid.model_modifier.apply_body_mass_ipos(changed, name, mass=parameter.value[0])
    else:
        parameter.apply_modifier(changed)
    found = changed.body(name)
    full = found.fullinertia.flatten()
    if not numpy.isfinite(full).all():
        turned = sysid.model_modifier.inertia_to_fullinertia(found.iquat, found.inertia)
        full = turned[[0, 1, 2, 0, 0, 1], [0, 1, 2, 1, 2, 2]]
    listed = lambda numbers: " ".join(repr(float(number)) for number in numbers)
    inertial = body.find("inertial")
    inertial.attrib = {"mass": listed([found.mass]), "pos": listed(found.ipos), "fullinertia": listed(full)}
parameters.save_to_disk(FOLDER / "parameters.yaml")
document.write(FOLDER / "identified.xml")

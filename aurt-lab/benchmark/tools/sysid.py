"""mujoco.sysid on a single drive whose force is measured: rollouts in pieces, mass, damping, friction loss and offset.

Arms of several joints are solved by inverse dynamics (`sysid_arm`).
"""

import numpy as np

from cases import ArmCase
from result import Result
from signals import Rows, Skipped, rows
from tools import sysid_arm
from tools.sysid_drive import optimized, version as version

NAME, CASES = "mujoco.sysid", ArmCase
PIECE_S = 0.5
DRIVE = """
<mujoco>
  <option timestep="0.001" integrator="implicitfast" gravity="0 0 0"/>
  <worldbody>
    <body name="carriage">
      <inertial pos="0 0 0" mass="60" diaginertia="1 1 1"/>
      <joint name="q" type="slide" axis="1 0 0" damping="100" frictionloss="10"/>
    </body>
  </worldbody>
  <actuator><motor name="force" joint="q"/></actuator>
  <sensor><jointpos name="position" joint="q"/></sensor>
</mujoco>
"""


def parameters():
    """Start and bounds, as wide as AURT's deviations."""
    from mujoco import sysid

    found = sysid.ParameterDict()

    def add(name, start, low, high, modifier):
        found.add(sysid.Parameter(name, start, low, high, modifier=modifier))

    def damping(spec, p):
        spec.joint("q").damping = [p.value[0], 0, 0]

    add("mass_kg", 60.0, 10.0, 300.0, lambda spec, p: setattr(spec.body("carriage"), "mass", p.value[0]))
    add("viscous", 100.0, 0.0, 1000.0, damping)
    add("coulomb", 10.0, 0.0, 100.0, lambda spec, p: setattr(spec.joint("q"), "frictionloss", p.value[0]))
    # The force of the drive is what is measured less the offset.
    add("offset", 0.0, -50.0, 50.0, lambda spec, p: spec.actuator("force").biasprm.__setitem__(0, -p.value[0]))
    return found


def pieces(recording: Rows) -> list[slice]:
    """Pieces of half a second."""
    length = round(PIECE_S * recording.rate_hz)
    return [slice(k, k + length) for k in range(0, len(recording.t) - length, length)]


def solve(case: ArmCase) -> Result:
    """Estimates, and forces that the same equation predicts."""
    if case.joints > 1:
        return sysid_arm.solve(case)
    if case.name != "emps":
        raise Skipped("a loss is no force that moves anything")
    import mujoco
    from mujoco import sysid

    spec = mujoco.MjSpec.from_string(DRIVE)
    actuator = spec.actuator("force")
    actuator.biastype = mujoco.mjtBias.mjBIAS_AFFINE
    model = spec.compile()
    sequences = []
    for part in case.calibration:
        recording = rows(case, part)
        for cut in pieces(recording):
            t = recording.t[cut] - recording.t[cut.start]
            start = sysid.create_initial_state(model, recording.q[cut.start], recording.qd[cut.start])
            control = sysid.TimeSeries(t, recording.torque[cut])
            measured = sysid.TimeSeries.from_names(t, recording.q[cut], model)
            sequences.append(sysid.ModelSequences("drive", spec, "piece", start, control, measured))

    def difference(params, predicted, measured, model, return_all, **_):
        q = np.interp(measured.times, predicted.times, predicted.data[:, 0])[:, None]
        return 1e3 * (q - measured.data), sysid.TimeSeries(measured.times, q, measured.signal_mapping), measured

    residual = sysid.build_residual_fn(models_sequences=sequences, modify_residual=difference, n_threads=1)
    best = optimized(parameters(), residual, 50)
    values = {name: float(p.value[0]) for name, p in best.items()}
    return Result(values, [predicted_force(values, rows(case, part)) for part in case.held_out])


def predicted_force(values: dict[str, float], recording: Rows) -> np.ndarray:
    """Force of mass, friction and offset."""
    friction = values["viscous"] * recording.qd + values["coulomb"] * np.sign(recording.qd)
    return values["mass_kg"] * recording.qdd + friction + values["offset"]

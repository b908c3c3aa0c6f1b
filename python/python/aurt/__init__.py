"""Model, calibrate and explain the dynamics of robot manipulators from recordings of the real machine.

    >>> import aurt
    >>> recording = aurt.simulate("ur10e")
    >>> robot = aurt.Robot.by_name("ur10e")
    >>> model = aurt.calibrate(robot.model(arm_terms=["rotor_inertia"]), recording)
    >>> residual = recording.current - model.predict(recording)

Arrays have a row for each sample and a column for each joint. Joints count from 0; units are SI, and a model of motor
currents has A in the place of Nm.
"""

from ._aurt import (
    Checkup,
    Error,
    Exported,
    Gains,
    Model,
    Predictor,
    Recording,
    Report,
    Robot,
    Structure,
    Sweep,
    Tracking,
    Verdict,
    __version__,
    calibrate,
    calibrate_experiment,
    check,
    check_experiment,
    diagnose,
    diagnose_experiment,
    excite,
    gains,
    robots,
    simulate,
    sweep,
    track,
)
from .friction import FrictionModel

__all__ = [
    "Checkup",
    "Error",
    "Exported",
    "FrictionModel",
    "Gains",
    "Model",
    "Predictor",
    "Recording",
    "Report",
    "Robot",
    "Structure",
    "Sweep",
    "Tracking",
    "Verdict",
    "__version__",
    "calibrate",
    "calibrate_experiment",
    "check",
    "check_experiment",
    "diagnose",
    "diagnose_experiment",
    "excite",
    "gains",
    "robots",
    "simulate",
    "sweep",
    "track",
]

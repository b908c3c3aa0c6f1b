"""BAM (better-actuator-models) on a single drive: its models m1 and m2, its simulator, its loss and its optimizer (CMA-ES).

The actuator below tells BAM the drive's force per volt; its mass stands as the actuator's extra inertia. BAM's own programs record and fit
servos on a pendulum; arms of several joints are no cases of its identification.
"""

import contextlib
import io
from collections.abc import Callable

import numpy as np

from cases import ArmCase
from result import Result, package_version
from signals import Skipped, rows
from tools.sysid import pieces, predicted_force

NAME, CASES = "BAM", ArmCase
MODELS, TRIALS, SEED = ("m1", "m2"), 600, 1


def version() -> str:
    """Package, and the optimizer that its `fit` uses."""
    modules = {"better-actuator-models": "bam.mujoco", "optuna": "optuna", "cmaes": "cmaes"}
    return ", ".join(package_version(name, module) for name, module in modules.items())


def classes():
    """A bench without gravity, and the drive."""
    from bam.actuator import Actuator
    from bam.parameter import Parameter
    from bam.testbench import Testbench

    class Bench(Testbench):
        """Nothing but the drive's own mass."""

        def __init__(self, log):
            pass

        def compute_mass(self, q, dq):
            return 0.0

        def compute_bias(self, q, dq):
            return 0.0

    class Drive(Actuator):
        """Force is the control less an offset."""

        def initialize(self):
            self.model.mass = Parameter(60.0, 10.0, 300.0)
            self.model.offset = Parameter(0.0, -50.0, 50.0)

        def compute_torque(self, control, torque_enable, q, dq):
            return control - self.model.offset.value

        def get_extra_inertia(self):
            return self.model.mass.value

        def reset(self):
            pass

    return Bench, Drive


def model_of(name: str):
    """A friction model of BAM on the drive; bounds as wide as those of the other tools."""
    from bam.model import models

    bench, drive = classes()
    model = models[name]()
    model.max_friction_base, model.max_viscous_friction = 100.0, 1000.0
    model.set_actuator(drive(bench))
    model.q_offset.optimize = False
    return model


def batch(case: ArmCase) -> dict:
    """Pieces of the calibration side by side, as `bam.logs` makes them."""
    columns = {"position": "q", "speed": "qd", "control": "torque"}
    cuts = [(r, cut) for r in (rows(case, part) for part in case.calibration) for cut in pieces(r)]
    arrays = {key: np.array([getattr(r, name)[cut, 0] for r, cut in cuts]).T for key, name in columns.items()}
    steps = len(arrays["position"])
    entries = [{key: values[k] for key, values in arrays.items()} | {"torque_enable": True} for k in range(steps)]
    return {"dt": 1 / case.rate_hz, "entries": entries}


def best(make: Callable, error: Callable, sampler, trials: int) -> tuple[float, object]:
    """Least error and the model that has it; the search of `bam.fit` without its command line."""
    import optuna

    def objective(trial) -> float:
        model = make()
        for key, parameter in model.get_parameters().items():
            if parameter.optimize:
                parameter.value = trial.suggest_float(key, parameter.min, parameter.max)
        return error(model)

    optuna.logging.set_verbosity(optuna.logging.ERROR)
    study = optuna.create_study(sampler=sampler)
    study.optimize(objective, n_trials=trials)
    model = make()
    model.load_parameters_from_dict(study.best_params)
    return study.best_value, model


def fit(name: str, log: dict) -> tuple[float, object]:
    """Mean absolute error of the positions, and the model."""
    import optuna
    from bam.simulate import Simulator

    measured = np.array([entry["position"] for entry in log["entries"]])

    def error(model) -> float:
        with np.errstate(all="ignore"):
            positions, _, _ = Simulator(model).rollout_log(log)
        return float(np.mean(np.abs(np.array(positions) - measured)))

    with contextlib.redirect_stderr(io.StringIO()):
        sampler = optuna.samplers.CmaEsSampler(restart_strategy="bipop", seed=SEED)
    return best(lambda: model_of(name), error, sampler, TRIALS)


def solve(case: ArmCase) -> Result:
    """Estimates of the model that fits best; its Stribeck term is not part of the published model."""
    if case.name != "emps":
        raise Skipped("BAM identifies one servo on a bench")
    log = batch(case)
    _, model = min((fit(name, log) for name in MODELS), key=lambda found: found[0])
    values = {
        "mass_kg": model.mass.value,
        "viscous": model.friction_viscous.value,
        "coulomb": model.friction_base.value,
        "offset": model.offset.value,
    }
    predictions = []
    for part in case.held_out:
        recording = rows(case, part)
        force = predicted_force(values | {"viscous": 0.0, "coulomb": 0.0}, recording)
        loss, damping = model.compute_frictions(recording.torque, 0.0, recording.qd)
        predictions.append(force + loss * np.sign(recording.qd) + damping * recording.qd)
    return Result(values, predictions)

"""figaroh: its `BaseIdentification` with friction, actuator inertia and offset, its decimation, QR base parameters and WLS.

Loads and couplings are columns appended to its regressor, as figaroh-examples does for the TX40.
"""

import logging

import numpy as np

from arm import pinocchio_model, rigid_body_regressor
from cases import ArmCase
from result import Result, package_version
from signals import Skipped, decimation, rows
from tools.wls import coupling_columns

NAME, CASES = "figaroh", ArmCase


def version() -> str:
    """Version of the package."""
    return package_version("figaroh", "figaroh.identification.base_identification")


class Robot:
    """What figaroh asks of a robot."""

    def __init__(self, case: ArmCase):
        from figaroh.backends.pinocchio import PinocchioBackend

        self.model = pinocchio_model(case)
        self.data = self.model.createData()
        self.backend = PinocchioBackend.from_model(self.model, self.data)
        self.q0, self.v0 = np.zeros(case.joints), np.zeros(case.joints)


def extra_columns(case: ArmCase, recording) -> np.ndarray:
    """Columns of load and coupling, [joint, row, column]."""
    blocks = [np.zeros((case.joints, len(recording.t), 0))]
    if case.load_link is not None:
        first = 10 * case.load_link
        load = rigid_body_regressor(case, recording)[:, :, first : first + 10]
        blocks.append(load * recording.part.loaded)
    if case.coupling:
        blocks.append(coupling_columns(case, recording))
    return np.concatenate(blocks, axis=2)


def extra_names(case: ArmCase) -> list[str]:
    """Names of these columns."""
    names = ["load_kg", *(f"load_{k}" for k in range(1, 10))] if case.load_link is not None else []
    return names + (["coupling_kg_m2", "coupling_viscous", "coupling_coulomb"] if case.coupling else [])


def identification_class():
    """figaroh's class with our recordings."""
    try:
        from figaroh.identification.base_identification import BaseIdentification
    except ImportError as error:
        raise Skipped("the package figaroh is not installed") from error
    logging.disable(logging.CRITICAL)

    class Identification(BaseIdentification):
        """Rows of the benchmark instead of files and filters of figaroh."""

        def __init__(self, case: ArmCase):
            self.case = case
            super().__init__(Robot(case), None)

        def load_param(self, config_file, setting_type="identification"):
            """Settings: every kind of parameter that figaroh has by default."""
            joints = list(range(self.case.joints))
            self.identif_config = {
                "act_idxq": joints, "act_idxv": joints, "active_joints": list(self.model.names)[1:],
                "is_joint_torques": True, "is_external_wrench": False, "has_friction": True,
                "has_actuator_inertia": self.case.joints > 1, "has_joint_offset": True, "robot_name": self.case.name,
                "has_coupled_wrist": False, "fv": joints, "fs": joints, "Ia": joints, "off": joints,
            }

        def load_trajectory_data(self, data_source=None):
            """Not used: `process_data` gives filtered rows."""

        def process_data(self, truncate=None):
            """Rows of all calibration parts, one after the other."""
            self.parts = [rows(self.case, part) for part in self.case.calibration]
            names = {"positions": "q", "velocities": "qd", "accelerations": "qdd", "torques": "torque", "timestamps": "t"}
            self.processed_data = {k: np.concatenate([getattr(p, a) for p in self.parts]) for k, a in names.items()}
            self.num_samples = len(self.processed_data["positions"])

        def calculate_full_regressor(self):
            """figaroh's regressor with load and coupling."""
            super().calculate_full_regressor()
            extra = np.concatenate([extra_columns(self.case, part) for part in self.parts], axis=1)
            own = self.dynamic_regressor
            self.dynamic_regressor = np.hstack([own, extra.reshape(len(own), -1)])

        def initialize_standard_parameters(self):
            """Their names."""
            super().initialize_standard_parameters()
            self.standard_parameter |= dict.fromkeys(extra_names(self.case), 0.0)

        def _store_results(self, identif_results):
            """Its reports know nothing of appended columns, and take time."""
            self.result = {}

        def print_quality_report(self):
            """Nothing is printed."""

        def coefficients(self) -> np.ndarray:
            """Base parameters at the columns that carry them, zero elsewhere."""
            kept = np.delete(np.arange(self.dynamic_regressor.shape[1]), self._idx_eliminated)
            found = np.zeros(self.dynamic_regressor.shape[1])
            found[kept[self._base_indices]] = self.phi_base
            return found

        def predict(self, recording) -> np.ndarray:
            """Torques on a recording."""
            from figaroh.tools.regressor import build_regressor_basic

            own = build_regressor_basic(self.robot, recording.q, recording.qd, recording.qdd, self.identif_config)
            extra = extra_columns(self.case, recording)
            matrix = np.hstack([own, extra.reshape(len(own), -1)])
            return (matrix @ self.coefficients()).reshape(self.case.joints, -1).T

    return Identification


def solve(case: ArmCase) -> Result:
    """Estimates and predictions."""
    identification = identification_class()(case)
    identification.initialize()
    identification.solve(decimation_factor=decimation(case), wls=True, plotting=False)
    values = dict(zip(identification.standard_parameter, identification.coefficients(), strict=True))
    if case.name == "emps":
        names = {"mass_kg": "m_joint_0", "viscous": "fv_joint_0", "coulomb": "fs_joint_0", "offset": "off_joint_0"}
        values |= {ours: values[theirs] for ours, theirs in names.items()}
    predictions = [identification.predict(rows(case, part)) for part in case.held_out]
    return Result({name: values[name] for name in case.truth}, predictions)

from datetime import datetime, timedelta
from os import PathLike
from pathlib import Path
from typing import Any, Callable, Literal, Sequence, TypedDict, Union, final, overload

import numpy
from numpy.typing import ArrayLike, NDArray

from .friction import FrictionModel

__all__ = [
    "Checkup",
    "Error",
    "Exported",
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
    "main",
    "robots",
    "simulate",
    "sweep",
    "track",
]

__version__: str

_Path = Union[str, PathLike[str]]
_Array = NDArray[numpy.float64]
_Stamps = Union[ArrayLike, Sequence[datetime], Sequence[timedelta]]
_Progress = Union[bool, Callable[[str], Any], None]
# A data frame where pandas is installed, else a list of dicts.
_Rows = Any
_ModelChoice = Union[str, dict[str, Any], FrictionModel, None]

class Error(ValueError):
    """What is wrong with a robot, a recording, a model or an argument, where, and what to do."""

class _Excitation(TypedDict):
    t: _Array
    q: _Array
    dq: _Array
    ddq: _Array
    condition_number: float | None

@final
class Robot:
    """A robot: its rigid bodies under gravity (m/s², in the base frame), without values of their parameters."""

    @staticmethod
    def from_urdf(
        path: _Path,
        *,
        base: str | None = None,
        tip: str | None = None,
        tips: Sequence[str] | None = None,
        joints: Sequence[str] | None = None,
        gravity: Sequence[float] = ...,
    ) -> Robot:
        """All joints of a URDF file on a link as a tree, the chain to `tip`, the tree to `tips`, or `joints`."""

    @staticmethod
    def from_mjcf(
        path: _Path,
        *,
        base: str | None = None,
        tip: str | None = None,
        tips: Sequence[str] | None = None,
        joints: Sequence[str] | None = None,
        gravity: Sequence[float] = ...,
    ) -> Robot:
        """The same of a MuJoCo file, with bodies instead of links."""

    @staticmethod
    def from_mdh(table: _Path, *, gravity: Sequence[float] = ...) -> Robot:
        """The robot of a table of modified Denavit–Hartenberg parameters: a file, or its text."""

    @staticmethod
    def by_name(name: str, *, gravity: Sequence[float] = ...) -> Robot:
        """A robot that is known by name: geometry and limits."""

    @staticmethod
    def _restored(name: str, state: str) -> Robot: ...

    @property
    def name(self) -> str: ...
    @property
    def joints(self) -> int: ...
    @property
    def joint_names(self) -> list[str]: ...
    @property
    def limits(self) -> _Rows: ...
    @property
    def notes(self) -> list[str]: ...
    @property
    def standard_parameters(self) -> _Array | None: ...
    @property
    def base_parameters(self) -> _Rows: ...
    def base_values(self, parameters: ArrayLike) -> _Array:
        """Values of the base parameters from those of the 10 N standard parameters."""

    def regressor(self, q: ArrayLike, dq: ArrayLike, ddq: ArrayLike, *, standard: bool = False) -> _Array:
        """The regressor Y of the base (or standard) parameters, τ = Y π; (samples, joints, parameters)."""

    def torque(self, q: ArrayLike, dq: ArrayLike, ddq: ArrayLike, parameters: ArrayLike | None = None) -> _Array:
        """Rigid-body torques, Nm, with the 10 N standard parameters of the links."""

    def model(
        self,
        *,
        coulomb: _ModelChoice = None,
        hysteresis: _ModelChoice = None,
        viscous: _ModelChoice = None,
        arm_terms: Sequence[str | dict[str, Any]] | None = None,
    ) -> Structure:
        """The structure of a model of this robot; constant Coulomb and linear viscous friction unless said."""

@final
class Structure:
    """The structure of a model: rigid bodies, friction of every joint, arm terms; without coefficients."""

    @property
    def joints(self) -> int: ...
    @property
    def parameters(self) -> _Rows: ...

@final
class Recording:
    """What a robot's joints did and what was measured meanwhile."""

    @overload
    def __new__(
        cls,
        t: Any,
        q: None = None,
        dq: None = None,
        *,
        tau: None = None,
        current: None = None,
        unit: Literal["Nm", "A"] | None = None,
        name: str | None = None,
        joint_names: Sequence[str] | None = None,
        topic: str | None = None,
        columns: dict[str, Any] | None = None,
        angle: Literal["rad", "deg"] | None = None,
        time: Literal["s", "ms", "us", "ns"] | None = None,
    ) -> Recording: ...
    @overload
    def __new__(
        cls,
        t: _Stamps,
        q: ArrayLike,
        dq: ArrayLike | None = None,
        *,
        tau: ArrayLike | None = None,
        current: ArrayLike | None = None,
        unit: Literal["Nm", "A"] | None = None,
        name: str | None = None,
        joint_names: Sequence[str] | None = None,
    ) -> Recording: ...
    @staticmethod
    def _restored(t: Any, q: Any, dq: Any | None, measured: Any | None, state: str) -> Recording: ...
    @property
    def joint_names(self) -> list[str]: ...
    @property
    def name(self) -> str: ...
    @property
    def joints(self) -> int: ...
    @property
    def duration_s(self) -> float: ...
    @property
    def t(self) -> _Array: ...
    @property
    def origin_s(self) -> float: ...
    @property
    def q(self) -> _Array: ...
    @property
    def dq(self) -> _Array | None: ...
    @property
    def tau(self) -> _Array | None: ...
    @property
    def current(self) -> _Array | None: ...
    @property
    def unit(self) -> str | None: ...
    @property
    def notes(self) -> list[str]: ...
    def window(self, from_s: float, to_s: float) -> Recording:
        """The samples between two times, s from the first stamp."""

    def named(self, name: str) -> Recording:
        """The same under another name."""

    def __len__(self) -> int: ...

@final
class Model:
    """A model with its coefficients."""

    @staticmethod
    def load(path: _Path) -> Model:
        """Reads a model that `save` or the command line wrote."""

    def save(self, path: _Path) -> None:
        """Writes the model into a file, which appears whole or not at all."""

    @property
    def joints(self) -> int: ...
    @property
    def unit(self) -> str: ...
    @property
    def parameters(self) -> _Rows: ...
    @property
    def coefficients(self) -> _Array: ...
    @property
    def covariance(self) -> _Array:
        """The covariance of the coefficients, in the order of `parameters` and the products of their units."""

    @property
    def errors(self) -> _Rows: ...
    @property
    def sigma(self) -> _Array: ...
    @property
    def warnings(self) -> list[str]: ...
    @property
    def structure(self) -> Structure: ...
    def torque(self, q: ArrayLike, dq: ArrayLike, ddq: ArrayLike, t: _Stamps | None = None) -> _Array:
        """Torques (or currents) for every sample; friction with memory starts at the first and needs the times."""

    def predict(self, recording: Recording) -> _Array:
        """What the model predicts at every stamp of a recording; (samples, joints)."""

    def mass_matrix(self, q: ArrayLike) -> _Array:
        """The mass matrices M(q), (samples, joints, joints), in the unit of predictions per rad/s² (kg m² for Nm)."""

    def gravity(self, q: ArrayLike) -> _Array:
        """The torques of weight g(q), (samples, joints), in the unit of predictions."""

    def export(
        self,
        target: Literal["c", "rust", "mjcf", "urdf", "sdf", "fmu"],
        out: _Path,
        *,
        name: str = "robot",
        kind: Literal["inverse", "forward"] | None = None,
        into: _Path | None = None,
        base: str | None = None,
        tip: str | None = None,
        force: bool = False,
    ) -> Exported:
        """Writes the model for another program into the folder `out`, as `aurt export` does."""

    def predictor(self) -> Predictor:
        """A predictor for single samples, in a control loop."""

    def simulate(
        self, recording: Recording, *, driven_by: Literal["motion", "measurement"] = "motion", bandwidth_hz: float = 10.0
    ) -> Recording:
        """How the model moves when it follows the recording's motion, or when what was measured drives it."""

    def report(self) -> Report: ...

@final
class Predictor:
    """Torques of a calibrated model, sample by sample, with the memory of its friction."""

    def torque(self, dt_s: float, q: ArrayLike, dq: ArrayLike, ddq: ArrayLike) -> _Array:
        """Torques (or currents) for a sample `dt_s` after the last one."""

    def reset(self) -> None:
        """Forgets the past."""

@final
class Verdict:
    """What a diagnosis found: where model and recordings differ, and what physics is missing."""

    @staticmethod
    def _restored(
        said: tuple[bool, str, str], added: list[str], notes: list[str], model: Model, html: str, title: str
    ) -> Verdict: ...
    @property
    def answer(self) -> str: ...
    @property
    def structure(self) -> str | None: ...
    @property
    def found(self) -> bool: ...
    @property
    def effects(self) -> _Rows: ...
    @property
    def indications(self) -> _Rows: ...
    @property
    def not_decidable(self) -> _Rows: ...
    @property
    def residual(self) -> _Rows: ...
    @property
    def model(self) -> Model: ...
    @property
    def added(self) -> list[str]: ...
    @property
    def notes(self) -> list[str]: ...
    def to_dict(self) -> dict[str, Any]: ...
    def report(self) -> Report: ...
    def _repr_html_(self) -> str: ...

@final
class Report:
    """A report: one self-contained HTML page that shows itself in a notebook."""

    @property
    def html(self) -> str: ...
    @property
    def title(self) -> str: ...
    def save(self, path: _Path) -> None: ...
    def _repr_html_(self) -> str: ...

def calibrate(
    model: Robot | Structure,
    calibration: Recording | Sequence[Recording],
    *,
    validation: Recording | Sequence[Recording] | None = None,
    f_dyn_hz: float = 10.0,
    sample_rate_hz: float | None = None,
    position_cutoff_hz: float | None = None,
    parallel_cutoff_hz: float | None = None,
    rest_velocity_rad_s: float = 0.03,
    trim_rest: bool = True,
    count_ends: bool = False,
    max_gap_s: float | None = None,
    torque_constants_nm_per_a: ArrayLike | None = None,
    gains: ArrayLike | None = None,
    offsets: ArrayLike | None = None,
    delay_s: ArrayLike | None = None,
    estimator: Literal["wls", "ols", "consistent", "essential", "irls"] = "wls",
    load_torque: Literal["fitted", "literal"] = "fitted",
    rest: Literal["keep", "exclude"] = "keep",
    fit_shapes: bool = True,
    progress: _Progress = None,
) -> Model:
    """Calibrates a model on recordings, and judges it on them and on those that are held out."""

def diagnose(
    model: Robot | Structure,
    calibration: Recording | Sequence[Recording],
    *,
    target: Recording | Sequence[Recording] | None = None,
    validation: Recording | Sequence[Recording] | None = None,
    f_dyn_hz: float = 10.0,
    sample_rate_hz: float | None = None,
    position_cutoff_hz: float | None = None,
    parallel_cutoff_hz: float | None = None,
    rest_velocity_rad_s: float = 0.03,
    trim_rest: bool = True,
    count_ends: bool = False,
    max_gap_s: float | None = None,
    torque_constants_nm_per_a: ArrayLike | None = None,
    gains: ArrayLike | None = None,
    offsets: ArrayLike | None = None,
    delay_s: ArrayLike | None = None,
    estimator: Literal["wls", "ols", "consistent", "essential", "irls"] = "wls",
    load_torque: Literal["fitted", "literal"] = "fitted",
    rest: Literal["keep", "exclude"] = "keep",
    fit_shapes: bool = True,
    progress: _Progress = None,
) -> Verdict:
    """Says what recordings show that a model lacks: with a target, what has changed in it; without, what is missing in the
    recordings that the model is calibrated on."""

@final
class Exported:
    """What an export wrote."""

    @property
    def files(self) -> list[Path]: ...
    @property
    def notes(self) -> list[str]: ...
    @property
    def changed(self) -> list[str]: ...
    @property
    def lost(self) -> list[str]: ...

@final
class Checkup:
    """What a check came to: findings to be heeded before anyone calibrates on the recordings."""

    @property
    def found(self) -> bool: ...
    @property
    def findings(self) -> list[str]: ...
    @property
    def mistakes(self) -> _Rows: ...
    @property
    def suitable_f_dyn_hz(self) -> float | None: ...
    def to_dict(self) -> dict[str, Any]: ...
    def reports(self) -> list[Report]: ...

def check(
    recordings: Recording | Sequence[Recording],
    *,
    robot: Robot | Structure | None = None,
    f_dyn_hz: float | None = None,
    progress: _Progress = None,
) -> Checkup:
    """Checks recordings before anyone calibrates on them, as `aurt check` does."""

def check_experiment(path: _Path, *, f_dyn_hz: float | None = None, progress: _Progress = None) -> Checkup:
    """Checks the setup of an experiment and its recordings."""

@final
class Tracking:
    """How a machine has changed since its calibration: friction, gains and load, with alarms."""

    @property
    def changed(self) -> bool: ...
    @property
    def alarms(self) -> _Rows: ...
    @property
    def drift(self) -> _Rows: ...
    @property
    def notes(self) -> list[str]: ...
    def to_dict(self) -> dict[str, Any]: ...
    def report(self) -> Report: ...
    def _repr_html_(self) -> str: ...

def track(
    experiment: _Path,
    model: Model | _Path,
    recordings: Recording | _Path | Sequence[Recording | _Path],
    *,
    window_s: float = 5.0,
    false_alarm_h: float = 720.0,
    friction_half_life_s: float = 60.0,
    gain_half_life_s: float = 120.0,
    load_half_life_s: float = 20.0,
    joint_names: Sequence[str] | None = None,
    topic: str | None = None,
    progress: _Progress = None,
) -> Tracking:
    """Follows a calibrated machine over time, as `aurt track` does."""

@final
class Gains:
    """Gains of the drives as recordings show them."""

    @property
    def joints(self) -> _Rows: ...
    @property
    def reference(self) -> int | None: ...
    @property
    def measured_in(self) -> str | None: ...
    @property
    def torque_constants_nm_per_a(self) -> list[float] | None: ...
    @property
    def instrument_gains(self) -> list[float] | None: ...
    @property
    def warnings(self) -> list[str]: ...
    def to_dict(self) -> dict[str, Any]: ...

def gains(
    experiment: _Path,
    *,
    mass_kg: float | None = None,
    mass_std_kg: float = 0.0,
    centre_of_mass_m: Sequence[float] | None = None,
    expect: bool = False,
    progress: _Progress = None,
) -> Gains:
    """Estimates the gains of the drives, as `aurt gains` does."""

def calibrate_experiment(path: _Path, *, progress: _Progress = None) -> Model:
    """Calibrates as an experiment's file says."""

def diagnose_experiment(path: _Path, *, progress: _Progress = None) -> Verdict:
    """Diagnoses as an experiment's file says."""

@final
class Sweep:
    """The points of a sweep, best first."""

    @property
    def table(self) -> Any:
        """The points that could be judged, best first, as rows."""
    @property
    def failed(self) -> Any:
        """The points that could not be judged, as rows, with the reasons."""
    @property
    def reference(self) -> str | None:
        """The point that others are compared with."""
    @property
    def best(self) -> str | None:
        """The best point, if any could be judged."""
    @property
    def document(self) -> dict[str, Any]:
        """All that `table.json` of `aurt sweep` holds."""
    def __len__(self) -> int: ...

def sweep(path: _Path, out: _Path, *, rows: str = "all", progress: _Progress = None) -> Sweep:
    """Runs the points of an experiment's section `sweep` that have no result in the folder yet, and ranks all."""

def main() -> int:
    """The command `aurt` with the arguments of this process; returns its exit status."""

def robots() -> list[str]:
    """Names of the robots that can be simulated."""

def simulate(
    robot: str,
    *,
    motion: dict[str, Any] | None = None,
    seed: int = 1,
    effects: Sequence[dict[str, Any]] | None = None,
    progress: _Progress = None,
    **scenario: Any,
) -> Recording:
    """What the logger of a simulated robot records; keywords are the keys of a scenario's file."""

def excite(
    robot: str,
    *,
    motion: dict[str, Any] | None = None,
    duration_s: float = 20.0,
    harmonics: int = 6,
    top_hz: float = 0.6,
    share: float = 0.8,
    tries: int = 600,
    rate_hz: float = 100.0,
    torque_limits: bool = False,
    seed: int = 1,
    progress: _Progress = None,
) -> _Excitation:
    """A motion that makes a robot's parameters visible."""

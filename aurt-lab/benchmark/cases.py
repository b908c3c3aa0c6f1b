"""Cases of the benchmark: recordings, split, what every tool is told, and what is known to be true.

Joints count from 0. Names of files are relative to the folder in the environment variable AURT_DATA.
"""

from dataclasses import dataclass, field

VERTICAL = (0.0, 0.0, -9.81)
UR10E_NM_PER_A = (11.976, 11.976, 9.839, 10.763, 10.763, 10.763)
KR300_UNITS_PER_NM = (0.0038932, 0.0037393, 0.0039630, 0.0045249, 0.0041733, 0.0064800)


@dataclass(frozen=True)
class Part:
    """A stretch of a recording; `loaded`: with the load of the case on the last link."""

    file: str
    begin_s: float = 0.0
    end_s: float = 1e6
    loaded: bool = False


@dataclass(frozen=True)
class Truth:
    """A known value."""

    value: float
    unit: str


@dataclass(frozen=True)
class ArmCase:
    """An arm whose joint torques (forces) are measured, and held-out motions on which they are predicted."""

    name: str
    title: str
    mdh: str
    calibration: tuple[Part, ...]
    held_out: tuple[Part, ...]
    f_dyn_hz: float
    rate_hz: float
    nm_per_unit: tuple[float, ...]
    gravity: tuple[float, float, float] = VERTICAL
    unit: str = "Nm"
    coupling: tuple[int, int] | None = None
    load_link: int | None = None
    offset: bool = False
    columns: tuple[str, ...] | None = None
    truth: dict[str, Truth] = field(default_factory=dict)

    @property
    def joints(self) -> int:
        """Number of joints."""
        return len(self.nm_per_unit)


@dataclass(frozen=True)
class DriveCase:
    """A robot whose commands and positions are recorded; held-out positions are simulated from commands alone."""

    name: str
    title: str
    experiment: str
    description: str
    calibration: tuple[Part, ...]
    held_out: tuple[Part, ...]
    position: slice
    command: slice
    truth: dict[str, Truth] = field(default_factory=dict)


def _ur10e(name: str, title: str, calibration: tuple[Part, ...], held_out: tuple[Part, ...], **more) -> ArmCase:
    """A case of the UR10e."""
    return ArmCase(
        name, title, "ur10e/mdh.csv", calibration, held_out, 2.5, 100.0, UR10E_NM_PER_A, unit="A", **more,
    )


UNLOADED, LOADED = "ur10e/unloaded_50s.csv", "ur10e/payload_50s.csv"
EXCITED_20, EXCITED_30, EXCITED_50 = (f"ur10e/excitation_{s}s.csv" for s in (20, 30, 50))

ARMS = (
    _ur10e(
        "ur10e_load", "UR10e, load of 2.805 kg",
        (Part(UNLOADED), Part(LOADED, 0.0, 25.0, True)), (Part(LOADED, 25.0, 60.0, True),),
        load_link=5, truth={"load_kg": Truth(2.805, "kg")},
    ),
    _ur10e(
        "ur10e_no_load", "UR10e, unchanged",
        (Part(UNLOADED), Part(EXCITED_50, loaded=True)), (Part(EXCITED_20, loaded=True),),
        load_link=5, truth={"load_kg": Truth(0.0, "kg")},
    ),
    _ur10e(
        "ur10e_torque", "UR10e, torque",
        (Part(UNLOADED), Part(EXCITED_50), Part(EXCITED_30)), (Part(EXCITED_20), Part("ur10e/point_to_point.csv")),
    ),
    ArmCase(
        "tx40", "TX40, coupled wrist", "tx40/mdh.csv",
        (Part("tx40/excitation_1khz.csv", 0.0, 4.5),), (Part("tx40/excitation_1khz.csv", 4.5, 9.0),),
        20.0, 1000.0, (1.0,) * 6, coupling=(5, 4),
        truth={
            "coupling_kg_m2": Truth(0.00964, "kg m²"),
            "coupling_viscous": Truth(0.616, "Nm s/rad"),
            "coupling_coulomb": Truth(1.95, "Nm"),
        },
    ),
    ArmCase(
        "emps", "EMPS, one drive", "emps",
        (Part("emps/DATA_EMPS.mat"),), (Part("emps/DATA_EMPS_PULSES.mat"),),
        10.0, 1000.0, (35.15065,), (0.0, 0.0, 0.0), "V", offset=True, columns=("t", "qm", "vir"),
        truth={
            "mass_kg": Truth(95.1089, "kg"),
            "viscous": Truth(203.5034, "N s/m"),
            "coulomb": Truth(20.3935, "N"),
            "offset": Truth(-3.1648, "N"),
        },
    ),
    ArmCase(
        "panda", "Panda, torque", "panda/mdh.csv",
        (Part("panda/excitation.csv", 0.0, 14.0),), (Part("panda/excitation.csv", 14.0, 22.0),),
        5.0, 1000.0, (1.0,) * 7,
    ),
    ArmCase(
        "kr300", "KR300, torque", "kuka_kr300/mdh.csv",
        (Part("kuka_kr300/A.csv"), Part("kuka_kr300/B.csv")), (Part("kuka_kr300/C.csv"),),
        10.0, 250.0, tuple(1 / u for u in KR300_UNITS_PER_NM), (0.0, 0.0, 9.81),
    ),
)


DYNO = "dyno/futek_test_22_04_2021_17-11-42.csv"
ARMS += (
    ArmCase(
        "dyno", "dyno, loss by the sensor", "shaft", (Part(DYNO, 4.0, 68.0),), (Part(DYNO, 70.0, 103.0),),
        1.0, 100.0, (1.0,), (0.0, 0.0, 0.0), offset=True,
    ),
)

SO101 = (
    "backlash_detection", "chirp_sweep", "friction_gravity", "hold_under_gravity", "multisine", "pick_place",
    "random_waypoints", "single_joint_elbow", "single_joint_rotation", "single_joint_wrist_pitch",
    "single_joint_wrist_roll", "slow_precision", "static_holding", "step_response", "trapezoidal_profile",
)
GO2 = "go2/traj_0.csv"

DRIVES = (
    DriveCase(
        "so101", "SO-101, rollouts", "5-servo/so101.toml", "so101/so101_new_calib.xml",
        tuple(Part(f"so101/{name}.csv") for name in SO101[::2]), tuple(Part(f"so101/{name}.csv") for name in SO101[1::2]),
        slice(7, 12), slice(1, 6),
    ),
    DriveCase(
        "go2", "Go2, rollouts", "6-quadruped/go2.toml", "go2/go2.xml",
        (Part(GO2, 0.0, 15.66),), (Part(GO2, 15.66, 23.5),), slice(1, 13), slice(13, 25),
    ),
)

CASES = ARMS + DRIVES

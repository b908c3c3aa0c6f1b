"""One calibration from every format: `AURT_DATA=… same-in-every-format.py AURT FOLDER`.

The recordings of the UR10e (docs/real-recordings.md) are written anew as NumPy, MATLAB, MCAP and Parquet files; AURT is the
program. Prints for each format the size of its files, how many numbers the calibrated model has, how many of them differ from those from
text in any bit, and by how much at most, relative; and whether the predictions for the held-out recording are the same file. Needs NumPy, SciPy, mcap-ros2-support and PyArrow.
"""

import json
import os
import pathlib
import subprocess
import sys

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
from mcap.writer import CompressionType
from mcap_ros2.writer import Writer
from scipy.io import savemat

AURT, FOLDER = sys.argv[1], pathlib.Path(sys.argv[2])
DATA = pathlib.Path(os.environ["AURT_DATA"]) / "ur10e"
FILES = ["excitation_20s", "point_to_point"]
JOINTS = [f"ur10e_joint_{j}" for j in range(6)]
ORDER = [3, 1, 5, 0, 2, 4]  # not that of the chain: joints are found by name
JOINT_STATE = (
    "std_msgs/Header header\nstring[] name\nfloat64[] position\nfloat64[] velocity\nfloat64[] effort\n"
    + "=" * 80
    + "\nMSG: std_msgs/Header\nbuiltin_interfaces/Time stamp\nstring frame_id\n"
    + "=" * 80
    + "\nMSG: builtin_interfaces/Time\nint32 sec\nuint32 nanosec"
)


def table(name):
    """Stamps, positions, velocities and currents of a recording."""
    lines = (DATA / f"{name}.csv").read_text().splitlines()
    rows = np.array([[float(x) for x in line.split(",")] for line in lines[1:]])
    names = lines[0].split(",")
    of = lambda prefix: rows[:, [names.index(f"{prefix}_{j}") for j in range(6)]]
    return rows[:, 0], of("actual_q"), of("actual_qd"), of("actual_current")


def csv(path, t, q, v, i):
    names = ["timestamp"] + [f"actual_{k}_{j}" for k in ("q", "qd", "current") for j in range(6)]
    rows = [",".join(repr(float(x)) for x in row) for row in np.column_stack([t, q, v, i])]
    path.write_text(",".join(names) + "\n" + "\n".join(rows) + "\n")


def bag(path, t, q, v, i, compression):
    with open(path, "wb") as stream:
        writer = Writer(stream, compression=compression)
        schema = writer.register_msgdef("sensor_msgs/msg/JointState", JOINT_STATE)
        for k, stamp in enumerate(t):
            ns = round(stamp * 1e9)
            message = {
                "header": {"stamp": {"sec": ns // 10**9, "nanosec": ns % 10**9}, "frame_id": ""},
                "name": [JOINTS[j] for j in ORDER],
                "position": q[k, ORDER].tolist(),
                "velocity": v[k, ORDER].tolist(),
                "effort": i[k, ORDER].tolist(),
            }
            writer.write_message("/joint_states", schema, message, log_time=ns)
        writer.finish()


def lists(t, q, v, i):
    column = lambda a: pa.array(list(a), pa.list_(pa.float64()))
    return pa.table({"time": t, "q": column(q), "qd": column(v), "current": column(i)})


def flat(t, q, v, i):
    series = {f"{k}_{j}": a[:, j] for k, a in (("q", q), ("qd", v), ("current", i)) for j in range(6)}
    return pa.table({"time": t} | series)


FORMATS = {
    "text": ("csv", csv),
    "NumPy, stored": ("npz", lambda p, t, q, v, i: np.savez(p, time=t, q=q, qd=v, current=i)),
    "NumPy, compressed, transposed": (
        "npz",
        lambda p, t, q, v, i: np.savez_compressed(p, time=t, q=q.T, qd=v.T, current=i.T),
    ),
    "MATLAB 6": ("mat", lambda p, t, q, v, i: savemat(p, {"time": t, "q": q, "qd": v, "current": i})),
    "MATLAB 7, structure": (
        "mat",
        lambda p, t, q, v, i: savemat(p, {"log": {"time": t, "q": q, "qd": v, "current": i}}, do_compression=True),
    ),
    "MCAP": ("mcap", lambda p, *a: bag(p, *a, CompressionType.NONE)),
    "MCAP, lz4": ("mcap", lambda p, *a: bag(p, *a, CompressionType.LZ4)),
    "MCAP, zstd": ("mcap", lambda p, *a: bag(p, *a, CompressionType.ZSTD)),
    "Parquet, Snappy": ("parquet", lambda p, *a: pq.write_table(flat(*a), p)),
    "Parquet, zstd, lists": ("parquet", lambda p, *a: pq.write_table(lists(*a), p, compression="zstd")),
    "text in degrees, ms, mA": (
        "csv",
        lambda p, t, q, v, i: csv(p, t * 1e3, np.rad2deg(q), np.rad2deg(v), i * 1e3),
    ),
}


def parameters(model):
    """All numbers of a model by their place, without what names files and times."""
    found = {}

    def walk(place, value):
        if isinstance(value, dict):
            for key, member in value.items():
                if key not in ("provenance", "recordings", "experiment"):
                    walk(f"{place}/{key}", member)
        elif isinstance(value, list):
            for k, member in enumerate(value):
                walk(f"{place}/{k}", member)
        elif isinstance(value, float):
            found[place] = value

    walk("", model)
    return found


first, first_predicted = None, None
for name, (ending, write) in FORMATS.items():
    folder = FOLDER / name.replace(", ", "_").replace(" ", "_")
    folder.mkdir(parents=True, exist_ok=True)
    for file in FILES:
        write(folder / f"{file}.{ending}", *table(file))
    said = 'angle = "deg"\ntime = "ms"\ncurrent = "mA"\n' if "degrees" in name else ""
    if ending == "mcap":
        said = f"joint_names = {json.dumps(JOINTS)}\n"
        source = lambda file: f'{{ file = "{file}.mcap", unit = "A" }}'
    else:
        source = lambda file: f'"{file}.{ending}"'
    (folder / "experiment.toml").write_text(
        f"""schema = 1
[robot]
mdh = "{DATA}/mdh.csv"
gravity_m_s2 = [0.0, 0.0, -9.81]
torque_constants_nm_per_a = [11.976, 11.976, 9.839, 10.763, 10.763, 10.763]
[joint_dynamics]
coulomb = {{ model = "absolute" }}
hysteresis = {{ model = "sign" }}
viscous = {{ model = "polynomial", powers = [1] }}
[recordings]
{said}calibration = [{source(FILES[0])}]
validation = [{source(FILES[1])}]
[preprocess]
f_dyn_hz = 2.5
"""
    )
    out = folder / "out"
    subprocess.run(["rm", "-rf", out], check=True)
    run = subprocess.run([AURT, "run", folder / "experiment.toml", "--out", out], capture_output=True, text=True)
    if run.returncode not in (0, 1):
        sys.exit(f"{name}: {run.stderr}")
    values = parameters(json.loads((out / "rd_calibrated.json").read_text()))
    predicted = (out / f"predicted_{FILES[1]}.csv").read_bytes()
    first, first_predicted = first or values, first_predicted or predicted
    assert values.keys() == first.keys() and len(values) > 40, name
    bits = sum(values[k] != first[k] for k in first)
    furthest = max(abs(values[k] - first[k]) / max(abs(first[k]), 1e-12) for k in first)
    same = "same" if predicted == first_predicted else "other"
    size = sum((folder / f"{file}.{ending}").stat().st_size for file in FILES)
    print(f"| {name} | {size / 1e6:.2f} MB | {len(values)} | {bits} | {furthest:.0e} | {same} |")

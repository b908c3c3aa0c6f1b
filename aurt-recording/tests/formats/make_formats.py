"""One recording in every format that AURT reads: `make_formats.py recording.csv folder`.

The files beside this script are the first 120 rows of `exciting_motion.csv` of `aurt demo`. Needs NumPy, SciPy,
mcap-ros2-support and rosbags for bags, and PyArrow for Parquet; formats whose packages are missing are left out, with a line.
"""

import pathlib
import sys

import numpy as np

SOURCE, FOLDER = pathlib.Path(sys.argv[1]), pathlib.Path(sys.argv[2])
JOINTS = ["shoulder_pan", "shoulder_lift", "elbow", "wrist_1", "wrist_2", "wrist_3"]
# Drivers list joints by the alphabet, not along the chain.
ORDER = sorted(range(6), key=lambda j: JOINTS[j])

table = np.array([[float(x) for x in line.split(",")] for line in SOURCE.read_text().splitlines()[1:]])
time, q, current = table[:, 0], table[:, 1:7], table[:, 7:13]
FOLDER.mkdir(exist_ok=True)

np.savez(FOLDER / "stored.npz", time=time, q=q, current=current, robot=np.array("UR10e"))
np.savez_compressed(FOLDER / "compressed.npz", time=time, q=np.asfortranarray(q), current=current.astype(">f8"))
np.savez_compressed(FOLDER / "transposed.npz", time=time, q=q.T, current=current.T)
np.save(FOLDER / "single.npy", table)

try:
    from scipy.io import savemat
except ImportError:
    print("left out: MATLAB (no scipy)")
else:
    savemat(FOLDER / "version_6.mat", {"time": time, "q": q, "current": current, "robot": "UR10e"})
    nested = {"log": {"time": time, "q": q.T, "current": current}, "note": "by SciPy"}
    savemat(FOLDER / "version_7.mat", nested, do_compression=True)

try:
    from mcap.writer import CompressionType
    from mcap_ros2.writer import Writer
except ImportError:
    print("left out: MCAP (no mcap-ros2-support)")
else:
    JOINT_STATE = """std_msgs/Header header
string[] name
float64[] position
float64[] velocity
float64[] effort
================================================================================
MSG: std_msgs/Header
builtin_interfaces/Time stamp
string frame_id
================================================================================
MSG: builtin_interfaces/Time
int32 sec
uint32 nanosec"""
    kinds = [("zstd", CompressionType.ZSTD), ("lz4", CompressionType.LZ4), ("plain", CompressionType.NONE)]
    for name, kind in kinds:
        with open(FOLDER / f"{name}.mcap", "wb") as stream:
            writer = Writer(stream, compression=kind, chunk_size=8192)
            state = writer.register_msgdef("sensor_msgs/msg/JointState", JOINT_STATE)
            text = writer.register_msgdef("std_msgs/msg/String", "string data")
            for k in range(len(time)):
                nanoseconds = round(time[k] * 1e9)
                message = {
                    "header": {
                        "stamp": {"sec": nanoseconds // 10**9, "nanosec": nanoseconds % 10**9},
                        "frame_id": "base",
                    },
                    "name": [JOINTS[j] for j in ORDER],
                    "position": [q[k, j] for j in ORDER],
                    "velocity": [],
                    "effort": [current[k, j] for j in ORDER],
                }
                writer.write_message("/arm/joint_states", state, message, log_time=nanoseconds + 1000)
                if k % 10 == 0:
                    writer.write_message("/remarks", text, {"data": f"row {k}"}, log_time=nanoseconds)
            writer.finish()

try:
    import shutil
    import sqlite3

    from rosbags.rosbag2 import CompressionFormat, CompressionMode, StoragePlugin
    from rosbags.rosbag2 import Writer as BagWriter
    from rosbags.typesys import Stores, get_typestore
except ImportError:
    print("left out: SQLite bags (no rosbags)")
else:
    store = get_typestore(Stores.ROS2_HUMBLE)
    kinds = store.types

    def messages(frame="base"):
        """Stamp of the recorder, topic, type and bytes of every message."""
        for k in range(len(time)):
            nanoseconds = round(time[k] * 1e9)
            stamp = kinds["builtin_interfaces/msg/Time"](sec=nanoseconds // 10**9, nanosec=nanoseconds % 10**9)
            kind = "sensor_msgs/msg/JointState"
            state = kinds[kind](
                header=kinds["std_msgs/msg/Header"](stamp=stamp, frame_id=frame),
                name=[JOINTS[j] for j in ORDER],
                position=q[k, ORDER],
                velocity=np.zeros(0),
                effort=current[k, ORDER],
            )
            yield nanoseconds + 1000, "/arm/joint_states", kind, bytes(store.serialize_cdr(state, kind))
            if k % 40 == 0:
                kind = "std_msgs/msg/String"
                words = kinds[kind](data=f"row {k} " * 1000)
                yield nanoseconds + 2000, "/remarks", kind, bytes(store.serialize_cdr(words, kind))

    def rosbag(folder, mode):
        shutil.rmtree(folder, ignore_errors=True)
        writer = BagWriter(folder, version=8, storage_plugin=StoragePlugin.SQLITE3)
        writer.set_compression(mode, CompressionFormat.ZSTD)
        with writer:
            topics = {}
            for log_time, topic, kind, data in messages():
                if topic not in topics:
                    topics[topic] = writer.add_connection(topic, kind, typestore=store)
                writer.write(topics[topic], log_time, data)

    for name, mode in [("packed_file", CompressionMode.FILE), ("packed_messages", CompressionMode.MESSAGE)]:
        rosbag(FOLDER / f"{name}_bag", mode)

    # As the recorder of ROS 2 splits a bag; small pages, so that messages and the table go over several.
    split_bag = FOLDER / "split_bag"
    split_bag.mkdir(exist_ok=True)
    everything = list(messages(frame="base" + 25 * " of the arm"))
    names = ["split_bag_0.db3", "split_bag_1.db3"]
    for name, part in zip(names, [everything[: len(everything) // 3], everything[len(everything) // 3 :]]):
        (split_bag / name).unlink(missing_ok=True)
        database = sqlite3.connect(split_bag / name)
        database.executescript(
            """PRAGMA page_size = 512; PRAGMA journal_mode = WAL;
            CREATE TABLE schema(schema_version INTEGER PRIMARY KEY, ros_distro TEXT NOT NULL);
            CREATE TABLE topics(id INTEGER PRIMARY KEY, name TEXT NOT NULL, type TEXT NOT NULL,
                serialization_format TEXT NOT NULL, offered_qos_profiles TEXT NOT NULL);
            CREATE TABLE messages(id INTEGER PRIMARY KEY, topic_id INTEGER NOT NULL, timestamp INTEGER NOT NULL,
                data BLOB NOT NULL);
            CREATE INDEX timestamp_idx ON messages (timestamp ASC);"""
        )
        topics = [("/remarks", "std_msgs/msg/String"), ("/arm/joint_states", "sensor_msgs/msg/JointState")]
        for topic, kind in topics:
            row = (topic, kind, "cdr", "")
            database.execute(
                "INSERT INTO topics(name, type, serialization_format, offered_qos_profiles) VALUES(?, ?, ?, ?)", row
            )
        for log_time, topic, _, data in part:
            number = 1 + [name for name, _ in topics].index(topic)
            database.execute("INSERT INTO messages(topic_id, timestamp, data) VALUES(?, ?, ?)", (number, log_time, data))
        database.commit()
        database.close()
    (split_bag / "metadata.yaml").write_text(
        "rosbag2_bagfile_information:\n  version: 4\n  storage_identifier: sqlite3\n  relative_file_paths:\n"
        + "".join(f"    - {name}\n" for name in names)
        + "  duration:\n    nanoseconds: 1\n"
    )

try:
    import pyarrow as pa
    import pyarrow.parquet as pq
except ImportError:
    print("left out: Parquet (no pyarrow)")
else:
    flat = {"time": time}
    flat |= {f"q_{j}": q[:, j] for j in range(6)} | {f"current_{j}": current[:, j] for j in range(6)}
    lists = {
        "time": time,
        "q": pa.array(list(q), pa.list_(pa.float64())),
        "current": pa.array(list(current), pa.list_(pa.float64(), 6)),
        "note": ["by PyArrow"] * len(time),
        "moving": time > 0.5,
    }
    # Texts and truth values are skipped; the rest is all that a writer can choose.
    pq.write_table(pa.table(flat), FOLDER / "snappy.parquet", row_group_size=50)
    pq.write_table(pa.table(lists), FOLDER / "zstd.parquet", compression="zstd", row_group_size=70)
    split = {name: "BYTE_STREAM_SPLIT" for name in flat}
    pq.write_table(
        pa.table(flat),
        FOLDER / "split.parquet",
        compression="gzip",
        use_dictionary=False,
        column_encoding=split,
        data_page_version="2.0",
        data_page_size=256,
    )
    moments = pa.array(np.round(time * 1e9).astype(np.int64) + 1_700_000_000 * 10**9, pa.timestamp("ns"))
    pq.write_table(
        pa.table(lists | {"time": moments}),
        FOLDER / "moments.parquet",
        compression="lz4",
        use_dictionary=False,
        column_encoding={"time": "DELTA_BINARY_PACKED"},
        data_page_size=256,
    )
    # Two episodes of a LeRobot data set: frames in lists of 32-bit floats, stamps that begin anew.
    frames = [[2.0 * k, 2.0 * k + 1.0] for k in range(6)]
    pq.write_table(
        pa.table(
            {
                "observation.state": pa.array(frames, pa.list_(pa.float32(), 2)),
                "action": pa.array(frames, pa.list_(pa.float32(), 2)),
                "timestamp": pa.array([0, 0.25, 0.5] * 2, pa.float32()),
                "frame_index": pa.array([0, 1, 2] * 2, pa.int64()),
                "episode_index": pa.array([0] * 3 + [1] * 3, pa.int64()),
            }
        ),
        FOLDER / "lerobot.parquet",
    )

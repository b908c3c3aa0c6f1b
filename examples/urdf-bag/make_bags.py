"""The bags beside this script, from the recordings that `aurt demo` writes: `make_bags.py DEMO FOLDER`.

    aurt demo --out demo
    python make_bags.py demo .

They are what the ROS 2 driver of a UR10e publishes: joints by name, in an order of its own, and motor currents in the place of
efforts. Needs mcap-ros2-support.
"""

import pathlib
import sys

from mcap.writer import CompressionType
from mcap_ros2.writer import Writer

DEMO, FOLDER = pathlib.Path(sys.argv[1]), pathlib.Path(sys.argv[2])
JOINTS = ["shoulder_pan_joint", "shoulder_lift_joint", "elbow_joint", "wrist_1_joint", "wrist_2_joint", "wrist_3_joint"]
ORDER = [2, 1, 0, 3, 4, 5]
LINE = "=" * 80
JOINT_STATE = f"""std_msgs/Header header
string[] name
float64[] position
float64[] velocity
float64[] effort
{LINE}
MSG: std_msgs/Header
builtin_interfaces/Time stamp
string frame_id
{LINE}
MSG: builtin_interfaces/Time
int32 sec
uint32 nanosec"""

for source, bag in [("exciting_motion", "monday"), ("other_motion", "tuesday")]:
    rows = [line.split(",") for line in (DEMO / f"{source}.csv").read_text().splitlines()[1:]]
    with open(FOLDER / f"{bag}.mcap", "wb") as stream:
        writer = Writer(stream, compression=CompressionType.ZSTD, chunk_size=1 << 20)
        schema = writer.register_msgdef("sensor_msgs/msg/JointState", JOINT_STATE)
        for row in rows:
            stamp_ns = round(float(row[0]) * 1e9)
            message = {
                "header": {"stamp": {"sec": stamp_ns // 10**9, "nanosec": stamp_ns % 10**9}, "frame_id": "base_link"},
                "name": [JOINTS[j] for j in ORDER],
                "position": [float(row[1 + j]) for j in ORDER],
                "velocity": [],
                "effort": [float(row[7 + j]) for j in ORDER],
            }
            writer.write_message("/joint_states", schema, message, log_time=stamp_ns)
        writer.finish()

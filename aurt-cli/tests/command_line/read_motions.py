"""Motions that `aurt` wrote, as parsers of others read them: `read_motions.py FOLDER` prints the rows as JSON.

Reads `motion.mcap` (mcap-ros2-support), `motion.lerobot` (PyArrow and pandas), `motion.yaml` (PyYAML) and `motion.script` (Python's
own parser: no package reads URScript). Numbers of bags and data sets are printed as the digits of their bits.
"""

import ast
import json
import pathlib
import struct
import sys

import pandas
import pyarrow.parquet
import yaml
from mcap_ros2.reader import read_ros2_messages

FOLDER = pathlib.Path(sys.argv[1])


def bits(numbers):
    return [struct.pack(">d", number).hex() for number in numbers]


def bag():
    messages = list(read_ros2_messages(str(FOLDER / "motion.mcap")))
    assert len(messages) == 1, messages
    motion = messages[0].ros_msg
    assert messages[0].schema.name == "trajectory_msgs/msg/JointTrajectory"
    assert (motion.header.stamp.sec, motion.header.stamp.nanosec, motion.header.frame_id) == (0, 0, "")
    points = []
    for point in motion.points:
        assert len(point.effort) == 0
        series = [bits(part) for part in (point.positions, point.velocities, point.accelerations)]
        points.append([point.time_from_start.sec * 10**9 + point.time_from_start.nanosec, *series])
    return {"names": list(motion.joint_names), "points": points}


def data_set():
    folder = FOLDER / "motion.lerobot"
    info = json.loads((folder / "meta/info.json").read_text())
    assert info["codebase_version"] == "v3.0" and isinstance(info["fps"], int)
    # As `DEFAULT_FEATURES` of lerobot.datasets.utils.
    assert info["features"]["timestamp"] == {"dtype": "float32", "shape": [1], "names": None}
    for counter in ("frame_index", "episode_index", "index", "task_index"):
        assert info["features"][counter] == {"dtype": "int64", "shape": [1], "names": None}, counter

    tasks = pandas.read_parquet(folder / "meta/tasks.parquet")
    assert list(tasks.columns) == ["task_index"] and tasks.iloc[0]["task_index"] == 0
    assert isinstance(tasks.iloc[0].name, str)
    (episode,) = pyarrow.parquet.read_table(folder / "meta/episodes/chunk-000/file-000.parquet").to_pylist()
    place = {"chunk_index": episode["data/chunk_index"], "file_index": episode["data/file_index"]}
    data = pyarrow.parquet.read_table(folder / info["data_path"].format(**place))
    rows = data.num_rows
    assert episode["tasks"] == list(tasks.index) and episode["episode_index"] == 0
    assert [episode["dataset_from_index"], episode["dataset_to_index"], episode["length"]] == [0, rows, rows]
    assert (info["total_frames"], info["total_episodes"], info["total_tasks"]) == (rows, 1, 1)

    assert set(data.column_names) == set(info["features"])
    columns = data.to_pydict()
    for name, feature in info["features"].items():
        kind = data.schema.field(name).type
        if feature["shape"] != [1]:
            assert all(len(value) == feature["shape"][0] == len(feature["names"]) for value in columns[name]), name
            kind = kind.value_type
        assert str(kind) == {"float32": "float", "int64": "int64"}[feature["dtype"]], (name, kind)
    assert columns["frame_index"] == columns["index"] == list(range(rows))
    assert set(columns["episode_index"]) == set(columns["task_index"]) == {0}
    assert columns["action"] == columns["observation.state"]
    statistics = json.loads((folder / "meta/stats.json").read_text())
    assert set(statistics) == set(info["features"])
    assert statistics["action"]["max"] == [max(series) for series in zip(*columns["action"])]
    return {
        "names": info["features"]["action"]["names"],
        "fps": info["fps"],
        "points": [[bits([stamp])[0], bits(q)] for stamp, q in zip(columns["timestamp"], columns["action"])],
    }


def goal():
    motion = yaml.safe_load((FOLDER / "motion.yaml").read_text())["trajectory"]
    times = [point["time_from_start"] for point in motion["points"]]
    return {
        "names": motion["joint_names"],
        "times_ns": [time["sec"] * 10**9 + time["nanosec"] for time in times],
        "positions": [point["positions"] for point in motion["points"]],
    }


# Arguments of the URScript manual in their order, and the ranges that it states.
ARGUMENTS = {
    "movej": ["q", "a", "v", "t", "r"],
    "servoj": ["q", "a", "v", "t", "lookahead_time", "gain"],
    "sleep": ["t"],
    "stopj": ["a"],
}
RANGES = {"t": (0.002, 1e3), "lookahead_time": (0.03, 0.2), "gain": (100, 2000), "a": (1e-3, 40), "v": (1e-3, 4)}


def script():
    """The calls of a URScript program.

    URScript has the expressions, calls, definitions and indentation of Python; its blocks end with a line `end`. Without these
    lines the program has to be Python, and each of them has to stand where Python sees its block end.
    """
    lines = (FOLDER / "motion.script").read_text(encoding="ascii").splitlines()
    (end,) = [k for k, line in enumerate(lines, 1) if line == "end"]
    lines[end - 1] = ""
    function, start = ast.parse("\n".join(lines)).body
    assert isinstance(function, ast.FunctionDef) and ast.unparse(function.args) == ""
    assert end == function.end_lineno + 1 and ast.unparse(start) == f"{function.name}()"
    calls = []
    for statement in function.body:
        call = statement.value
        names = ARGUMENTS[call.func.id]
        given = dict(zip(names, call.args)) | {keyword.arg: keyword.value for keyword in call.keywords}
        assert set(given) <= set(names) and len(given) == len(call.args) + len(call.keywords), ast.unparse(call)
        given = {name: ast.literal_eval(value) for name, value in given.items()}
        for name in set(given) & set(RANGES):
            assert RANGES[name][0] <= given[name] <= RANGES[name][1], ast.unparse(call)
        calls.append((call.func.id, given))
    assert [name for name, _ in calls] == ["movej", "sleep", *["servoj"] * (len(calls) - 3), "stopj"]
    (period_s,) = {given["t"] for name, given in calls if name == "servoj"}
    positions = [given["q"] for name, given in calls if name == "servoj"]
    return {"start": calls[0][1]["q"], "period_s": period_s, "positions": positions}


print(json.dumps({"bag": bag(), "data_set": data_set(), "goal": goal(), "script": script()}))

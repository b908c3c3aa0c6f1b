"""Long recordings for measuring how fast they are read: `large-recording.py ROWS FOLDER [FILE …]`.

Six joints at 500 Hz, positions and efforts, in MCAP (chunks of 1000 messages: plain, lz4, zstd) and in Parquet (Snappy, zstd,
plain). Needs NumPy, PyArrow, lz4 and zstandard.
"""

import pathlib
import struct
import sys
import zlib

import lz4.frame
import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
import zstandard

ROWS, FOLDER = int(sys.argv[1]), pathlib.Path(sys.argv[2])
FOLDER.mkdir(parents=True, exist_ok=True)
PIECE = 1_000_000


def motion(first, count):
    """Stamps, positions and efforts of some rows, rounded as encoders and drives round."""
    t = np.arange(first, first + count) * 0.002
    w = 1.0 + 0.3 * np.arange(6)
    return t, np.round(np.sin(t[:, None] * w), 5), np.round(3 * np.cos(t[:, None] * w), 3)


def parquet(name, **options):
    schema = pa.schema([(c, pa.float64()) for c in ["time"] + [f"{k}_{j}" for k in ("q", "current") for j in range(6)]])
    with pq.ParquetWriter(FOLDER / name, schema, **options) as writer:
        for first in range(0, ROWS, PIECE):
            t, q, i = motion(first, min(PIECE, ROWS - first))
            writer.write_table(pa.table([t, *q.T, *i.T], schema=schema))


def record(kind, body):
    return struct.pack("<BQ", kind, len(body)) + body


def text(value):
    return struct.pack("<I", len(value)) + value.encode()


def mcap(name, compression, pack):
    # All messages are of one length, hence an array of records: stamp, frame, names, three lists.
    names = b"".join(struct.pack("<I", 3) + f"j{j}\0".encode() + b"\0" for j in range(6))
    # The empty frame is a zero with three bytes of alignment; the lists that follow are aligned as they are.
    before = struct.pack("<I", 1) + b"\0\0\0\0" + struct.pack("<I", 6) + names
    message = np.dtype(
        [("op", "u1"), ("len", "<u8"), ("channel", "<u2"), ("seq", "<u4"), ("log", "<u8"), ("pub", "<u8")]
        + [("cdr", "S4"), ("sec", "<i4"), ("nsec", "<u4"), ("names", f"V{len(before)}")]
        + [("nq", "<u4"), ("q", "<f8", 6)]
        + [("nv", "<u4"), ("ne", "<u4"), ("e", "<f8", 6)]
    )
    with open(FOLDER / name, "wb") as out:
        out.write(b"\x89MCAP0\r\n" + record(1, text("ros2") + text("")))
        definitions = record(3, struct.pack("<H", 1) + text("sensor_msgs/msg/JointState") + text("ros2msg") + text(""))
        definitions += record(4, struct.pack("<HH", 1, 1) + text("/joint_states") + text("cdr") + struct.pack("<I", 0))
        out.write(definitions)
        for first in range(0, ROWS, PIECE):
            t, q, e = motion(first, min(PIECE, ROWS - first))
            rows = np.zeros(len(t), message)
            ns = np.round(t * 1e9).astype("i8")
            rows["op"], rows["len"], rows["channel"] = 5, message.itemsize - 9, 1
            rows["log"] = rows["pub"] = ns
            rows["cdr"] = b"\0\1"
            rows["sec"], rows["nsec"] = ns // 10**9, ns % 10**9
            rows["names"] = np.void(before)
            rows["nq"], rows["ne"], rows["q"], rows["e"] = 6, 6, q, e
            for start in range(0, len(t), 1000):
                plain = rows[start : start + 1000].tobytes()
                packed = pack(plain)
                chunk = struct.pack("<QQQI", 0, 0, len(plain), zlib.crc32(plain)) + text(compression)
                out.write(record(6, chunk + struct.pack("<Q", len(packed)) + packed))
        out.write(record(15, struct.pack("<I", 0)) + record(2, struct.pack("<QQI", 0, 0, 0)) + b"\x89MCAP0\r\n")


KINDS = {
    "snappy.parquet": lambda n: parquet(n),
    "zstd.parquet": lambda n: parquet(n, compression="zstd"),
    "plain.parquet": lambda n: parquet(n, compression="none", use_dictionary=False),
    "plain.mcap": lambda n: mcap(n, "", lambda b: b),
    "lz4.mcap": lambda n: mcap(n, "lz4", lz4.frame.compress),
    "zstd.mcap": lambda n: mcap(n, "zstd", zstandard.ZstdCompressor(level=1).compress),
}
for name in sys.argv[3:] or KINDS:
    KINDS[name](name)

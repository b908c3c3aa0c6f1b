"""What the torque sensor of a bench of two drives says, beside their currents; needs no package.

    python sensor.py FOLDER_OF_DYNO losses.csv

prints the torque constant under stall and the losses at equal speeds, cold and warm, and writes the losses over time.
"""

import csv
import math
import statistics
import sys
from pathlib import Path

STALL = "futek_test_12_05_2021_11-32-30.csv"
DAMPED = "futek_test_22_04_2021_17-11-42.csv"


def rows(path):
    with open(path) as lines:
        for row in csv.DictReader(line for line in lines if not line.startswith("#")):
            yield {name: float(value) for name, value in row.items() if value}


def stalled(folder):
    kept = [r for r in rows(folder / STALL) if r["c1 mode"] == 9 and r["time [s]"] > 2 and abs(r["a1 q-axis [A]"]) > 0.5]
    line = statistics.linear_regression([r["a1 q-axis [A]"] for r in kept], [r["trs605-5 torque [Nm]"] for r in kept])
    rest = [r["trs605-5 torque [Nm]"] - line.intercept - line.slope * r["a1 q-axis [A]"] for r in kept]
    print(f"torque under stall: {line.slope:.4f} Nm/A by the sensor, rest {statistics.pstdev(rest):.3f} Nm")


def losses(folder, target):
    last, table = None, []
    for r in rows(folder / DAMPED):
        time_s, q = r["time [s]"], r["a1 position [rad]"]
        # Drive 2 faces drive 1: its torque holds against that of drive 1.
        by_sensor = r["a1 torque [Nm]"] - r["trd605 torque [Nm]"]
        by_currents = r["a1 torque [Nm]"] - r["a2 torque [Nm]"]
        speed = 0.0 if last is None else (q - last[1]) / (time_s - last[0])
        last = time_s, q
        table.append((time_s, q, by_sensor, by_currents, r["motor temp [C]"], speed))
    with open(target, "w") as out:
        print("time,position,by_sensor,by_currents", file=out)
        for row in table:
            print(*row[:4], sep=",", file=out)
    print("speed rad/s    motor °C      loss of drive 1 by the sensor, Nm")
    for speed in (3.2, 7.3, 11.6, 15.9, 20.1):
        for begin, end in ((4, 34), (69.5, 104)):
            own = [r for r in table if begin < r[0] < end and abs(r[5] - speed) < 1.5]
            means = [statistics.fmean(r[2] for r in own[k : k + 25]) for k in range(0, len(own) - 24, 25)]
            deviation = statistics.stdev(means) / math.sqrt(len(means))
            warm = statistics.fmean(r[4] for r in own)
            print(f"{speed:8.1f} {warm:12.1f} {statistics.fmean(means):15.3f} ± {deviation:.3f}")


if __name__ == "__main__":
    stalled(Path(sys.argv[1]))
    losses(Path(sys.argv[1]), sys.argv[2])

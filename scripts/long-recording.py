"""A recording as long as one likes, from a short one: `long-recording.py ROWS SHORT.csv LONG.csv`.

Repeats the rows of a table with a uniform clock in its first column and carries the clock on. A motion that ends where it begins,
at rest, goes on without a jump.
"""

import pathlib
import sys

PIECE = 100_000


def main():
    rows, short, long = int(sys.argv[1]), pathlib.Path(sys.argv[2]), pathlib.Path(sys.argv[3])
    header, *lines = short.read_text().splitlines()
    stamps = [float(line.split(",", 1)[0]) for line in lines]
    rest = [line.split(",", 1)[1] for line in lines]
    period_s = round((stamps[-1] - stamps[0]) / (len(stamps) - 1), 9)
    with long.open("w") as out:
        out.write(header + "\n")
        for first in range(0, rows, PIECE):
            piece = range(first, min(first + PIECE, rows))
            out.write("\n".join(f"{k * period_s:.6f},{rest[k % len(rest)]}" for k in piece) + "\n")


if __name__ == "__main__":
    main()

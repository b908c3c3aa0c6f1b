"""Known truth, rivals beside: every tool on every case, one table in Markdown.

    pip install -r aurt-lab/benchmark/requirements.txt          # Python 3.12
    AURT_DATA=/path/to/recordings python aurt-lab/benchmark/run.py --aurt target/release/aurt

A case whose recordings are absent, and a tool whose program or package is, are skipped with a line that says why. A cell has errors of the
estimates against the truth, the error on held-out data, and processor time: user and system, reading, fitting and
predicting, on one thread.
"""

import argparse
import importlib
import os
import pathlib
import sys

for variable in ("OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS", "MKL_NUM_THREADS", "RAYON_NUM_THREADS"):
    os.environ[variable] = "1"

# Modules with one name share a column: each has its own kind of case.
TOOLS = (
    "aurt", "aurt_drive", "aurt_diagnose", "wls", "figaroh_tool", "sysid", "sysid_drive", "bam_tool", "bam_drive",
    "trees", "trees_drive", "wls_trees",
)


def parse() -> argparse.Namespace:
    """Command line."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--aurt", help="the program (default: the environment variable AURT, or aurt on the path)")
    parser.add_argument("--case", action="append", help="only this case; may be repeated")
    parser.add_argument("--tool", action="append", choices=TOOLS, help="only this module; may be repeated")
    return parser.parse_args()


def usable(names: list[str]) -> list:
    """Modules of the tools that are installed; versions and reasons go to standard output."""
    from signals import Skipped

    found, told = [], set()
    for name in names:
        try:
            module = importlib.import_module(f"tools.{name}")
            text = f"{module.NAME}: {module.version()}"
            found.append(module)
        except Skipped as reason:
            text = f"{name}: skipped, {reason}"
        if text not in told:
            print(text)
        told.add(text)
    return found


def main() -> int:
    """Prints versions, what is skipped, and the table."""
    arguments = parse()
    if arguments.aurt:
        os.environ["AURT"] = str(pathlib.Path(arguments.aurt).resolve())
    try:
        import numpy  # noqa: F401
        import scipy  # noqa: F401
    except ImportError as error:
        print(f"benchmark: skipped, the package {error.name} is not installed")
        return 0
    from report import Score, score, table

    from cases import CASES
    from signals import Skipped, data_folder

    print(f"Python {sys.version.split()[0]}")
    tools = usable(list(arguments.tool or TOOLS))
    try:
        data_folder()
    except Skipped as reason:
        print(f"all cases: skipped, {reason}")
        return 0
    scores = {}
    for case in CASES:
        if arguments.case and case.name not in arguments.case:
            continue
        for tool in (tool for tool in tools if isinstance(case, tool.CASES)):
            try:
                found = score(case, tool)
                scores.setdefault(case.name, {})[tool.NAME] = found
                print(f"{case.name}, {tool.NAME}: {found}", file=sys.stderr, flush=True)
            except Skipped as reason:
                print(f"{case.name}, {tool.NAME}: skipped, {reason}")
            except Exception as error:  # A tool that fails ends its cell, not the run.
                scores.setdefault(case.name, {})[tool.NAME] = Score("failed", None, 0.0)
                print(f"{case.name}, {tool.NAME}: failed, {error!r}")
    names = list(dict.fromkeys(tool.NAME for tool in tools))
    print("\n" + table(scores, {case.name: case for case in CASES}, names))
    return 0


if __name__ == "__main__":
    sys.exit(main())

"""Known truth, rivals beside: every tool on every case, one table in Markdown.

    pip install -r aurt-lab/benchmark/requirements.txt          # Python 3.12
    AURT_DATA=/path/to/recordings AURT=target/release/aurt python aurt-lab/benchmark/run.py

A case whose recordings are absent, and a tool whose program or package is, are skipped with a line that says why.
Processor time is user and system time of reading, fitting and predicting, on one thread.
"""

import argparse
import importlib
import os
import sys

for variable in ("OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS", "MKL_NUM_THREADS", "RAYON_NUM_THREADS"):
    os.environ[variable] = "1"

TOOLS = ("command", "aurt", "aurt_diagnose", "aurt_drive", "wls", "figaroh_tool", "sysid", "sysid_drive", "bam_tool", "trees", "wls_trees", "trees_drive")


def parse() -> argparse.Namespace:
    """Command line."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--case", action="append", help="only this case; may be repeated")
    parser.add_argument("--tool", action="append", choices=TOOLS, help="only this tool; may be repeated")
    return parser.parse_args()


def usable(names: tuple[str, ...]) -> list:
    """Modules of the tools that are installed; versions and reasons go to standard output."""
    from signals import Skipped

    found = []
    for name in names:
        try:
            module = importlib.import_module(f"tools.{name}")
            print(f"{module.NAME}: {module.version()}")
            found.append(module)
        except Skipped as reason:
            print(f"{name}: skipped, {reason}")
    return found


def main() -> int:
    """Prints versions, what is skipped, and the table."""
    arguments = parse()
    try:
        import numpy  # noqa: F401
        import scipy  # noqa: F401
    except ImportError as error:
        print(f"benchmark: skipped, the package {error.name} is not installed")
        return 0
    from report import line, table

    from cases import CASES
    from signals import Skipped, data_folder

    tools = usable(tuple(arguments.tool or TOOLS))
    try:
        data_folder()
    except Skipped as reason:
        print(f"all cases: skipped, {reason}")
        return 0
    lines = []
    for case in CASES:
        if arguments.case and case.name not in arguments.case:
            continue
        for tool in tools:
            try:
                lines.append(line(case, tool))
                print(f"{case.name}, {tool.NAME}: {lines[-1].seconds:.1f} s", file=sys.stderr, flush=True)
            except Skipped as reason:
                print(f"{case.name}, {tool.NAME}: skipped, {reason}")
    print(table(lines))
    return 0


if __name__ == "__main__":
    sys.exit(main())

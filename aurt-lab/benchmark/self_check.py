"""Checks that nothing missing is an error: without AURT_DATA, with an empty folder, and with no package at all.

    python aurt-lab/benchmark/self_check.py
"""

import os
import pathlib
import subprocess
import sys
import tempfile

RUN = pathlib.Path(__file__).with_name("run.py")


def output(folder: str | None, *options: str) -> str:
    """What a run prints; it must end with status 0."""
    environment = {key: value for key, value in os.environ.items() if key not in ("AURT_DATA", "AURT")}
    if folder:
        environment["AURT_DATA"] = folder
    done = subprocess.run([sys.executable, *options, RUN], capture_output=True, text=True, env=environment, check=False)
    assert done.returncode == 0, done.stderr
    return done.stdout


def main() -> None:
    """Prints what each run skips."""
    for folder, options in ((None, ()), (None, ("-S",))):
        text = output(folder, *options)
        assert "skipped" in text, text
        print(text)
    with tempfile.TemporaryDirectory() as empty:
        text = output(empty)
        assert "skipped" in text and "Traceback" not in text, text
        print(text)


if __name__ == "__main__":
    main()

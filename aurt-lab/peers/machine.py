"""What the comparisons share: our benchmarks, built, and the processor's name."""

import json
import pathlib
import platform
import subprocess

ROOT = pathlib.Path(__file__).resolve().parent.parent.parent


def build_ours(package, bench):
    """The program of one of our benchmarks."""
    command = ["cargo", "bench", "-p", package, "--bench", bench, "--no-run", "--message-format=json"]
    lines = subprocess.run(command, cwd=ROOT, check=True, stdout=subprocess.PIPE, text=True).stdout.splitlines()
    messages = map(json.loads, lines)
    return next(
        m["executable"]
        for m in messages
        if m.get("reason") == "compiler-artifact" and m["target"]["name"] == bench and m["executable"]
    )


def processor():
    """The processor's name."""
    try:
        lines = pathlib.Path("/proc/cpuinfo").read_text().splitlines()
        return next(line.split(":", 1)[1].strip() for line in lines if line.startswith("model name"))
    except (OSError, StopIteration):
        return platform.processor() or platform.machine()

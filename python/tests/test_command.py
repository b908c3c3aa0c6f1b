"""The command `aurt` of the wheel: the script and `python -m aurt` end as the Rust program does."""

import json
import pathlib
import re
import signal
import subprocess
import sys
import time

import pytest

import aurt

SCRIPT = [pathlib.Path(sys.executable).with_name("aurt")]
MODULE = [sys.executable, "-m", "aurt"]


def run(command, *arguments):
    return subprocess.run([*command, *arguments], capture_output=True, text=True, timeout=300)


@pytest.mark.parametrize("command", [SCRIPT, MODULE], ids=["script", "module"])
def test_statuses_are_those_of_the_program(command, tmp_path):
    version = run(command, "--version")
    assert (version.returncode, version.stdout) == (0, f"aurt {aurt.__version__}\n")
    assert run(command, "completions", "bash").stdout.startswith("_aurt()")
    assert "Usage: aurt [OPTIONS] <COMMAND>" in run(command, "--help").stdout
    missing = run(command, "run", tmp_path / "missing.toml", "--out", tmp_path / "out")
    assert missing.returncode == 2 and "missing.toml" in missing.stderr and not (tmp_path / "out").exists()
    refused = run(command, "no-command", "--json")
    assert refused.returncode == 2 and "no-command" in json.loads(refused.stdout)["error"]["problems"][0]["message"]


def test_a_reader_that_has_seen_enough_is_no_failure():
    with subprocess.Popen([*SCRIPT, "models", "--json"], stdout=subprocess.PIPE, stderr=subprocess.PIPE) as command:
        command.stdout.close()
        assert (command.wait(60), command.stderr.read()) == (0, b"")


def listens(process):
    """Whether the program handles SIGTERM, which Python alone does not."""
    caught = re.search(r"^SigCgt:\s*(\w+)", pathlib.Path(f"/proc/{process.pid}/status").read_text(), re.MULTILINE)
    return int(caught[1], 16) >> (signal.SIGTERM - 1) & 1


@pytest.mark.skipif(not pathlib.Path("/proc/self/status").exists(), reason="looks into /proc")
def test_ctrl_c_leaves_nothing_half_written(tmp_path):
    with subprocess.Popen([*SCRIPT, "demo", "--out", tmp_path / "demo"], stderr=subprocess.PIPE, text=True) as command:
        while not listens(command):
            time.sleep(0.01)
        command.send_signal(signal.SIGINT)
        assert command.wait(60) == 130
        assert "interrupted: nothing was written" in command.stderr.read()
    assert list(tmp_path.iterdir()) == []

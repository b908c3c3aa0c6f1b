"""What a tool says of a case, and how long it takes."""

import os
from dataclasses import dataclass, field
from importlib import metadata

import numpy as np

from signals import Skipped


@dataclass
class Result:
    """Estimates by the names of the case's truths, and predictions for its held-out parts (torques or positions)."""

    values: dict[str, float] = field(default_factory=dict)
    predictions: list[np.ndarray] | None = None
    note: str = ""


def processor_s() -> float:
    """Processor time of this process and of programs it has waited for."""
    times = os.times()
    return times.user + times.system + times.children_user + times.children_system


def package_version(name: str) -> str:
    """Version of an installed package."""
    try:
        return f"{name} {metadata.version(name)}"
    except metadata.PackageNotFoundError as error:
        raise Skipped(f"the package {name} is not installed") from error

"""What a tool says of a case, and how long it takes."""

import importlib
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


def processor_s() -> float:
    """Processor time of this process and of programs it has waited for."""
    times = os.times()
    return times.user + times.system + times.children_user + times.children_system


def package_version(name: str, module: str | None = None) -> str:
    """Version of an installed package, whose module is loaded here rather than in the first case."""
    try:
        if module:
            importlib.import_module(module)
        return f"{name} {metadata.version(name)}"
    except metadata.PackageNotFoundError as error:
        raise Skipped(f"the package {name} is not installed") from error
    except ImportError as error:
        raise Skipped(f"the package {name} cannot be loaded: {error}") from error

"""Friction models that are Python classes."""

from __future__ import annotations

from typing import Any, Sequence

import numpy


class FrictionModel:
    """A friction model of one joint without memory: a batch of samples in, columns out.

    The friction is the sum of coefficient k times column k; calibration finds the coefficients. Give an instance in the
    place of a name: ``robot.model(viscous=Drag())``. The joint dynamics are f_C(load) · H + f_v, of the Coulomb level, the
    hysteresis and the viscous friction; each place asks for what the model has to declare (see ``invariants``).

    Such a model is slow, since every evaluation waits for the interpreter, and a calibrated model that has one cannot be
    saved: a file holds no Python object.
    """

    name: str = "python_model"
    """Name in messages."""

    columns: Sequence[tuple[str, str]] = ()
    """Name and unit of the coefficient of each column."""

    invariants: Sequence[str] = ()
    """What holds for every column. The place `coulomb` asks for "even_in_load" and "positive"; `hysteresis` for
    "bounded_by_one"; `viscous` for "odd_in_velocity", "continuous_in_velocity" and "sign_of_velocity"."""

    reads_load: bool = False
    """Whether a column depends on the load torque."""

    def evaluate(
        self,
        t: numpy.ndarray,
        q: numpy.ndarray,
        dq: numpy.ndarray,
        ddq: numpy.ndarray,
        load: numpy.ndarray,
    ) -> Any:
        """The columns as an array (samples, columns), of the joint's stamps in s, angle in rad, velocity in rad/s,
        acceleration in rad/s² and load torque in the unit of the measurement. A sample's columns depend on that sample
        alone: a motion comes in batches."""
        raise NotImplementedError

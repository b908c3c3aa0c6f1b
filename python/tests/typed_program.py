"""A program that `mypy --strict` accepts: what the stub promises, used."""

from __future__ import annotations

import datetime
import sys
from pathlib import Path

import numpy
from numpy.typing import NDArray

import aurt


class Drag(aurt.FrictionModel):
    name = "drag"
    columns = [("F_v", "Nm s^2/rad^2")]
    invariants = ["odd_in_velocity", "continuous_in_velocity", "sign_of_velocity"]

    def evaluate(
        self,
        t: NDArray[numpy.float64],
        q: NDArray[numpy.float64],
        dq: NDArray[numpy.float64],
        ddq: NDArray[numpy.float64],
        load: NDArray[numpy.float64],
    ) -> NDArray[numpy.float64]:
        drag: NDArray[numpy.float64] = dq * abs(dq)
        return drag


def main(folder: Path) -> float:
    simulated = aurt.simulate("two_link", seed=1)
    begin = datetime.datetime(2026, 3, 1, tzinfo=datetime.timezone.utc)
    stamps = [begin + datetime.timedelta(seconds=float(t)) for t in simulated.t]
    monday = aurt.Recording(stamps, simulated.q, tau=simulated.tau, name="monday", joint_names=["a", "b"])
    robot = aurt.Robot.from_mdh("alpha,a,d\n0,0,0\n0,1,0\n", gravity=[0.0, -9.81, 0.0])
    checkup: aurt.Checkup = aurt.check(monday, robot=robot)
    findings: list[str] = checkup.findings
    model = aurt.calibrate(robot.model(viscous=Drag()), monday, f_dyn_hz=10.0, estimator="wls", fit_shapes=False)
    model = aurt.calibrate(robot, [monday], validation=None, progress=print if findings else None)
    mass: NDArray[numpy.float64] = model.mass_matrix(monday.q)
    deviations = numpy.sqrt(numpy.diag(model.covariance))
    exported = model.export("c", folder / "c", name="two_link")
    files: list[Path] = exported.files
    return float(mass[0, 0, 0] + model.gravity(monday.q)[0, 0] + deviations.sum() + len(files) + monday.origin_s)


if __name__ == "__main__":
    main(Path(sys.argv[1]))

"""What several tests use: a simulated robot and its recordings."""

import numpy
import pytest

import aurt

TWO_LINK = "alpha,a,d\n0,0,0\n0,1,0\n"
TWO_LINK_GRAVITY = [0.0, -9.81, 0.0]


def motion(duration_s):
    """A motion of all joints."""
    return {"kind": "multi_sine", "duration_s": duration_s, "harmonics": 6, "top_hz": 1.0, "share": 0.6}


@pytest.fixture(scope="session")
def two_link():
    """Two links that turn about parallel axes."""
    return aurt.Robot.from_mdh(TWO_LINK, gravity=TWO_LINK_GRAVITY)


@pytest.fixture(scope="session")
def monday():
    """A recording of them."""
    return aurt.simulate("two_link", motion=motion(10.0), seed=1).named("monday")


@pytest.fixture(scope="session")
def tuesday():
    """Another one."""
    return aurt.simulate("two_link", motion=motion(10.0), seed=2).named("tuesday")


@pytest.fixture(scope="session")
def model(two_link, monday, tuesday):
    """Their model."""
    return aurt.calibrate(two_link, monday, validation=tuesday)


def states(samples, joints, seed=0):
    """Positions, velocities and accelerations, uniform within ±3 rad, ±2 rad/s and ±10 rad/s²."""
    random = numpy.random.default_rng(seed)
    return [random.uniform(-reach, reach, (samples, joints)) for reach in (3.0, 2.0, 10.0)]

"""The callback with which MuJoCo feels what its file has no word for."""

import numpy
import pytest

import aurt
from conftest import motion, states

mujoco = pytest.importorskip("mujoco")
from aurt.mujoco import Passive  # noqa: E402

# The two links of `TWO_LINK`, with bodies, damping and dry friction that the calibrated arm does not have.
FILE = """<mujoco><option gravity="0 -9.81 0" timestep="0.001"><flag contact="disable"/></option><worldbody>
<body><inertial pos="0.4 0 0" mass="4" diaginertia="0.1 0.1 0.1"/>
  <joint name="first" axis="0 0 1" damping="0.5" frictionloss="0.7"/>
  <body pos="1 0 0"><inertial pos="0.3 0 0" mass="2" diaginertia="0.1 0.1 0.1"/>
    <joint name="second" axis="0 0 1" armature="0.05"/></body></body>
<body pos="3 0 0"><inertial pos="0 0 0" mass="1" diaginertia="1 1 1"/><joint name="beside" axis="0 0 1"/></body>
</worldbody></mujoco>"""
# The same with the bodies, rotors and friction of the robot that is simulated.
CORRECTED = """<mujoco><option gravity="0 -9.81 0" timestep="0.002"><flag contact="disable"/></option><worldbody>
<body><inertial pos="0.5 0 0" mass="5" diaginertia="0.00225 0.4178 0.4178"/>
  <joint name="first" axis="0 0 1" armature="0.8" damping="5" frictionloss="6"/>
  <body pos="1 0 0"><inertial pos="0.5 0 0" mass="3" diaginertia="0.00135 0.2507 0.2507"/>
    <joint name="second" axis="0 0 1" armature="0.3" damping="2.5" frictionloss="3"/></body></body>
<body pos="3 0 0"><inertial pos="0 0 0" mass="1" diaginertia="1 1 1"/><joint name="beside" axis="0 0 1"/></body>
</worldbody></mujoco>"""
OTHER = '<mujoco><worldbody><body><joint name="door"/><geom size="0.1"/></body></worldbody></mujoco>'


@pytest.fixture
def call():
    """Sets the callback; there is none after the test."""
    yield mujoco.set_mjcb_passive
    mujoco.set_mjcb_passive(None)


@pytest.fixture(scope="module")
def loaded(two_link, monday):
    """A model whose friction grows with the load."""
    return aurt.calibrate(two_link.model(coulomb="absolute"), monday)


def inverse(arm, q, dq, ddq, time_s=0.0):
    """Torques of the first two joints."""
    data = mujoco.MjData(arm)
    data.time = time_s
    data.qpos[:2], data.qvel[:2], data.qacc[:2] = q, dq, ddq
    mujoco.mj_inverse(arm, data)
    return data.qfrc_inverse[:2].copy()


def test_inverse_dynamics_become_those_of_the_model(loaded, call):
    arm = mujoco.MjModel.from_xml_string(FILE)
    q, dq, ddq = states(50, 2)
    # Away from rest, and where the constraint of dry friction is saturated against the motion.
    dq = numpy.sign(dq) * (0.5 + numpy.abs(dq))
    wanted = loaded.torque(q, dq, ddq)
    without = numpy.array([inverse(arm, *row) for row in zip(q, dq, ddq)])
    call(Passive(loaded, arm, joints=["first", "second"]))
    found = numpy.array([inverse(arm, *row) for row in zip(q, dq, ddq)])
    assert numpy.abs(without - wanted).max() > 1.0
    assert numpy.allclose(found, wanted, rtol=0.0, atol=1e-9)


def test_near_rest_torques_run_through_from_one_side_to_the_other(loaded, call):
    arm = mujoco.MjModel.from_xml_string(FILE)
    arm.dof_frictionloss[:] = 0.0
    call(Passive(loaded, arm, joints=["first", "second"], rest_velocity_rad_s=0.1))
    q, ddq = numpy.array([0.3, -0.8]), numpy.array([1.0, 2.0])
    below, middle, above = (inverse(arm, q, numpy.full(2, v), ddq) for v in (-0.1, 0.0, 0.1))
    assert (above - below).min() > 0.1
    assert numpy.allclose(middle, 0.5 * (below + above), rtol=0.0, atol=0.05)


def test_an_arm_that_is_let_go_comes_to_rest_and_other_models_are_left_alone(two_link, monday, call):
    model = aurt.calibrate(two_link.model(coulomb="absolute", arm_terms=["rotor_inertia"]), monday)
    arm, door = mujoco.MjModel.from_xml_string(CORRECTED), mujoco.MjModel.from_xml_string(OTHER)
    call(Passive(model, arm, joints=["first", "second"]))
    data = mujoco.MjData(arm)
    speed = numpy.empty((4000, 3))
    for row in speed:
        mujoco.mj_step(arm, data)
        row[:] = numpy.abs(data.qvel)
    assert 1.0 < speed[:, :2].max() < 10.0 and speed[-200:].max() < 0.03, speed[-1]
    assert not speed[:, 2].any(), "the joint beside the chain feels nothing"
    beside = mujoco.MjData(door)
    mujoco.mj_forward(door, beside)
    assert not beside.qfrc_passive.any()


def test_friction_with_memory_advances_with_time_and_begins_anew(two_link, monday, call):
    remembering = aurt.calibrate(two_link.model(hysteresis="dahl"), monday)
    arm = mujoco.MjModel.from_xml_string(FILE)
    arm.dof_frictionloss[:] = 0.0
    call(Passive(remembering, arm, joints=["first", "second"]))
    window = aurt.simulate("two_link", motion=motion(4.0), seed=3)
    q = window.q
    dq = numpy.gradient(q, window.t, axis=0)
    wanted = remembering.torque(q, dq, numpy.zeros_like(q), window.t)
    for _ in range(2):
        found = numpy.array([inverse(arm, *row) for row in zip(q, dq, numpy.zeros_like(q), window.t)])
        assert numpy.abs(found - wanted)[1:].max() < 1e-3 * numpy.abs(wanted).max()


def test_what_cannot_be_is_refused(loaded, two_link):
    arm = mujoco.MjModel.from_xml_string(FILE)
    with pytest.raises(aurt.Error, match=r"3 joints \(first, second, beside\) for a model with 2"):
        Passive(loaded, arm)
    with pytest.raises(aurt.Error, match="not every one of the joints"):
        Passive(loaded, arm, joints=["first", "third"])
    with pytest.raises(aurt.Error, match="must be above 0"):
        Passive(loaded, arm, joints=["first", "second"], rest_velocity_rad_s=0.0)
    with pytest.raises(TypeError, match="no aurt.Model"):
        Passive(two_link, arm)

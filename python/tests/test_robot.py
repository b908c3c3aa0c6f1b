"""Robots: descriptions, regressors, torques."""

import pickle
from pathlib import Path

import numpy
import pytest

import aurt
from conftest import TWO_LINK, TWO_LINK_GRAVITY, states

PENDULUM = """<robot name="pendulum">
  <link name="base"/>
  <link name="rod"><inertial>
    <origin xyz="0.5 0 0"/><mass value="2"/><inertia ixx="0" ixy="0" ixz="0" iyy="0.1" iyz="0" izz="0.1"/>
  </inertial></link>
  <joint name="hinge" type="revolute">
    <parent link="base"/><child link="rod"/><axis xyz="0 -1 0"/>
    <limit lower="-1" upper="2" velocity="3" effort="40"/>
  </joint>
</robot>
"""


def test_a_robot_by_name_has_geometry_and_limits():
    robot = aurt.Robot.by_name("ur10e")
    assert robot.joints == 6 and robot.name == "ur10e" and robot.standard_parameters is None
    assert len(robot.limits) == 6 and len(robot.base_parameters) == 36
    with pytest.raises(aurt.Error, match="did you mean `ur10e`"):
        aurt.Robot.by_name("ur1oe")


def test_the_torque_of_a_pendulum_is_that_of_the_textbook(tmp_path):
    path = tmp_path / "pendulum.urdf"
    path.write_text(PENDULUM)
    robot = aurt.Robot.from_urdf(path)
    assert robot.joint_names == ["hinge"] and robot.name == "pendulum"
    angle, acceleration = numpy.linspace(-1.0, 2.0, 50)[:, None], numpy.linspace(-5.0, 5.0, 50)[:, None]
    # Inertia about the hinge, 0.1 + 2 · 0.5², and gravity at a lever of half a metre.
    expected = (0.1 + 2.0 * 0.25) * acceleration + 2.0 * 9.81 * 0.5 * numpy.cos(angle)
    assert numpy.allclose(robot.torque(angle, 0.0 * angle, acceleration), expected, rtol=1e-12, atol=1e-12)
    with pytest.raises(aurt.Error, match="pendulum.urdf"):
        path.write_text(PENDULUM.replace('value="2"', 'value="two"'))
        aurt.Robot.from_urdf(path)


def test_regressors_give_the_torques():
    robot = aurt.Robot.by_name("ur10e")
    parameters = numpy.random.default_rng(1).uniform(-1.0, 1.0, 60)
    motion = states(700, 6)
    torque = robot.torque(*motion, parameters)
    standard = robot.regressor(*motion, standard=True)
    base = robot.regressor(*motion)
    assert standard.shape == (700, 6, 60) and base.shape == (700, 6, 36)
    assert numpy.allclose(standard @ parameters, torque, rtol=0, atol=1e-11 * abs(torque).max())
    assert numpy.allclose(base @ robot.base_values(parameters), torque, rtol=0, atol=1e-9 * abs(torque).max())
    one = robot.regressor(*(x[3] for x in motion))
    assert numpy.array_equal(one, base[3])


def test_a_finger_that_follows_another_has_parameters_of_its_own(tmp_path):
    joint, link = PENDULUM.index("  <joint"), PENDULUM.index("</robot>")
    follower = PENDULUM[joint:link].replace("hinge", "second").replace('"rod"', '"tip"').replace('"base"', '"rod"')
    rod = PENDULUM[PENDULUM.index('  <link name="rod">') : joint].replace('"rod"', '"tip"')
    follower = follower.replace("</joint>", '<mimic joint="hinge" multiplier="0.5"/></joint>')
    path = tmp_path / "finger.urdf"
    path.write_text(PENDULUM[:joint] + rod + PENDULUM[joint:link] + follower + "</robot>")
    robot = aurt.Robot.from_urdf(path)
    assert robot.joints == 1 and len(robot.standard_parameters) == 20
    motion = states(50, 1)
    values = robot.base_values(robot.standard_parameters)
    assert numpy.allclose(robot.regressor(*motion) @ values, robot.torque(*motion), rtol=0, atol=1e-9)


def test_a_part_of_a_tree_is_chosen(tmp_path):
    def arm(side):
        inner = f"<body name='{side}2'><joint name='{side}_elbow'/><geom type='sphere' size='.1' mass='1'/></body>"
        return f"<body name='{side}1'><joint name='{side}_shoulder'/><geom type='sphere' size='.1' mass='2'/>{inner}</body>"

    path = tmp_path / "arms.xml"
    path.write_text(f"<mujoco><worldbody>{arm('left')}{arm('right')}</worldbody></mujoco>")
    robot = aurt.Robot.from_mjcf(path)
    assert robot.joint_names == ["left_shoulder", "left_elbow", "right_shoulder", "right_elbow"]
    part = aurt.Robot.from_mjcf(path, tips=["left2", "right1"])
    assert part.joint_names == ["left_shoulder", "left_elbow", "right_shoulder"]
    assert aurt.Robot.from_mjcf(path, joints=["right_elbow"]).joint_names == ["right_elbow"]
    with pytest.raises(aurt.Error, match="give one"):
        aurt.Robot.from_mjcf(path, tip="left2", joints=["right_elbow"])


def test_a_mujoco_file_is_a_robot(tmp_path):
    path = tmp_path / "arm.xml"
    path.write_text(
        "<mujoco><worldbody><body><joint name='hinge' axis='0 -1 0'/>"
        "<geom type='box' size='.5 .05 .05' pos='.5 0 0' mass='2'/></body></worldbody></mujoco>"
    )
    robot = aurt.Robot.from_mjcf(path)
    assert robot.joint_names == ["hinge"] and robot.standard_parameters[9] == pytest.approx(2.0)


def test_a_table_is_text_or_a_file(tmp_path):
    path = tmp_path / "mdh.csv"
    path.write_text(TWO_LINK)
    motion, parameters = states(20, 2), numpy.ones(20)
    torques = [
        aurt.Robot.from_mdh(table, gravity=TWO_LINK_GRAVITY).torque(*motion, parameters) for table in (TWO_LINK, path)
    ]
    assert numpy.array_equal(*torques)
    with pytest.raises(aurt.Error, match="none.csv"):
        aurt.Robot.from_mdh(tmp_path / "none.csv")


def test_parameters_that_do_not_fit_are_refused():
    robot, motion = aurt.Robot.by_name("ur10e"), states(5, 6)
    with pytest.raises(aurt.Error, match="no masses"):
        robot.torque(*motion)
    with pytest.raises(aurt.Error, match="must have 60"):
        robot.torque(*motion, numpy.ones(59))
    with pytest.raises(aurt.Error, match="value 2 of parameters"):
        robot.torque(*motion, [0.0, 0.0, numpy.nan] + 57 * [0.0])
    with pytest.raises(aurt.Error, match="is no number"):
        robot.torque(*motion, 60 * [1e308])


def test_models_are_named_as_experiments_name_them(two_link):
    structure = two_link.model(
        coulomb="absolute",
        viscous={"model": "polynomial", "powers": numpy.array([1, 3])},
        arm_terms=["rotor_inertia", {"model": "spring", "joints": [1]}],
    )
    names = [row for row in structure.parameters["name"]]
    assert "F_v3_1" in names and any(name.startswith("spring") for name in names)
    for wrong in ({"coulomb": "absolut"}, {"viscous": {"model": "polynomial", "powers": [0]}}, {"hysteresis": "absolute"}):
        with pytest.raises(aurt.Error):
            two_link.model(**wrong)
    with pytest.raises(TypeError, match="evaluate"):
        two_link.model(coulomb=3)


def test_a_pickled_robot_is_the_same(two_link):
    urdf = Path(__file__).parents[2] / "examples" / "urdf-bag" / "ur10e.urdf"
    for robot in (two_link, aurt.Robot.by_name("ur10e"), aurt.Robot.from_urdf(urdf, gravity=[0, 9.81, 0])):
        copy = pickle.loads(pickle.dumps(robot))
        for name in ("name", "joints", "joint_names", "notes"):
            assert getattr(copy, name) == getattr(robot, name), name
        assert str(copy.limits) == str(robot.limits) and str(copy.base_parameters) == str(robot.base_parameters)
        motion = states(20, robot.joints)
        parameters = numpy.linspace(1, 2, 10 * robot.joints)
        assert numpy.array_equal(copy.torque(*motion, parameters), robot.torque(*motion, parameters))

"""Friction models in Python give what the same models in Rust give."""

import numpy
import pytest

import aurt
from conftest import states


class Linear(aurt.FrictionModel):
    """F_v q̇, as `polynomial` with the power 1."""

    name = "linear"
    columns = [("F_v", "Nm s/rad")]
    invariants = ["odd_in_velocity", "continuous_in_velocity", "sign_of_velocity"]

    def evaluate(self, t, q, dq, ddq, load):
        return dq


class Level(aurt.FrictionModel):
    """1 and |τ_J|, as `absolute`."""

    name = "level"
    columns = [("F_C0", "Nm"), ("F_C1", "1")]
    invariants = ["even_in_load", "positive"]
    reads_load = True

    def evaluate(self, t, q, dq, ddq, load):
        return numpy.stack([numpy.ones_like(load), abs(load)], axis=1)


class Sign(aurt.FrictionModel):
    """sign(q̇), as `sign`."""

    name = "direction"
    columns = [("H", "1")]
    invariants = ["bounded_by_one"]

    def evaluate(self, t, q, dq, ddq, load):
        return numpy.sign(dq)


def test_a_model_in_python_is_fitted_as_the_same_in_rust(two_link, monday, tuesday):
    of_python = aurt.calibrate(two_link.model(coulomb=Level(), hysteresis=Sign(), viscous=Linear()), monday)
    of_rust = aurt.calibrate(two_link.model(coulomb="absolute"), monday)
    assert len(of_python.coefficients) == len(of_rust.coefficients)
    assert numpy.allclose(of_python.coefficients, of_rust.coefficients, rtol=1e-9, atol=1e-12)
    assert numpy.allclose(of_python.predict(tuesday), of_rust.predict(tuesday), rtol=1e-9, atol=1e-9)
    motion = states(600, 2)
    assert numpy.allclose(of_python.torque(*motion), of_rust.torque(*motion), rtol=1e-9, atol=1e-9)


def test_a_model_in_python_cannot_be_saved(two_link, monday, tmp_path):
    model = aurt.calibrate(two_link.model(viscous=Linear()), monday)
    with pytest.raises(aurt.Error, match="Python object"):
        model.save(tmp_path / "model.json")
    assert not (tmp_path / "model.json").exists()


def test_models_that_do_not_fit_are_refused(two_link):
    with pytest.raises(aurt.Error, match="odd in velocity"):
        two_link.model(viscous=Sign())
    with pytest.raises(TypeError, match="column"):
        two_link.model(viscous=aurt.FrictionModel())
    unknown = Linear()
    unknown.invariants = ["beautiful"]
    with pytest.raises(aurt.Error, match="`beautiful`"):
        two_link.model(viscous=unknown)


@pytest.mark.parametrize(
    ("result", "said"),
    [
        (lambda dq: dq[:-1], "shape"),
        (lambda dq: numpy.full_like(dq, numpy.nan), "NaN in column 0"),
        (lambda dq: 1 / 0, "division by zero"),
        (lambda dq: "friction", "linear"),
        (lambda dq: numpy.stack([dq, dq], axis=1), "shape"),
    ],
)
def test_what_a_model_does_wrong_is_said(two_link, monday, result, said):
    wrong = Linear()
    wrong.evaluate = lambda t, q, dq, ddq, load: result(dq)
    with pytest.raises(aurt.Error, match="`linear` failed") as caught:
        aurt.calibrate(two_link.model(viscous=wrong), monday)
    assert said in str(caught.value)

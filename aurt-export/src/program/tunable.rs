//! What of a model stays open in the C of a unit: coefficients beyond those of the bodies, gravity, a load.

use aurt_rbd::SerialChain;
use aurt_traits::MeasurementUnit;

use super::newton_euler::Vector;
use super::tape::{Tape, Value, ZERO};
use crate::Source;

/// A number that can be chosen when the model runs.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Parameter {
    pub name: String,
    pub unit: String,
    pub description: String,
    pub start: f64,
}

/// The parameters of a model, in the order of the argument `p`: coefficients of friction and arm terms, the size of
/// gravity, and, for chains in Nm, a point mass that the last link carries.
#[derive(Debug, Clone)]
pub(crate) struct Tunable {
    parameters: Vec<Parameter>,
    coefficients: Vec<Value>,
    /// Number of coefficients of the bodies, which are constants.
    constant: usize,
    gravity_m_s2: [f64; 3],
    carries: bool,
}

impl Tunable {
    /// What can be chosen in a model.
    pub fn new(source: &Source<'_>, chain: &SerialChain) -> Self {
        let constant = source.model.base().len();
        let all = source.model.parameters().iter().zip(source.coefficients).enumerate();
        let parameter = |(column, (p, value)): (usize, (&aurt_traits::Parameter, &f64))| {
            let unit = source.model.unit(column, source.unit);
            let description = format!("coefficient {} in {unit}", p.name);
            Parameter { name: p.name.clone(), unit, description, start: *value }
        };
        let mut parameters: Vec<Parameter> = all.skip(constant).map(parameter).collect();
        let gravity_m_s2 = chain.gravity_m_s2();
        let size = gravity_m_s2.iter().map(|g| g * g).sum::<f64>().sqrt();
        let [x, y, z] = gravity_m_s2;
        let mut add = |name: &str, unit: &str, description: String, start: f64| {
            let (name, unit) = (name.into(), unit.into());
            parameters.push(Parameter { name, unit, description, start });
        };
        add(
            "gravity_m_s2",
            "m/s2",
            format!("size of gravity; its direction is that of the calibration, {x} {y} {z} m/s^2"),
            size,
        );
        let carries = source.unit == MeasurementUnit::NewtonMetre && chain.is_serial();
        if carries {
            add("payload_mass_kg", "kg", "point mass that the last link carries".into(), 0.0);
            for axis in ["x", "y", "z"] {
                let description = format!("its {axis} in the frame of the last link");
                add(&format!("payload_{axis}_m"), "m", description, 0.0);
            }
        }
        let coefficients = source.coefficients.iter().map(|c| Value::Constant(*c)).collect();
        Self { parameters, coefficients, constant, gravity_m_s2, carries }
    }

    /// The parameters, in the order of `p`.
    pub fn parameters(&self) -> &[Parameter] {
        &self.parameters
    }

    /// The model's coefficients, those that can be chosen as arguments.
    pub fn coefficients(&self, tape: &mut Tape) -> Vec<Value> {
        let mut values = self.coefficients.clone();
        for (k, value) in values[self.constant..].iter_mut().enumerate() {
            *value = tape.input(format!("p[{k}]"));
        }
        values
    }

    fn after_coefficients(&self, tape: &mut Tape, place: usize) -> Value {
        tape.input(format!("p[{}]", self.coefficients.len() - self.constant + place))
    }

    /// Gravity in the base frame.
    pub fn gravity(&self, tape: &mut Tape) -> Vector {
        let size = self.gravity_m_s2.iter().map(|g| g * g).sum::<f64>().sqrt();
        if size == 0.0 {
            return [ZERO; 3];
        }
        let chosen = self.after_coefficients(tape, 0);
        self.gravity_m_s2.map(|g| tape.multiply(chosen, Value::Constant(g / size)))
    }

    /// Standard parameters of the point mass on the last link; none for trees and for models in amperes.
    pub fn carried(&self, tape: &mut Tape) -> Vec<Value> {
        if !self.carries {
            return Vec::new();
        }
        let [m, x, y, z] = [1, 2, 3, 4].map(|place| self.after_coefficients(tape, place));
        let [mx, my, mz] = [x, y, z].map(|c| tape.multiply(m, c));
        let [xx, yy, zz] = [(mx, x), (my, y), (mz, z)].map(|(a, b)| tape.multiply(a, b));
        let [xy, xz, yz] = [(mx, y), (mx, z), (my, z)].map(|(a, b)| {
            let product = tape.multiply(a, b);
            tape.negate(product)
        });
        let [about_x, about_y, about_z] = [(yy, zz), (xx, zz), (xx, yy)].map(|(a, b)| tape.add(a, b));
        vec![about_x, xy, xz, about_y, yz, about_z, mx, my, mz, m]
    }
}

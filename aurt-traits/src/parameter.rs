use serde::{Deserialize, Serialize};

/// The quantity that a recording measured for each joint, and so the unit of a model's output.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
pub enum MeasurementUnit {
    /// Joint torque in newton metres.
    #[default]
    #[serde(rename = "Nm")]
    NewtonMetre,
    /// Motor current in amperes (Γ = λ τ in the paper: every coefficient carries the factor λ in A/Nm).
    #[serde(rename = "A")]
    Ampere,
}

impl MeasurementUnit {
    /// The unit's symbol, `Nm` or `A`.
    pub const fn symbol(self) -> &'static str {
        match self {
            Self::NewtonMetre => "Nm",
            Self::Ampere => "A",
        }
    }

    /// The word used in column names: `torque` or `current`.
    pub const fn quantity(self) -> &'static str {
        match self {
            Self::NewtonMetre => "torque",
            Self::Ampere => "current",
        }
    }

    /// A unit that was written for torques (`Nm s/rad`, `kg m^2`, `1/Nm`) as it reads in this unit.
    ///
    /// ```
    /// use aurt_traits::MeasurementUnit::{Ampere, NewtonMetre};
    /// assert_eq!(NewtonMetre.express("kg m^2"), "kg m^2");
    /// assert_eq!(Ampere.express("Nm s/rad"), "A s/rad");
    /// assert_eq!(Ampere.express("kg m^2"), "A/Nm kg m^2");
    /// assert_eq!(Ampere.express("rad/s"), "rad/s");
    /// ```
    pub fn express(self, unit: &str) -> String {
        match self {
            Self::NewtonMetre => unit.to_owned(),
            Self::Ampere if unit.contains("Nm") => unit.replace("Nm", "A"),
            // Masses and inertias are known as far as the torque per ampere is; motions and ratios are.
            Self::Ampere if unit.contains("kg") => format!("A/Nm {unit}"),
            Self::Ampere => unit.to_owned(),
        }
    }

    /// [`Self::express`] of a joint that turns, or slides: then it has forces and lengths where others have torques and angles.
    ///
    /// ```
    /// use aurt_traits::MeasurementUnit::{Ampere, NewtonMetre};
    /// assert_eq!(NewtonMetre.express_of_joint("Nm s/rad", true), "N s/m");
    /// assert_eq!(NewtonMetre.express_of_joint("kg m^2", true), "kg");
    /// assert_eq!(Ampere.express_of_joint("kg m^2", true), "A/N kg");
    /// assert_eq!(Ampere.express_of_joint("Nm s/rad", false), "A s/rad");
    /// ```
    pub fn express_of_joint(self, unit: &str, slides: bool) -> String {
        let expressed = self.express(unit);
        if slides {
            expressed.replace("kg m^2", "kg").replace("Nm", "N").replace("rad", "m")
        } else {
            expressed
        }
    }
}

/// A coefficient that multiplies one column of a regressor.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Parameter {
    /// Name, unique within the model that owns it (snake_case, the field's usual symbol or term).
    pub name: String,
    /// Unit for a torque-measuring robot, e.g. `Nm`, `Nm s/rad`, `kg m^2`, `1`; see [`MeasurementUnit::express`].
    pub unit: String,
}

impl Parameter {
    /// A parameter of the given name and unit.
    pub fn new(name: impl Into<String>, unit: impl Into<String>) -> Self {
        Self { name: name.into(), unit: unit.into() }
    }
}

/// How a search should step through a shape parameter.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Scale {
    /// Steps are differences.
    Linear,
    /// Steps are factors; both bounds are positive.
    Logarithmic,
}

/// A parameter in which a model is *not* linear (Stribeck velocity, presliding threshold).
///
/// The linear coefficients are found by least squares for each value of the shape parameters; these are
/// found by a bounded search around that (variable projection).
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct ShapeParameter {
    /// Name, equal to the model's configuration key.
    pub name: String,
    /// Unit, e.g. `rad/s`.
    pub unit: String,
    /// Present value.
    pub value: f64,
    /// Smallest value that makes sense physically.
    pub lower: f64,
    /// Largest value that makes sense physically.
    pub upper: f64,
    /// How to step through it.
    pub scale: Scale,
}

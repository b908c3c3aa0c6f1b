//! Whether a calibrated model could be of a machine: bodies that can exist, friction that brakes, rotors that are heavy.
//!
//! Least squares knows no physics. Where a value contradicts it by more than its noise, something that is not in the
//! model, or that the recordings do not show, hides in the value.

mod body;
mod fitted;
mod friction;
mod pseudo_inertia;

pub(crate) use body::carried;
pub(crate) use fitted::Fitted;
pub(crate) use friction::braking_rows;
pub(crate) use pseudo_inertia::{Standard, adjoint, metric, pseudo_inertia, standard_of};

use aurt_traits::ColumnGroup;

use crate::CalibratedParameter;

pub(crate) fn warnings(fitted: &Fitted<'_>) -> Vec<String> {
    let mut warnings = body::warnings(fitted);
    warnings.extend(friction::warnings(fitted));
    warnings.extend(rotors(fitted));
    warnings
}

/// Inertia that is added to single motors cannot be negative.
fn rotors(fitted: &Fitted<'_>) -> Vec<String> {
    let model = fitted.model;
    let motors = model.groups().iter().filter(|(group, _)| match group {
        ColumnGroup::ArmTerm(k) => !model.arm_terms()[*k].is_load(),
        ColumnGroup::RigidBody | ColumnGroup::JointDynamics(_) => false,
    });
    let negative: Vec<String> = motors
        .flat_map(|(_, columns)| columns.clone())
        .filter(|k| model.parameters()[*k].unit == "kg m^2" && fitted.value(*k).is_negative())
        .map(|k| {
            let CalibratedParameter { name, unit, .. } = &fitted.parameters[k];
            format!("{name} = {} {unit}", fitted.value(k))
        })
        .collect();
    if negative.is_empty() {
        return Vec::new();
    }
    vec![format!(
        "unphysical: negative inertia of a motor ({}). The estimate compensates for another error proportional to \
         acceleration: a delay of the measurement, wrong torque constants, gravity upside down, a wrong sign, or badly \
         excited bodies; run `aurt check`, then `aurt diagnose`",
        negative.join(", ")
    )]
}

#[cfg(test)]
mod tests {
    use aurt_plugins::model::RigidBodyDynamics;
    use aurt_plugins::{Registry, SlotModel};
    use aurt_rbd::{MdhRows, MdhTable};
    use aurt_traits::{ArmTerm, JointStack, MeasurementUnit};
    use serde_json::{Value, json};

    use super::*;
    use crate::{CalibrationOptions, JointRange};

    fn build<M: SlotModel + ?Sized>(configuration: &Value) -> Box<M> {
        Registry::linked().unwrap().build_from_json(configuration).unwrap()
    }

    /// What is said of an arm of three joints, Coulomb and viscous friction 1 unless `values` says otherwise, all
    /// standard deviations `std`, moved at up to 2 rad/s under up to 20 Nm.
    fn said(coulomb: &str, term: Value, values: &[(&str, f64)], std: f64) -> Vec<String> {
        let table =
            MdhTable::parse("alpha,a,d\npi/2,0,0.2\n0,-0.6,0\n0,0,0\n", "mdh.csv", MdhRows::Next).unwrap();
        let bodies = RigidBodyDynamics::from_mdh(&table, [0.0, 0.0, -9.81], 0).unwrap();
        let stack = JointStack::new(
            build(&json!({ "model": coulomb })),
            build(&json!({ "model": "dahl" })),
            build(&json!({ "model": "polynomial", "powers": [1, 3] })),
        )
        .unwrap();
        let model = bodies.with_joint_dynamics(vec![stack; 3], vec![build::<dyn ArmTerm>(&term)]).unwrap();
        let usual = |name: &str| f64::from(u8::from(name.starts_with("F_C") || name.starts_with("F_v1")));
        assert!(
            values.iter().all(|(name, _)| model.parameters().iter().any(|p| p.name == *name)),
            "{values:?}"
        );
        let parameters: Vec<CalibratedParameter> = model
            .parameters()
            .iter()
            .map(|p| CalibratedParameter {
                name: p.name.clone(),
                unit: p.unit.clone(),
                value: values
                    .iter()
                    .find(|(name, _)| *name == p.name)
                    .map_or_else(|| usual(&p.name), |(_, v)| *v),
                std_dev: Some(std),
                relative_std_dev_percent: None,
                interval_95: None,
                excited: true,
            })
            .collect();
        let n = parameters.len();
        let mut covariance = vec![0.0; n * n];
        (0..n).for_each(|k| covariance[k * n + k] = std * std / 2.0);
        let range = JointRange { velocity_rad_s: 2.0, load_torque: Some(20.0) };
        warnings(&Fitted {
            model: &model,
            parameters: &parameters,
            covariance: &covariance,
            bandwidth: 2.0,
            ranges: &[range; 3],
            options: &CalibrationOptions::default(),
            unit_of_measurement: MeasurementUnit::NewtonMetre,
        })
    }

    fn rotors() -> Value {
        json!({ "model": "rotor_inertia" })
    }

    /// A ball of 2 kg and 0.02 kg m², its centre 0.1 m along x, with `zz` as its third moment.
    fn ball(sign: f64, zz: f64) -> Vec<(&'static str, f64)> {
        let steiner = 2.0 * 0.1 * 0.1;
        let mut values = vec![
            ("payload.XX_2", 0.02),
            ("payload.YY_2", 0.02 + steiner),
            ("payload.ZZ_2", zz + steiner),
            ("payload.mX_2", 0.2),
            ("payload.m_2", 2.0),
        ];
        values.iter_mut().for_each(|(_, v)| *v *= sign);
        values
    }

    #[test]
    fn what_a_machine_can_have_is_not_complained_of() {
        assert_eq!(said("constant", rotors(), &[("rotor_inertia.I_a_1", 0.5)], 0.01), Vec::<String>::new());
        let payload = || json!({ "model": "payload", "link": 2 });
        assert_eq!(said("constant", payload(), &ball(1.0, 0.02), 1e-4), Vec::<String>::new());
        // A load that was taken off is a body with the opposite sign.
        assert_eq!(said("constant", payload(), &ball(-1.0, 0.02), 1e-4), Vec::<String>::new());
    }

    #[test]
    fn a_body_that_cannot_be_is_told_with_its_moments() {
        let payload = || json!({ "model": "payload", "link": 2 });
        let flat = said("constant", payload(), &ball(1.0, 0.06), 1e-4);
        assert!(
            flat.len() == 1 && flat[0].contains("0.020, 0.020 and 0.060 kg m², the largest exceeds"),
            "{flat:?}"
        );
        let negative = said("constant", payload(), &ball(1.0, -0.01), 1e-4);
        assert!(
            negative[0].contains("a principal moment of inertia about its centre of mass is negative"),
            "{negative:?}"
        );
        // What noise may have done is not held against the value.
        assert_eq!(said("constant", payload(), &ball(1.0, 0.06), 0.05), Vec::<String>::new());
        let part = json!({ "model": "payload", "link": 2, "parameters": ["mX", "m"] });
        let light = said("constant", part, &[("payload.m_2", -1.0)], 0.1);
        assert!(light[0].contains("negative mass (-1.00 ± 0.10 kg)"), "{light:?}");
    }

    #[test]
    fn friction_that_drives_is_found_at_the_speed_and_load_where_it_does() {
        let cubic = said("constant", rotors(), &[("F_v3_1", -1.0)], 0.01);
        assert!(
            cubic.len() == 1 && cubic[0].contains("joint 1 (-") && cubic[0].contains("at 2.00 rad/s"),
            "{cubic:?}"
        );
        let load = said("square", rotors(), &[("F_C1_0", -0.02)], 1e-4);
        assert!(load[0].contains("joint 0 (-") && load[0].contains("under 20.00 Nm"), "{load:?}");
        assert_eq!(said("square", rotors(), &[("F_C1_0", -0.001)], 1e-5), Vec::<String>::new());
    }

    #[test]
    fn rotors_are_not_lighter_than_nothing() {
        let negative = said("constant", rotors(), &[("rotor_inertia.I_a_1", -0.1)], 0.01);
        assert!(negative[0].contains("rotor_inertia.I_a_1 = -0.100 ± 0.010 kg m^2"), "{negative:?}");
        assert_eq!(said("constant", rotors(), &[("rotor_inertia.I_a_1", -0.1)], 0.1), Vec::<String>::new());
    }
}

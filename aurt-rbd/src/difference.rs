//! In which joint and quantity the geometry of two descriptions of a robot differs.

use std::any::Any;
use std::fmt;

use aurt_traits::{BaseParameters, RigidBodyRegressor};

use crate::random::Uniform;
use crate::{CoupledChain, Joint, LinkBody, Placement, RbdError, SerialChain, carry_over};

/// Share of a joint's torque that two descriptions of one robot may differ by: lengths that are rounded to a millimetre
/// differ by less.
const SAME_ROBOT: f64 = 3e-3;
/// Differences of lengths in m, angles in rad and factors that are none.
const NOTABLE: f64 = 1e-4;

/// A difference between the geometry of two robots, the first of which is "ours".
#[derive(Debug, Clone, PartialEq)]
#[expect(missing_docs, reason = "the messages name the fields")]
pub enum GeometryDifference {
    /// The gravity vectors in the base frames, m/s².
    Gravity { ours: [f64; 3], theirs: [f64; 3] },
    /// A quantity of a joint that both descriptions state.
    Joint { joint: usize, quantity: &'static str, ours: String, theirs: String },
    /// The torque of a joint, where the descriptions have no quantities in common.
    Torque {
        joint: usize,
        /// Share of the torque that no masses explain.
        left: f64,
    },
}

impl fmt::Display for GeometryDifference {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Gravity { ours, theirs } => write!(f, "gravity is {ours:?} m/s² and {theirs:?} m/s²"),
            Self::Joint { joint, quantity, ours, theirs } => {
                write!(f, "{quantity} of joint {joint} is {ours} and {theirs}")
            }
            Self::Torque { joint, left } => {
                write!(f, "{:.0} % of the torque of joint {joint} are left by any masses", 100.0 * left)
            }
        }
    }
}

/// The difference between the geometry of our rigid bodies, of which these are the base parameters, and theirs; none where
/// ours can have the torques of theirs, however their link frames lie.
///
/// # Errors
/// [`RbdError::Count`] for another number of joints.
pub fn geometry_difference(
    ours: &dyn RigidBodyRegressor,
    base: &BaseParameters,
    theirs: &dyn RigidBodyRegressor,
) -> Result<Option<GeometryDifference>, RbdError> {
    let worst = |theirs: &dyn RigidBodyRegressor| -> Result<(usize, f64), RbdError> {
        let left = carry_over(ours, base, theirs, &some_bodies(theirs))?.left;
        Ok(left.into_iter().enumerate().max_by(|a, b| a.1.total_cmp(&b.1)).unwrap_or((0, 0.0)))
    };
    let (joint, left) = worst(theirs)?;
    if left <= SAME_ROBOT {
        return Ok(None);
    }
    let [our_gravity, their_gravity] = [ours, theirs].map(RigidBodyRegressor::gravity_m_s2);
    let turned = theirs.with_gravity(our_gravity);
    if our_gravity != their_gravity && worst(&*turned)?.1 <= SAME_ROBOT {
        return Ok(Some(GeometryDifference::Gravity { ours: our_gravity, theirs: their_gravity }));
    }
    let stated = joints(ours).zip(joints(theirs)).and_then(|(ours, theirs)| first_difference(ours, theirs));
    Ok(Some(stated.unwrap_or(GeometryDifference::Torque { joint, left })))
}

/// Standard parameters of bodies that could be links.
fn some_bodies(body: &dyn RigidBodyRegressor) -> Vec<f64> {
    let mut random = Uniform::from_seed(1);
    let mut standard = vec![0.0; body.standard_parameters().len()];
    for indices in body.bodies() {
        let mass_kg = 2.0 + random.within(1.0);
        let com_m = [(); 3].map(|()| random.within(0.2));
        let [xx, yy, zz] = [(); 3].map(|()| 0.02 + random.within(0.005));
        let own = LinkBody { mass_kg, com_m, inertia_at_com_kg_m2: [xx, 0.0, 0.0, yy, 0.0, zz] };
        indices.iter().zip(own.standard_parameters()).for_each(|(index, value)| standard[*index] = value);
    }
    standard
}

/// The joints of a chain or tree, with the multiplier and offset by which each follows its coordinate.
type StatedJoints<'a> = Vec<(&'a Joint, [f64; 2])>;

fn joints(body: &dyn RigidBodyRegressor) -> Option<StatedJoints<'_>> {
    let any: &dyn Any = body;
    if let Some(chain) = any.downcast_ref::<SerialChain>() {
        return Some(chain.joints().iter().map(|joint| (joint, [1.0, 0.0])).collect());
    }
    let coupled = any.downcast_ref::<CoupledChain>()?;
    let couplings = coupled.couplings().iter().map(|coupling| [coupling.multiplier, coupling.offset]);
    Some(coupled.chain().joints().iter().zip(couplings).collect())
}

/// The first quantity that both state with different values.
fn first_difference(ours: StatedJoints<'_>, theirs: StatedJoints<'_>) -> Option<GeometryDifference> {
    if ours.len() != theirs.len() {
        return None;
    }
    for (joint, ((ours, our_coupling), (theirs, their_coupling))) in ours.into_iter().zip(theirs).enumerate()
    {
        let differs = |quantity, ours: String, theirs: String| {
            Some(GeometryDifference::Joint { joint, quantity, ours, theirs })
        };
        if ours.kind != theirs.kind {
            return differs("the kind", format!("{:?}", ours.kind), format!("{:?}", theirs.kind));
        }
        if ours.parent != theirs.parent {
            return differs("the parent link", format!("{:?}", ours.parent), format!("{:?}", theirs.parent));
        }
        let mut numbers = vec![
            ("the sign", ours.sign, theirs.sign),
            ("the multiplier", our_coupling[0], their_coupling[0]),
            ("the offset of the coupling (rad, m)", our_coupling[1], their_coupling[1]),
        ];
        match (&ours.placement, &theirs.placement) {
            (
                Placement::Mdh { alpha_rad: alpha, a_m: a, d_m: d },
                Placement::Mdh { alpha_rad: their_alpha, a_m: their_a, d_m: their_d },
            ) => numbers.extend([
                ("alpha (rad)", *alpha, *their_alpha),
                ("a (m)", *a, *their_a),
                ("d (m)", *d, *their_d),
            ]),
            (
                Placement::Fixed { rotation, translation_m },
                Placement::Fixed { rotation: their_rotation, translation_m: their_translation },
            ) => {
                let entries = |of: &[f64]| format!("{of:?}");
                let away = |a: &[f64], b: &[f64]| a.iter().zip(b).any(|(a, b)| (a - b).abs() > NOTABLE);
                if away(translation_m, their_translation) {
                    return differs("the origin (m)", entries(translation_m), entries(their_translation));
                }
                if away(rotation.as_flattened(), their_rotation.as_flattened()) {
                    let [ours, theirs] = [rotation, their_rotation].map(|r| entries(r.as_flattened()));
                    return differs("the rotation", ours, theirs);
                }
            }
            _ => return None,
        }
        numbers.push(("the theta offset (rad)", ours.theta_offset_rad, theirs.theta_offset_rad));
        if let Some((quantity, ours, theirs)) = numbers.into_iter().find(|(_, a, b)| (a - b).abs() > NOTABLE)
        {
            return differs(quantity, format!("{ours}"), format!("{theirs}"));
        }
    }
    None
}

#[cfg(test)]
mod tests {
    use std::f64::consts::FRAC_PI_2;

    use super::*;
    use crate::base_parameters;

    /// Twist, length and offset of a UR10e.
    const ARM: [[f64; 3]; 6] = [
        [0.0, 0.0, 0.1807],
        [FRAC_PI_2, 0.0, 0.0],
        [0.0, -0.6127, 0.0],
        [0.0, -0.571_55, 0.174_15],
        [FRAC_PI_2, 0.0, 0.119_85],
        [-FRAC_PI_2, 0.0, 0.116_55],
    ];
    const UPRIGHT: [f64; 3] = [0.0, 0.0, -9.81];

    fn chain(arm: [[f64; 3]; 6], gravity_m_s2: [f64; 3]) -> SerialChain {
        let joints = arm.map(|[alpha_rad, a_m, d_m]| Joint::revolute(Placement::Mdh { alpha_rad, a_m, d_m }));
        SerialChain::new(joints.to_vec(), gravity_m_s2).unwrap()
    }

    /// The arm with all frames given by matrices, and its base turned about the vertical.
    fn as_matrices(turn_rad: f64) -> SerialChain {
        let joint = |(j, [alpha_rad, a_m, d_m]): (usize, [f64; 3])| {
            let placement = Placement::from_roll_pitch_yaw(
                [a_m, -d_m * alpha_rad.sin(), d_m * alpha_rad.cos()],
                [alpha_rad, 0.0, if j == 0 { turn_rad } else { 0.0 }],
            );
            Joint::revolute(placement)
        };
        SerialChain::new(ARM.into_iter().enumerate().map(joint).collect(), UPRIGHT).unwrap()
    }

    fn said(theirs: &SerialChain) -> Option<String> {
        let ours = chain(ARM, UPRIGHT);
        let base = base_parameters(&ours, 1).unwrap();
        let found = geometry_difference(&ours, &base, theirs).unwrap();
        found.map(|difference| difference.to_string())
    }

    #[test]
    fn one_robot_is_the_same_in_any_frames_and_another_is_told_by_joint_and_quantity() {
        assert_eq!(said(&chain(ARM, UPRIGHT)), None);
        assert_eq!(said(&as_matrices(0.0)), None);
        assert_eq!(said(&as_matrices(1.0)), None);
        let changed = |joint: usize, quantity: usize, by: f64| {
            let mut arm = ARM;
            arm[joint][quantity] += by;
            said(&chain(arm, UPRIGHT))
        };
        assert_eq!(changed(2, 1, -0.1).as_deref(), Some("a (m) of joint 2 is -0.6127 and -0.7127"));
        assert_eq!(changed(4, 2, 0.02).as_deref(), Some("d (m) of joint 4 is 0.11985 and 0.13985"));
        // Where on its own axis the last frame lies concerns no torque.
        assert_eq!(changed(5, 2, 0.02), None);
        assert!(changed(3, 0, 0.1).unwrap().starts_with("alpha (rad) of joint 3"));
        // Lengths that are rounded.
        assert_eq!(changed(2, 1, 2e-4), None);
        let turned = said(&chain(ARM, [0.0, -9.81, 0.0])).unwrap();
        assert_eq!(turned, "gravity is [0.0, 0.0, -9.81] m/s² and [0.0, -9.81, 0.0] m/s²");
        let mut other = as_matrices(0.0).joints().to_vec();
        other[4].placement = Placement::from_roll_pitch_yaw([0.0, -0.3, 0.0], [FRAC_PI_2, 0.0, 0.0]);
        let other = said(&SerialChain::new(other, UPRIGHT).unwrap()).unwrap();
        assert!(other.contains("left by any masses"), "{other}");
    }
}

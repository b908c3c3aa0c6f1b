//! A rigid body in closed form for terms that need one: N links in a plane, all axes along z.
//!
//! With the absolute angles θ_i = q_0 + … + q_i and the joints' positions p_i in the plane, link i loads joint
//! j ≤ i with ZZ θ̈_i + s × (p̈_i − g) + (p_i − p_j) × (m (p̈_i − g) + θ̈_i ẑ × s − θ̇_i² s), where s is its first
//! moment in the base frame. This is Newton's and Euler's law about p_j.

use aurt_traits::{MotionView, Parameter, RegressorTile, RigidBodyRegressor};
use serde::{Deserialize, Serialize};

#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct PlanarArm {
    pub lengths_m: Vec<f64>,
    pub gravity_m_s2: [f64; 3],
}

impl PlanarArm {
    pub fn new(joints: usize) -> Self {
        let lengths_m = (0..joints).map(|i| 0.4 - 0.03 * i as f64).collect();
        Self { lengths_m, gravity_m_s2: [0.8, -9.6, 1.1] }
    }
}

const SYMBOLS: [(&str, &str); 10] = [
    ("XX", "kg m^2"),
    ("XY", "kg m^2"),
    ("XZ", "kg m^2"),
    ("YY", "kg m^2"),
    ("YZ", "kg m^2"),
    ("ZZ", "kg m^2"),
    ("mX", "kg m"),
    ("mY", "kg m"),
    ("mZ", "kg m"),
    ("m", "kg"),
];

fn cross(a: [f64; 2], b: [f64; 2]) -> f64 {
    a[0] * b[1] - a[1] * b[0]
}

#[typetag::serde(name = "planar_arm")]
impl RigidBodyRegressor for PlanarArm {
    fn joints(&self) -> usize {
        self.lengths_m.len()
    }

    fn standard_parameters(&self) -> Vec<Parameter> {
        (0..self.joints())
            .flat_map(|i| SYMBOLS.iter().map(move |(s, unit)| Parameter::new(format!("{s}_{i}"), *unit)))
            .collect()
    }

    fn loads(&self, parameter: usize, joint: usize) -> bool {
        joint <= parameter / 10 && matches!(parameter % 10, 5 | 6 | 7 | 9)
    }

    fn evaluate(&self, motion: MotionView<'_>, out: &mut RegressorTile<'_>) {
        let joints = self.joints();
        let [gx, gy, _] = self.gravity_m_s2;
        for n in 0..motion.samples() {
            let (mut angle, mut rate, mut acceleration) = (0.0, 0.0, 0.0);
            let (mut here, mut lift) = ([0.0; 2], [-gx, -gy]);
            let mut origins = Vec::with_capacity(joints);
            for link in 0..joints {
                angle += motion.position_rad(link)[n];
                rate += motion.velocity_rad_s(link)[n];
                acceleration += motion.acceleration_rad_s2(link)[n];
                origins.push(here);
                let (sin, cos) = angle.sin_cos();
                for (joint, origin) in origins.iter().enumerate() {
                    let reach = [here[0] - origin[0], here[1] - origin[1]];
                    // The force and the moment about p_link of a unit first moment along `s`.
                    let moment = |s: [f64; 2]| {
                        let force = [
                            -acceleration * s[1] - rate * rate * s[0],
                            acceleration * s[0] - rate * rate * s[1],
                        ];
                        cross(s, lift) + cross(reach, force)
                    };
                    for (index, value) in [
                        (5, acceleration),
                        (6, moment([cos, sin])),
                        (7, moment([-sin, cos])),
                        (9, cross(reach, lift)),
                    ] {
                        if let Some(column) = out.entry_mut(joint, 10 * link + index) {
                            column[n] = value;
                        }
                    }
                }
                let length = self.lengths_m[link];
                here = [here[0] + length * cos, here[1] + length * sin];
                lift = [
                    lift[0] + length * (-acceleration * sin - rate * rate * cos),
                    lift[1] + length * (acceleration * cos - rate * rate * sin),
                ];
            }
        }
    }

    fn gravity_m_s2(&self) -> [f64; 3] {
        self.gravity_m_s2
    }

    fn with_gravity(&self, gravity_m_s2: [f64; 3]) -> Box<dyn RigidBodyRegressor> {
        Box::new(Self { gravity_m_s2, ..self.clone() })
    }
}

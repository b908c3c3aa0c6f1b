//! Models to export, and what they predict.

use aurt_export::Check;
use aurt_friction::arm_terms::coulomb_asymmetric::CoulombAsymmetric;
use aurt_friction::arm_terms::coupling::Coupling;
use aurt_friction::arm_terms::current_offset::CurrentOffset;
use aurt_friction::arm_terms::joint_friction::JointFriction;
use aurt_friction::arm_terms::joint_selection::JointSelection;
use aurt_friction::arm_terms::lugre_damped::LuGreDamped;
use aurt_friction::arm_terms::payload::{Inertial, Payload};
use aurt_friction::arm_terms::rotor_inertia::RotorInertia;
use aurt_friction::arm_terms::spring::Spring;
use aurt_friction::arm_terms::temperature::Temperature;
use aurt_friction::arm_terms::viscous_asymmetric::ViscousAsymmetric;
use aurt_friction::coulomb::absent::Absent;
use aurt_friction::coulomb::absolute::Absolute;
use aurt_friction::coulomb::constant::Constant;
use aurt_friction::coulomb::square::Square;
use aurt_friction::coulomb::stribeck::{LoadDependence, Stribeck, StribeckLaw};
use aurt_friction::hysteresis::bouc_wen::BoucWen;
use aurt_friction::hysteresis::dahl::Dahl;
use aurt_friction::hysteresis::gms::Gms;
use aurt_friction::hysteresis::lugre::LuGre;
use aurt_friction::hysteresis::maxwell_slip::MaxwellSlip;
use aurt_friction::hysteresis::sign::Sign;
use aurt_friction::hysteresis::tanh::Tanh;
use aurt_friction::viscous::polynomial::Polynomial;
use aurt_friction::viscous::saturating::Saturating;
use aurt_rbd::robots::DescribedRobot;
use aurt_rbd::{ChainDynamics, Joint, LinkBody, Parent, Placement, SerialChain, base_parameters};
use aurt_traits::{ArmTerm, JointStack, LoadTorque, Motion, RobotModel, RobotState, RobotTile};

/// Numbers between −1 and 1 (the constants are Knuth's MMIX).
pub struct Numbers(u64);

impl Numbers {
    pub fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
    }

    pub fn many(&mut self, count: usize) -> Vec<f64> {
        (0..count).map(|_| self.next()).collect()
    }
}

/// A model with coefficients.
pub struct Case {
    pub model: RobotModel,
    pub coefficients: Vec<f64>,
    pub load: LoadTorque,
    pub standard: Vec<f64>,
    pub chain: SerialChain,
}

impl Case {
    /// The coefficient of a name.
    pub fn coefficient(&self, name: &str) -> f64 {
        let place = self.model.parameters().iter().position(|p| p.name == name);
        self.coefficients[place.unwrap_or_else(|| panic!("no {name}"))]
    }

    /// The largest difference of the torques of a file's bodies from those of this one's, relative to the largest torque.
    pub fn difference(&self, read: &DescribedRobot) -> f64 {
        let chain = SerialChain::new(read.joints.clone(), self.chain.gravity_m_s2()).unwrap();
        let mut described = ChainDynamics::new(chain, read.standard_parameters.as_ref().unwrap()).unwrap();
        let mut bodies = ChainDynamics::new(self.chain.clone(), &self.standard).unwrap();
        let (mut found, mut wanted) = (vec![0.0; read.joints.len()], vec![0.0; read.joints.len()]);
        let (mut worst, mut size) = (0.0_f64, 0.0_f64);
        for check in checks(self, 32) {
            described.inverse_dynamics(&check.q_rad, &check.qd_rad_s, &check.qdd_rad_s2, &mut found);
            bodies.inverse_dynamics(&check.q_rad, &check.qd_rad_s, &check.qdd_rad_s2, &mut wanted);
            for (f, w) in found.iter().zip(&wanted) {
                worst = worst.max((f - w).abs());
                size = size.max(w.abs());
            }
        }
        worst / size
    }
}

fn mdh(alpha_rad: f64, a_m: f64, d_m: f64) -> Joint {
    Joint::revolute(Placement::Mdh { alpha_rad, a_m, d_m })
}

/// Six revolute joints, with offsets, senses and one placement that is no row of a table.
pub fn arm() -> SerialChain {
    let right = std::f64::consts::FRAC_PI_2;
    let oblique = Placement::from_roll_pitch_yaw([0.05, -0.02, 0.3], [0.3, -0.7, 1.1]);
    let joints = vec![
        mdh(0.0, 0.0, 0.18),
        Joint { sign: -1.0, theta_offset_rad: 0.4, ..mdh(right, 0.1, 0.0) },
        mdh(0.0, -0.61, 0.0),
        Joint { theta_offset_rad: -right, ..mdh(0.0, -0.57, 0.17) },
        Joint::revolute(oblique),
        Joint { sign: -1.0, ..mdh(-right, 0.0, 0.12) },
    ];
    SerialChain::new(joints, [0.3, 0.0, -9.81]).unwrap()
}

/// Prismatic joints first, in between and turned.
pub fn gantry() -> SerialChain {
    let slide = |alpha_rad, a_m, d_m| Joint::prismatic(Placement::Mdh { alpha_rad, a_m, d_m });
    let joints = vec![
        Joint { sign: -1.0, ..slide(0.3, 0.0, 0.1) },
        mdh(-1.1, 0.2, 0.0),
        Joint { theta_offset_rad: 0.6, ..slide(std::f64::consts::FRAC_PI_2, 0.1, 0.2) },
        Joint { theta_offset_rad: -0.2, ..mdh(0.4, 0.3, 0.1) },
    ];
    SerialChain::new(joints, [0.0, 0.0, -9.81]).unwrap()
}

/// A torso with two arms, one of which has a prismatic joint, and a joint beside it on the base.
pub fn two_arms() -> SerialChain {
    let shoulder =
        |y_m, roll| Joint::revolute(Placement::from_roll_pitch_yaw([0.1, y_m, 0.4], [roll, 0.2, 0.0]));
    let joints = vec![
        mdh(0.2, 0.0, 0.3),
        shoulder(0.2, -1.3),
        Joint { sign: -1.0, theta_offset_rad: 0.3, ..mdh(1.2, 0.3, 0.05) },
        Joint { parent: Parent::Link(0), ..shoulder(-0.2, 1.3) },
        Joint::prismatic(Placement::Mdh { alpha_rad: -0.9, a_m: 0.1, d_m: 0.2 }),
        mdh(0.4, 0.25, 0.0),
        Joint { parent: Parent::Base, ..mdh(0.7, -0.4, 0.1) },
    ];
    SerialChain::new(joints, [0.2, -0.3, -9.7]).unwrap()
}

fn stack(joint: usize) -> JointStack {
    let stribeck = |stribeck_exponent, load| {
        Box::new(Stribeck {
            stribeck_velocity_rad_s: 0.3,
            stribeck_exponent,
            load,
            law: if joint == 4 { StribeckLaw::Rational } else { StribeckLaw::Exponential },
            level: joint != 3,
        })
    };
    let tanh = || Box::new(Tanh { velocity_rad_s: 0.02 });
    let polynomial = |powers: &[u32]| Box::new(Polynomial { powers: powers.to_vec() });
    let made = match joint {
        0 => JointStack::new(Box::new(Constant {}), Box::new(Sign::default()), polynomial(&[1])),
        1 => JointStack::new(Box::new(Absolute {}), tanh(), polynomial(&[1, 2, 3])),
        2 => {
            JointStack::new(Box::new(Square {}), Box::new(Sign { rest_velocity_rad_s: 0.1 }), polynomial(&[]))
        }
        3 => {
            let saturating = Saturating { saturation_velocity_rad_s: 0.7, linear: true };
            JointStack::new(stribeck(2.0, LoadDependence::Absolute), tanh(), Box::new(saturating))
        }
        4 => JointStack::new(stribeck(1.3, LoadDependence::Square), tanh(), polynomial(&[3])),
        _ => {
            JointStack::new(stribeck(1.0, LoadDependence::None), Box::new(Sign::default()), polynomial(&[2]))
        }
    };
    made.unwrap()
}

fn stack_with_memory(joint: usize) -> JointStack {
    let polynomial = || Box::new(Polynomial { powers: vec![1] });
    let made = match joint {
        0 => JointStack::new(Box::new(Absolute {}), Box::new(Dahl { presliding_rad: 0.02 }), polynomial()),
        1 => JointStack::new(Box::new(Constant {}), Box::new(MaxwellSlip::default()), polynomial()),
        2 => JointStack::new(Box::new(Absolute {}), Box::new(LuGre::default()), polynomial()),
        3 => JointStack::new(Box::new(Square {}), Box::new(Gms::default()), polynomial()),
        4 => {
            let sharp = BoucWen { presliding_rad: 0.03, exponent: 1.7, beta: 0.8 };
            JointStack::new(Box::new(Constant {}), Box::new(sharp), polynomial())
        }
        _ => JointStack::new(Box::new(Absent {}), Box::new(Sign::default()), polynomial()),
    };
    made.unwrap()
}

fn bodies(numbers: &mut Numbers, count: usize) -> Vec<f64> {
    (0..count)
        .flat_map(|_| {
            let [x, y, z] = [0; 3].map(|_| 0.02 + 0.01 * numbers.next());
            let com_m = [0; 3].map(|_| 0.2 * numbers.next());
            // Moments of three orthogonal rods meet the triangle inequality.
            let inertia_at_com_kg_m2 =
                [y + z, 1e-3 * numbers.next(), 1e-3 * numbers.next(), x + z, 1e-3, x + y];
            LinkBody { mass_kg: 3.0 + numbers.next(), com_m, inertia_at_com_kg_m2 }.standard_parameters()
        })
        .collect()
}

/// A model of a chain with friction with memory of every kind that can be exported, and a load.
pub fn case_with_memory(chain: SerialChain) -> Case {
    let slow = LuGre { stribeck_exponent: 1.5, ..LuGre::default() };
    let beside = JointFriction {
        joints: JointSelection::of(vec![0, 2]),
        coulomb: Box::new(Absolute {}),
        hysteresis: Box::new(slow),
        viscous: Box::new(Polynomial { powers: vec![2] }),
    };
    let last = chain.joints().len() - 1;
    let damped = LuGreDamped { joints: JointSelection::of(vec![last]), ..LuGreDamped::default() };
    let coupled = Coupling {
        joint: 3,
        partner: 1,
        ratio: -0.4,
        inertia: true,
        viscous: true,
        coulomb: true,
        rest_velocity_rad_s: 0.01,
    };
    let warming = Temperature { joints: JointSelection::of(vec![0, 3]), warming_time_s: 2.0 };
    let load = Payload { link: None, parameters: Some(vec![Inertial::M, Inertial::MX]) };
    let terms: Vec<Box<dyn ArmTerm>> =
        vec![Box::new(beside), Box::new(damped), Box::new(load), Box::new(coupled), Box::new(warming)];
    let mut case = made(chain, true, terms, stack_with_memory);
    // A load that a machine can carry: arbitrary moments would make the mass matrix indefinite.
    for (parameter, value) in case.model.parameters().iter().zip(&mut case.coefficients) {
        match parameter.name.as_str() {
            name if name.starts_with("payload.m_") => *value = 0.8,
            name if name.starts_with("payload.mX_") => *value = 0.04,
            _ => {}
        }
    }
    case.load = LoadTorque::Fitted(case.coefficients.clone());
    case
}

pub fn half_of_gravity(chain: SerialChain) -> SerialChain {
    SerialChain::new(chain.joints().to_vec(), chain.gravity_m_s2().map(|g| 0.5 * g)).unwrap()
}

/// A point mass in the frame of the last link.
#[derive(Debug, Clone, Copy)]
pub struct Load {
    pub mass_kg: f64,
    pub at_m: [f64; 3],
}

/// A model with the arm term `payload`, whose coefficients are those of a load.
pub fn case_with_load(chain: SerialChain, Load { mass_kg: m, at_m: [x, y, z] }: Load) -> Case {
    let terms: Vec<Box<dyn ArmTerm>> = vec![Box::new(Payload::default())];
    let mut case = made(chain, true, terms, stack);
    let own = [
        m * (y * y + z * z),
        -m * x * y,
        -m * x * z,
        m * (x * x + z * z),
        -m * y * z,
        m * (x * x + y * y),
        m * x,
        m * y,
        m * z,
        m,
    ];
    let first = case.model.group(aurt_traits::ColumnGroup::ArmTerm(0)).start;
    case.coefficients[first..first + own.len()].copy_from_slice(&own);
    case.load = LoadTorque::Fitted(case.coefficients.clone());
    case
}

/// A model of a chain with friction of every kind without memory that can be exported.
pub fn case(chain: SerialChain, fitted: bool) -> Case {
    let terms: Vec<Box<dyn ArmTerm>> = vec![
        Box::new(RotorInertia { joints: JointSelection::of(vec![1, 3]) }),
        Box::new(Spring { joints: JointSelection::of(vec![2]), rest_rad: None }),
        Box::new(CurrentOffset { joints: JointSelection::of(vec![0]) }),
        Box::new(ViscousAsymmetric { joints: JointSelection::of(vec![2]) }),
        Box::new(CoulombAsymmetric { joints: JointSelection::of(vec![0, 1]), rest_velocity_rad_s: 0.05 }),
    ];
    made(chain, fitted, terms, stack)
}

fn made(
    chain: SerialChain,
    fitted: bool,
    terms: Vec<Box<dyn ArmTerm>>,
    stack: fn(usize) -> JointStack,
) -> Case {
    let joints = chain.joints().len();
    let base = base_parameters(&chain, 0).unwrap();
    let mut numbers = Numbers(7);
    let standard = bodies(&mut numbers, joints);
    let values = base.values(&standard);
    let stacks = (0..joints).map(stack).collect();
    let model = RobotModel::new(std::sync::Arc::new(chain.clone()), base, stacks, terms).unwrap();
    let count = model.parameters().len();
    let mut coefficients: Vec<f64> = numbers.many(count).iter().map(|v| 1.5 + v).collect();
    coefficients[..values.len()].copy_from_slice(&values);
    let weights = coefficients.iter().map(|c| c * (1.0 + 0.1 * numbers.next())).collect();
    let load = if fitted { LoadTorque::Fitted(weights) } else { LoadTorque::Literal };
    Case { model, coefficients, load, standard, chain }
}

/// What the model's regressor predicts at random states; at the first, all joints rest.
pub fn checks(case: &Case, count: usize) -> Vec<Check> {
    let joints = case.model.joints();
    let mut numbers = Numbers(11);
    let states: Vec<[Vec<f64>; 3]> = (0..count)
        .map(|n| {
            let speed = if n == 0 { 0.0 } else { 2.0 };
            [3.0, speed, 5.0].map(|reach| numbers.many(joints).iter().map(|v| reach * v).collect())
        })
        .collect();
    predicted(case, 1.0, states)
}

/// What it predicts along a motion with reversals, small ones within the presliding distances among them.
pub fn checks_along_a_path(case: &Case, count: usize) -> Vec<Check> {
    let joints = case.model.joints();
    let mut numbers = Numbers(13);
    let waves: Vec<[f64; 2]> = (0..joints).map(|_| [5.0 + 3.0 * numbers.next(), numbers.next()]).collect();
    let states = (0..count)
        .map(|n| {
            let time_s = 0.01 * n as f64;
            let size = if n % 97 < 40 { 0.004 } else { 0.4 };
            let wave = |derivative: f64| -> Vec<f64> {
                let phase = derivative * std::f64::consts::FRAC_PI_2;
                waves
                    .iter()
                    .map(|[rate, start]| size * rate.powf(derivative) * (rate * time_s + start + phase).sin())
                    .collect()
            };
            [wave(0.0), wave(1.0), wave(2.0)]
        })
        .collect();
    predicted(case, 0.01, states)
}

/// What it predicts along a smooth motion that begins at rest.
pub fn checks_along_a_swing(case: &Case, count: usize, step_s: f64) -> Vec<Check> {
    let joints = case.model.joints();
    let states = (0..count)
        .map(|n| {
            let time_s = step_s * n as f64;
            let wave = |derivative: i32| -> Vec<f64> {
                (0..joints)
                    .map(|j| {
                        let rate = 3.0 + j as f64;
                        let phase = rate * time_s + f64::from(derivative) * std::f64::consts::FRAC_PI_2;
                        let still = if derivative == 0 { 1.0 } else { 0.0 };
                        0.2 * (still - rate.powi(derivative) * phase.cos())
                    })
                    .collect()
            };
            [wave(0), wave(1), wave(2)]
        })
        .collect();
    predicted(case, step_s, states)
}

fn predicted(case: &Case, step_s: f64, states: Vec<[Vec<f64>; 3]>) -> Vec<Check> {
    let joints = case.model.joints();
    let series = |k: usize| (0..joints).flat_map(|j| states.iter().map(move |s| s[k][j])).collect();
    let times: Vec<f64> = (0..states.len()).map(|n| step_s * n as f64).collect();
    let motion = Motion::new(joints, times.clone(), series(0), series(1), series(2)).unwrap();
    let (mut state, mut tile) = (RobotState::default(), RobotTile::default());
    case.model.evaluate(motion.view(), &case.load, &mut state, &mut tile).unwrap();
    let torque = |joint: usize, n: usize| -> f64 {
        let slots = case.model.row_slots(joint).zip(case.model.row_columns(joint));
        slots.map(|(slot, column)| case.coefficients[*column] * tile.slot(slot)[n]).sum()
    };
    states
        .iter()
        .enumerate()
        .map(|(n, [q, qd, qdd])| Check {
            time_s: times[n],
            q_rad: q.clone(),
            qd_rad_s: qd.clone(),
            qdd_rad_s2: qdd.clone(),
            torque_nm: (0..joints).map(|j| torque(j, n)).collect(),
        })
        .collect()
}

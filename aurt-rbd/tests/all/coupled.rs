//! Chains in which joints follow others.

use aurt_rbd::{
    ChainDynamics, CoupledChain, Coupling, Joint, LinkBody, Placement, SerialChain, base_parameters,
};
use aurt_traits::{Motion, RegressorTile, RigidBodyRegressor};
use proptest::prelude::*;

const COUPLINGS: [Coupling; 5] = [
    Coupling::own(0),
    Coupling { coordinate: 1, multiplier: -0.7, offset: 0.3 },
    Coupling::own(1),
    Coupling { coordinate: 0, multiplier: 0.25, offset: -0.1 },
    Coupling { coordinate: 1, multiplier: 2.0, offset: 0.0 },
];

/// Five joints, the fourth of which slides, that two coordinates move.
fn chain() -> SerialChain {
    let placement = |rpy: [f64; 3]| Placement::from_roll_pitch_yaw([0.3, -0.1, 0.2], rpy);
    let turns = |rpy| Joint::revolute(placement(rpy));
    let joints = vec![
        turns([0.1, 0.4, 0.0]),
        turns([1.2, 0.0, -0.3]),
        turns([0.0, -0.8, 0.5]),
        Joint::prismatic(placement([0.6, 0.2, 0.0])),
        turns([-1.1, 0.3, 0.9]),
    ];
    SerialChain::new(joints, [1.0, -2.0, -9.0]).unwrap()
}

fn bodies() -> Vec<f64> {
    let body = |k: f64| LinkBody {
        mass_kg: 1.0 + k,
        com_m: [0.1 * k, 0.05, -0.1],
        inertia_at_com_kg_m2: [0.05, 0.001, -0.002, 0.06, 0.003, 0.04],
    };
    (0..5).flat_map(|k| body(f64::from(k)).standard_parameters()).collect()
}

fn motion(u: [f64; 2], ud: [f64; 2], udd: [f64; 2]) -> Motion {
    Motion::new(2, vec![0.0], u.into(), ud.into(), udd.into()).unwrap()
}

fn torque(coupled: &CoupledChain, motion: &Motion) -> [f64; 2] {
    let mut torque = [0.0; 2];
    coupled.torque(motion.view(), &bodies(), &mut torque, 1);
    torque
}

/// Energy of the chain with its joints where the coordinates put them.
fn energy_j(dynamics: &mut ChainDynamics, u: [f64; 2], ud: [f64; 2]) -> f64 {
    let q = COUPLINGS.map(|c| c.multiplier * u[c.coordinate] + c.offset);
    let qd = COUPLINGS.map(|c| c.multiplier * ud[c.coordinate]);
    dynamics.energy(&q, &qd).total_j()
}

proptest! {
    /// The coordinates' torques give the power by which the chain's energy grows, which knows nothing of them.
    #[test]
    fn torques_do_the_work_that_the_energy_grows_by(
        u in prop::array::uniform2(-3.0..3.0_f64),
        ud in prop::array::uniform2(-2.0..2.0_f64),
        udd in prop::array::uniform2(-5.0..5.0_f64),
    ) {
        let coupled = CoupledChain::new(chain(), COUPLINGS.to_vec()).unwrap();
        let tau = torque(&coupled, &motion(u, ud, udd));
        let mut dynamics = ChainDynamics::new(chain(), &bodies()).unwrap();
        let step_s = 1e-4;
        let mut at = |t: f64| {
            let u = [0, 1].map(|c: usize| u[c] + ud[c] * t + 0.5 * udd[c] * t * t);
            let ud = [0, 1].map(|c: usize| ud[c] + udd[c] * t);
            energy_j(&mut dynamics, u, ud)
        };
        let growth = (at(step_s) - at(-step_s)) / (2.0 * step_s);
        let power = tau[0] * ud[0] + tau[1] * ud[1];
        prop_assert!((growth - power).abs() < 1e-5 * (1.0 + power.abs()), "{growth} and {power}");
    }

    /// Y π = τ over more samples than are evaluated at once, with wanted columns only.
    #[test]
    fn regressor_times_parameters_is_the_torque(shift in -1.0..1.0_f64) {
        let coupled = CoupledChain::new(chain(), COUPLINGS.to_vec()).unwrap();
        let samples = 300;
        let series = |speed: f64| (0..2 * samples).map(|k| (speed * k as f64 + shift).sin()).collect::<Vec<_>>();
        let time_s = (0..samples).map(|k| k as f64).collect();
        let motion = Motion::new(2, time_s, series(0.7), series(0.31), series(1.9)).unwrap();
        let parameters = 50;
        let mut destination = vec![RegressorTile::UNWANTED; 2 * parameters];
        let mut used = 0;
        for joint in 0..2 {
            for p in (0..parameters).filter(|p| coupled.loads(*p, joint)) {
                destination[joint * parameters + p] = used;
                used += 1;
            }
        }
        let stride = samples + 4;
        let mut data = vec![f64::NAN; used as usize * stride];
        coupled.evaluate(motion.view(), &mut RegressorTile::new(&destination, parameters, samples, stride, &mut data));
        let standard = bodies();
        let mut torque = vec![0.0; 2 * stride];
        coupled.torque(motion.view(), &standard, &mut torque, stride);
        for joint in 0..2 {
            for k in 0..samples {
                let entry = |p: usize| match destination[joint * parameters + p] {
                    RegressorTile::UNWANTED => 0.0,
                    d => data[d as usize * stride + k] * standard[p],
                };
                let sum: f64 = (0..parameters).map(entry).sum();
                let found = torque[joint * stride + k];
                prop_assert!((sum - found).abs() < 1e-10 * (1.0 + found.abs()), "{joint}, {k}: {sum} and {found}");
            }
        }
    }
}

#[test]
fn a_chain_of_which_all_joints_move_alone_is_that_chain() {
    let own: Vec<Coupling> = (0..5).map(Coupling::own).collect();
    let coupled = CoupledChain::new(chain(), own).unwrap();
    let of_chain = base_parameters(&chain(), 0).unwrap();
    assert_eq!(base_parameters(&coupled, 0).unwrap(), of_chain);
}

/// A telescope of two tubes that extend alike: inertia m_0 + 4 m_1 and weight m_0 + 2 m_1.
#[test]
fn a_telescope_has_one_inertia_and_one_weight() {
    let slide = Joint::prismatic(Placement::from_roll_pitch_yaw([0.0, 0.0, 0.1], [0.0; 3]));
    let telescope = |gravity_m_s2| {
        let chain = SerialChain::new(vec![slide, slide], gravity_m_s2).unwrap();
        CoupledChain::new(chain, vec![Coupling::own(0); 2]).unwrap()
    };
    let across = base_parameters(&telescope([0.0, -9.81, 0.0]), 0).unwrap();
    assert_eq!(across.combinations, [[(9, 1.0), (19, 4.0)]]);
    let upright = telescope([0.0, 0.0, -9.81]);
    assert_eq!(base_parameters(&upright, 0).unwrap().len(), 2);
    let mut standard = [0.0; 20];
    (standard[9], standard[19]) = (3.0, 2.0);
    let motion = Motion::new(1, vec![0.0], vec![0.4], vec![-0.3], vec![1.5]).unwrap();
    let mut force = [0.0];
    upright.torque(motion.view(), &standard, &mut force, 1);
    assert!((force[0] - (11.0 * 1.5 + 7.0 * 9.81)).abs() < 1e-12, "{force:?}");
}

#[test]
fn it_is_saved_and_read_and_what_cannot_be_is_refused() {
    let coupled = CoupledChain::new(chain(), COUPLINGS.to_vec()).unwrap();
    let boxed: Box<dyn RigidBodyRegressor> = Box::new(coupled.clone());
    let text = serde_json::to_string(&boxed).unwrap();
    let read: Box<dyn RigidBodyRegressor> = serde_json::from_str(&text).unwrap();
    assert_eq!(format!("{read:?}"), format!("{coupled:?}"));
    let other = text.replace("-0.7", "0.0");
    assert!(serde_json::from_str::<Box<dyn RigidBodyRegressor>>(&other).is_err());

    let refused = |change: &dyn Fn(&mut Vec<Coupling>)| {
        let mut couplings = COUPLINGS.to_vec();
        change(&mut couplings);
        CoupledChain::new(chain(), couplings).unwrap_err().to_string()
    };
    for (change, part) in [
        (
            &(|c: &mut Vec<Coupling>| c.truncate(4)) as &dyn Fn(&mut Vec<Coupling>),
            "couplings: expected 5, got 4",
        ),
        (&|c| c[1].multiplier = 0.0, "joint 1: multiplier must not be zero"),
        (&|c| c[3].multiplier = f64::NAN, "joint 3: multiplier"),
        (&|c| c[4].offset = f64::INFINITY, "joint 4: offset must be finite"),
        (&|c| c[2].coordinate = 3, "joint 2: coordinate is 3, and no joint has the one before"),
        (&|c| c[2].coordinate = usize::MAX, "joint 2: coordinate"),
    ] {
        let error = refused(change);
        assert!(error.contains(part), "{part}\n---\n{error}");
    }
}

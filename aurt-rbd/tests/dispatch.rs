//! The regressor kernel's instruction sets, batches and tiles: a program of its own, because the instruction set is chosen for the
//! whole process.
#![expect(clippy::unwrap_used, reason = "a test may panic")]

#[path = "all/robots/mod.rs"]
#[expect(dead_code, reason = "the other program uses the rest")]
mod robots;

use aurt_rbd::{Dispatch, SerialChain};
use aurt_traits::{Motion, RegressorTile, RigidBodyRegressor};
use proptest::prelude::*;

/// What the kernel leaves where it must not write.
const UNTOUCHED: f64 = -12345.678;

/// A motion of `samples` samples with angles within ± `reach`.
fn motion(joints: usize, samples: usize, reach: f64, seed: u64) -> Motion {
    let mut state = seed;
    let mut series = |reach: f64| -> Vec<f64> {
        (0..joints * samples)
            .map(|_| {
                state = state.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
                reach * ((state >> 11) as f64 / (1_u64 << 52) as f64 - 1.0)
            })
            .collect()
    };
    Motion::new(joints, vec![0.0; samples], series(reach), series(3.0), series(10.0)).unwrap()
}

/// Destinations of the entries that `wanted` asks for, in a scattered order.
fn destinations(chain: &SerialChain, wanted: impl Fn(usize, usize) -> bool) -> Vec<u32> {
    let parameters = chain.standard_parameters().len();
    let entries: Vec<bool> = (0..chain.joints().len())
        .flat_map(|joint| (0..parameters).map(move |parameter| (joint, parameter)))
        .map(|(joint, parameter)| wanted(joint, parameter))
        .collect();
    let count = entries.iter().filter(|w| **w).count() as u32;
    let mut next = 0;
    entries
        .iter()
        .map(|wanted| {
            if !wanted {
                return RegressorTile::UNWANTED;
            }
            next += 1;
            count - next
        })
        .collect()
}

fn evaluate(
    level: Dispatch,
    chain: &SerialChain,
    motion: &Motion,
    wanted: &[u32],
    stride: usize,
    shift: usize,
) -> Vec<f64> {
    let columns = wanted.iter().filter(|d| **d != RegressorTile::UNWANTED).count();
    let mut data = vec![UNTOUCHED; shift + columns * stride];
    let parameters = chain.standard_parameters().len();
    let mut tile = RegressorTile::new(wanted, parameters, motion.samples(), stride, &mut data[shift..]);
    chain.evaluate_on(level, motion.view(), &mut tile);
    data.split_off(shift)
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(96))]

    /// All levels agree to 1e-12 of a column's size, the fused ones bit for bit, for any chain, number of
    /// samples, selection of entries, stride and alignment.
    #[test]
    fn levels_agree(
        chain in robots::any_tree(),
        samples in 1_usize..70,
        padding in 0_usize..9,
        shift in 0_usize..8,
        seed in any::<u64>(),
        density in prop_oneof![Just(1_u64), 2_u64..5],
    ) {
        let motion = motion(chain.joints().len(), samples, 4.0, seed);
        let wanted = destinations(&chain, |joint, parameter| {
            (joint as u64 * 31 + parameter as u64 * 17 + seed % 1000).is_multiple_of(density)
        });
        let stride = samples + padding;
        let reference = evaluate(Dispatch::Baseline, &chain, &motion, &wanted, stride, 0);
        let mut fused: Option<Vec<f64>> = None;
        for level in Dispatch::available() {
            let ours = evaluate(level, &chain, &motion, &wanted, stride, shift);
            for (a, b) in ours.chunks(stride).zip(reference.chunks(stride)) {
                let size = b[..samples].iter().fold(1.0, |m: f64, v| m.max(v.abs()));
                for s in 0..samples {
                    prop_assert!((a[s] - b[s]).abs() <= 1e-12 * size, "{level}: {} and {}", a[s], b[s]);
                }
                // Beyond the samples nothing is written.
                prop_assert!(a[samples..].iter().all(|v| *v == UNTOUCHED));
            }
            if level != Dispatch::Baseline {
                prop_assert_eq!(&ours, fused.get_or_insert_with(|| ours.clone()), "{}", level);
            }
        }
    }

    /// Where a sample stands in a batch does not change its bits.
    #[test]
    fn batches_may_be_split_anywhere(
        chain in robots::any_tree(),
        samples in 2_usize..60,
        cut in 0.0..1.0_f64,
        seed in any::<u64>(),
    ) {
        let motion = motion(chain.joints().len(), samples, 4.0, seed);
        let cut = ((samples - 1) as f64 * cut) as usize + 1;
        let parameters = chain.standard_parameters().len();
        let wanted = destinations(&chain, |joint, parameter| chain.loads(parameter, joint));
        let columns = wanted.iter().filter(|d| **d != RegressorTile::UNWANTED).count();
        for level in Dispatch::available() {
            let whole = evaluate(level, &chain, &motion, &wanted, samples, 0);
            for range in [0..cut, cut..samples] {
                let mut part = vec![0.0; columns * range.len()];
                let mut tile = RegressorTile::new(&wanted, parameters, range.len(), range.len(), &mut part);
                chain.evaluate_on(level, motion.view().slice(range.clone()), &mut tile);
                for (a, b) in part.chunks(range.len()).zip(whole.chunks(samples)) {
                    prop_assert_eq!(a, &b[range.clone()]);
                }
            }
        }
    }
}

/// `loads` promises: entries for which it is false are zero – seen as the exact dependence of the torque on
/// each parameter by an independent algorithm – and are never written.
#[test]
fn what_cannot_load_is_zero_and_never_written() {
    let chain = robots::robot(robots::PANDA, [1.0, 2.0, -9.0]);
    let (joints, parameters) = (chain.joints().len(), chain.standard_parameters().len());
    let motion = motion(joints, 9, 3.0, 5);
    let wanted = destinations(&chain, |_, _| true);
    for level in Dispatch::available() {
        let data = evaluate(level, &chain, &motion, &wanted, 9, 0);
        for joint in 0..joints {
            for parameter in 0..parameters {
                let column = &data[wanted[joint * parameters + parameter] as usize * 9..][..9];
                let untouched = column.iter().all(|v| *v == UNTOUCHED);
                assert_eq!(
                    untouched,
                    !chain.loads(parameter, joint),
                    "{level}: {parameter} on joint {joint}"
                );
            }
        }
    }
    let mut torque = vec![0.0; joints];
    for parameter in 0..parameters {
        let mut standard = vec![0.0; parameters];
        standard[parameter] = 1.0;
        let mut dynamics = aurt_rbd::ChainDynamics::new(chain.clone(), &standard).unwrap();
        let view = motion.view();
        let at = |series: &dyn Fn(usize) -> f64| -> Vec<f64> { (0..joints).map(series).collect() };
        let (q, qd, qdd) = (
            at(&|j| view.position_rad(j)[4]),
            at(&|j| view.velocity_rad_s(j)[4]),
            at(&|j| view.acceleration_rad_s2(j)[4]),
        );
        dynamics.inverse_dynamics(&q, &qd, &qdd, &mut torque);
        for joint in 0..joints {
            if !chain.loads(parameter, joint) {
                assert!(
                    torque[joint].abs() < 1e-12,
                    "parameter {parameter}, joint {joint}: {}",
                    torque[joint]
                );
            }
        }
    }
}

/// The baseline uses nothing that differs between machines, so its bits are part of the contract. The constant
/// is the xor of all bit patterns of the regressor of this motion.
#[test]
fn baseline_is_reproducible_bit_for_bit() {
    let chain = robots::robot(robots::UR10E, robots::DOWN);
    let motion = motion(6, 100, 3.0, 1);
    let wanted = destinations(&chain, |joint, parameter| chain.loads(parameter, joint));
    let data = evaluate(Dispatch::Baseline, &chain, &motion, &wanted, 100, 0);
    let bits = data.iter().fold(0_u64, |x, v| x.rotate_left(1) ^ v.to_bits());
    assert_eq!(bits, 0x9d46_d386_aeea_3899, "{bits:#x}");
}

#[test]
fn names_and_selection() {
    for level in Dispatch::available() {
        assert_eq!(Dispatch::from_name(level.name()).unwrap(), level);
        assert_eq!(Dispatch::from_name(&format!(" {} ", level.name().to_uppercase())).unwrap(), level);
    }
    let error = Dispatch::from_name("sse9").unwrap_err().to_string();
    assert!(error.contains("`sse9` is not known; available here: baseline"), "{error}");
    Dispatch::Baseline.select().unwrap();
    assert_eq!(Dispatch::active(), Dispatch::Baseline);
}

#[test]
fn nothing_to_do_is_done() {
    let chain = robots::robot(robots::UR10E, robots::DOWN);
    let none = destinations(&chain, |_, _| false);
    let all = destinations(&chain, |_, _| true);
    for level in Dispatch::available() {
        assert!(evaluate(level, &chain, &motion(6, 10, 1.0, 1), &none, 10, 0).is_empty());
        let untouched = evaluate(level, &chain, &motion(6, 0, 1.0, 1), &all, 3, 0);
        assert!(untouched.iter().all(|v| *v == UNTOUCHED));
    }
}

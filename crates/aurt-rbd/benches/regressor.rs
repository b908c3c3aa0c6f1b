//! Time per evaluation of the regressor kernel, for every instruction set of this processor.
//!
//! `cargo bench -p aurt-rbd` prints the fastest round, the median and the upper quartile in nanoseconds per
//! sample. Rounds are shorter than a scheduler's time slice, so that the fastest ones are undisturbed even on a
//! busy machine. `-- --peer` prints one line of tab-separated figures per case for scripts.

use std::hint::black_box;
use std::time::Instant;

use aurt_rbd::{Dispatch, MdhRows, MdhTable, SerialChain, base_parameters};
use aurt_traits::{Motion, RegressorTile, RigidBodyRegressor};

const UR10E: &str = "alpha,a,d\npi/2,0,0.1807\n0,-0.6127,0\n0,-0.57155,0\npi/2,0,0.17415\n\
                     -pi/2,0,0.11985\n0,0,0.11655\n";
const PANDA: &str = "alpha,a,d\n-pi/2,0,0.333\npi/2,0,0\npi/2,0.0825,0.316\n-pi/2,-0.0825,0\npi/2,0,0.384\n\
                     pi/2,0.088,0\n0,0,0.107\n";

fn chain(mdh: &str) -> SerialChain {
    let table = MdhTable::parse(mdh, "mdh.csv", MdhRows::Next).expect("a constant");
    SerialChain::from_mdh(&table, [0.0, 0.0, -9.81]).expect("a constant")
}

fn motion(joints: usize, samples: usize) -> Motion {
    let series = |reach: f64| -> Vec<f64> {
        (0..joints * samples)
            .map(|k| reach * (2.0 * (k as f64 * 0.618_033_988_749_894_9).fract() - 1.0))
            .collect()
    };
    Motion::new(joints, vec![0.0; samples], series(3.0), series(2.0), series(10.0)).expect("lengths fit")
}

/// Minimum, median and upper quartile of nanoseconds per sample.
fn time(level: Dispatch, chain: &SerialChain, wanted: &[u32], samples: usize, stride: usize) -> [f64; 3] {
    let motion = motion(chain.joints().len(), samples);
    let parameters = chain.joints().len() * aurt_rbd::INERTIAL_PARAMETERS;
    let columns =
        wanted.iter().filter(|d| **d != RegressorTile::UNWANTED).max().map_or(0, |d| *d as usize + 1);
    let mut store = vec![0.0; columns * stride + 8];
    let shift = (64 - store.as_ptr() as usize % 64) / 8 % 8;
    let mut data = &mut store[shift..shift + columns * stride];
    let repeats = (2000 / samples).max(1);
    let mut rounds: Vec<f64> = (0..1001)
        .map(|_| {
            let start = Instant::now();
            for _ in 0..repeats {
                let mut tile = RegressorTile::new(wanted, parameters, samples, stride, data);
                chain.evaluate_on(level, black_box(motion.view()), &mut tile);
                black_box(&mut data);
            }
            start.elapsed().as_secs_f64() * 1e9 / (repeats * samples) as f64
        })
        .collect();
    rounds.sort_by(f64::total_cmp);
    [rounds[0], rounds[500], rounds[750]]
}

fn main() {
    let peer = std::env::args().any(|a| a == "--peer");
    for (name, mdh) in [("ur10e", UR10E), ("panda", PANDA)] {
        let chain = chain(mdh);
        let (joints, parameters) = (chain.joints().len(), chain.standard_parameters().len());
        let mut next = 0;
        let mut wanted = |keep: &dyn Fn(usize) -> bool| -> Vec<u32> {
            next = 0;
            (0..joints * parameters)
                .map(|entry| {
                    let (joint, parameter) = (entry / parameters, entry % parameters);
                    if !keep(parameter) || !chain.loads(parameter, joint) {
                        return RegressorTile::UNWANTED;
                    }
                    next += 1;
                    next - 1
                })
                .collect()
        };
        let all = wanted(&|_| true);
        let base = base_parameters(&chain, 0).expect("a constant robot").columns;
        let kept = wanted(&|p| base.contains(&p));
        for level in Dispatch::available() {
            for (case, destinations, samples, stride) in [
                ("all columns, 16 samples", &all, 16, 16),
                ("all columns, tile of 256", &all, 256, 264),
                ("NONE", &vec![RegressorTile::UNWANTED; joints * parameters], 256, 264),
                (
                    "FIRST",
                    &{
                        let mut v = vec![RegressorTile::UNWANTED; joints * parameters];
                        v.iter_mut().enumerate().for_each(|(k, d)| {
                            if k % 10 == 0 && k % parameters / 10 > k / parameters {
                                *d = (k / 10) as u32
                            }
                        });
                        v
                    },
                    256,
                    264,
                ),
                ("base columns, 16 samples", &kept, 16, 16),
                ("base columns, tile of 256", &kept, 256, 264),
            ] {
                let [low, median, high] = time(level, &chain, destinations, samples, stride);
                if peer {
                    println!("{name}\t{level}\t{case}\t{median}");
                } else {
                    println!(
                        "{name:6} {:9} {case:28} {low:7.1} ns, median {median:.1}, upper quartile {high:.1}",
                        level.name()
                    );
                }
            }
        }
    }
}

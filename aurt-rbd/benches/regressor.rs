//! Time per evaluation of the regressor kernel, for every instruction set of this processor.
//!
//! `cargo bench -p aurt-rbd` prints the fastest and the median round in nanoseconds per evaluation. Rounds are
//! shorter than a scheduler's time slice, so that the fastest ones are undisturbed even on a busy machine.
//!
//! - `stored`: every column goes into a tile of 256 samples, as the least-squares accumulation gets it;
//! - `in cache`: the columns go to ten places by turns, so that the calculation alone is timed;
//! - `base, stored`: only the columns of the base parameters, into a tile.
//!
//! `-- --tsv` prints robot, level, case and the fastest round, separated by tabs, for scripts.
#![expect(clippy::expect_used, reason = "the robots are constants")]

use std::hint::black_box;
use std::time::Instant;

use aurt_rbd::{Dispatch, INERTIAL_PARAMETERS, MdhRows, MdhTable, SerialChain, base_parameters};
use aurt_traits::{Motion, RegressorTile, RigidBodyRegressor};

const ROBOTS: [(&str, &str); 2] = [
    (
        "ur10e",
        "alpha,a,d\npi/2,0,0.1807\n0,-0.6127,0\n0,-0.57155,0\npi/2,0,0.17415\n-pi/2,0,0.11985\n0,0,0.11655\n",
    ),
    (
        "panda",
        "alpha,a,d\n-pi/2,0,0.333\npi/2,0,0\npi/2,0.0825,0.316\n-pi/2,-0.0825,0\npi/2,0,0.384\n\
         pi/2,0.088,0\n0,0,0.107\n",
    ),
];
const SAMPLES: usize = 256;
/// Distance between columns: not a power of two, which would put all columns on the same cache sets.
const STRIDE: usize = SAMPLES + 8;
const ROUNDS: usize = 801;
const CALLS_PER_ROUND: usize = 8;

fn motion(joints: usize) -> Motion {
    let series = |reach: f64| -> Vec<f64> {
        (0..joints * SAMPLES)
            .map(|k| reach * (2.0 * (k as f64 * 0.618_033_988_749_894_9).fract() - 1.0))
            .collect()
    };
    Motion::new(joints, vec![0.0; SAMPLES], series(3.0), series(2.0), series(10.0)).expect("lengths fit")
}

/// Destinations of the entries that a filter keeps, one column each.
fn destinations(chain: &SerialChain, keep: impl Fn(usize) -> bool) -> Vec<u32> {
    let joints = chain.joints().len();
    let mut next = 0;
    (0..joints)
        .flat_map(|joint| (0..joints * INERTIAL_PARAMETERS).map(move |parameter| (joint, parameter)))
        .map(|(joint, parameter)| {
            if !keep(parameter) || !chain.loads(parameter, joint) {
                return RegressorTile::UNWANTED;
            }
            next += 1;
            next - 1
        })
        .collect()
}

/// Fastest and median round in nanoseconds per evaluation.
fn time(level: Dispatch, chain: &SerialChain, destinations: &[u32]) -> [f64; 2] {
    let motion = motion(chain.joints().len());
    let parameters = chain.joints().len() * INERTIAL_PARAMETERS;
    let columns = destinations.iter().map(|d| d.wrapping_add(1)).max().unwrap_or(0) as usize;
    let mut data = vec![0.0; columns * STRIDE];
    let mut rounds: Vec<f64> = (0..ROUNDS)
        .map(|_| {
            let start = Instant::now();
            for _ in 0..CALLS_PER_ROUND {
                let mut tile = RegressorTile::new(destinations, parameters, SAMPLES, STRIDE, &mut data);
                chain.evaluate_on(level, black_box(motion.view()), &mut tile);
                black_box(&mut data);
            }
            start.elapsed().as_secs_f64() * 1e9 / (CALLS_PER_ROUND * SAMPLES) as f64
        })
        .collect();
    rounds.sort_by(f64::total_cmp);
    [rounds[0], rounds[ROUNDS / 2]]
}

fn robot(name: &str, mdh: &str) -> SerialChain {
    let table = MdhTable::parse(mdh, name, MdhRows::Next).expect("a constant table");
    SerialChain::from_mdh(&table, [0.0, 0.0, -9.81]).expect("a constant chain")
}

/// What is timed: its name, and where the entries go.
fn cases(chain: &SerialChain) -> [(&'static str, Vec<u32>); 3] {
    let base = base_parameters(chain, 0).expect("a constant chain").columns;
    let all = destinations(chain, |_| true);
    let in_cache = all.iter().map(|d| if *d == RegressorTile::UNWANTED { *d } else { d % 10 }).collect();
    let kept = destinations(chain, |parameter| base.contains(&parameter));
    [("stored", all), ("in cache", in_cache), ("base, stored", kept)]
}

fn main() {
    let tsv = std::env::args().any(|a| a == "--tsv");
    for (name, mdh) in ROBOTS {
        let chain = robot(name, mdh);
        let cases = cases(&chain);
        for level in Dispatch::available() {
            for (case, destinations) in &cases {
                let [fastest, median] = time(level, &chain, destinations);
                if tsv {
                    println!("{name}\t{level}\t{case}\t{fastest:.2}");
                } else {
                    let level = level.name();
                    println!("{name:6} {level:9} {case:13} {fastest:7.1} ns (median round {median:.1})");
                }
            }
        }
    }
}

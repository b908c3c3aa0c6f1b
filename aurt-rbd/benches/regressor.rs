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

mod kernel;

use aurt_rbd::Dispatch;
use kernel::{ROBOTS, cases, robot, time};

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

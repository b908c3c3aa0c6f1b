//! Least squares on a tall matrix: [`JointFactor`] takes in the rows, [`System`] solves.
//!
//! `cargo bench -p aurt-calibration --bench least_squares [-- --rows 300000 --columns 70 --rounds 7 --tsv]`
//!
//! Entries are fractional parts, (i + 1) · (c + 0.0131 k) mod 1 − ½ with c = 0.7548776662466927 (Roberts, 2018) for
//! row i and column k, so that other programs can make the same matrix; the measurement is the column after the last.
//! Processor time of one thread per instruction set, in ms: median [smallest, largest]. `--tsv` also prints the
//! solution, for comparison.
#![expect(clippy::unwrap_used, reason = "a benchmark may panic")]

mod workload;

use aurt_calibration::{JointFactor, System};
use aurt_traits::Dispatch;
use workload::{option, processor_s, summary};

/// Rows handed over at once, as the parallel filter does.
const BLOCK: usize = 512;

fn main() {
    let (rows, columns) = (option("--rows").unwrap_or(300_000), option("--columns").unwrap_or(70));
    let rounds = option("--rounds").unwrap_or(7);
    let tsv = std::env::args().any(|a| a == "--tsv");
    let series = |k: usize| -> Vec<f64> {
        let step = 0.754_877_666_246_692_7 + 0.0131 * k as f64;
        (0..rows).map(|i| ((i as f64 + 1.0) * step) % 1.0 - 0.5).collect()
    };
    let matrix: Vec<Vec<f64>> = (0..=columns).map(series).collect();
    for level in Dispatch::available() {
        level.select().unwrap();
        let mut times = Vec::new();
        let mut solution = Vec::new();
        for _ in 0..rounds {
            let start = processor_s();
            let mut factor = JointFactor::new((0..columns).collect());
            for first in (0..rows).step_by(BLOCK) {
                let block = first..(first + BLOCK).min(rows);
                let measurement = &matrix[columns][block.clone()];
                factor.push(|k| &matrix[k][block.clone()], measurement, |_| true);
            }
            let system = System::new(columns, vec![factor]);
            solution = system.solve(&[1.0], |_| true).unwrap().coefficients;
            times.push(1e3 * (processor_s() - start));
        }
        let [median, least, most] = summary(&mut times);
        if tsv {
            let solution: Vec<String> = solution.iter().map(|x| format!("{x:e}")).collect();
            println!("{level}\t{median:.3}\t{least:.3}\t{most:.3}\t{}", solution.join(" "));
        } else {
            println!("{level:9} {rows} × {columns}: {median:8.1} ms [{least:.1}, {most:.1}]");
        }
    }
}

//! Times of the crate beside those of the C.

use std::path::Path;
use std::process::Command;

use aurt_export::{Export, c, rust};

use super::super::models::*;
use super::super::{source, write};

const FUNCTIONS: [&str; 4] = ["torque", "rigid_body_torque", "mass_matrix", "regressor"];

/// A program that prints ns per evaluation of each function along a line through the positions, of the fastest thousand.
const C: &str = include_str!("times.c");
const RUST: &str = r#"macro_rules! time { ($q:ident, $call:expr) => {{
    let (mut best, mut sum) = (f64::INFINITY, 0.0);
    for _ in 0..300 {
        let start = std::time::Instant::now();
        for k in 0..1000 { $q[0] = 1e-3 * k as f64; sum += std::hint::black_box($call)[0]; }
        best = best.min(start.elapsed().as_secs_f64() * 1e6);
    }
    println!("{best:.1}");
    assert!(sum != 0.5);
}}; }
fn main() {
    let (mut q, v, a) = ([0.1, -0.7, 1.1, 0.3, -0.4, 0.2], [0.5, -0.3, 0.4, 0.6, -0.2, 0.1], [1.0, 2.0, -1.0, 3.0, -2.0, 1.0]);
    time!(q, machine::torque(&q, &v, &a));
    time!(q, machine::rigid_body_torque(&q, &v, &a));
    time!(q, machine::mass_matrix(&q));
    time!(q, machine::regressor(&q, &v, &a));
}
"#;

fn run(folder: &Path, program: &str, arguments: &[&str]) -> String {
    let run = Command::new(program).args(arguments).current_dir(folder).output().unwrap();
    assert!(run.status.success(), "{}", String::from_utf8_lossy(&run.stderr));
    String::from_utf8_lossy(&run.stdout).into_owned()
}

#[test]
#[ignore = "times differ from machine to machine; docs/export.md has those of one"]
fn times_of_the_crate_and_of_the_c() {
    let case = case(arm(), true);
    let source = source(&case);
    let folder = tempfile::tempdir().unwrap();
    let stored = checks(&case, 1);
    for Export { files, lost, notes } in
        [c::export(&source, &stored), rust::export(&source, &stored)].map(Result::unwrap)
    {
        write(&Export { files, lost, notes }, folder.path());
    }
    std::fs::write(folder.path().join("time.c"), C).unwrap();
    std::fs::write(folder.path().join("time.rs"), RUST).unwrap();
    run(folder.path(), "cc", &["-std=c99", "-O2", "time.c", "machine.c", "-o", "c", "-lm"]);
    let library = ["--edition=2021", "--crate-type=rlib", "--crate-name=machine", "-Copt-level=3"];
    run(folder.path(), "rustc", &[&library[..], &["--cfg=feature=\"std\"", "src/lib.rs"]].concat());
    run(
        folder.path(),
        "rustc",
        &["--edition=2021", "-Copt-level=3", "-L.", "--extern=machine", "time.rs", "-o", "rs"],
    );
    let mut best = [[f64::INFINITY; 4]; 2];
    for _ in 0..9 {
        for (program, best) in ["./c", "./rs"].iter().zip(&mut best) {
            let program = folder.path().join(program);
            let text = run(folder.path(), program.to_str().unwrap(), &[]);
            text.lines().zip(best).for_each(|(line, best)| *best = best.min(line.parse().unwrap()));
        }
    }
    for (name, (c, rust)) in FUNCTIONS.iter().zip(best[0].iter().zip(&best[1])) {
        println!("{name}: C {c} ns, Rust {rust} ns, Rust over C {:.2}", rust / c);
    }
}

//! Time of the per-sample algorithms and of the base parameters: `cargo bench -p aurt-rbd --bench dynamics`;
//! with `--tsv` as `aurt-lab/peers/dynamics.py` reads it.
//!
//! Fastest of many short rounds, on one core.
#![expect(clippy::expect_used, reason = "the robots are constants")]

use std::hint::black_box;
use std::time::Instant;

use aurt_rbd::{ChainDynamics, LinkBody, MdhRows, MdhTable, SerialChain, base_parameters};

const UR10E: &str = "alpha,a,d\npi/2,0,0.1807\n0,-0.6127,0\n0,-0.57155,0\npi/2,0,0.17415\n\
                     -pi/2,0,0.11985\n0,0,0.11655\n";

fn fastest(rounds: usize, calls: usize, mut work: impl FnMut()) -> f64 {
    (0..rounds)
        .map(|_| {
            let start = Instant::now();
            for _ in 0..calls {
                work();
            }
            start.elapsed().as_secs_f64() * 1e9 / calls as f64
        })
        .fold(f64::INFINITY, f64::min)
}

fn main() {
    let table = MdhTable::parse(UR10E, "ur10e", MdhRows::Next).expect("a constant table");
    let chain = SerialChain::from_mdh(&table, [0.0, 0.0, -9.81]).expect("a constant chain");
    let body = LinkBody {
        mass_kg: 3.0,
        com_m: [0.1, 0.02, 0.05],
        inertia_at_com_kg_m2: [0.02, 0.0, 0.0, 0.03, 0.0, 0.03],
    };
    let mut dynamics =
        ChainDynamics::new(chain.clone(), &[body.standard_parameters(); 6].concat()).expect("six links");
    let (q, qd, tau) = ([0.3, -1.0, 1.2, 0.4, -0.7, 2.0], [0.5; 6], [10.0, -30.0, 12.0, 2.0, 1.0, 0.5]);
    let (mut out, mut mass) = ([0.0; 6], [0.0; 36]);
    let times = [
        (
            "inverse dynamics",
            fastest(2000, 200, || dynamics.inverse_dynamics(black_box(&q), &qd, &tau, &mut out)),
        ),
        (
            "forward dynamics",
            fastest(2000, 200, || dynamics.forward_dynamics(black_box(&q), &qd, &tau, &mut out)),
        ),
        ("mass matrix", fastest(2000, 200, || dynamics.mass_matrix(black_box(&q), &mut mass))),
        (
            "base parameters",
            fastest(50, 1, || {
                black_box(base_parameters(black_box(&chain), 0).expect("a constant chain"));
            }),
        ),
    ];
    black_box((out, mass));
    if std::env::args().any(|argument| argument == "--tsv") {
        // Name, nanoseconds, and what comes out at that state.
        let mut torque = [0.0; 6];
        let mut acceleration = [0.0; 6];
        dynamics.inverse_dynamics(&q, &qd, &tau, &mut torque);
        dynamics.forward_dynamics(&q, &qd, &tau, &mut acceleration);
        dynamics.mass_matrix(&q, &mut mass);
        let diagonal: [f64; 6] = std::array::from_fn(|joint| mass[7 * joint]);
        for ((name, nanoseconds), values) in times.iter().zip([torque, acceleration, diagonal]) {
            println!("{name}\t{nanoseconds}\t{}", values.map(|v| v.to_string()).join("\t"));
        }
        return;
    }
    for (name, nanoseconds) in times {
        println!("UR10e, {name:17} {:10.2} µs", nanoseconds / 1e3);
    }
}

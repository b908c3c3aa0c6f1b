//! The integrator: energy, order, and friction that takes exactly what it should.

use aurt_rbd::ChainDynamics;
use aurt_simulation::plant::{Gear, Machine, Release, TRACE_STEP_S, Traces};
use aurt_simulation::{Robot, robots};

/// The robot without friction in its drives.
fn frictionless(mut robot: Robot) -> Robot {
    for drive in &mut robot.drives {
        (drive.coulomb_nm, drive.viscous_nm_s, drive.load_coefficient) = (0.0, 0.0, 0.0);
    }
    robot
}

fn release(robot: &Robot, duration_s: f64, steps: Option<usize>) -> Release {
    let n = robot.joints();
    Release {
        start_rad: robot.drives.iter().enumerate().map(|(j, d)| d.home_rad + 0.2 * j as f64).collect(),
        start_rad_s: (0..n).map(|j| 0.8 - 0.3 * j as f64).collect(),
        torque_nm: vec![0.0; n],
        duration_s,
        steps,
    }
}

/// Mechanical energy at every sample, J.
fn energy(robot: &Robot, traces: &Traces) -> Vec<f64> {
    let rotors: Vec<f64> = robot.drives.iter().map(|d| d.rotor_inertia_kg_m2).collect();
    let mut dynamics = ChainDynamics::new(robot.chain().unwrap(), &robot.standard_parameters())
        .unwrap()
        .with_rotor_inertia(&rotors)
        .unwrap();
    let n = robot.joints();
    (0..traces.samples)
        .map(|k| {
            let row = k * n..(k + 1) * n;
            dynamics.energy(&traces.position_rad[row.clone()], &traces.velocity_rad_s[row]).total_j()
        })
        .collect()
}

#[test]
fn a_frictionless_arm_keeps_its_energy() {
    for robot in Robot::all().into_iter().map(frictionless) {
        let traces = release(&robot, 10.0, None).run(Machine::new(&robot)).unwrap();
        let energy = energy(&robot, &traces);
        let n = robot.joints();
        let swing = traces.velocity_rad_s.iter().map(|v| v.abs()).fold(0.0, f64::max);
        assert!(swing > 1.0, "{} hardly moves", robot.name);
        let size = {
            let kinetic = energy.iter().copied().fold(f64::NEG_INFINITY, f64::max);
            kinetic.abs().max(1.0)
        };
        let drift = energy.iter().map(|e| (e - energy[0]).abs()).fold(0.0, f64::max) / size;
        println!("{} ({n} joints): relative drift {drift:.1e} in 10 s", robot.name);
        assert!(drift < 1e-5, "{}: {drift:e}", robot.name);
    }
}

#[test]
fn friction_takes_its_work_from_the_energy() {
    let mut robot = frictionless(robots::ur10e());
    for drive in &mut robot.drives {
        (drive.coulomb_nm, drive.viscous_nm_s) = (0.4, 0.6);
    }
    let traces = release(&robot, 4.0, None).run(Machine::new(&robot)).unwrap();
    let energy = energy(&robot, &traces);
    let n = robot.joints();
    let power = |k: usize| {
        let row = &traces.velocity_rad_s[k * n..(k + 1) * n];
        row.iter().map(|v| 0.4 * v.abs() + 0.6 * v * v).sum::<f64>()
    };
    let work: f64 = (1..traces.samples).map(|k| 0.5 * TRACE_STEP_S * (power(k - 1) + power(k))).sum();
    let lost = energy[0] - energy[traces.samples - 1];
    assert!(work > 5.0 && traces.events > 0, "{work} {}", traces.events);
    assert!((lost - work).abs() < 2e-4 * work, "lost {lost}, taken {work}");
}

/// Halving the step divides the error by sixteen: the classical Runge–Kutta method is of order four.
#[test]
fn the_order_of_the_integrator_is_four() {
    let elastic = |robot: &Robot| {
        let mut machine = Machine::new(robot);
        machine.joints[1].gear =
            Gear::Compliant { stiffness_nm_rad: 2.0e4, damping_nm_s: 5.0, half_gap_rad: 0.0 };
        machine
    };
    let robot = frictionless(robots::ur10e());
    for (name, machine) in
        [("rigid", &Machine::new as &dyn Fn(&Robot) -> Machine), ("one elastic gear", &elastic)]
    {
        let end = |steps: usize| {
            let traces = release(&robot, 1.0, Some(steps)).run(machine(&robot)).unwrap();
            traces.position_rad[traces.position_rad.len() - robot.joints()..].to_vec()
        };
        let steps = if name == "rigid" { [1, 2, 4] } else { [2, 4, 8] };
        let best = end(64);
        let error =
            |steps: usize| end(steps).iter().zip(&best).map(|(a, b)| (a - b).powi(2)).sum::<f64>().sqrt();
        let errors = steps.map(error);
        let orders = [(errors[0] / errors[1]).log2(), (errors[1] / errors[2]).log2()];
        println!("{name}: errors {errors:?}, orders {orders:?}");
        assert!(orders.iter().all(|order| (3.6..4.6).contains(order)), "{name}: {errors:?} {orders:?}");
    }
}

/// A joint held by friction alone stays where it is, at no cost: events do not chatter.
#[test]
fn what_is_held_stays() {
    let mut robot = robots::ur10e();
    for drive in &mut robot.drives {
        drive.coulomb_nm = 500.0;
    }
    let mut held = release(&robot, 2.0, None);
    held.start_rad_s.fill(0.0);
    let traces = held.run(Machine::new(&robot)).unwrap();
    assert_eq!(traces.events, 0);
    assert!(traces.velocity_rad_s.iter().all(|v| *v == 0.0));
    let n = robot.joints();
    assert_eq!(traces.position_rad[..n], traces.position_rad[traces.position_rad.len() - n..]);
}

#[test]
fn releases_that_make_no_sense_are_refused() {
    let robot = robots::two_link();
    let good = release(&robot, 1.0, None);
    let refused = |release: Release| release.run(Machine::new(&robot)).unwrap_err().to_string();
    assert!(refused(Release { duration_s: 0.0, ..good.clone() }).contains("duration"));
    assert!(refused(Release { torque_nm: vec![0.0], ..good.clone() }).contains("drive torques"));
    assert!(refused(Release { start_rad: vec![f64::NAN; 2], ..good }).contains("angles at the start"));
}

//! Models with memory against closed solutions and known properties of each.

use aurt_friction::conformance::joint::evaluate;
use aurt_friction::conformance::recording::Recording;
use aurt_friction::coulomb::absolute::Absolute;
use aurt_friction::coulomb::stribeck::Stribeck;
use aurt_friction::hysteresis::bouc_wen::BoucWen;
use aurt_friction::hysteresis::dahl::Dahl;
use aurt_friction::hysteresis::gms::Gms;
use aurt_friction::hysteresis::lugre::LuGre;
use aurt_friction::hysteresis::maxwell_slip::MaxwellSlip;
use aurt_friction::viscous::polynomial::Polynomial;
use aurt_traits::{Columns, JointModel, JointSeries, JointStack};

/// Positions from each corner to the next in `steps` equal steps.
fn polyline(corners: &[f64], steps: usize) -> Vec<f64> {
    let mut q = vec![corners[0]];
    for pair in corners.windows(2) {
        q.extend((1..=steps).map(|n| pair[0] + (pair[1] - pair[0]) * n as f64 / steps as f64));
    }
    q
}

/// The columns of a model along positions sampled every `dt_s`.
fn along(model: &dyn JointModel, position_rad: &[f64], dt_s: f64) -> Vec<Vec<f64>> {
    let time_s: Vec<f64> = (0..position_rad.len()).map(|n| n as f64 * dt_s).collect();
    let velocity_rad_s: Vec<f64> = (0..position_rad.len())
        .map(|n| {
            let n = n.clamp(1, position_rad.len() - 1);
            (position_rad[n] - position_rad[n - 1]) / dt_s
        })
        .collect();
    let zeros = vec![0.0; position_rad.len()];
    let series = JointSeries {
        time_s: &time_s,
        position_rad,
        velocity_rad_s: &velocity_rad_s,
        acceleration_rad_s2: &zeros,
        load_torque: &zeros,
    };
    evaluate(model, &series, &[]).unwrap()
}

fn close(found: f64, expected: f64, tolerance: f64) {
    assert!((found - expected).abs() <= tolerance, "{found} for {expected}");
}

fn five_elements() -> MaxwellSlip {
    MaxwellSlip { thresholds_rad: Some(vec![0.01, 0.02, 0.05, 0.1, 0.3]), ..MaxwellSlip::default() }
}

/// The sum of all elements, each with the weight one.
fn total(columns: &[Vec<f64>]) -> Vec<f64> {
    (0..columns[0].len()).map(|n| columns.iter().map(|c| c[n]).sum()).collect()
}

#[test]
fn maxwell_slip_forgets_an_inner_loop_once_it_is_closed() {
    let model = five_elements();
    let with_loop = along(&model, &polyline(&[0.0, 0.5, 0.42, 0.46, 0.42, 0.1], 400), 0.01);
    let without = along(&model, &polyline(&[0.0, 0.5, 0.42, 0.1], 400), 0.01);
    // The state at the closure, and the way on from there, are those of a path that never took the loop.
    for (a, b) in with_loop.iter().zip(&without) {
        for n in 0..=400 {
            close(a[4 * 400 + n], b[2 * 400 + n], 1e-12);
        }
    }
    // Within the loop the force is another one: the memory is not in the present position.
    let (outer, inner) = (total(&without), total(&with_loop));
    assert!((inner[3 * 400] - outer[400 + 200]).abs() > 0.5, "{} {}", inner[3 * 400], outer[600]);
}

#[test]
fn maxwell_slip_branches_are_the_virgin_curve_doubled() {
    // Masing's rule: after a reversal at the force F_0, F(x) = F_0 − 2 f(x/2), with f the curve of first loading.
    let model = five_elements();
    let steps = 600;
    let virgin = total(&along(&model, &polyline(&[0.0, 0.6], steps), 0.01));
    let force = total(&along(&model, &polyline(&[0.0, 0.6, -0.6], 2 * steps), 0.01));
    for n in 0..=steps {
        // A step of the second branch is 1.2/1200 = 0.001 rad, the same as of the virgin curve.
        let half = if n % 2 == 0 { virgin[n / 2] } else { 0.5 * (virgin[n / 2] + virgin[n / 2 + 1]) };
        close(force[2 * steps + n], force[2 * steps] - 2.0 * half, 1e-9);
    }
}

#[test]
fn maxwell_slip_starts_as_a_spring_and_ends_at_its_level() {
    let force = total(&along(&five_elements(), &polyline(&[0.0, 0.5], 5_000), 0.01));
    let stiffness: f64 = [0.01, 0.02, 0.05, 0.1, 0.3].iter().map(|t| 1.0 / t).sum();
    close(force[1] / 1e-4, stiffness, 1e-9 * stiffness);
    close(force[5_000], 5.0, 1e-12);
}

#[test]
fn dahl_settles_into_the_closed_loop() {
    // Steady oscillation over ±A: H = ±tanh(A/p) at the ends, and the loop encloses 4 A − 4 p tanh(A/p).
    let (p, amplitude, steps) = (0.02, 0.03, 2_000);
    let corners: Vec<f64> = (0..21).map(|n| if n % 2 == 0 { -amplitude } else { amplitude }).collect();
    let q = polyline(&corners, steps);
    let h = &along(&Dahl { presliding_rad: p }, &q, 0.01)[0];
    let end = (amplitude / p).tanh();
    close(h[20 * steps], -end, 1e-12);
    close(h[19 * steps], end, 1e-12);
    let area: f64 = (18 * steps..20 * steps).map(|n| 0.5 * (h[n] + h[n + 1]) * (q[n + 1] - q[n])).sum();
    close(area, 4.0 * amplitude - 4.0 * p * end, 1e-7);
}

#[test]
fn dahl_is_the_same_however_coarsely_a_stroke_is_sampled() {
    let model = Dahl { presliding_rad: 0.02 };
    let coarse = along(&model, &polyline(&[0.0, 0.05, 0.01, 0.03], 1), 1.0);
    let fine = along(&model, &polyline(&[0.0, 0.05, 0.01, 0.03], 1_000), 1e-3);
    for stroke in 0..=3 {
        close(coarse[0][stroke], fine[0][1_000 * stroke], 1e-13);
    }
}

#[test]
fn bouc_wen_with_beta_one_is_dahl() {
    let q = Recording::random(5, 1, 2_000).joint(0).position_rad.to_vec();
    let dahl = along(&Dahl { presliding_rad: 0.01 }, &q, 0.004);
    let bouc_wen = along(&BoucWen { presliding_rad: 0.01, exponent: 1.0, beta: 1.0 }, &q, 0.004);
    for (a, b) in dahl[0].iter().zip(&bouc_wen[0]) {
        close(*b, *a, 1e-6);
    }
}

#[test]
fn lugre_has_its_stiffness_at_rest_and_its_levels_in_sliding() {
    let model = LuGre { presliding_rad: 0.01, coulomb_ratio: 0.6, ..LuGre::default() };
    // F = F_S H = σ_0 Δq for small displacements, σ_0 = F_S/p.
    let small = along(&model, &[0.0, 1e-7], 1.0);
    close(small[0][1] / 1e-7, 100.0, 1e-2);
    // Slow: break-away level. Fast: sliding level. Between them the Stribeck curve.
    for (speed, level) in [(1e-4, 1.0), (0.05, 0.6 + 0.4 * (-1.0_f64).exp()), (2.0, 0.6)] {
        let duration = 0.5 / speed;
        let h = along(&model, &polyline(&[0.0, 0.5], 1_000), duration / 1_000.0);
        close(h[0][1_000], level, 1e-5);
    }
}

#[test]
fn lugre_breaks_away_higher_than_it_slides() {
    // Velocity rises from zero over one second: friction overshoots its sliding level.
    let model = LuGre { presliding_rad: 1e-4, coulomb_ratio: 0.6, ..LuGre::default() };
    let q: Vec<f64> = (0..=1_000).map(|n| 0.15 * (f64::from(n) / 1_000.0).powi(2)).collect();
    let h = &along(&model, &q, 1e-3)[0];
    let peak = h.iter().fold(0.0, |a: f64, b| a.max(*b));
    assert!(peak > 0.9 && peak < 1.0, "{peak}");
    close(h[1_000], 0.6, 1e-3);
}

/// The LuGre equation in its usual form, ż = v − σ_0 |v| z/g(v), by Runge–Kutta in small steps of time.
fn lugre_by_runge_kutta(model: &LuGre, velocity: impl Fn(f64) -> f64, until_s: f64) -> f64 {
    let (break_away, steps) = (7.0, 400_000);
    let stiffness = break_away / model.presliding_rad;
    let rate = |t: f64, z: f64| {
        let v = velocity(t);
        let coulomb = break_away * model.coulomb_ratio;
        let level = coulomb + (break_away - coulomb) * (-(v / model.stribeck_velocity_rad_s).powi(2)).exp();
        v - stiffness * v.abs() * z / level
    };
    let (mut z, dt) = (0.0, until_s / f64::from(steps));
    for n in 0..steps {
        let t = f64::from(n) * dt;
        let k1 = rate(t, z);
        let k2 = rate(t + 0.5 * dt, z + 0.5 * dt * k1);
        let k3 = rate(t + 0.5 * dt, z + 0.5 * dt * k2);
        let k4 = rate(t + dt, z + dt * k3);
        z += dt * (k1 + 2.0 * k2 + 2.0 * k3 + k4) / 6.0;
    }
    stiffness * z / break_away
}

#[test]
fn lugre_converges_to_its_differential_equation_in_second_order() {
    let model = LuGre { presliding_rad: 0.02, ..LuGre::default() };
    let (omega, until) = (3.0_f64, 2.4);
    let exact = lugre_by_runge_kutta(&model, |t| 0.1 * omega * (omega * t).cos(), until);
    let error = |steps: usize| {
        let dt = until / steps as f64;
        let q: Vec<f64> = (0..=steps).map(|n| 0.1 * (omega * n as f64 * dt).sin()).collect();
        (along(&model, &q, dt)[0][steps] - exact).abs()
    };
    let (coarse, fine) = (error(240), error(2_400));
    assert!(coarse < 2e-3, "{coarse:e} at 100 Hz");
    assert!(fine < coarse / 50.0, "{coarse:e} at 100 Hz, {fine:e} at 1 kHz");
}

#[test]
fn gms_without_weakening_is_maxwell_slip() {
    let recording = Recording::random(11, 1, 4_000);
    let plain = evaluate(&MaxwellSlip::default(), &recording.joint(0), &[]).unwrap();
    let general = evaluate(&Gms { coulomb_ratio: 1.0, ..Gms::default() }, &recording.joint(0), &[]).unwrap();
    for (a, b) in plain.iter().flatten().zip(general.iter().flatten()) {
        close(*b, *a, 1e-10);
    }
}

#[test]
fn gms_slides_on_the_stribeck_curve_and_lags_behind_it() {
    let model = Gms {
        thresholds_rad: Some(vec![0.01]),
        coulomb_ratio: 0.5,
        attraction_per_s: 20.0,
        ..Gms::default()
    };
    let level = |v: f64| 0.5 + 0.5 * (-(v / 0.05_f64).powi(2)).exp();
    // One second at each speed, in steps of 1 ms; the element slips from the first threshold on.
    let (slow, fast, dt) = (0.04, 0.1, 1e-3);
    let mut q = vec![0.0];
    for speed in [slow, fast] {
        for _ in 0..1_000 {
            q.push(q[q.len() - 1] + speed * dt);
        }
    }
    let force = &along(&model, &q, dt)[0];
    close(force[1_000], level(slow), 1e-6);
    // After the change of speed the force decays to the new level with the rate C/g.
    let after = 0.05;
    let expected = level(fast) + (level(slow) - level(fast)) * (-20.0 * after / level(fast)).exp();
    close(force[1_050], expected, 1e-6);
    close(force[2_000], level(fast), 1e-6);
}

#[test]
fn gms_meets_the_transition_to_slip_inside_a_step() {
    // One step that reaches the level after 40 % of its way is as good as many small ones.
    let model = Gms { thresholds_rad: Some(vec![0.01]), coulomb_ratio: 0.5, ..Gms::default() };
    let level = 0.5 + 0.5 * (-(0.5_f64).powi(2)).exp();
    let stroke = 0.01 * level / 0.4;
    let coarse = along(&model, &[0.0, stroke], stroke / 0.025);
    let fine = along(&model, &polyline(&[0.0, stroke], 10_000), stroke / 0.025 / 10_000.0);
    close(coarse[0][1], fine[0][10_000], 1e-9);
    close(coarse[0][1], level, 1e-9);
}

#[test]
fn stribeck_dips_from_break_away_to_sliding() {
    let model = Stribeck::default();
    let (sliding, excess) = (3.0, 2.0);
    let velocity = [0.0, 0.05, 1.0];
    let zeros = [0.0; 3];
    let series = JointSeries {
        time_s: &zeros,
        position_rad: &zeros,
        velocity_rad_s: &velocity,
        acceleration_rad_s2: &zeros,
        load_torque: &zeros,
    };
    let c = evaluate(&model, &series, &[]).unwrap();
    let level = |n: usize| sliding * c[0][n] + excess * c[1][n];
    close(level(0), 5.0, 1e-15);
    close(level(1), 3.0 + 2.0 / std::f64::consts::E, 1e-12);
    close(level(2), 3.0, 1e-12);
}

#[test]
fn load_dependent_gms_is_a_product_of_columns() {
    let stack = JointStack::new(
        Box::new(Absolute {}),
        Box::new(Gms { elements: Some(3), ..Gms::default() }),
        Box::new(Polynomial { powers: vec![1] }),
    )
    .unwrap();
    let names: Vec<String> = stack.columns().into_iter().map(|p| p.name).collect();
    assert_eq!(
        names,
        ["F_C0.m0", "F_C0.m1", "F_C0.m2", "F_C1.m0", "F_C1.m1", "F_C1.m2", "F_v1"].map(String::from)
    );
    let recording = Recording::random(3, 1, 500);
    let series = recording.joint(0);
    let mut data = vec![0.0; 7 * 500];
    let mut state = stack.initial_state(&series.slice(0..1));
    stack.evaluate(&series, &mut state, &mut Columns::new(&mut data, 7, 500, 500)).unwrap();
    let elements = evaluate(&Gms { elements: Some(3), ..Gms::default() }, &series, &[]).unwrap();
    // Levels W_i = F_i + G_i |τ_J| on the elements, plus viscous friction.
    let (constant, growing) = ([2.0, 1.0, 0.5], [0.1, 0.05, 0.02]);
    for n in 0..500 {
        let direct: f64 = (0..3)
            .map(|i| (constant[i] + growing[i] * series.load_torque[n].abs()) * elements[i][n])
            .sum::<f64>()
            + 3.0 * series.velocity_rad_s[n];
        let coefficients = [&constant[..], &growing[..], &[3.0]].concat();
        let columns: f64 = coefficients.iter().enumerate().map(|(k, x)| x * data[k * 500 + n]).sum();
        close(columns, direct, 1e-12 * direct.abs().max(1.0));
    }
}

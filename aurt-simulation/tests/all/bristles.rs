//! The simulator's LuGre, generalised Maxwell-slip and Masing friction do what textbooks say of them.

use crate::experiments;

use aurt_simulation::plant::Bristle;
use aurt_simulation::plant::bristles::{Gms, LuGre, Masing};
use experiments::{COULOMB_NM, Curve, STATIC_NM, along, break_away_nm, stick_slip};

const LEVEL_NM: f64 = 10.0;
const STEP_RAD: f64 = 1e-5;

fn lugre() -> LuGre {
    LuGre { stiffness_nm_rad: 1e4, damping_nm_s: 0.0 }
}

fn gms() -> Gms {
    Gms::from_displacements(LEVEL_NM, &[0.0005, 0.001, 0.002, 0.004], &[0.25; 4])
}

fn masing() -> Masing {
    Masing { half_way_rad: 1e-3 }
}

fn bristles() -> [(&'static str, Box<dyn Bristle>); 3] {
    [("LuGre", Box::new(lugre())), ("GMS", Box::new(gms())), ("Masing", Box::new(masing()))]
}

fn path(bristle: &dyn Bristle, turning_points_rad: &[f64]) -> Curve {
    along(bristle, LEVEL_NM, turning_points_rad, STEP_RAD, 1e-2)
}

fn last(curve: &Curve) -> f64 {
    curve[curve.len() - 1][1]
}

/// Work that a closed loop takes, ∮ F dx.
fn area(curve: &[[f64; 2]]) -> f64 {
    curve.windows(2).map(|w| 0.5 * (w[0][1] + w[1][1]) * (w[1][0] - w[0][0])).sum()
}

#[test]
fn presliding_is_a_spring_first_and_coulomb_in_the_end() {
    for (name, bristle) in bristles() {
        let start = path(&*bristle, &[1e-5]);
        let slope = last(&start) / 1e-5;
        let stiffness = bristle.stiffness_nm_rad(LEVEL_NM);
        assert!((slope / stiffness - 1.0).abs() < 0.02, "{name}: {slope} and {stiffness}");
        // Masing's curve approaches its level as 1/x, the others faster.
        let end = last(&path(&*bristle, &[0.2]));
        assert!((end - LEVEL_NM).abs() < 0.006 * LEVEL_NM, "{name}: {end}");
    }
}

#[test]
fn cycles_are_closed_loops_that_take_work() {
    for (name, bristle) in bristles() {
        let cycle = [6e-3, -6e-3];
        let twice = path(&*bristle, &[6e-3, -6e-3, 6e-3, -6e-3, 6e-3]);
        let per_cycle = (2.0 * 12e-3_f64 / STEP_RAD).round() as usize;
        let (second, first) = (twice.len() - 1, twice.len() - 1 - per_cycle);
        assert!((twice[second][1] - twice[first][1]).abs() < 0.02, "{name}: {cycle:?}");
        let work = area(&twice[first..]);
        // At most that of a rectangle of the level's height, and a good part of it.
        let rectangle = 4.0 * LEVEL_NM * 6e-3;
        assert!(work > 0.4 * rectangle && work < rectangle, "{name}: {work} of {rectangle}");
    }
}

/// After an inner loop GMS and Masing go on as if it had not been; LuGre, which knows its present deflection
/// alone, does not close the loop.
#[test]
fn memory_is_nonlocal_where_it_should_be() {
    let ways = [vec![5e-3, 0.0], vec![5e-3, 0.0, 2e-3, 0.0]];
    let gap = |bristle: &dyn Bristle| {
        let [without, with] = ways.clone().map(|way| last(&path(bristle, &way)));
        (without - with).abs()
    };
    assert!(gap(&gms()) < 1e-9 && gap(&masing()) < 1e-9, "{} {}", gap(&gms()), gap(&masing()));
    assert!(gap(&lugre()) > 0.05 * LEVEL_NM, "{}", gap(&lugre()));
    // A reversal that leaves the outermost loop behind is forgotten: the virgin curve goes on.
    let far = |way: &[f64]| last(&path(&masing(), way));
    assert!((far(&[8e-3]) - far(&[5e-3, 3e-3, 8e-3])).abs() < 1e-9);
}

#[test]
fn a_split_path_is_the_same_path() {
    for (name, bristle) in bristles() {
        let coarse = along(&*bristle, LEVEL_NM, &[3e-3, -1e-3, 2e-3], 1e-3, 1e-2);
        let fine = along(&*bristle, LEVEL_NM, &[3e-3, -1e-3, 2e-3], 1e-6, 1e-2);
        let tolerance = if name == "GMS" { 0.05 } else { 1e-6 };
        assert!((last(&coarse) - last(&fine)).abs() < tolerance, "{name}");
    }
}

fn textbook() -> Box<dyn Bristle> {
    Box::new(LuGre { stiffness_nm_rad: 1e5, damping_nm_s: 1e5_f64.sqrt() })
}

/// Canudas de Wit et al. (1995), figure 4: the break-away force lies between the static and the Coulomb level
/// and falls with the rate at which the force grows.
#[test]
fn break_away_depends_on_the_rate() {
    let torques: Vec<f64> =
        [0.5, 2.0, 10.0, 40.0].iter().map(|rate| break_away_nm(textbook(), *rate).unwrap()).collect();
    assert!(torques.windows(2).all(|w| w[1] < w[0]), "{torques:?}");
    assert!(torques[0] < STATIC_NM && torques[0] > 0.9 * STATIC_NM, "{torques:?}");
    assert!(torques[3] > COULOMB_NM, "{torques:?}");
}

/// Figure 6 there: a body drawn by a spring sticks until the spring pulls with about the static level, slips,
/// and sticks again, in a cycle that repeats itself.
#[test]
fn stick_and_slip_is_a_limit_cycle() {
    let slip = Gms::from_displacements(COULOMB_NM, &[5e-6, 1e-5, 2e-5, 4e-5], &[0.25; 4]);
    for bristle in [textbook(), Box::new(slip) as Box<dyn Bristle>] {
        let (_, velocity, friction) = stick_slip(bristle, 60.0).unwrap();
        // Without damping of its own a bristle that sticks keeps trembling a little.
        let sticking = |point: &[f64; 2]| point[1].abs() < 0.02;
        let late = &velocity[velocity.len() / 3..];
        let share = late.iter().filter(|p| sticking(p)).count() as f64 / late.len() as f64;
        assert!((0.3..0.95).contains(&share), "it sticks for {share} of the time");
        let slips: Vec<f64> =
            late.windows(2).filter(|w| sticking(&w[0]) && !sticking(&w[1])).map(|w| w[1][0]).collect();
        let periods: Vec<f64> = slips.windows(2).map(|w| w[1] - w[0]).collect();
        assert!(periods.len() >= 3, "{slips:?}");
        let mean = periods.iter().sum::<f64>() / periods.len() as f64;
        assert!(periods.iter().all(|p| (p / mean - 1.0).abs() < 0.02), "{periods:?}");
        let most = friction.iter().map(|p| p[1]).fold(0.0, f64::max);
        assert!((0.93..1.02).contains(&(most / STATIC_NM)), "{most}");
    }
}

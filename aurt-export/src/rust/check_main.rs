
#![allow(unused_parens, clippy::all)]

use @NAME@::{self as robot, State};

/// Fails where a column differs by more than 1e-12 of its largest stored value, or of a thousandth of the table's, in which
/// columns that are zero but for rounding count.
fn compare<const WIDTH: usize>(what: &str, stored: &[[f64; WIDTH]], found: &[[f64; WIDTH]]) {
    assert_eq!(stored.len(), found.len());
    let largest = |values: &mut dyn Iterator<Item = f64>| values.fold(0.0, |a: f64, b| a.max(b.abs()));
    let all = 1e-3 * largest(&mut stored.iter().flatten().copied());
    let mut worst = 0.0_f64;
    for column in 0..WIDTH {
        let size = largest(&mut stored.iter().map(|row| row[column])).max(all);
        for (s, f) in stored.iter().zip(found) {
            assert!(f[column].is_finite(), "{what}[{column}] is {}", f[column]);
            let difference = (s[column] - f[column]).abs();
            let relative = if difference > 0.0 { difference / size } else { 0.0 };
            assert!(relative <= @TOLERANCE@, "{what}[{column}]: differs by {relative:.3e} of the largest value");
            worst = worst.max(relative);
        }
    }
    println!("{what:18} passed, largest relative difference {worst:.3e}");
}

/// What a function of the motion gives for the first samples.
fn of_motion<const WIDTH: usize>(
    rows: usize,
    function: fn(&[f64; robot::JOINTS], &[f64; robot::JOINTS], &[f64; robot::JOINTS]) -> [f64; WIDTH],
) -> Vec<[f64; WIDTH]> {
    (0..rows).map(|n| function(&Q[n], &QD[n], &QDD[n])).collect()
}

#[test]
fn steps_give_the_torques_of_the_model_and_the_same_bits_again() {
    let steps = || -> Vec<_> {
        let mut state = State::new();
        (0..T.len()).map(|n| robot::step(&mut state, T[n][0], &Q[n], &QD[n], &QDD[n])).collect()
    };
    let once = steps();
    compare("step", &TORQUE, &once);
    let bits = |rows: &[[f64; robot::JOINTS]]| -> Vec<u64> { rows.iter().flatten().map(|v| v.to_bits()).collect() };
    assert_eq!(bits(&once), bits(&steps()));
}

#[test]
fn bodies_are_those_of_the_model() {
    compare("rigid_body_torque", &RIGID, &of_motion(T.len(), robot::rigid_body_torque));
    compare("gravity", &GRAVITY, &Q.map(|q| robot::gravity(&q)));
    compare("mass_matrix", &MASS, &Q.map(|q| robot::mass_matrix(&q)));
    compare("regressor", &REGRESSOR, &of_motion(REGRESSOR.len(), robot::regressor));
}
@MEMORYLESS@

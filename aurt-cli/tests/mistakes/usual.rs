//! The mistakes.

use std::f64::consts::{FRAC_PI_2, TAU};

use crate::world::World;

pub struct Mistake {
    pub what: &'static str,
    pub make: fn(&mut World),
    /// What tells it with its cure: all words of one of these.
    pub cures: &'static [&'static [&'static str]],
    /// Whether it is tried on simulated recordings too.
    pub simulated: bool,
}

const fn mistake(
    what: &'static str,
    make: fn(&mut World),
    cures: &'static [&'static [&'static str]],
) -> Mistake {
    Mistake { what, make, cures, simulated: false }
}

const fn everywhere(
    what: &'static str,
    make: fn(&mut World),
    cures: &'static [&'static [&'static str]],
) -> Mistake {
    Mistake { what, make, cures, simulated: true }
}

const DEGREES: f64 = 180.0 / std::f64::consts::PI;

pub const MISTAKES: &[Mistake] = &[
    everywhere(
        "positions in degrees",
        |w| w.each(|l| l.scale(l.positions(), DEGREES)),
        &[&["angle = \"deg\""]],
    ),
    mistake(
        "positions in degrees in one calibration file",
        |w| w.only(1, |l| l.scale(l.positions(), DEGREES)),
        &[&["tuesday.csv", "angle = \"deg\""]],
    ),
    mistake(
        "positions in degrees in the held-out file",
        |w| w.only(2, |l| l.scale(l.positions(), DEGREES)),
        &[&["friday.csv", "angle = \"deg\""]],
    ),
    mistake(
        "positions in turns",
        |w| w.each(|l| l.scale(l.positions(), 1.0 / TAU)),
        &[&["counts_per_revolution"]],
    ),
    mistake(
        "positions in encoder counts",
        |w| w.each(|l| l.scale(l.positions(), 4096.0 / TAU)),
        &[&["counts_per_revolution"]],
    ),
    mistake(
        "positions of the motors, gears of 100",
        |w| w.each(|l| l.scale(l.positions(), 100.0)),
        &[&["gear_ratio"]],
    ),
    mistake(
        "`angle = \"deg\"` for positions in rad",
        |w| w.recorded.push("angle = \"deg\"".into()),
        &[&["angle"], &["gear_ratio"], &["counts_per_revolution"]],
    ),
    mistake(
        "velocities in degrees per second",
        |w| w.each(|l| l.scale(l.velocities(), DEGREES)),
        &[&["logged velocity", "57.3"]],
    ),
    everywhere("time in ms", |w| w.each(|l| l.scale(0..1, 1e3)), &[&["time = \"ms\""]]),
    mistake("time in µs", |w| w.each(|l| l.scale(0..1, 1e6)), &[&["time = \"us\""]]),
    mistake("time in ns", |w| w.each(|l| l.scale(0..1, 1e9)), &[&["time = \"ns\""]]),
    mistake(
        "time in ms in the held-out file",
        |w| w.only(2, |l| l.scale(0..1, 1e3)),
        &[&["friday.csv", "time = \"ms\""]],
    ),
    mistake("`time = \"ms\"` for stamps in s", |w| w.recorded.push("time = \"ms\"".into()), &[&["time"]]),
    mistake(
        "`rate_hz` of another logger",
        |w| w.recorded.push("rate_hz = 1000.0".into()),
        &[&["logged velocity"], &["rate_hz"]],
    ),
    everywhere(
        "currents in mA",
        |w| w.each(|l| l.scale(l.measurements(), 1e3)),
        &[&["current = \"mA\""], &["Nmm"]],
    ),
    mistake(
        "constant of joint 1 ten times too large",
        |w| constants(w, |k| k[1] *= 10.0),
        &[&["joint 1", "constant"]],
    ),
    mistake(
        "constant of joint 2 ten times too small",
        |w| constants(w, |k| k[2] *= 0.1),
        &[&["joint 2", "constant"]],
    ),
    mistake(
        "constant of joint 1 with the other sign",
        |w| constants(w, |k| k[1] *= -1.0),
        &[&["joint 1", "sign"]],
    ),
    everywhere(
        "gravity upside down",
        |w| w.gravity("[0.0, 0.0, 9.81]"),
        &[&["gravity_m_s2", "[0, 0, -9.81]"]],
    ),
    mistake("gravity along y", |w| w.gravity("[0.0, -9.81, 0.0]"), &[&["gravity_m_s2", "[0, 0, -9.81]"]]),
    mistake("gravity along -x", |w| w.gravity("[-9.81, 0.0, 0.0]"), &[&["gravity_m_s2", "[0, 0, -9.81]"]]),
    mistake(
        "gravity of a base on a slope",
        |w| w.gravity("[0.0, 6.937, -6.937]"),
        &[&["gravity_m_s2", "[0, 0, -9.81]"]],
    ),
    everywhere("gravity in g", |w| w.gravity("[0.0, 0.0, -1.0]"), &[&["gravity_m_s2", "[0, 0, -9.81]"]]),
    mistake("gravity in mm/s²", |w| w.gravity("[0.0, 0.0, -9810.0]"), &[&["9.81 m/s^2"]]),
    everywhere(
        "gravity forgotten, zero",
        |w| w.gravity("[0.0, 0.0, 0.0]"),
        &[&["gravity_m_s2", "[0, 0, -9.81]"]],
    ),
    mistake(
        "`mdh_rows` the other way",
        |w| w.set("mdh_rows", "\"previous\""),
        &[&["`mdh_rows` to \"next\""]],
    ),
    everywhere(
        "lengths of the table in mm",
        |w| lengths(w, 1e3),
        &[&["metres"], &["multiply the columns a and d", "0.001"]],
    ),
    mistake("lengths of the table in cm", |w| lengths(w, 1e2), &[&["multiply the columns a and d", "0.01"]]),
    everywhere("alpha in degrees", |w| w.column("alpha", degrees), &[&["radians"]]),
    mistake(
        "columns a and d exchanged",
        |w| w.table[0] = vec!["alpha".into(), "d".into(), "a".into()],
        &[&["a and d", "exchange"]],
    ),
    mistake("rows of the table from the tip", |w| w.table[1..].reverse(), &[&["order of the rows"]]),
    mistake(
        "alpha with the other sign",
        |w| w.column("alpha", |c| format!("{}", -value(c))),
        &[&["signs of the column alpha"]],
    ),
    everywhere("a row of the table missing", |w| drop(w.table.pop()), &[&["joint"]]),
    mistake("a row of the table too many", |w| w.table.push(vec!["0".into(); 3]), &[&["joint"]]),
    mistake(
        "zero of joint 1 a quarter turn off",
        |w| w.each(|l| l.add(l.position(1), FRAC_PI_2)),
        &[&["theta", "row 1"]],
    ),
    mistake(
        "zero of joint 2 a quarter turn off",
        |w| w.each(|l| l.add(l.position(2), -FRAC_PI_2)),
        &[&["theta", "row 2"]],
    ),
    everywhere("position of joint 1 with the other sign", |w| position_sign(w, 1), &[&["joint 1", "sign"]]),
    mistake("position of joint 2 with the other sign", |w| position_sign(w, 2), &[&["joint 2", "sign"]]),
    mistake("position of joint 3 with the other sign", |w| position_sign(w, 3), &[&["joint 3", "sign"]]),
    mistake("position of joint 5 with the other sign", |w| position_sign(w, 5), &[&["joint 5", "sign"]]),
    mistake("position of joint 0 with the other sign", |w| position_sign(w, 0), &[&["joint 0", "sign"]]),
    everywhere(
        "axis of joint 2 the other way",
        |w| {
            position_sign(w, 2);
            measurement_sign(w, 2);
        },
        &[&["joint 2", "sign"]],
    ),
    mistake(
        "measurement of joint 0 with the other sign",
        |w| measurement_sign(w, 0),
        &[&["joint 0", "sign"]],
    ),
    everywhere(
        "measurement of joint 1 with the other sign",
        |w| measurement_sign(w, 1),
        &[&["joint 1", "sign"]],
    ),
    mistake(
        "measurement of joint 4 with the other sign",
        |w| measurement_sign(w, 4),
        &[&["joint 4", "sign"]],
    ),
    everywhere(
        "all measurements with the other sign",
        |w| w.each(|l| l.scale(l.measurements(), -1.0)),
        &[&["gains of -1 for all joints"], &["check the signs"]],
    ),
    mistake(
        "gravity upside down and joint 1 with the other sign",
        |w| {
            w.gravity("[0.0, 0.0, 9.81]");
            measurement_sign(w, 1);
        },
        &[&["gravity_m_s2", "[0, 0, -9.81]", "joint 1"]],
    ),
    mistake(
        "degrees and gravity upside down",
        |w| {
            w.gravity("[0.0, 0.0, 9.81]");
            w.each(|l| l.scale(l.positions(), DEGREES));
        },
        &[&["angle = \"deg\""]],
    ),
    mistake(
        "all columns from the tip",
        |w| {
            reorder(w, true, &[5, 4, 3, 2, 1, 0]);
            reorder(w, false, &[5, 4, 3, 2, 1, 0]);
        },
        &[&["order", "tip first"]],
    ),
    mistake(
        "measurements of joints 1 and 2 exchanged",
        |w| reorder(w, false, &[0, 2, 1, 3, 4, 5]),
        &[&["measurements", "joints 1 and 2 exchanged"]],
    ),
    mistake(
        "measurements of joints 0 and 3 exchanged",
        |w| reorder(w, false, &[3, 1, 2, 0, 4, 5]),
        &[&["measurements", "joints 0 and 3 exchanged"]],
    ),
    mistake(
        "positions of joints 2 and 3 exchanged",
        |w| reorder(w, true, &[0, 1, 3, 2, 4, 5]),
        &[&["positions", "joints 2 and 3 exchanged"]],
    ),
    mistake(
        "shoulder and elbow exchanged, positions and measurements",
        |w| {
            reorder(w, true, &[0, 2, 1, 3, 4, 5]);
            reorder(w, false, &[0, 2, 1, 3, 4, 5]);
        },
        &[&["joints 1 and 2 exchanged"]],
    ),
    mistake(
        "columns in an order that no exchange or shift makes",
        |w| {
            reorder(w, true, &[3, 0, 1, 2, 5, 4]);
            reorder(w, false, &[3, 0, 1, 2, 5, 4]);
        },
        &[&["joints 3, 0, 1, 2, 5 and 4", "[1, 2, 3, 0, 5, 4]"]],
    ),
    mistake(
        "measurements shifted by one joint",
        |w| reorder(w, false, &[5, 0, 1, 2, 3, 4]),
        &[&["measurements", "order"]],
    ),
    mistake(
        "positions shifted by one joint",
        |w| reorder(w, true, &[1, 2, 3, 4, 5, 0]),
        &[&["positions", "order"]],
    ),
    mistake(
        "velocities selected as measurements",
        |w| select(w, "[1, 6]", "[7, 12]"),
        &[&["velocity of joint", "columns"]],
    ),
    mistake(
        "measurement columns selected one too far left",
        |w| select(w, "[1, 6]", "[12, 17]"),
        &[&["velocity of joint", "columns"]],
    ),
    mistake(
        "position columns selected one too far right",
        |w| select(w, "[2, 7]", "[13, 18]"),
        &[&["positions", "order"], &["columns"]],
    ),
    mistake(
        "velocities selected as positions",
        |w| select(w, "[7, 12]", "[13, 18]"),
        &[&["columns"], &["same robot"]],
    ),
    everywhere("measurements 200 ms late", |w| w.each(|l| l.delay(0.2)), &[&["delay_s"]]),
    everywhere(
        "sign of a measurement from the middle of one calibration file on",
        |w| {
            w.only(1, |l| {
                let (column, half) = (l.measurement(1), l.rows.len() / 2);
                l.rows[half..].iter_mut().for_each(|row| row[column] *= -1.0);
            });
        },
        &[&["joint 1", "tuesday.csv", "after its first stamp on", "sign"]],
    ),
    mistake(
        "two measurements exchanged in one calibration file",
        |w| w.only(1, |l| l.reorder(l.measurement(1), &[1, 0])),
        &[&["tuesday.csv", "joints 1 and 2 exchanged"]],
    ),
    mistake(
        "measurements 200 ms late in one file",
        |w| w.only(1, |l| l.delay(0.2)),
        &[&["tuesday.csv", "delay_s"]],
    ),
    mistake(
        "position of joint 3 constantly zero",
        |w| w.each(|l| l.fill(l.position(3), 0.0)),
        &[&["joint 3", "position column"]],
    ),
    mistake(
        "measurement of joint 3 constantly zero",
        |w| w.each(|l| l.fill(l.measurement(3), 0.0)),
        &[&["joint 3", "constantly 0", "columns"]],
    ),
    mistake(
        "measurement of joint 2 a copy of joint 1",
        |w| w.each(|l| l.repeat(l.measurement(1), l.measurement(2))),
        &[&["joints 1 and 2 are the same column"]],
    ),
    mistake(
        "position of joint 2 a copy of joint 1",
        |w| w.each(|l| l.repeat(l.position(1), l.position(2))),
        &[&["joints 1 and 2 are the same column"]],
    ),
    everywhere(
        "a calibration file held out again",
        |w| w.validation = "[\"monday.csv\"]".into(),
        &[&["monday.csv"]],
    ),
    mistake(
        "a copy of a calibration file held out",
        |w| w.logs[2] = w.logs[0].clone(),
        &[&["friday.csv", "monday.csv"]],
    ),
    mistake(
        "windows that overlap",
        |w| {
            w.calibration = "[{ file = \"monday.csv\", window_s = [0.0, 20.0] }]".into();
            w.validation = "[{ file = \"monday.csv\", window_s = [10.0, 25.0] }]".into();
        },
        &[&["monday.csv"]],
    ),
    mistake("f_dyn beyond the logger", |w| w.f_dyn_hz = 100.0, &[&["f_dyn_hz can be at most"]]),
    mistake("f_dyn of 0.01 Hz", |w| w.f_dyn_hz = 0.01, &[&["f_dyn_hz"]]),
    mistake("the name of another robot", |w| w.geometry = "name = \"panda\"".into(), &[&["joints"]]),
    mistake(
        "the name of a smaller robot of the same family",
        |w| w.geometry = "name = \"ur3e\"".into(),
        &[&["`name` to \"ur10e\""], &["ur10e"]],
    ),
    mistake(
        "a name with a slip of the pen",
        |w| w.geometry = "name = \"ur10ee\"".into(),
        &[&["did you mean", "ur10e"]],
    ),
    everywhere(
        "a key with a slip of the pen",
        |w| w.set("gravitiy_m_s2", "[0, 0, -9.81]"),
        &[&["gravity_m_s2"]],
    ),
    everywhere("stamps that run backwards", |w| w.each(|l| l.rows.reverse()), &[&["time goes back"]]),
    mistake(
        "decimal commas between commas",
        |w| w.text = Some(|t| t.replacen("0.", "0,", 40)),
        &[&["cells"], &["columns"]],
    ),
    mistake("a cell that is no number", |w| w.text = Some(|t| t.replacen("-0.0", "NaN", 1)), &[&["row"]]),
    everywhere("a file that breaks off", |w| w.text = Some(|t| t[..t.len() - 9].to_owned()), &[&["last"]]),
    everywhere(
        "no joint moves",
        |w| {
            w.each(|l| {
                let first = l.rows[0].clone();
                l.rows.iter_mut().for_each(|row| row[1..].copy_from_slice(&first[1..]));
            });
        },
        &[&["joint", "mov"], &["rest"]],
    ),
];

fn value(cell: &str) -> f64 {
    let pi = std::f64::consts::PI;
    match cell.trim() {
        "pi/2" => pi / 2.0,
        "-pi/2" => -pi / 2.0,
        number => number.parse().unwrap(),
    }
}

fn degrees(cell: &str) -> String {
    format!("{}", value(cell).to_degrees())
}

fn constants(world: &mut World, change: impl Fn(&mut [f64])) {
    let mut constants = [11.976, 11.976, 9.839, 10.763, 10.763, 10.763];
    change(&mut constants);
    world.set("torque_constants_nm_per_a", &format!("{constants:?}"));
}

fn lengths(world: &mut World, factor: f64) {
    for column in ["a", "d"] {
        world.column(column, |c| format!("{}", value(c) * factor));
    }
}

fn position_sign(world: &mut World, joint: usize) {
    world.each(|l| {
        l.scale(l.position(joint)..l.position(joint) + 1, -1.0);
        l.scale(l.velocities().skip(joint).take(1), -1.0);
    });
}

fn measurement_sign(world: &mut World, joint: usize) {
    world.each(|l| l.scale(l.measurement(joint)..l.measurement(joint) + 1, -1.0));
}

/// Columns in another order: positions with their velocities, or measurements.
fn reorder(world: &mut World, motion: bool, from: &[usize]) {
    world.each(|l| {
        if !motion {
            return l.reorder(l.measurement(0), from);
        }
        l.reorder(l.position(0), from);
        l.velocities().take(1).for_each(|first| l.reorder(first, from));
    });
}

fn select(world: &mut World, position: &str, measurement: &str) {
    let entry = |name: &str| {
        format!(
            "{{ file = \"{name}\", unit = \"A\", columns = {{ time = 0, position = {position}, measurement = \
             {measurement} }} }}"
        )
    };
    world.calibration = format!("[{}, {}]", entry("monday.csv"), entry("tuesday.csv"));
    world.validation = format!("[{}]", entry("friday.csv"));
}

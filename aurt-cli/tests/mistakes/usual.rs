//! The mistakes: those of the laboratory, with the joints and sizes that the demo and the UR10e have, and what is wrong with
//! files and keys.

use std::f64::consts::{FRAC_PI_2, TAU};

use aurt_lab::setups::Columns::{self, Both, Measurements, Positions};
use aurt_lab::setups::mistakes::{Made, scale, told};
use aurt_lab::setups::{Geometry, Log, Setup};

pub struct Mistake {
    pub what: &'static str,
    pub make: fn(&mut Setup) -> Made,
    /// Whether it is tried on simulated recordings too.
    pub simulated: bool,
}

const fn mistake(what: &'static str, make: fn(&mut Setup) -> Made) -> Mistake {
    Mistake { what, make, simulated: false }
}

const fn everywhere(what: &'static str, make: fn(&mut Setup) -> Made) -> Mistake {
    Mistake { what, make, simulated: true }
}

const DEGREES: f64 = 180.0 / std::f64::consts::PI;
const ANGLE: &str = "angle = \"deg\"";

pub const MISTAKES: &[Mistake] = &[
    everywhere("positions in degrees", |s| with(s.degrees(true), &[ANGLE])),
    mistake("positions in degrees in one calibration file", |s| with(s.degrees_in(1), &[ANGLE])),
    mistake("positions in degrees in the held-out file", |s| with(s.degrees_in(2), &[ANGLE])),
    mistake("positions in turns", |s| counts(s, 1.0)),
    mistake("positions in encoder counts", |s| counts(s, 4096.0)),
    mistake("positions of the motors, gears of 100", |s| with(s.gears(100.0), &["gear_ratio"])),
    mistake("`angle = \"deg\"` for positions in rad", |s| s.degrees(false)),
    mistake("velocities in degrees per second", |s| {
        s.each(|l| scale(&mut l.velocity_rad_s, DEGREES));
        told(&[&["logged velocity", "57.3"]])
    }),
    everywhere("time in ms", Setup::milliseconds),
    mistake("time in µs", |s| stamps(s, 1e6, "time = \"us\"")),
    mistake("time in ns", |s| stamps(s, 1e9, "time = \"ns\"")),
    mistake("time in ms in the held-out file", |s| {
        s.logs[2].units.milliseconds = true;
        told(&[&["recording_3.csv", "time = \"ms\""]])
    }),
    mistake("`time = \"ms\"` for stamps in s", |s| {
        s.declared.milliseconds = true;
        told(&[&["time"]])
    }),
    mistake("`rate_hz` of another logger", |s| {
        s.edit = Some(|t| t.replace("[recordings]", "[recordings]\nrate_hz = 1000.0"));
        told(&[&["logged velocity"], &["rate_hz"]])
    }),
    everywhere("currents in mA", Setup::milliampere),
    mistake("constant of joint 1 ten times too large", |s| s.constant(1, 10.0)),
    mistake("constant of joint 2 ten times too small", |s| s.constant(2, 0.1)),
    mistake("constant of joint 1 with the other sign", |s| s.constant_sign(1)),
    everywhere("gravity upside down", |s| s.gravity([0.0, 0.0, 9.81])),
    mistake("gravity along y", |s| s.gravity([0.0, -9.81, 0.0])),
    mistake("gravity along -x", |s| s.gravity([-9.81, 0.0, 0.0])),
    mistake("gravity of a base on a slope", |s| s.gravity([0.0, 6.937, -6.937])),
    everywhere("gravity in g", |s| s.gravity([0.0, 0.0, -1.0])),
    mistake("gravity in mm/s²", |s| {
        s.gravity_m_s2[2] *= 1e3;
        told(&[&["9.81 m/s^2"]])
    }),
    everywhere("gravity forgotten, zero", |s| s.gravity([0.0; 3])),
    mistake("`mdh_rows` the other way", Setup::mdh_rows),
    everywhere("lengths of the table in mm", |s| s.lengths(1e3)),
    mistake("lengths of the table in cm", |s| with(s.lengths(1e2), &["multiply the columns a and d"])),
    everywhere("alpha in degrees", |s| {
        s.mdh.iter_mut().for_each(|row| row.alpha_rad = row.alpha_rad.to_degrees());
        told(&[&["radians"]])
    }),
    mistake("columns a and d exchanged", Setup::exchanged_lengths),
    mistake("rows of the table from the tip", Setup::from_tip_rows),
    mistake("alpha with the other sign", |s| with(s.mirrored(), &["signs of the column alpha"])),
    everywhere("a row of the table missing", |s| {
        s.mdh.pop();
        told(&[&["joint"]])
    }),
    mistake("a row of the table too many", |s| {
        s.mdh.push(s.mdh[0]);
        told(&[&["joint"]])
    }),
    mistake("zero of joint 1 a quarter turn off", |s| with(s.zero(1, FRAC_PI_2), &["theta", "row 1"])),
    mistake("zero of joint 2 a quarter turn off", |s| with(s.zero(2, -FRAC_PI_2), &["theta", "row 2"])),
    everywhere("position of joint 1 with the other sign", |s| s.sign(Positions, 1)),
    mistake("position of joint 2 with the other sign", |s| s.sign(Positions, 2)),
    mistake("position of joint 3 with the other sign", |s| s.sign(Positions, 3)),
    mistake("position of joint 5 with the other sign", |s| s.sign(Positions, 5)),
    mistake("position of joint 0 with the other sign", |s| s.sign(Positions, 0)),
    everywhere("axis of joint 2 the other way", |s| s.sign(Both, 2)),
    mistake("measurement of joint 0 with the other sign", |s| s.sign(Measurements, 0)),
    everywhere("measurement of joint 1 with the other sign", |s| s.sign(Measurements, 1)),
    mistake("measurement of joint 4 with the other sign", |s| s.sign(Measurements, 4)),
    everywhere("all measurements with the other sign", Setup::all_signs),
    mistake("gravity upside down and joint 1 with the other sign", |s| {
        s.sign(Measurements, 1);
        with(s.gravity([0.0, 0.0, 9.81]), &["joint 1"])
    }),
    mistake("degrees and gravity upside down", |s| {
        s.gravity([0.0, 0.0, 9.81]);
        with(s.degrees(true), &[ANGLE])
    }),
    mistake("all columns from the tip", |s| with(s.from_tip(), &["order"])),
    mistake("measurements of joints 1 and 2 exchanged", |s| {
        with(s.exchanged(Measurements, [1, 2]), &["measurements"])
    }),
    mistake("measurements of joints 0 and 3 exchanged", |s| {
        with(s.exchanged(Measurements, [0, 3]), &["measurements"])
    }),
    mistake("positions of joints 2 and 3 exchanged", |s| {
        with(s.exchanged(Positions, [2, 3]), &["positions"])
    }),
    mistake("shoulder and elbow exchanged, positions and measurements", |s| s.exchanged(Both, [1, 2])),
    mistake("columns in an order that no exchange or shift makes", |s| {
        ordered(s, Both, [3, 0, 1, 2, 5, 4], &["joints 3, 0, 1, 2, 5 and 4", "[1, 2, 3, 0, 5, 4]"])
    }),
    mistake("measurements shifted by one joint", |s| {
        ordered(s, Measurements, [5, 0, 1, 2, 3, 4], &["measurements", "order"])
    }),
    mistake("positions shifted by one joint", |s| {
        ordered(s, Positions, [1, 2, 3, 4, 5, 0], &["positions", "order"])
    }),
    mistake("velocities selected as measurements", |s| {
        s.columns = Some([1, 7]);
        told(&[&["velocity of joint", "columns"]])
    }),
    mistake("measurement columns selected one too far left", |s| {
        s.columns = Some([1, 12]);
        told(&[&["velocity of joint", "columns"]])
    }),
    mistake("position columns selected one too far right", |s| {
        s.columns = Some([2, 13]);
        told(&[&["positions", "order"], &["columns"]])
    }),
    mistake("velocities selected as positions", |s| {
        s.columns = Some([7, 13]);
        told(&[&["columns"], &["same robot"]])
    }),
    everywhere("measurements 200 ms late", |s| s.delay(0.2, None)),
    everywhere("sign of a measurement from the middle of one calibration file on", |s| {
        let series = &mut s.logs[1].measurement[1];
        let half = series.len() / 2;
        series[half..].iter_mut().for_each(|v| *v = -*v);
        told(&[&["joint 1", "recording_2.csv", "after its first stamp on", "sign"]])
    }),
    mistake("two measurements exchanged in one calibration file", |s| {
        s.logs[1].measurement.swap(1, 2);
        told(&[&["recording_2.csv", "joints 1 and 2 exchanged"]])
    }),
    mistake("measurements 200 ms late in one file", |s| s.delay(0.2, Some(1))),
    mistake("position of joint 3 constantly zero", |s| {
        s.each(|l| l.position_rad[3].fill(0.0));
        told(&[&["joint 3", "position column"]])
    }),
    mistake("measurement of joint 3 constantly zero", |s| {
        s.each(|l| l.measurement[3].fill(0.0));
        told(&[&["joint 3", "constantly 0", "columns"]])
    }),
    mistake("measurement of joint 2 a copy of joint 1", |s| s.copied(Measurements, [1, 2])),
    mistake("position of joint 2 a copy of joint 1", |s| s.copied(Positions, [1, 2])),
    everywhere("a calibration file held out again", |s| {
        s.edit = Some(|t| t.replace("[\"recording_3.csv\"]", "[\"recording_1.csv\"]"));
        told(&[&["recording_1.csv"]])
    }),
    mistake("a copy of a calibration file held out", |s| {
        s.logs[2] = Log { validates: true, ..s.logs[0].clone() };
        told(&[&["recording_3.csv", "recording_1.csv"]])
    }),
    mistake("windows that overlap", |s| {
        s.edit = Some(|t| {
            let window = |s| format!("[{{ file = \"recording_1.csv\", window_s = {s} }}]");
            t.replace("[\"recording_1.csv\", \"recording_2.csv\"]", &window("[0.0, 20.0]"))
                .replace("[\"recording_3.csv\"]", &window("[10.0, 25.0]"))
        });
        told(&[&["recording_1.csv"]])
    }),
    mistake("f_dyn beyond the logger", |s| {
        s.f_dyn_hz = 100.0;
        told(&[&["f_dyn_hz can be at most"]])
    }),
    mistake("f_dyn of 0.01 Hz", |s| {
        s.f_dyn_hz = 0.01;
        told(&[&["f_dyn_hz"]])
    }),
    mistake("the name of another robot", |s| named(s, "panda", &[&["joints"]])),
    mistake("the name of a smaller robot of the same family", |s| {
        named(s, "ur3e", &[&["`name` to \"ur10e\""], &["ur10e"]])
    }),
    mistake("a name with a slip of the pen", |s| named(s, "ur10ee", &[&["did you mean", "ur10e"]])),
    everywhere("a key with a slip of the pen", |s| {
        s.robot_lines.push("gravitiy_m_s2 = [0, 0, -9.81]".into());
        told(&[&["gravity_m_s2"]])
    }),
    everywhere("stamps that run backwards", |s| {
        s.each(|l| l.time_s.reverse());
        s.each(|l| l.families(Both).flatten().for_each(|series| series.reverse()));
        told(&[&["time goes back"]])
    }),
    mistake("decimal commas between commas", |s| {
        s.edit = Some(|t| in_recordings(t, |t| t.replacen("0.", "0,", 40)));
        told(&[&["cells"], &["columns"]])
    }),
    mistake("a cell that is no number", |s| {
        s.edit = Some(|t| in_recordings(t, |t| t.replacen("-0.0", "NaN", 1)));
        told(&[&["row"]])
    }),
    everywhere("a file that breaks off", |s| {
        s.edit = Some(|t| in_recordings(t, |t| t[..t.len() - 9].to_owned()));
        told(&[&["last"]])
    }),
    everywhere("no joint moves", |s| {
        s.each(|l| l.families(Both).flatten().for_each(|series| *series = vec![series[0]; series.len()]));
        told(&[&["joint", "mov"], &["rest"]])
    }),
];

/// A mistake that an answer has to tell with more words.
fn with(made: Made, words: &[&str]) -> Made {
    let (detail, mut cures) = made?;
    cures.iter_mut().for_each(|cure| cure.extend(words.iter().map(|word| (*word).to_owned())));
    Some((detail, cures))
}

fn counts(setup: &mut Setup, per_turn: f64) -> Made {
    setup.each(|log| scale(&mut log.position_rad, per_turn / TAU));
    told(&[&["counts_per_revolution"]])
}

fn stamps(setup: &mut Setup, factor: f64, cure: &str) -> Made {
    setup.each(|log| scale([&mut log.time_s], factor));
    told(&[&[cure]])
}

/// Joint j is what joint `from[j]` was.
fn ordered(setup: &mut Setup, of: Columns, from: [usize; 6], cure: &[&str]) -> Made {
    setup.each(|log| log.families(of).for_each(|family| *family = from.map(|j| family[j].clone()).to_vec()));
    told(&[cure])
}

fn named(setup: &mut Setup, name: &str, cures: &[&[&str]]) -> Made {
    setup.geometry = Geometry::Name(name.to_owned());
    told(cures)
}

/// An edit of recordings, which the other files are spared.
fn in_recordings(text: &str, edit: impl Fn(&str) -> String) -> String {
    if text.starts_with("time") { edit(text) } else { text.to_owned() }
}

//! Usual mistakes, each of a random joint or size.

use std::f64::consts::{FRAC_PI_2, PI};

use aurt_simulation::Random;
use aurt_traits::{MeasurementUnit, RobotNames};

use super::setup::{Geometry, Log, Setup, file_name};

#[derive(Debug, Clone)]
pub struct Kind {
    pub name: &'static str,
    pub detail: String,
    /// What tells it with its cure: all words of one of these.
    pub cures: Vec<Vec<String>>,
}

/// The detail of a mistake that was made, and what tells it with its cure; nothing for a setup that cannot have it.
type Made = Option<(String, Vec<Vec<String>>)>;
type Make = fn(&mut Setup, &mut Random) -> Made;

const KINDS: [(&str, Make); 32] = [
    ("zero of a joint a quarter or half a turn off", zero),
    ("position of a joint with the other sign", |s, r| sign(s, r, true)),
    ("measurement of a joint with the other sign", |s, r| sign(s, r, false)),
    ("all measurements with the other sign", all_signs),
    ("positions of two joints exchanged", |s, r| exchanged(s, r, true, false)),
    ("measurements of two joints exchanged", |s, r| exchanged(s, r, false, true)),
    ("positions and measurements of two joints exchanged", |s, r| exchanged(s, r, true, true)),
    ("columns from the tip", from_tip),
    ("name of another maker's robot", |s, r| other_robot(s, r, false)),
    ("name of another robot of the family", |s, r| other_robot(s, r, true)),
    ("gravity upside down", |s, _| gravity(s, |g| g.map(|v| -v))),
    ("gravity along another axis", |s, r| {
        let side = r.sign();
        if r.chance(0.5) {
            gravity(s, |_| [side * 9.81, 0.0, 0.0])
        } else {
            gravity(s, |_| [0.0, side * 9.81, 0.0])
        }
    }),
    ("gravity zero", |s, _| gravity(s, |_| [0.0; 3])),
    ("gravity in g", |s, _| gravity(s, |g| g.map(|v| v / 9.81))),
    ("degrees for radians", |s, _| degrees(s, true)),
    ("radians for degrees", |s, _| degrees(s, false)),
    ("degrees in one recording", degrees_in_one),
    ("gears not stated", gears),
    ("stamps in ms", milliseconds),
    ("seconds for ms", seconds),
    ("clock too fast or too slow", clock),
    ("currents in mA", milliampere),
    ("torques in Nmm", newton_millimetres),
    ("torque constants of two joints exchanged", constants_exchanged),
    ("torque constant ten times off", constant_off),
    ("torque constant with the other sign", constant_sign),
    ("measurements late", |s, r| delay(s, r, false)),
    ("measurements late in one recording", |s, r| delay(s, r, true)),
    ("columns one too far", one_too_far),
    ("column of another joint", copied),
    ("`mdh_rows` the other way", mdh_rows),
    ("table: a and d, lengths, order or alpha wrong", table),
];

impl Kind {
    pub fn make(index: usize, setup: &mut Setup, random: &mut Random) -> Option<Self> {
        let (name, make) = KINDS[index % KINDS.len()];
        make(setup, random).map(|(detail, cures)| Self { name, detail, cures })
    }

    pub fn names() -> impl Iterator<Item = &'static str> {
        KINDS.iter().map(|(name, _)| *name)
    }
}

fn words(cures: &[&[&str]]) -> Vec<Vec<String>> {
    cures.iter().map(|cure| cure.iter().map(|word| (*word).to_owned()).collect()).collect()
}

fn joint_words(setup: &Setup, joint: usize, others: &[&str]) -> Vec<Vec<String>> {
    let named = |other: &&str| vec![called(setup, &[joint]), (*other).to_owned()];
    others.iter().map(named).collect()
}

fn called(setup: &Setup, joints: &[usize]) -> String {
    RobotNames::of_joints(&setup.joint_names()).joint_list(joints)
}

fn each(setup: &mut Setup, change: impl Fn(&mut Log)) {
    setup.logs.iter_mut().for_each(change);
}

/// Zeros of the last joint are those of its body, and so is that of the first one where gravity lies along its axis.
fn zero(setup: &mut Setup, random: &mut Random) -> Made {
    if setup.joints() < 3 {
        return None;
    }
    let joint = 1 + random.index(setup.joints() - 2);
    let offset = [FRAC_PI_2, -FRAC_PI_2, PI][random.index(3)];
    each(setup, |log| log.position_rad[joint].iter_mut().for_each(|q| *q += offset));
    let row = format!("row {joint}");
    let cures = vec![vec!["theta".into(), row], vec![format!("zero of {}", called(setup, &[joint]))]];
    Some((format!("joint {joint}, {:.0}°", offset.to_degrees()), cures))
}

fn turn(series: &mut [f64]) {
    series.iter_mut().for_each(|v| *v = -*v);
}

fn sign(setup: &mut Setup, random: &mut Random, position: bool) -> Made {
    let joint = random.index(setup.joints());
    each(setup, |log| {
        turn(if position { &mut log.position_rad[joint] } else { &mut log.measurement[joint] });
    });
    Some((format!("joint {joint}"), joint_words(setup, joint, &["sign"])))
}

fn all_signs(setup: &mut Setup, _: &mut Random) -> Made {
    each(setup, |log| log.measurement.iter_mut().for_each(|y| turn(y)));
    Some((String::new(), words(&[&["gains of -1 for all joints"], &["check the signs"]])))
}

fn two(joints: usize, random: &mut Random) -> [usize; 2] {
    let first = random.index(joints - 1);
    [first, first + 1 + random.index(joints - 1 - first)]
}

fn exchanged(setup: &mut Setup, random: &mut Random, position: bool, measurement: bool) -> Made {
    let [a, b] = two(setup.joints(), random);
    each(setup, |log| {
        if position {
            log.position_rad.swap(a, b);
        }
        if measurement {
            log.measurement.swap(a, b);
        }
    });
    Some((format!("joints {a} and {b}"), vec![vec![format!("{} exchanged", called(setup, &[a, b]))]]))
}

fn from_tip(setup: &mut Setup, _: &mut Random) -> Made {
    each(setup, |log| {
        log.position_rad.reverse();
        log.measurement.reverse();
    });
    let cures = if setup.joints() == 2 { words(&[&["exchanged"]]) } else { words(&[&["tip first"]]) };
    Some((String::new(), cures))
}

fn other_robot(setup: &mut Setup, random: &mut Random, family: bool) -> Made {
    let Geometry::Name(own) = &setup.geometry else { return None };
    let others: &[&str] = match (own.as_str(), family) {
        ("ur5e", true) => &["ur3e", "ur10e", "ur16e"],
        ("ur10e", true) => &["ur3e", "ur5e", "ur16e"],
        ("panda", true) => return None,
        ("panda", false) => &["gen3", "iiwa14", "xarm7"],
        _ => &["irb120", "kr6_r700", "tx2_60", "xarm6"],
    };
    let cure = vec![vec![format!("`name` to \"{own}\"")]];
    let other = others[random.index(others.len())];
    let detail = format!("{other} for {own}");
    setup.geometry = Geometry::Name(other.to_owned());
    Some((detail, cure))
}

fn gravity(setup: &mut Setup, changed: impl Fn([f64; 3]) -> [f64; 3]) -> Made {
    let own = setup.gravity_m_s2;
    setup.gravity_m_s2 = changed(own);
    // The opposite of what stands may be what stood.
    let along = own.iter().filter(|v| **v != 0.0).count() == 1;
    if own == setup.gravity_m_s2 || !along {
        return None;
    }
    let numbers: Vec<String> = own.iter().map(|v| format!("{v}")).collect();
    let cure = format!("`gravity_m_s2` to [{}]", numbers.join(", "));
    Some((format!("{:?}", setup.gravity_m_s2), vec![vec![cure]]))
}

const ANGLES: &[&[&str]] = &[&["angle"], &["gear_ratio"], &["counts_per_revolution"]];

fn degrees(setup: &mut Setup, written: bool) -> Made {
    if setup.declared.gear_ratio.is_some() {
        return None;
    }
    setup.declared.degrees = !written;
    each(setup, |log| log.units.degrees = written);
    Some((String::new(), words(ANGLES)))
}

fn degrees_in_one(setup: &mut Setup, random: &mut Random) -> Made {
    if setup.logs.len() < 2 || setup.declared.degrees || setup.declared.gear_ratio.is_some() {
        return None;
    }
    let log = random.index(setup.logs.len());
    setup.logs[log].units.degrees = true;
    Some((file_name(log), vec![vec![file_name(log), "angle".into()]]))
}

fn gears(setup: &mut Setup, random: &mut Random) -> Made {
    if setup.declared.degrees {
        return None;
    }
    let ratio = random.between(30.0, 160.0).round();
    setup.declared.gear_ratio = None;
    each(setup, |log| log.units.gear_ratio = Some(ratio));
    Some((format!("{ratio}"), words(ANGLES)))
}

fn milliseconds(setup: &mut Setup, _: &mut Random) -> Made {
    setup.declared.milliseconds = false;
    each(setup, |log| log.units.milliseconds = true);
    Some((String::new(), words(&[&["time = \"ms\""]])))
}

fn seconds(setup: &mut Setup, _: &mut Random) -> Made {
    setup.declared.milliseconds = true;
    each(setup, |log| log.units.milliseconds = false);
    Some((String::new(), words(&[&["`time"], &["time ="]])))
}

fn clock(setup: &mut Setup, random: &mut Random) -> Made {
    let factor = [2.0, 0.5, 4.0, 0.25, 10.0][random.index(5)];
    each(setup, |log| log.time_s.iter_mut().for_each(|t| *t *= factor));
    Some((format!("{factor}"), words(&[&["multiply the stamps"], &["rate_hz"]])))
}

fn milliampere(setup: &mut Setup, _: &mut Random) -> Made {
    if setup.unit != MeasurementUnit::Ampere {
        return None;
    }
    setup.declared.milliampere = false;
    each(setup, |log| log.units.milliampere = true);
    Some((String::new(), words(&[&["current = \"mA\""]])))
}

fn newton_millimetres(setup: &mut Setup, _: &mut Random) -> Made {
    if setup.unit != MeasurementUnit::NewtonMetre {
        return None;
    }
    each(setup, |log| log.measurement.iter_mut().flatten().for_each(|y| *y *= 1e3));
    Some((String::new(), words(&[&["Nmm"]])))
}

fn constants_exchanged(setup: &mut Setup, random: &mut Random) -> Made {
    let [a, b] = two(setup.joints(), random);
    let constants = setup.constants_nm_per_a.as_mut()?;
    if (0.8..1.25).contains(&(constants[a] / constants[b])) {
        return None;
    }
    constants.swap(a, b);
    Some((
        format!("joints {a} and {b}"),
        vec![vec![format!("the torque constants of {}", called(setup, &[a, b]))]],
    ))
}

fn constant_off(setup: &mut Setup, random: &mut Random) -> Made {
    let joint = random.index(setup.joints());
    let factor = if random.chance(0.5) { 10.0 } else { 0.1 };
    setup.constants_nm_per_a.as_mut()?[joint] *= factor;
    Some((format!("joint {joint}, {factor}"), joint_words(setup, joint, &["constant"])))
}

fn constant_sign(setup: &mut Setup, random: &mut Random) -> Made {
    let joint = random.index(setup.joints());
    setup.constants_nm_per_a.as_mut()?[joint] *= -1.0;
    Some((format!("joint {joint}"), joint_words(setup, joint, &["sign"])))
}

fn delay(setup: &mut Setup, random: &mut Random, one: bool) -> Made {
    if one && setup.logs.len() < 2 {
        return None;
    }
    let delay_s = random.between(0.08, 0.4);
    let chosen = random.index(setup.logs.len());
    for (_, log) in setup.logs.iter_mut().enumerate().filter(|(k, _)| !one || *k == chosen) {
        let period_s = (log.time_s[log.time_s.len() - 1] - log.time_s[0]) / (log.time_s.len() - 1) as f64;
        let rows = (delay_s / period_s).round() as usize;
        for series in &mut log.measurement {
            let before = series.clone();
            for (k, value) in series.iter_mut().enumerate() {
                *value = before[k.saturating_sub(rows)];
            }
        }
    }
    let mut cure = vec!["delay_s".to_owned()];
    cure.extend(one.then(|| file_name(chosen)));
    Some((format!("{:.0} ms", 1e3 * delay_s), vec![cure]))
}

fn one_too_far(setup: &mut Setup, random: &mut Random) -> Made {
    let joints = setup.joints();
    // Positions from the second on, and the first measurement; or the last position before the measurements.
    let position = random.chance(0.5);
    setup.columns = Some(if position { [2, 1 + joints] } else { [1, joints] });
    let cures: &[&[&str]] = if position { &[&["positions", "order"], &["columns"]] } else { &[&["columns"]] };
    Some((if position { "positions" } else { "measurements" }.into(), words(cures)))
}

fn copied(setup: &mut Setup, random: &mut Random) -> Made {
    let [a, b] = two(setup.joints(), random);
    let position = random.chance(0.5);
    each(setup, |log| {
        let family = if position { &mut log.position_rad } else { &mut log.measurement };
        family[b] = family[a].clone();
    });
    let of = if position { "position" } else { "measurement" };
    Some((
        format!("{of} of joint {b}"),
        vec![vec![format!("{} are the same column", called(setup, &[a, b]))]],
    ))
}

fn mdh_rows(setup: &mut Setup, _: &mut Random) -> Made {
    if setup.geometry != Geometry::Table {
        return None;
    }
    setup.robot_lines.push("mdh_rows = \"previous\"".into());
    Some((String::new(), words(&[&["`mdh_rows` to \"next\""]])))
}

fn table(setup: &mut Setup, random: &mut Random) -> Made {
    if setup.geometry != Geometry::Table {
        return None;
    }
    let before = setup.mdh.clone();
    let rows = &mut setup.mdh;
    let (detail, cures): (&str, &[&[&str]]) = match random.index(4) {
        0 => {
            rows.iter_mut().for_each(|r| std::mem::swap(&mut r.a_m, &mut r.d_m));
            ("a and d exchanged", &[&["a and d", "exchange"]])
        }
        1 => {
            rows.iter_mut().for_each(|r| (r.a_m, r.d_m) = (100.0 * r.a_m, 100.0 * r.d_m));
            ("lengths in cm", &[&["multiply the columns a and d", "0.01"], &["metres"]])
        }
        2 => {
            rows.reverse();
            ("rows from the tip", &[&["order of the rows"]])
        }
        _ => {
            rows.iter_mut().for_each(|r| r.alpha_rad = -r.alpha_rad);
            ("alpha with the other sign", &[&["signs of the column alpha"], &["gravity_m_s2"]])
        }
    };
    (*rows != before).then(|| (detail.to_owned(), words(cures)))
}

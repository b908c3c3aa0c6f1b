//! Usual mistakes, made in setups: the laboratory draws their joints and sizes, tests of `aurt check` state them.
//!
//! They are made in files alone, and told by words that people read: neither is taken from what the product tries to undo.

use std::f64::consts::{FRAC_PI_2, PI};

use aurt_rbd::MdhRow;
use aurt_simulation::Random;
use aurt_traits::{MeasurementUnit, RobotNames};

use super::setup::Columns::{self, Both, Measurements, Positions};
use super::setup::{Geometry, Log, Setup, file_name};

#[derive(Debug, Clone)]
pub struct Kind {
    pub name: &'static str,
    pub detail: String,
    pub cures: Cures,
}

/// Cures of a mistake: an answer tells it with all words of one of these.
pub type Cures = Vec<Vec<String>>;
/// The detail of a mistake that was made, and what tells it; nothing for a setup that cannot have it.
pub type Made = Option<(String, Cures)>;

/// A mistake of a kind, drawn and made.
type Draw = fn(&mut Setup, &mut Random) -> Made;

/// The mistakes, each of a random joint or size.
const KINDS: [(&str, Draw); 32] = [
    // Zeros of the last joint are those of its body, and so is that of the first one where gravity lies along its axis.
    ("zero of a joint a quarter or half a turn off", |s, r| {
        if s.joints() < 3 {
            return None;
        }
        let joint = 1 + r.index(s.joints() - 2);
        s.zero(joint, [FRAC_PI_2, -FRAC_PI_2, PI][r.index(3)])
    }),
    ("position of a joint with the other sign", |s, r| s.sign(Positions, r.index(s.joints()))),
    ("measurement of a joint with the other sign", |s, r| s.sign(Measurements, r.index(s.joints()))),
    ("all measurements with the other sign", |s, _| s.all_signs()),
    ("positions of two joints exchanged", |s, r| s.exchanged(Positions, two(s, r))),
    ("measurements of two joints exchanged", |s, r| s.exchanged(Measurements, two(s, r))),
    ("positions and measurements of two joints exchanged", |s, r| s.exchanged(Both, two(s, r))),
    ("columns from the tip", |s, _| s.from_tip()),
    ("name of another maker's robot", |s, r| s.other_robot(r, false)),
    ("name of another robot of the family", |s, r| s.other_robot(r, true)),
    ("gravity upside down", |s, _| s.gravity(s.gravity_m_s2.map(|v| -v))),
    ("gravity along another axis", |s, r| {
        let side = r.sign();
        s.gravity(if r.chance(0.5) { [side * 9.81, 0.0, 0.0] } else { [0.0, side * 9.81, 0.0] })
    }),
    ("gravity zero", |s, _| s.gravity([0.0; 3])),
    ("gravity in g", |s, _| s.gravity(s.gravity_m_s2.map(|v| v / 9.81))),
    ("degrees for radians", |s, _| s.degrees(true)),
    ("radians for degrees", |s, _| s.degrees(false)),
    ("degrees in one recording", |s, r| {
        let has = s.logs.len() > 1 && !s.declared.degrees && s.declared.gear_ratio.is_none();
        has.then(|| s.degrees_in(r.index(s.logs.len()))).flatten()
    }),
    ("gears not stated", |s, r| {
        (!s.declared.degrees).then(|| s.gears(r.between(30.0, 160.0).round())).flatten()
    }),
    ("stamps in ms", |s, _| s.milliseconds()),
    ("seconds for ms", |s, _| s.seconds()),
    ("clock too fast or too slow", |s, r| s.clock([2.0, 0.5, 4.0, 0.25, 10.0][r.index(5)])),
    ("currents in mA", |s, _| s.milliampere()),
    ("torques in Nmm", |s, _| s.newton_millimetres()),
    ("torque constants of two joints exchanged", |s, r| s.constants_exchanged(two(s, r))),
    ("torque constant ten times off", |s, r| {
        let joint = r.index(s.joints());
        s.constant(joint, if r.chance(0.5) { 10.0 } else { 0.1 })
    }),
    ("torque constant with the other sign", |s, r| s.constant_sign(r.index(s.joints()))),
    ("measurements late", |s, r| {
        let delay_s = r.between(0.08, 0.4);
        // One is drawn for all too.
        r.index(s.logs.len());
        s.delay(delay_s, None)
    }),
    ("measurements late in one recording", |s, r| {
        let delay_s = (s.logs.len() > 1).then(|| r.between(0.08, 0.4))?;
        s.delay(delay_s, Some(r.index(s.logs.len())))
    }),
    ("columns one too far", |s, r| s.one_too_far(if r.chance(0.5) { Positions } else { Measurements })),
    ("column of another joint", |s, r| {
        let joints = two(s, r);
        s.copied(if r.chance(0.5) { Positions } else { Measurements }, joints)
    }),
    ("`mdh_rows` the other way", |s, _| s.mdh_rows()),
    ("table: a and d, lengths, order or alpha wrong", |s, r| {
        if s.geometry != Geometry::Table {
            return None;
        }
        match r.index(4) {
            0 => s.exchanged_lengths(),
            1 => s.lengths(100.0),
            2 => s.from_tip_rows(),
            _ => s.mirrored(),
        }
    }),
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

pub fn tells(text: &str, cures: &[Vec<String>]) -> bool {
    cures.iter().any(|cure| cure.iter().all(|word| text.contains(word.as_str())))
}

fn two(setup: &Setup, random: &mut Random) -> [usize; 2] {
    let first = random.index(setup.joints() - 1);
    [first, first + 1 + random.index(setup.joints() - 1 - first)]
}

/// A mistake without joint or size.
pub fn told(cures: &[&[&str]]) -> Made {
    detailed("", cures)
}

fn detailed(detail: &str, cures: &[&[&str]]) -> Made {
    let words = |cure: &&[&str]| cure.iter().map(|word| (*word).to_owned()).collect();
    Some((detail.to_owned(), cures.iter().map(words).collect()))
}

pub fn scale<'s>(all: impl IntoIterator<Item = &'s mut Vec<f64>>, factor: f64) {
    all.into_iter().flatten().for_each(|v| *v *= factor);
}

const ANGLES: &[&[&str]] = &[&["angle"], &["gear_ratio"], &["counts_per_revolution"]];

impl Setup {
    fn called(&self, joints: &[usize]) -> String {
        RobotNames::of_joints(&self.joint_names()).joint_list(joints)
    }

    pub fn each(&mut self, change: impl Fn(&mut Log)) {
        self.logs.iter_mut().for_each(change);
    }

    pub fn zero(&mut self, joint: usize, offset_rad: f64) -> Made {
        self.each(|log| log.position_rad[joint].iter_mut().for_each(|q| *q += offset_rad));
        let zero = format!("zero of {}", self.called(&[joint]));
        let detail = format!("joint {joint}, {:.0}°", offset_rad.to_degrees());
        detailed(&detail, &[&["theta", &format!("row {joint}")], &[&zero]])
    }

    pub fn sign(&mut self, of: Columns, joint: usize) -> Made {
        self.each(|log| scale(log.families(of).map(|family| &mut family[joint]), -1.0));
        detailed(&format!("joint {joint}"), &[&[&self.called(&[joint]), "sign"]])
    }

    pub fn all_signs(&mut self) -> Made {
        self.each(|log| scale(&mut log.measurement, -1.0));
        told(&[&["gains of -1 for all joints"], &["check the signs"]])
    }

    pub fn exchanged(&mut self, of: Columns, [a, b]: [usize; 2]) -> Made {
        self.each(|log| log.families(of).for_each(|family| family.swap(a, b)));
        detailed(&format!("joints {a} and {b}"), &[&[&format!("{} exchanged", self.called(&[a, b]))]])
    }

    pub fn from_tip(&mut self) -> Made {
        self.each(|log| log.families(Both).for_each(|family| family.reverse()));
        told(if self.joints() == 2 { &[&["exchanged"]] } else { &[&["tip first"]] })
    }

    fn other_robot(&mut self, random: &mut Random, family: bool) -> Made {
        let Geometry::Name(own) = &self.geometry else { return None };
        let others: &[&str] = match (own.as_str(), family) {
            ("ur5e", true) => &["ur3e", "ur10e", "ur16e"],
            ("ur10e", true) => &["ur3e", "ur5e", "ur16e"],
            ("panda", true) => return None,
            ("panda", false) => &["gen3", "iiwa14", "xarm7"],
            _ => &["irb120", "kr6_r700", "tx2_60", "xarm6"],
        };
        let other = others[random.index(others.len())];
        let made = detailed(&format!("{other} for {own}"), &[&[&format!("`name` to \"{own}\"")]]);
        self.geometry = Geometry::Name(other.to_owned());
        made
    }

    pub fn gravity(&mut self, to_m_s2: [f64; 3]) -> Made {
        let own = std::mem::replace(&mut self.gravity_m_s2, to_m_s2);
        // The opposite of what stands may be what stood.
        let along = own.iter().filter(|v| **v != 0.0).count() == 1;
        if own == to_m_s2 || !along {
            return None;
        }
        let cure = format!("`gravity_m_s2` to [{}, {}, {}]", own[0], own[1], own[2]);
        detailed(&format!("{to_m_s2:?}"), &[&[&cure]])
    }

    pub fn degrees(&mut self, written: bool) -> Made {
        if self.declared.gear_ratio.is_some() {
            return None;
        }
        self.declared.degrees = !written;
        self.each(|log| log.units.degrees = written);
        told(ANGLES)
    }

    pub fn degrees_in(&mut self, log: usize) -> Made {
        self.logs[log].units.degrees = true;
        detailed(&file_name(log), &[&[&file_name(log), "angle"]])
    }

    pub fn gears(&mut self, ratio: f64) -> Made {
        self.declared.gear_ratio = None;
        self.each(|log| log.units.gear_ratio = Some(ratio));
        detailed(&format!("{ratio}"), ANGLES)
    }

    pub fn milliseconds(&mut self) -> Made {
        self.declared.milliseconds = false;
        self.each(|log| log.units.milliseconds = true);
        told(&[&["time = \"ms\""]])
    }

    pub fn seconds(&mut self) -> Made {
        self.declared.milliseconds = true;
        self.each(|log| log.units.milliseconds = false);
        told(&[&["`time"], &["time ="]])
    }

    fn clock(&mut self, factor: f64) -> Made {
        self.each(|log| scale([&mut log.time_s], factor));
        detailed(&format!("{factor}"), &[&["multiply the stamps"], &["rate_hz"]])
    }

    pub fn milliampere(&mut self) -> Made {
        if self.unit != MeasurementUnit::Ampere {
            return None;
        }
        self.declared.milliampere = false;
        self.each(|log| log.units.milliampere = true);
        told(&[&["current = \"mA\""]])
    }

    fn newton_millimetres(&mut self) -> Made {
        if self.unit != MeasurementUnit::NewtonMetre {
            return None;
        }
        self.each(|log| scale(&mut log.measurement, 1e3));
        told(&[&["Nmm"]])
    }

    fn constants_exchanged(&mut self, [a, b]: [usize; 2]) -> Made {
        let constants = self.constants_nm_per_a.as_mut()?;
        if (0.8..1.25).contains(&(constants[a] / constants[b])) {
            return None;
        }
        constants.swap(a, b);
        let cure = format!("the torque constants of {}", self.called(&[a, b]));
        detailed(&format!("joints {a} and {b}"), &[&[&cure]])
    }

    pub fn constant(&mut self, joint: usize, factor: f64) -> Made {
        self.constants_nm_per_a.as_mut()?[joint] *= factor;
        detailed(&format!("joint {joint}, {factor}"), &[&[&self.called(&[joint]), "constant"]])
    }

    pub fn constant_sign(&mut self, joint: usize) -> Made {
        self.constants_nm_per_a.as_mut()?[joint] *= -1.0;
        detailed(&format!("joint {joint}"), &[&[&self.called(&[joint]), "sign"]])
    }

    /// Measurements of a recording, or of all, come so much late.
    pub fn delay(&mut self, delay_s: f64, one: Option<usize>) -> Made {
        for (_, log) in self.logs.iter_mut().enumerate().filter(|(k, _)| one.is_none_or(|one| *k == one)) {
            let period_s = (log.time_s[log.time_s.len() - 1] - log.time_s[0]) / (log.time_s.len() - 1) as f64;
            let rows = (delay_s / period_s).round() as usize;
            for series in &mut log.measurement {
                let before = series.clone();
                for (k, value) in series.iter_mut().enumerate() {
                    *value = before[k.saturating_sub(rows)];
                }
            }
        }
        let file = one.map_or_else(String::new, file_name);
        detailed(&format!("{:.0} ms", 1e3 * delay_s), &[&["delay_s", &file]])
    }

    /// Positions from the second on, and the first measurement; or the last position before the measurements.
    fn one_too_far(&mut self, of: Columns) -> Made {
        let joints = self.joints();
        if of == Positions {
            self.columns = Some([2, 1 + joints]);
            return detailed("positions", &[&["positions", "order"], &["columns"]]);
        }
        self.columns = Some([1, joints]);
        detailed("measurements", &[&["columns"]])
    }

    /// The column of one joint instead of another's.
    pub fn copied(&mut self, of: Columns, [a, b]: [usize; 2]) -> Made {
        self.each(|log| {
            let family = if of == Positions { &mut log.position_rad } else { &mut log.measurement };
            family[b] = family[a].clone();
        });
        let of = if of == Positions { "position" } else { "measurement" };
        let cure = format!("{} are the same column", self.called(&[a, b]));
        detailed(&format!("{of} of joint {b}"), &[&[&cure]])
    }

    pub fn mdh_rows(&mut self) -> Made {
        if self.geometry != Geometry::Table {
            return None;
        }
        self.robot_lines.push("mdh_rows = \"previous\"".into());
        told(&[&["`mdh_rows` to \"next\""]])
    }

    /// A change of a table; nothing if it changes none.
    fn table(&mut self, change: impl Fn(&mut Vec<MdhRow>), detail: &str, cures: &[&[&str]]) -> Made {
        let before = self.mdh.clone();
        change(&mut self.mdh);
        if self.mdh == before { None } else { detailed(detail, cures) }
    }

    pub fn exchanged_lengths(&mut self) -> Made {
        let change =
            |rows: &mut Vec<MdhRow>| rows.iter_mut().for_each(|r| std::mem::swap(&mut r.a_m, &mut r.d_m));
        self.table(change, "a and d exchanged", &[&["a and d", "exchange"]])
    }

    pub fn lengths(&mut self, factor: f64) -> Made {
        let row = |r: &mut MdhRow| (r.a_m, r.d_m) = (factor * r.a_m, factor * r.d_m);
        let cures: &[&[&str]] =
            &[&["multiply the columns a and d", &format!("{}", 1.0 / factor)], &["metres"]];
        self.table(|rows| rows.iter_mut().for_each(row), "lengths in cm", cures)
    }

    pub fn from_tip_rows(&mut self) -> Made {
        self.table(|rows| rows.reverse(), "rows from the tip", &[&["order of the rows"]])
    }

    pub fn mirrored(&mut self) -> Made {
        let cures: &[&[&str]] = &[&["signs of the column alpha"], &["gravity_m_s2"]];
        let change = |rows: &mut Vec<MdhRow>| rows.iter_mut().for_each(|r| r.alpha_rad = -r.alpha_rad);
        self.table(change, "alpha with the other sign", cures)
    }
}

//! The usual mistakes, the likelier first: of two that explain the data alike the earlier one is told.

use std::f64::consts::{FRAC_PI_2, PI};

use aurt_rbd::robots::KNOWN_ROBOTS;
use aurt_rbd::{Joint, JointKind, MdhRow, MdhRows, MdhTable, RobotDescription};
use aurt_traits::MeasurementUnit;

use super::mistake::{Columns, Mistake, Reading, Table, exchanged, pairs};
use super::setup::{Setup, Subject};

pub const EARTH_M_S2: f64 = 9.81;
/// A gravity as large as this is left at its size.
const EARTHLY_M_S2: [f64; 2] = [9.7, 9.9];
const GEAR_RATIOS: [f64; 8] = [30.0, 50.0, 80.0, 100.0, 101.0, 120.0, 160.0, 200.0];
const DELAYS_S: [f64; 10] = [0.02, 0.04, 0.06, 0.08, 0.1, 0.15, 0.2, 0.3, 0.5, 1.0];
/// Ratios of rates of loggers.
const RATES: [f64; 6] = [2.0, 0.5, 4.0, 0.25, 10.0, 0.1];
/// Units and constants of measurements.
const GAINS: [f64; 6] = [1e-3, 1e3, 0.1, 10.0, 0.01, 100.0];

/// All mistakes that are tried first, those of the robot before those of recordings.
pub fn usual(subject: &Subject, setup: &Setup) -> Vec<Mistake> {
    let mut mistakes = directions(setup.gravity_m_s2);
    mistakes.extend(tables(subject, &setup.joints));
    let mut readings = readings(setup.moving_joints());
    readings.extend(constants(subject));
    mistakes.extend(readings.into_iter().map(|what| Mistake::Reading { what, file: None }));
    // The zero of a joint that others follow is theirs too.
    if setup.couplings.is_empty() {
        mistakes.extend(zeros(&setup.joints, subject.table.is_some()));
    }
    mistakes
}

/// What a single recording of several can have that others have not.
pub fn of_file(joints: usize, file: usize) -> Vec<Mistake> {
    let single = |r: &Reading| {
        !matches!(r, Reading::Order { .. } | Reading::Gain { .. } | Reading::Geared(_) | Reading::Time(_))
    };
    let readings = readings(joints).into_iter().filter(single);
    readings.map(|what| Mistake::Reading { what, file: Some(file) }).collect()
}

/// Whether a mistake is usual enough to be tried as the second of two.
pub fn is_likely(mistake: &Mistake) -> bool {
    match mistake {
        Mistake::Gravity { to_m_s2 } => to_m_s2.iter().filter(|v| **v != 0.0).count() == 1,
        Mistake::Geometry { what, .. } => matches!(what, Table::Rows(_)),
        Mistake::Reading { what, .. } => match what {
            Reading::Degrees | Reading::PositionSign(_) | Reading::MeasurementSign(_) => true,
            Reading::Order { of, order } => {
                *of != Columns::Position
                    && (order.iter().rev().copied().eq(0..order.len()) || is_neighbours(order))
            }
            Reading::Turns
            | Reading::Geared(_)
            | Reading::AxisSign(_)
            | Reading::AllMeasurementSigns
            | Reading::Delay(_)
            | Reading::Time(_)
            | Reading::Gain { .. }
            | Reading::Constants { .. }
            | Reading::During { .. } => false,
        },
    }
}

fn is_neighbours(order: &[usize]) -> bool {
    let moved: Vec<usize> = (0..order.len()).filter(|j| order[*j] != *j).collect();
    matches!(moved[..], [a, b] if b == a + 1)
}

/// Gravity along the axes and halfway between them.
fn directions(now: [f64; 3]) -> Vec<Mistake> {
    let size = now.iter().map(|g| g * g).sum::<f64>().sqrt();
    let size = if (EARTHLY_M_S2[0]..=EARTHLY_M_S2[1]).contains(&size) { size } else { EARTH_M_S2 };
    let steps = [0.0, -1.0, 1.0];
    let mut directions: Vec<[f64; 3]> = Vec::new();
    for z in steps {
        for y in steps {
            directions.extend(steps.map(|x| [x, y, z]));
        }
    }
    directions.retain(|d| d.iter().any(|v| *v != 0.0));
    // Upside down is the likeliest.
    let is_opposite =
        |d: &[f64; 3]| size > 0.0 && d.iter().zip(&now).all(|(d, g)| (d * size + g).abs() < 1e-6);
    directions.sort_by_key(|d| (!is_opposite(d), d.iter().filter(|v| **v != 0.0).count()));
    let to = |d: [f64; 3]| {
        let length = d.iter().map(|v| v * v).sum::<f64>().sqrt();
        d.map(|v| if v == 0.0 { 0.0 } else { size * v / length })
    };
    let differs = |g: &[f64; 3]| g.iter().zip(&now).any(|(a, b)| (a - b).abs() > 1e-6);
    let mut mistakes: Vec<[f64; 3]> = directions.into_iter().map(to).filter(differs).collect();
    if now != [0.0; 3] {
        mistakes.push([0.0; 3]);
    }
    mistakes.into_iter().map(|to_m_s2| Mistake::Gravity { to_m_s2 }).collect()
}

fn tables(subject: &Subject, now: &[Joint]) -> Vec<Mistake> {
    let mut tables: Vec<(Table, Vec<Joint>)> = Vec::new();
    if let Some(table) = &subject.table {
        let other = match table.reading {
            MdhRows::Next => MdhRows::Previous,
            MdhRows::Previous => MdhRows::Next,
        };
        tables.push((Table::Rows(other), MdhTable { reading: other, ..table.clone() }.joints()));
        let changed = |change: &dyn Fn(&mut MdhTable)| {
            let mut table = table.clone();
            change(&mut table);
            table.joints()
        };
        let of_rows = |change: &dyn Fn(&mut MdhRow)| changed(&|t| t.rows.iter_mut().for_each(change));
        for factor in [1e-3, 1e-2, 1e-1, 10.0, 100.0, 1e3] {
            let scaled = of_rows(&|row| (row.a_m, row.d_m) = (row.a_m * factor, row.d_m * factor));
            tables.push((Table::Lengths(factor), scaled));
        }
        tables.extend([
            (Table::Reversed, changed(&|t| t.rows.reverse())),
            (Table::Exchanged, of_rows(&|row| std::mem::swap(&mut row.a_m, &mut row.d_m))),
            (Table::Mirrored, of_rows(&|row| row.alpha_rad = -row.alpha_rad)),
        ]);
    }
    if subject.name.is_some() {
        for robot in KNOWN_ROBOTS.iter().filter(|r| r.joints() == now.len()) {
            if let Ok(chain) = robot.description().chain([0.0; 3]) {
                tables.push((Table::Known(&robot.name), chain.joints().to_vec()));
            }
        }
    }
    tables.retain(|(_, joints)| joints.as_slice() != now);
    tables.into_iter().map(|(what, joints)| Mistake::Geometry { what, joints }).collect()
}

fn zeros(joints: &[Joint], in_table: bool) -> Vec<Mistake> {
    let turning = (0..joints.len()).filter(|j| joints[*j].kind == JointKind::Revolute);
    let offsets = turning.flat_map(|joint| [FRAC_PI_2, -FRAC_PI_2, PI].map(|offset_rad| (joint, offset_rad)));
    offsets
        .map(|(joint, offset_rad)| Mistake::Geometry {
            what: Table::Zero { joint, offset_rad, in_table },
            joints: Vec::new(),
        })
        .collect()
}

fn readings(joints: usize) -> Vec<Reading> {
    let mut readings = vec![Reading::Degrees, Reading::Turns, Reading::AllMeasurementSigns];
    readings.extend((0..joints).map(Reading::MeasurementSign));
    readings.extend((0..joints).map(Reading::PositionSign));
    readings.extend((0..joints).map(Reading::AxisSign));
    for of in [Columns::Both, Columns::Measurement, Columns::Position] {
        readings.extend(orders(joints).into_iter().map(|order| Reading::Order { of, order }));
    }
    readings.extend(DELAYS_S.iter().flat_map(|d| [Reading::Delay(*d), Reading::Delay(-*d)]));
    readings.extend(GEAR_RATIOS.map(Reading::Geared));
    readings.extend(RATES.map(Reading::Time));
    readings.extend((0..joints).flat_map(|joint| GAINS.map(|factor| Reading::Gain { joint, factor })));
    readings
}

/// Torque constants that turn currents into torques, of every two joints with different ones.
fn constants(subject: &Subject) -> Vec<Reading> {
    let is_current = subject.recordings.iter().any(|r| r.loaded.recording.unit == MeasurementUnit::Ampere);
    let constants = subject.instrument.torque_constants_nm_per_a.as_deref().filter(|_| is_current);
    let constants = constants.unwrap_or_default();
    pairs(constants.len())
        .map(|[a, b]| Reading::Constants { joints: [a, b], factor: constants[b] / constants[a] })
        .filter(|r| !matches!(r, Reading::Constants { factor, .. } if *factor == 1.0))
        .collect()
}

/// Tip first, shifted by one to either side, two exchanged.
fn orders(joints: usize) -> Vec<Vec<usize>> {
    let plain: Vec<usize> = (0..joints).collect();
    let rotated = |by: usize| (0..joints).map(|j| (j + by) % joints).collect::<Vec<_>>();
    let mut orders: Vec<Vec<usize>> = pairs(joints).map(|pair| exchanged(&plain, pair)).collect();
    for order in [plain.iter().rev().copied().collect(), rotated(1), rotated(joints.saturating_sub(1))] {
        if order != plain && !orders.contains(&order) {
            orders.push(order);
        }
    }
    orders
}

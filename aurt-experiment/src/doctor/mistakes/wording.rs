//! What is said of mistakes, and what undoes them.

use aurt_rbd::MdhRows;
use aurt_report::rendering::number::significant;
use aurt_report::rendering::text::capital;
use aurt_traits::RobotNames;

use super::found::Step;
use super::mistake::{Columns, Mistake, Reading, Table};
use super::trial::Score;

/// Of what explains the data as well, how many are told by name.
const TOLD: usize = 2;

/// An error in percent of the measurement: `7 %`.
pub fn percent(error: f64) -> String {
    let percent = 100.0 * error;
    if percent < 9.95 { format!("{percent:.1} %") } else { format!("{percent:.0} %") }
}

/// What a step found, by how much it helps, and what to change.
pub fn sentence(step: &Step, before: Option<&Score>, files: &[String], names: RobotNames<'_>) -> String {
    let [seems, order] = said(&step.mistake, files, names);
    let after = percent(step.after.total);
    let of_total = || {
        before.map_or_else(
            || format!("without it nothing can be fitted, with it the error is {after}"),
            |b| format!("error {} → {after}", percent(b.total)),
        )
    };
    // With friction that grows with the load, and where joints move; the error of the other trials hardly shows it.
    let error = step.likelier.map_or_else(of_total, |factor| {
        let less = 100.0 * (1.0 - factor);
        format!("where joints move, recordings are predicted from each other with an error that is {less:.0} % smaller")
    });
    let error = step.own.map_or(error, |own| {
        let [before, after] = own.map(percent);
        format!("of this recording, error {before} → {after}")
    });
    let mut alike: Vec<String> = step.alike.iter().take(TOLD).map(|other| undone(other, names)).collect();
    if step.alike.len() > TOLD {
        alike.push(format!("{} more", step.alike.len() - TOLD));
    }
    let or = if alike.is_empty() {
        String::new()
    } else {
        format!(" As well explained by: {}.", alike.join("; "))
    };
    format!("{seems}: {error}. {}.{or}", capital(&order))
}

/// A list of numbers as an experiment writes it.
pub fn list(values: &[f64]) -> String {
    let numbers: Vec<String> = values.iter().map(|v| number(*v)).collect();
    format!("[{}]", numbers.join(", "))
}

pub fn number(value: f64) -> String {
    let rounded = (value * 1e4).round() / 1e4;
    if rounded == 0.0 || value.abs() < 1e-2 { significant(value, 4) } else { format!("{rounded}") }
}

/// The cure of a mistake, as an order without its full stop.
pub fn undone(mistake: &Mistake, names: RobotNames<'_>) -> String {
    let [_, order] = said(mistake, &[], names);
    order
}

/// A mistake as it shows and its cure: a sentence and an order, both without a full stop.
fn said(mistake: &Mistake, files: &[String], names: RobotNames<'_>) -> [String; 2] {
    match mistake {
        Mistake::Gravity { to_m_s2 } => {
            let seems = match axis(*to_m_s2) {
                Some(axis) => format!("Gravity seems to point along {axis}"),
                None if *to_m_s2 == [0.0; 3] => {
                    "Gravity seems to be compensated, or the base to lie so that none acts".into()
                }
                None => format!("Gravity seems to be {} m/s² in the base frame", list(to_m_s2)),
            };
            [seems, format!("change `gravity_m_s2` to {}", list(to_m_s2))]
        }
        Mistake::Geometry { what, .. } => of_table(what, names),
        Mistake::Reading { what, file } => {
            let file = file.and_then(|f| files.get(f));
            let of = file.map_or_else(String::new, |name| format!(" in {name}"));
            let Reading::During { what, span_s } = what else { return of_reading(what, &of, names) };
            let stretch = stretch(*span_s);
            let [seems, _] = of_reading(what, &format!("{of}{stretch}"), names);
            [seems, format!("correct the recording{stretch}, or leave the stretch out with `window_s`")]
        }
    }
}

fn of_table(what: &Table, names: RobotNames<'_>) -> [String; 2] {
    match what {
        Table::Rows(rows) => {
            let to = if *rows == MdhRows::Next { "next" } else { "previous" };
            [
                "The rows of the table seem to lead to the other joint".into(),
                format!("change `mdh_rows` to \"{to}\""),
            ]
        }
        Table::Lengths(factor) => [
            format!("The lengths of the table seem to be {} too large", times(1.0 / factor)),
            format!("multiply the columns a and d of the table by {}", number(*factor)),
        ],
        Table::Reversed => [
            "The rows of the table seem to stand from tip to base".into(),
            "turn the order of the rows of the table round".into(),
        ],
        Table::Exchanged => [
            "The columns a and d of the table seem to be exchanged".into(),
            "exchange the names of the columns a and d in the header of the table".into(),
        ],
        Table::Mirrored => [
            "The column alpha of the table seems to have the other sign".into(),
            "turn the signs of the column alpha of the table".into(),
        ],
        Table::Known(name) => {
            [format!("The robot seems to be a {name}"), format!("change `name` to \"{name}\"")]
        }
        Table::Zero { joint, offset_rad, in_table } => {
            let name = names.joint(*joint);
            let order = if *in_table {
                format!("add {offset_rad:.4} rad to the column theta of row {joint} of the table")
            } else {
                format!(
                    "turn the `origin` of {name} by {offset_rad:.4} rad about its axis in the robot's description, or add this to its \
                     position"
                )
            };
            [format!("The zero of {name} seems to lie {:.0}° off", offset_rad.to_degrees()), order]
        }
    }
}

/// The words for a reading; `of` says of which recording and stretch it is.
fn of_reading(what: &Reading, of: &str, names: RobotNames<'_>) -> [String; 2] {
    match what {
        Reading::Degrees => [
            format!("Positions{of} seem to be in degrees"),
            "write `angle = \"deg\"` in `[recordings]`".into(),
        ],
        Reading::Turns => [
            format!("Positions{of} seem to be in turns"),
            "write `counts_per_revolution = 1` in `[recordings]`".into(),
        ],
        Reading::Geared(ratio) => {
            let ratio = number(*ratio);
            [
                format!("Positions{of} seem to be those of the motors, behind gears of about {ratio}"),
                format!("write the drives' `gear_ratio`, about {ratio}, in `[recordings]`"),
            ]
        }
        Reading::PositionSign(joint) => {
            let name = names.joint(*joint);
            [
                format!("The position of {name}{of} seems to have the other sign"),
                format!(
                    "write a `gear_ratio` of -1 for {name} in `[recordings]`, or turn its axis round in the robot's description (`sign` \
                     -1 in an MDH table, `axis` in a URDF file)"
                ),
            ]
        }
        Reading::AxisSign(joint) => {
            let name = names.joint(*joint);
            [
                format!("The position and the measurement of {name}{of} seem to have the other sign"),
                format!(
                    "turn the axis of {name} round in the robot's description (`sign` -1 in an MDH table, `axis` in a URDF file), or \
                     write a `gear_ratio` of -1 in `[recordings]` and a gain of -1 as `gains` of `[instrument]` for {name}"
                ),
            ]
        }
        Reading::MeasurementSign(joint) => {
            let name = names.joint(*joint);
            [
                format!("The measurement of {name}{of} seems to have the other sign"),
                format!("write a gain of -1 for {name} as `gains` of `[instrument]`"),
            ]
        }
        Reading::AllMeasurementSigns => [
            format!("All measurements{of} seem to have the other sign"),
            "write gains of -1 for all joints as `gains` of `[instrument]`".into(),
        ],
        Reading::Order { of: columns, order } => {
            let (columns, now) = (columns_of(*columns), permutation(order, names));
            [
                format!("The {columns}{of} seem to stand in another order, {now}"),
                format!("list the {columns} in the order {order:?} of the joints now, with `columns`"),
            ]
        }
        Reading::Delay(delay) => {
            let [late, early] =
                if *delay > 0.0 { ["Measurements", "positions"] } else { ["Positions", "measurements"] };
            [
                format!("{late}{of} seem to lag {:.0} ms behind {early}", 1e3 * delay.abs()),
                format!(
                    "write {} for every joint as `delay_s` of `[instrument]`, or record both with one clock",
                    number(*delay)
                ),
            ]
        }
        Reading::Time(factor) => [
            format!("The clock{of} seems to run {}", if *factor > 1.0 { "too fast" } else { "too slowly" }),
            format!(
                "multiply the stamps by {}: look at the rate of the logger, and write it as `rate_hz` in `[recordings]`",
                number(*factor)
            ),
        ],
        Reading::Gain { joint, factor } => {
            let name = names.joint(*joint);
            let (size, way) = if *factor < 1.0 { (1.0 / factor, "large") } else { (*factor, "small") };
            let factor = number(*factor);
            [
                format!("The measurement of {name}{of} seems to be {} too {way}", times(size)),
                format!(
                    "write a gain of {factor} for {name} as `gains` of `[instrument]`, or correct its torque constant"
                ),
            ]
        }
        Reading::Constants { joints, .. } => {
            let joints = names.joint_list(joints);
            [
                format!("The torque constants of {joints} seem to be exchanged"),
                format!("exchange the torque constants of {joints} in `torque_constants_nm_per_a`"),
            ]
        }
        Reading::During { what, .. } => of_reading(what, of, names),
    }
}

fn columns_of(columns: Columns) -> &'static str {
    match columns {
        Columns::Position => "positions",
        Columns::Measurement => "measurements",
        Columns::Both => "columns of positions and measurements",
    }
}

fn permutation(order: &[usize], names: RobotNames<'_>) -> String {
    let joints = order.len();
    let moved: Vec<usize> = (0..joints).filter(|j| order[*j] != *j).collect();
    let is_rotated = |by: usize| (0..joints).all(|j| order[j] == (j + by) % joints);
    match moved[..] {
        [_, _] => format!("{} exchanged", names.joint_list(&moved)),
        _ if order.iter().rev().copied().eq(0..order.len()) => "tip first".into(),
        _ if is_rotated(1) => "the last joint first".into(),
        _ if is_rotated(joints - 1) => "the first joint last".into(),
        _ => {
            // The place of joint j in the file is order[j].
            let in_file = (0..joints).filter_map(|place| order.iter().position(|p| *p == place));
            names.joint_list(&in_file.collect::<Vec<_>>())
        }
    }
}

/// ` from 15.0 s on`, ` up to 15.0 s`, ` from 15.0 s to 22.5 s` after the first stamp.
fn stretch(span_s: [Option<f64>; 2]) -> String {
    match span_s {
        [Some(from), Some(to)] => format!(" from {from:.1} s to {to:.1} s after its first stamp"),
        [Some(from), None] => format!(" from {from:.1} s after its first stamp on"),
        [None, Some(to)] => format!(" up to {to:.1} s after its first stamp"),
        [None, None] => String::new(),
    }
}

fn times(factor: f64) -> String {
    format!("{} times", significant(factor, 3))
}

fn axis(vector: [f64; 3]) -> Option<String> {
    let along: Vec<usize> = (0..3).filter(|k| vector[*k] != 0.0).collect();
    let [one] = along[..] else { return None };
    Some(format!("{}{}", if vector[one] > 0.0 { '+' } else { '-' }, ["x", "y", "z"][one]))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn joints_with_names_are_called_by_them() {
        let own = ["base", "elbow", "wrist"].map(str::to_owned);
        let names = RobotNames::of_joints(&own);
        let reading = |what| Mistake::Reading { what, file: None };
        for (what, seen, cure) in [
            (Reading::PositionSign(1), "The position of elbow seems", "-1 for elbow"),
            (Reading::Gain { joint: 2, factor: 2.0 }, "The measurement of wrist seems", "for wrist as"),
        ] {
            let [seems, order] = said(&reading(what.clone()), &[], names);
            assert!(seems.contains(seen) && order.contains(cure), "{seems} {order}");
            let [nameless, _] = said(&reading(what), &[], RobotNames::default());
            assert!(nameless.contains("of joint "), "{nameless}");
        }
    }
}

//! What is said of mistakes, and what undoes them.

use aurt_rbd::MdhRows;
use aurt_report::rendering::number::significant;
use aurt_traits::RobotNames;

use super::{
    found::Step,
    mistake::{Columns, Mistake, Reading, Table},
    trial::Score,
};

/// Of what explains the data as well, how many are told by name.
const TOLD: usize = 2;

/// An error in percent of the measurement: `7 %`.
pub fn percent(error: f64) -> String {
    let percent = 100.0 * error;
    if percent < 9.95 { format!("{percent:.1} %") } else { format!("{percent:.0} %") }
}

/// What a step found, by how much it helps, and what to change.
pub fn sentence(step: &Step, before: Option<&Score>, files: &[String], names: RobotNames<'_>) -> String {
    let seems = seems(&step.mistake, files, names);
    let of_total = || {
        before.map_or_else(
            || {
                format!(
                    "without it nothing can be fitted, with it the error is {}",
                    percent(step.after.total)
                )
            },
            |b| format!("error {} → {}", percent(b.total), percent(step.after.total)),
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
    format!("{seems}: {error}. {}.{or}", capital(&undone(&step.mistake, names)))
}

fn capital(text: &str) -> String {
    let mut letters = text.chars();
    letters.next().map_or_else(String::new, |first| first.to_uppercase().chain(letters).collect())
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

/// What seems to be the case, as a sentence without its full stop.
fn seems(mistake: &Mistake, files: &[String], names: RobotNames<'_>) -> String {
    match mistake {
        Mistake::Gravity { to_m_s2 } => match axis(*to_m_s2) {
            Some(axis) => format!("Gravity seems to point along {axis}"),
            None if *to_m_s2 == [0.0; 3] => {
                "Gravity seems to be compensated, or the base to lie so that none acts".into()
            }
            None => format!("Gravity seems to be {} m/s² in the base frame", list(to_m_s2)),
        },
        Mistake::Geometry { what, .. } => match what {
            Table::Rows(_) => "The rows of the table seem to lead to the other joint".into(),
            Table::Lengths(factor) => {
                format!("The lengths of the table seem to be {} too large", times(1.0 / factor))
            }
            Table::Reversed => "The rows of the table seem to stand from tip to base".into(),
            Table::Exchanged => "The columns a and d of the table seem to be exchanged".into(),
            Table::Mirrored => "The column alpha of the table seems to have the other sign".into(),
            Table::Known(name) => format!("The robot seems to be a {name}"),
            Table::Zero { joint, offset_rad, .. } => {
                format!(
                    "The zero of {} seems to lie {:.0}° off",
                    names.joint(*joint),
                    offset_rad.to_degrees()
                )
            }
        },
        Mistake::Reading { what, file } => {
            let (what, span_s) = match what {
                Reading::During { what, span_s } => (&**what, *span_s),
                what => (what, [None, None]),
            };
            let mut of =
                file.and_then(|f| files.get(f)).map_or_else(String::new, |name| format!(" in {name}"));
            of.push_str(&stretch(span_s));
            match what {
                Reading::Degrees => format!("Positions{of} seem to be in degrees"),
                Reading::Turns => format!("Positions{of} seem to be in turns"),
                Reading::Geared(ratio) => {
                    format!(
                        "Positions{of} seem to be those of the motors, behind gears of about {}",
                        number(*ratio)
                    )
                }
                Reading::PositionSign(joint) => {
                    format!("The position of {}{of} seems to have the other sign", names.joint(*joint))
                }
                Reading::AxisSign(joint) => {
                    format!(
                        "The position and the measurement of {}{of} seem to have the other sign",
                        names.joint(*joint)
                    )
                }
                Reading::MeasurementSign(joint) => {
                    format!("The measurement of {}{of} seems to have the other sign", names.joint(*joint))
                }
                Reading::AllMeasurementSigns => format!("All measurements{of} seem to have the other sign"),
                Reading::Order { of: columns, order } => {
                    format!(
                        "The {}{of} seem to stand in another order, {}",
                        columns_of(*columns),
                        permutation(order, names)
                    )
                }
                Reading::Delay(delay) if *delay > 0.0 => {
                    format!("Measurements{of} seem to lag {:.0} ms behind positions", 1e3 * delay)
                }
                Reading::Delay(delay) => {
                    format!("Positions{of} seem to lag {:.0} ms behind measurements", -1e3 * delay)
                }
                Reading::Time(factor) => {
                    format!(
                        "The clock{of} seems to run {}",
                        if *factor > 1.0 { "too fast" } else { "too slowly" }
                    )
                }
                Reading::Gain { joint, factor } => format!(
                    "The measurement of {}{of} seems to be {} too {}",
                    names.joint(*joint),
                    times(if *factor < 1.0 { 1.0 / factor } else { *factor }),
                    if *factor < 1.0 { "large" } else { "small" }
                ),
                Reading::Constants { joints, .. } => {
                    format!("The torque constants of {} seem to be exchanged", names.joint_list(joints))
                }
                Reading::During { .. } => format!("Measurements{of} seem to be others"),
            }
        }
    }
}

/// What to do about it, as an order without its full stop.
pub fn undone(mistake: &Mistake, names: RobotNames<'_>) -> String {
    match mistake {
        Mistake::Gravity { to_m_s2 } => format!("change `gravity_m_s2` to {}", list(to_m_s2)),
        Mistake::Geometry { what, .. } => match what {
            Table::Rows(MdhRows::Next) => "change `mdh_rows` to \"next\"".into(),
            Table::Rows(MdhRows::Previous) => "change `mdh_rows` to \"previous\"".into(),
            Table::Lengths(factor) => {
                format!("multiply the columns a and d of the table by {}", number(*factor))
            }
            Table::Reversed => "turn the order of the rows of the table round".into(),
            Table::Exchanged => "exchange the names of the columns a and d in the header of the table".into(),
            Table::Mirrored => "turn the signs of the column alpha of the table".into(),
            Table::Known(name) => format!("change `name` to \"{name}\""),
            Table::Zero { joint, offset_rad, in_table: true } => {
                format!("add {offset_rad:.4} rad to the column theta of row {joint} of the table")
            }
            Table::Zero { joint, offset_rad, in_table: false } => format!(
                "turn the `origin` of {} by {offset_rad:.4} rad about its axis in the robot's description, or add this to its position",
                names.joint(*joint)
            ),
        },
        Mistake::Reading { what: Reading::During { span_s, .. }, .. } => {
            format!("correct the recording{}, or leave the stretch out with `window_s`", stretch(*span_s))
        }
        Mistake::Reading { what, .. } => match what {
            Reading::Degrees => "write `angle = \"deg\"` in `[recordings]`".into(),
            Reading::Turns => "write `counts_per_revolution = 1` in `[recordings]`".into(),
            Reading::Geared(ratio) => {
                format!("write the drives' `gear_ratio`, about {}, in `[recordings]`", number(*ratio))
            }
            Reading::PositionSign(joint) => {
                format!(
                    "write a `gear_ratio` of -1 for {} in `[recordings]`, or turn its axis round in the robot's description (`sign` -1 in an \
                     MDH table, `axis` in a URDF file)",
                    names.joint(*joint)
                )
            }
            Reading::AxisSign(joint) => {
                format!(
                    "turn the axis of {0} round in the robot's description (`sign` -1 in an MDH table, `axis` in a URDF file), or write a \
                     `gear_ratio` of -1 in `[recordings]` and a gain of -1 as `gains` of `[instrument]` for {0}",
                    names.joint(*joint)
                )
            }
            Reading::MeasurementSign(joint) => {
                format!("write a gain of -1 for {} as `gains` of `[instrument]`", names.joint(*joint))
            }
            Reading::AllMeasurementSigns => {
                "write gains of -1 for all joints as `gains` of `[instrument]`".into()
            }
            Reading::Order { of, order } => {
                format!(
                    "list the {} in the order {order:?} of the joints now, with `columns`",
                    columns_of(*of)
                )
            }
            Reading::Delay(delay) => {
                format!(
                    "write {} for every joint as `delay_s` of `[instrument]`, or record both with one clock",
                    number(*delay)
                )
            }
            Reading::Time(factor) => format!(
                "multiply the stamps by {}: look at the rate of the logger, and write it as `rate_hz` in `[recordings]`",
                number(*factor)
            ),
            Reading::Gain { joint, factor } => {
                format!(
                    "write a gain of {} for {} as `gains` of `[instrument]`, or correct its torque constant",
                    number(*factor),
                    names.joint(*joint)
                )
            }
            Reading::Constants { joints, .. } => {
                let joints = names.joint_list(joints);
                format!("exchange the torque constants of {joints} in `torque_constants_nm_per_a`")
            }
            Reading::During { what, .. } => {
                undone(&Mistake::Reading { what: (**what).clone(), file: None }, names)
            }
        },
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
            let (said, order) =
                (seems(&reading(what.clone()), &[], names), undone(&reading(what.clone()), names));
            assert!(said.contains(seen) && order.contains(cure), "{said} {order}");
            let nameless = seems(&reading(what), &[], RobotNames::default());
            assert!(nameless.contains("of joint "), "{nameless}");
        }
    }
}

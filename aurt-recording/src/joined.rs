//! Recordings that lie in several files: positions in one, measurements in another, joined by their time stamps.

use std::path::Path;

use crate::error::RecordingError;
use crate::formats::read_whole;
use crate::noise::median_step_s;
use crate::read_options::ReadOptions;
use crate::recorded_as::{Quantity, RecordedAs, TimeUnit};
use crate::recording::{ReadReport, Recording};
use crate::robot_joints::RobotJoints;

/// Stamps this much of a period apart are of one moment: text rounds them, and two drives of one bus are not nearer.
const SAME_MOMENT_PERIODS: f64 = 1e-3;
/// Share of stamps that have to have a partner for rows to be joined without interpolation.
const COMMON_STAMPS: f64 = 0.9;
/// Neighbours further apart than so many periods are not interpolated between.
const WIDEST_PERIODS: f64 = 3.0;
/// Periods that differ by less are of one rate.
const ONE_RATE: f64 = 1.01;

/// Reads a recording whose measurements or velocities are in [`RecordedAs::joined`] files.
///
/// Rows are those of the common time span. Where the stamps of the slower file have partners in the other, rows with equal
/// stamps belong together and the numbers stay as they are. Otherwise the recording has the stamps of the slower file, and
/// x(t) = x(tₐ) + (t − tₐ)/(t_b − tₐ) · (x(t_b) − x(tₐ)) is taken of the other, between neighbours that are at most three
/// of its periods apart; rows without such neighbours are left out.
pub(crate) fn read(path: &Path, options: &ReadOptions) -> Result<Recording, RecordingError> {
    let alone = |recorded: &RecordedAs| RecordedAs { joined: Vec::new(), ..recorded.clone() };
    let own = ReadOptions {
        needs_measurement: false,
        accepts_plan: false,
        recorded: alone(&options.recorded),
        ..options.clone()
    };
    let mut whole = read_whole(path, &own)?;
    whole.report = of_file(&whole);
    let last = options.recorded.joined.len();
    for (place, other) in options.recorded.joined.iter().enumerate() {
        let still_missing = options.needs_measurement && whole.measurement.is_none() && place + 1 == last;
        let part = ReadOptions {
            joints: Some(RobotJoints {
                names: whole.joints.names().to_vec(),
                sliding: (0..whole.joints()).map(|joint| options.slides(joint)).collect(),
                ..whole.joints().into()
            }),
            columns: other.columns.clone(),
            unit: other.unit.or(options.unit),
            recorded: alone(&other.recorded),
            needs_position: false,
            needs_measurement: still_missing,
            accepts_plan: false,
            ..options.clone()
        };
        let mut part = read_whole(&other.file, &part)?;
        part.report = of_file(&part);
        whole = join(whole, part, other.clock_offset_s)?;
    }
    Ok(whole)
}

/// The report on a file, with every sentence saying of which one it is.
fn of_file(recording: &Recording) -> ReadReport {
    let report = &recording.report;
    let name = recording.file.file_name().unwrap_or_default().to_string_lossy();
    let found = usize::from(!report.columns.is_empty());
    let (of_file, choices) =
        (|n: &String| format!("{name}: {n}"), report.notes().len() - report.irregularities.len());
    ReadReport {
        format: format!("{name}: {} rows, {}", report.rows, report.format),
        rows: recording.samples(),
        columns: report.columns.iter().map(|c| format!("{c} ({name})")).collect(),
        remarks: report.notes()[1 + found..choices].iter().map(of_file).collect(),
        irregularities: report.irregularities.iter().map(of_file).collect(),
        origin_s: report.origin_s,
        set_back_s: report.set_back_s.clone(),
        branches: report.branches.clone(),
        line_is_row: true,
        ..ReadReport::default()
    }
}

/// Where in a file a row of the joined recording is from.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Place {
    Row(usize),
    /// Between a row and the next, at this share of the way.
    After(usize, f64),
}

impl Place {
    fn of(self, series: &[f64]) -> f64 {
        match self {
            Self::Row(row) => series[row],
            Self::After(row, share) => series[row] + share * (series[row + 1] - series[row]),
        }
    }
}

fn join(whole: Recording, part: Recording, clock_offset_s: f64) -> Result<Recording, RecordingError> {
    refuse_doubled(&whole, &part)?;
    let shift_s = part.report.origin_s - whole.report.origin_s + clock_offset_s;
    let mut part = part;
    for recording in [&whole, &part] {
        if let Some(at) = recording.report.set_back_s.first() {
            return Err(refusal(
                &whole,
                &part,
                format!(
                    "the clock of {} was set back {:.3} s after its start",
                    shown(recording),
                    at - recording.time_s[0]
                ),
                "cut both files there, and join the pieces",
            ));
        }
    }
    if shift_s != 0.0 {
        part.time_s.iter_mut().for_each(|t| *t += shift_s);
    }
    let periods = [period_s(&whole)?, period_s(&part)?];
    refuse_other_unit(&whole, &part, periods)?;
    refuse_apart(&whole, &part, clock_offset_s)?;
    let (name, other) = (shown(&whole), shown(&part));
    let part_is_slower = periods[1] > ONE_RATE * periods[0];
    let (slower, faster) = if part_is_slower { (&part, &whole) } else { (&whole, &part) };
    let fast_period_s = if part_is_slower { periods[0] } else { periods[1] };
    let tolerance_s = SAME_MOMENT_PERIODS * periods[0].min(periods[1]);
    let within = common(&slower.time_s, &faster.time_s, tolerance_s);
    let partners = partners(&slower.time_s, &faster.time_s, tolerance_s);
    let rates = periods.map(shown_rate);
    let (rows, remark) = if partners.len() as f64 >= COMMON_STAMPS * within.len() as f64 {
        let remark = format!(
            "{name} ({}) and {other} ({}) are joined by equal stamps: {} rows of {} and {}",
            rates[0],
            rates[1],
            partners.len(),
            whole.samples(),
            part.samples()
        );
        (partners, remark)
    } else {
        let rows = between(&slower.time_s, &faster.time_s, within.clone(), tolerance_s, fast_period_s);
        let (slow, fast) = (shown(slower), shown(faster));
        let which = if part_is_slower || periods[0] > ONE_RATE * periods[1] {
            format!("those of {slow}, the slower one,")
        } else {
            format!("those of {slow}")
        };
        let left_out = match within.len() - rows.len() {
            0 => String::new(),
            n => format!(
                "; {n} rows are left out, since neighbours are more than {WIDEST_PERIODS} periods apart"
            ),
        };
        let remark = format!(
            "{name} ({}) and {other} ({}) have different stamps: {which} are kept ({} rows), what is in {fast} is \
             interpolated linearly{left_out}",
            rates[0],
            rates[1],
            rows.len(),
        );
        (rows, remark)
    };
    if rows.len() < 2 {
        return Err(refusal(
            &whole,
            &part,
            format!("{} rows have a counterpart within {WIDEST_PERIODS} periods", rows.len()),
            "check that both were recorded at the same time",
        ));
    }
    Ok(assembled(&whole, &part, part_is_slower, &rows, remark))
}

/// The recording of these rows: of the slower file the rows themselves, of the faster what is there at that time.
fn assembled(
    whole: &Recording,
    part: &Recording,
    part_is_slower: bool,
    rows: &[(usize, Place)],
    remark: String,
) -> Recording {
    let take = |from_slower: bool, family: &Vec<Vec<f64>>| -> Vec<Vec<f64>> {
        let at = |s: &Vec<f64>, row: &(usize, Place)| if from_slower { s[row.0] } else { row.1.of(s) };
        family.iter().map(|s| rows.iter().map(|row| at(s, row)).collect()).collect()
    };
    let of_whole = |family: &Vec<Vec<f64>>| take(!part_is_slower, family);
    let of_part = |family: &Vec<Vec<f64>>| take(part_is_slower, family);
    let stamps = if part_is_slower { &part.time_s } else { &whole.time_s };
    let mut report = whole.report.clone();
    report.format = format!("{}; {}", whole.report.format, part.report.format);
    report.rows = rows.len();
    report.columns.extend(part.report.columns.iter().cloned());
    report.remarks.push(remark);
    report.remarks.extend(part.report.remarks.iter().cloned());
    report.irregularities.extend(part.report.irregularities.iter().cloned());
    let mut velocity = whole.velocity_rad_s.as_ref().map(of_whole);
    if let Some(other) = &part.velocity_rad_s {
        if velocity.is_some() {
            report.remarks.push(format!("joint velocities are those of {}", shown(whole)));
        } else {
            velocity = Some(of_part(other));
        }
    }
    let measured = whole.measurement.as_ref().map(of_whole);
    Recording {
        file: whole.file.clone(),
        time_s: rows.iter().map(|(row, _)| stamps[*row]).collect(),
        position_rad: of_whole(&whole.position_rad),
        velocity_rad_s: velocity,
        unit: if measured.is_some() { whole.unit } else { part.unit },
        joints: whole.joints.clone(),
        measurement: measured.or_else(|| part.measurement.as_ref().map(of_part)),
        report,
    }
}

/// The rows of `slower` that lie in the span of `faster`.
fn common(slower: &[f64], faster: &[f64], tolerance_s: f64) -> std::ops::Range<usize> {
    let (Some(from), Some(to)) = (faster.first(), faster.last()) else { return 0..0 };
    let begin = slower.partition_point(|t| *t < from - tolerance_s);
    let end = slower.partition_point(|t| *t <= to + tolerance_s);
    begin..end.max(begin)
}

/// Rows of equal stamps, in their order; of stamps that repeat, the first goes with the first.
fn partners(slower: &[f64], faster: &[f64], tolerance_s: f64) -> Vec<(usize, Place)> {
    let (mut i, mut j) = (0, 0);
    let mut rows = Vec::new();
    while i < slower.len() && j < faster.len() {
        let later = faster[j] - slower[i];
        if later.abs() <= tolerance_s {
            rows.push((i, Place::Row(j)));
            (i, j) = (i + 1, j + 1);
        } else if later < 0.0 {
            j += 1;
        } else {
            i += 1;
        }
    }
    rows
}

/// For each of the slower file's rows its place among the faster one's, where neighbours are near enough.
fn between(
    slower: &[f64],
    faster: &[f64],
    within: std::ops::Range<usize>,
    tolerance_s: f64,
    fast_period_s: f64,
) -> Vec<(usize, Place)> {
    let mut rows = Vec::with_capacity(within.len());
    let mut next = 0;
    for row in within {
        let stamp = slower[row];
        while next < faster.len() && faster[next] < stamp - tolerance_s {
            next += 1;
        }
        if faster.get(next).is_some_and(|t| *t <= stamp + tolerance_s) {
            rows.push((row, Place::Row(next)));
        } else if next > 0 && next < faster.len() {
            let gap = faster[next] - faster[next - 1];
            if gap <= WIDEST_PERIODS * fast_period_s {
                rows.push((row, Place::After(next - 1, (stamp - faster[next - 1]) / gap)));
            }
        }
    }
    rows
}

/// The middle distance of two stamps that differ.
fn period_s(recording: &Recording) -> Result<f64, RecordingError> {
    median_step_s(&recording.time_s).ok_or_else(|| {
        RecordingError::clock(
            &recording.file,
            "it has no two stamps that differ, and files are joined by their stamps",
            "record two samples at least, or state rate_hz",
        )
    })
}

/// Positions and measurements have to be in one file each.
fn refuse_doubled(whole: &Recording, part: &Recording) -> Result<(), RecordingError> {
    let doubled = [
        (Quantity::Position, "joint positions", !part.position_rad.is_empty()),
        (Quantity::Measurement, "a measurement", whole.measurement.is_some() && part.measurement.is_some()),
    ];
    let Some((quantity, what, _)) = doubled.into_iter().find(|(.., doubled)| *doubled) else { return Ok(()) };
    let rest = part.families().count() > 1;
    let instead = if quantity == Quantity::Position && (rest || part.measurement.is_some()) {
        "take = [\"measurement\"] in the table of the second"
    } else {
        "take = [\"position\", \"velocity\"] in the table of the one whose measurement is not meant"
    };
    Err(refusal(
        whole,
        part,
        format!("both have {what}"),
        &format!("say what is taken of one of them, e.g. {instead}"),
    ))
}

/// Stamps of which one second is another file's thousand.
fn refuse_other_unit(whole: &Recording, part: &Recording, periods: [f64; 2]) -> Result<(), RecordingError> {
    const UNITS: [(f64, TimeUnit); 3] =
        [(1e3, TimeUnit::Millisecond), (1e6, TimeUnit::Microsecond), (1e9, TimeUnit::Nanosecond)];
    let about = |ratio: f64, unit: f64| (0.9..1.1).contains(&(ratio / unit));
    let by_duration = [whole, part].map(Recording::duration_s);
    for (factor, unit) in UNITS {
        for (k, recording) in [(1, part), (0, whole)] {
            let longer = by_duration[k] / by_duration[1 - k];
            // A file that lasts a thousand times as long has more rows, unless its seconds are shorter.
            let slower = periods[k] / periods[1 - k];
            if about(longer, factor) && (factor / 20.0..factor * 20.0).contains(&slower) {
                return Err(refusal(
                    whole,
                    part,
                    format!("{} lasts {factor:e} times as long", recording.file.display()),
                    &format!("its stamps seem to be in {0}: write time = \"{0}\"", unit.key()),
                ));
            }
        }
    }
    Ok(())
}

/// Files without common time: two clocks, or two moments.
fn refuse_apart(whole: &Recording, part: &Recording, offset_s: f64) -> Result<(), RecordingError> {
    let span = |r: &Recording| r.time_s.first().copied().zip(r.time_s.last().copied());
    let (Some((a, a_end)), Some((b, b_end))) = (span(whole), span(part)) else { return Ok(()) };
    if a.max(b) < a_end.min(b_end) {
        return Ok(());
    }
    let origin_s = whole.report.origin_s;
    let times = |from: f64, to: f64| format!("{:.3} s to {:.3} s", from + origin_s, to + origin_s);
    Err(refusal(
        whole,
        part,
        format!(
            "their times do not overlap: {} and {}; the second begins {:.6} s after the first",
            times(a, a_end),
            times(b, b_end),
            b - a
        ),
        &format!(
            "if they have two clocks and began together, write clock_offset_s = {:.6} in the table of the second; otherwise \
             they are of two moments",
            offset_s + a - b
        ),
    ))
}

fn refusal(whole: &Recording, part: &Recording, reason: String, remedy: &str) -> RecordingError {
    RecordingError::Joined {
        path: whole.file.clone(),
        other: part.file.clone(),
        reason,
        remedy: remedy.to_owned(),
    }
}

fn shown(recording: &Recording) -> String {
    recording.file.file_name().unwrap_or_default().to_string_lossy().into_owned()
}

/// `125 Hz`, to six decimals at most.
fn shown_rate(period_s: f64) -> String {
    let number = format!("{:.6}", 1.0 / period_s);
    format!("{} Hz", number.trim_end_matches('0').trim_end_matches('.'))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn equal_stamps_go_together_in_their_order() {
        let rows = partners(&[0.0, 1.0, 1.0, 2.0, 4.0], &[1.0, 1.0, 2.0, 3.0, 4.0], 1e-6);
        let expected = [(1, 0), (2, 1), (3, 2), (4, 4)].map(|(i, j)| (i, Place::Row(j)));
        assert_eq!(rows, expected);
    }

    #[test]
    fn nothing_is_interpolated_across_a_gap() {
        let fast = [0.0, 1.0, 2.0, 6.0, 7.0];
        let slow = [0.5, 2.0, 4.0, 6.5, 8.0];
        let within = common(&slow, &fast, 1e-6);
        assert_eq!(within, 0..4);
        let rows = between(&slow, &fast, within, 1e-6, 1.0);
        assert_eq!(rows, [(0, Place::After(0, 0.5)), (1, Place::Row(2)), (3, Place::After(3, 0.5))]);
        assert_eq!(Place::After(0, 0.25).of(&[2.0, 6.0]), 3.0);
    }
}

use std::path::Path;

use crate::branches::BranchTrack;
use crate::csv::columns::Selected;
use crate::csv::header::Header;
use crate::csv::plausibility::{self, Finding, Turns};
use crate::error::RecordingError;
use crate::read_options::ReadOptions;
use crate::recording::{DroppedRow, ReadReport, Recording};

/// Corrupt rows of which line and reason are kept; of more, only the number.
const KEPT_DETAILS: usize = 10_000;

/// Rows of a machine that runs on over which the share of corrupt ones is judged.
const JUDGED_ROWS: usize = 10_000;

const IRREGULARITIES: usize = 100;

/// Magnitude of time stamps beyond which they are corrupt, in s.
const TIME_LIMIT_S: f64 = 1e20;

/// Rows as they are read, series by series, without those that cannot be true.
pub(super) struct Collector<'a> {
    selected: &'a Selected,
    /// Column of each place in a row; a stamp that was not read counts as the first.
    columns: Vec<usize>,
    /// Whether anything is in other units than SI.
    scaled: bool,
    /// For each place in a row the magnitude that its values cannot exceed.
    limits: Vec<f64>,
    series: Vec<Vec<f64>>,
    lines: Vec<u32>,
    rows: usize,
    dropped: Vec<Dropped>,
    report: ReadReport,
    /// Rows seen and left out when the share of the latter was judged last.
    judged: [usize; 2],
    /// Whether the latest row was kept.
    follows: bool,
    /// Rows that came late, unless they are of a machine that runs on.
    late: Option<Late>,
    /// What is added to stamps since the clock was set back.
    forward_s: f64,
    /// Whether rows were handed out.
    begun: bool,
    /// The first second of stamps that are in two columns.
    first_second: Option<f64>,
    turns: Vec<Turns>,
    branches: Vec<BranchTrack>,
    /// Whether rows that lack a number are left out on request.
    drops: bool,
    /// Why the file is refused once all of its rows are counted.
    refused: Option<RecordingError>,
    refused_rows: usize,
}

struct Dropped {
    line: usize,
    /// Place of the offending value in the row.
    place: usize,
    reason: Reason,
}

enum Reason {
    Absurd(f64),
    TimeBack { stamp: f64, before: f64 },
    TimeAhead { stamp: f64, after: f64 },
    Outlier { value: f64, what: &'static str },
    NoNumber,
}

fn shown(line: usize) -> u32 {
    u32::try_from(line).unwrap_or(u32::MAX)
}

impl<'a> Collector<'a> {
    pub(super) fn new(selected: &'a Selected, options: &ReadOptions, rows: usize) -> Self {
        let mut limits = vec![TIME_LIMIT_S];
        limits.extend(selected.position.iter().map(|_| options.position_limit_rad));
        limits.extend(selected.velocity.iter().flatten().map(|_| options.velocity_limit_rad_s));
        limits.extend(selected.measurement.iter().flatten().map(|_| options.measurement_limit));
        Self {
            selected,
            columns: selected.time.is_none().then_some(0).into_iter().chain(selected.all()).collect(),
            scaled: selected.factors.iter().any(|f| *f != [1.0, 1.0]),
            series: limits.iter().map(|_| Vec::with_capacity(rows)).collect(),
            lines: Vec::with_capacity(rows),
            limits,
            rows: 0,
            dropped: Vec::new(),
            report: ReadReport::default(),
            judged: [0; 2],
            follows: false,
            late: (!options.is_running).then(Late::default),
            forward_s: 0.0,
            begun: false,
            first_second: None,
            turns: vec![Turns::default(); selected.position.len()],
            branches: selected.branches.iter().map(|(joint, _)| BranchTrack::new(joint.clone())).collect(),
            drops: options.recorded.drops_rows(),
            refused: None,
            refused_rows: 0,
        }
    }

    pub(super) const fn held(&self) -> usize {
        self.lines.len()
    }

    /// Rows seen, dropped ones included.
    pub(super) const fn rows(&self) -> usize {
        self.rows
    }

    /// Place of the first number of a row that is read; before it may stand a stamp that follows from the rate.
    pub(super) fn first_read(&self) -> usize {
        usize::from(self.selected.time.is_none())
    }

    /// Takes a row as it was read, unless it cannot be true; it is left in SI units.
    pub(super) fn add(&mut self, row: &mut [f64], line: usize) {
        let whole = row;
        let (row, _) = whole.split_at_mut(whole.len() - self.branches.len());
        if let Some(rate_hz) = self.selected.rate_hz {
            row[0] = self.rows as f64 / rate_hz;
        }
        if self.selected.nanoseconds.is_some()
            && let [seconds, .., nanoseconds] = row
        {
            *seconds = (*seconds - *self.first_second.get_or_insert(*seconds)) + *nanoseconds / 1e9;
        }
        self.rows += 1;
        if self.scaled {
            for (value, [up, down]) in row.iter_mut().zip(&self.selected.factors) {
                *value = *value * up / down;
            }
        }
        if let Some(place) = row.iter().zip(&self.limits).position(|(v, limit)| v.abs() > *limit) {
            self.drop_row(line, place, Reason::Absurd(row[place]));
            return;
        }
        whole[0] += self.forward_s;
        self.place(whole, line);
    }

    fn place(&mut self, row: &mut [f64], line: usize) {
        let stamp = row[0];
        let time = &self.series[0];
        let last = time.len().checked_sub(1);
        if last.is_some_and(|last| self.is_row(last, row)) {
            return self.repeat(line);
        }
        if let Some(before) = time.last().copied().filter(|last| stamp < *last) {
            // One of the two stamps is wrong: the earlier one if it lies ahead of a series that goes on.
            let one_ahead = self.follows && time.len() >= 2 && stamp >= time[time.len() - 2];
            if !one_ahead {
                let Some(late) = &self.late else {
                    return self.drop_row(line, 0, Reason::TimeBack { stamp, before });
                };
                if late.ends_before(stamp) {
                    row[0] += self.settle(None);
                    return self.place(row, line);
                }
                self.follows = false;
                return self.late.get_or_insert_default().rows.push((row.to_vec(), line));
            }
            let ahead = self.lines.pop().map_or(line, |l| l as usize);
            for series in &mut self.series {
                series.pop();
            }
            self.drop_row(ahead, 0, Reason::TimeAhead { stamp: before, after: stamp });
        }
        row[0] += self.settle(Some(stamp));
        self.keep(row, line);
    }

    /// Decides on the rows that came late: they are dropped, or later stamps set forward by what is returned.
    fn settle(&mut self, next: Option<f64>) -> f64 {
        let Some(late) = self.late.as_mut().map(std::mem::take).filter(|late| !late.rows.is_empty()) else {
            return 0.0;
        };
        let before = self.series[0].last().copied().unwrap_or_default();
        let Some(moved_s) = late.set_back_s(&self.series, next) else {
            for (row, line) in late.rows {
                let at = self.series[0].partition_point(|t| *t < row[0]);
                if self.is_row(at, &row) {
                    self.repeat(line);
                } else {
                    self.drop_row(line, 0, Reason::TimeBack { stamp: row[0], before });
                }
            }
            return 0.0;
        };
        let (first, line) = (late.rows[0].0[0], late.rows[0].1);
        self.report.remarks.push(format!(
            "the clock was set back from {before:.3} s to {first:.3} s in line {line}: the recording is split there, and later \
             stamps are {moved_s:.3} s later"
        ));
        self.forward_s += moved_s;
        self.report.set_back_s.push(first + moved_s);
        for (mut row, line) in late.rows {
            row[0] += moved_s;
            self.keep(&row, line);
        }
        moved_s
    }

    fn keep(&mut self, row: &[f64], line: usize) {
        let (row, beside) = row.split_at(row.len() - self.branches.len());
        let scaled = beside.iter().zip(&self.selected.branch_factors);
        for (track, (value, [up, down])) in self.branches.iter_mut().zip(scaled) {
            track.add(row[0], *value * up / down);
        }
        for (series, value) in self.series.iter_mut().zip(row) {
            series.push(*value);
        }
        self.lines.push(shown(line));
        self.follows = true;
    }

    /// Whether the row held at a place is this one, stamp and numbers alike. Stamps that follow from the rate tell rows apart.
    fn is_row(&self, at: usize, row: &[f64]) -> bool {
        self.selected.time.is_some()
            && self.series.iter().zip(row).all(|(series, value)| series.get(at) == Some(value))
    }

    /// Counts a row that is there already.
    fn repeat(&mut self, line: usize) {
        self.report.repeated_rows += 1;
        self.report.absent.push(shown(line));
    }

    /// Refuses the file because of a row, once all such rows are counted; a machine that runs on has no end.
    pub(super) fn refuse(&mut self, error: RecordingError) -> Result<(), RecordingError> {
        self.rows += 1;
        self.refused_rows += 1;
        self.refused.get_or_insert(error);
        if self.late.is_some() { Ok(()) } else { self.refusal() }
    }

    /// The refusal with the number of rows that are its reason.
    fn refusal(&mut self) -> Result<(), RecordingError> {
        let Some(mut error) = self.refused.take() else { return Ok(()) };
        if let RecordingError::Cell { rows, .. } | RecordingError::Value { rows, .. } = &mut error {
            *rows = self.refused_rows;
        }
        Err(error)
    }

    /// Counts a row whose cell in a column of the file is no finite number.
    pub(super) fn skip(&mut self, line: usize, column: usize) {
        self.rows += 1;
        if self.drops {
            self.report.rows_without_numbers += 1;
            return self.report.absent.push(shown(line));
        }
        let place = self.columns.iter().position(|c| *c == column).unwrap_or(0);
        self.drop_row(line, place, Reason::NoNumber);
    }

    fn drop_row(&mut self, line: usize, place: usize, reason: Reason) {
        self.follows = false;
        self.report.dropped_rows += 1;
        self.report.absent.push(shown(line));
        if self.dropped.len() < KEPT_DETAILS {
            self.dropped.push(Dropped { line, place, reason });
        }
    }

    /// The recording without rows that their neighbours contradict; an error if too many rows were left out.
    pub(super) fn finish(
        mut self,
        path: &Path,
        header: &Header,
        format: String,
        max_share: f64,
    ) -> Result<Recording, RecordingError> {
        self.refusal()?;
        self.settle(None);
        let series = self.piece(true);
        self.judge(path, header, max_share, [0; 2])?;
        self.dropped.sort_by_key(|d| d.line);
        let in_words = |d: &Dropped| DroppedRow { line: d.line, reason: self.in_words(d, header) };
        let mut report = ReadReport {
            format,
            rows: self.rows,
            columns: self.selected.in_words(header),
            dropped: self.dropped.iter().map(in_words).collect(),
            origin_s: self.first_second.unwrap_or(0.0),
            branches: self.branches.into_iter().filter_map(BranchTrack::motion).collect(),
            ..self.report
        };
        report.absent.sort_unstable();
        report.remarks.splice(0..0, self.selected.remarks.iter().cloned());
        report.irregularities.splice(0..0, self.selected.unread.clone());
        Ok(self.selected.recording(path, series, report))
    }

    /// An error if too many of the latest rows were left out; nothing is said of fewer than ten thousand.
    pub(super) fn judge_latest(
        &mut self,
        path: &Path,
        header: &Header,
        max_share: f64,
    ) -> Result<(), RecordingError> {
        if self.rows - self.judged[0] >= JUDGED_ROWS {
            self.judge(path, header, max_share, self.judged)?;
            self.judged = [self.rows, self.report.dropped_rows];
        }
        Ok(())
    }

    /// An error if too many rows were left out since so many were seen and left out.
    fn judge(
        &self,
        path: &Path,
        header: &Header,
        max_share: f64,
        [seen, left_out]: [usize; 2],
    ) -> Result<(), RecordingError> {
        let (total, rows) = (self.rows - seen, self.report.dropped_rows - left_out);
        let allowed = (max_share * total as f64).floor() as usize;
        if rows > allowed {
            let latest = self.dropped.iter().skip(left_out.min(self.dropped.len().saturating_sub(1)));
            let first = latest.min_by_key(|d| d.line);
            let (line, column, reason) = first.map_or((0, 0, String::new()), |first| {
                // Files that are no text have rows, and columns by name alone.
                let column = if header.line == 0 { 0 } else { self.columns[first.place] + 1 };
                (first.line, column, self.in_words(first, header))
            });
            return Err(RecordingError::CorruptRows {
                path: path.to_owned(),
                line,
                column,
                reason,
                rows,
                total,
                allowed,
                max_share,
            });
        }
        Ok(())
    }

    /// Hands out the rows held, without those that their neighbours contradict. Unless they are the last, two rows stay
    /// back as neighbours of those to come.
    pub(super) fn piece(&mut self, last: bool) -> Vec<Vec<f64>> {
        let first = !std::mem::replace(&mut self.begun, true);
        let (joints, rows) = (self.selected.position.len(), self.lines.len());
        let measured = self.series.len() - self.selected.measurement.as_ref().map_or(0, Vec::len);
        let (time, values) = self.series.split_at(1);
        let mut findings = plausibility::position_outliers(&time[0], &values[..joints]);
        findings.extend(plausibility::measurement_outliers(&self.series[measured..]).into_iter().map(|f| {
            // Places count from the positions on.
            Finding { place: f.place + measured - 1, ..f }
        }));
        // At a cut between two pieces a row has a neighbour on one side only.
        findings.retain(|f| (first || f.row > 0) && (last || f.row + 1 < rows));
        self.drop_findings(&findings);
        let ready = if last { self.lines.len() } else { self.lines.len().saturating_sub(2) };
        let lines: Vec<u32> = self.lines.drain(..ready).collect();
        let mut series: Vec<Vec<f64>> = if last {
            std::mem::take(&mut self.series)
        } else {
            self.series.iter_mut().map(|s| s.drain(..ready).collect()).collect()
        };
        // In another unit every motion is a jump: that would hide the reason.
        let sliding = &self.selected.sliding;
        let degrees = plausibility::remark_on_degrees(&series[1..=joints], sliding);
        let tells_jumps = degrees.is_none();
        self.report.irregularities.extend(degrees);
        let (time, values) = series.split_at_mut(1);
        for ((joint, position), turns) in values.iter_mut().enumerate().take(joints).zip(&mut self.turns) {
            let joint = plausibility::JointPosition { joint, slides: sliding[joint], tells_jumps };
            let [unwrapped, jumped] = joint.unwrap(&time[0], position, &lines, turns);
            self.report.remarks.extend(unwrapped);
            self.report.irregularities.extend(jumped);
        }
        // Of many pieces every one may have the same to say.
        self.report.irregularities.truncate(IRREGULARITIES);
        self.report.remarks.truncate(IRREGULARITIES);
        series
    }

    fn drop_findings(&mut self, findings: &[Finding]) {
        if findings.is_empty() {
            return;
        }
        let mut keep = vec![true; self.lines.len()];
        for finding in findings {
            if std::mem::replace(&mut keep[finding.row], false) {
                let value = self.series[1 + finding.place][finding.row];
                let line = self.lines[finding.row] as usize;
                self.drop_row(line, 1 + finding.place, Reason::Outlier { value, what: finding.what });
            }
        }
        for series in &mut self.series {
            let mut kept = keep.iter();
            series.retain(|_| kept.next().copied().unwrap_or(true));
        }
        let mut kept = keep.iter();
        self.lines.retain(|_| kept.next().copied().unwrap_or(true));
    }

    fn in_words(&self, dropped: &Dropped, header: &Header) -> String {
        let name = header.name(self.columns[dropped.place]);
        match dropped.reason {
            Reason::Absurd(value) => {
                format!("{name} = {value:e} lies beyond ±{:e}", self.limits[dropped.place])
            }
            Reason::TimeBack { stamp, before } => format!("time goes back from {before} s to {stamp} s"),
            Reason::TimeAhead { stamp, after } => {
                format!("time leaps ahead to {stamp} s, and the next row has {after} s")
            }
            Reason::Outlier { value, what } => format!("{name} = {value} {what}"),
            Reason::NoNumber => format!("{name} is no finite number"),
        }
    }
}

/// Rows out of order are no more than so many in a run.
const MOST: usize = 100;

/// Rows from which the distance of stamps is taken.
const USUAL: usize = 20;

/// Gap that is left where a clock was set back: how long it really is, nobody knows. It splits every recording.
const GAP_S: f64 = 1.0;

#[derive(Default)]
pub(super) struct Late {
    pub(super) rows: Vec<(Vec<f64>, usize)>,
}

impl Late {
    pub(super) fn ends_before(&self, stamp: f64) -> bool {
        self.rows.len() >= MOST || self.rows.last().is_some_and(|(row, _)| stamp < row[0])
    }

    /// By how much the clock has to be set forward if it was set back: the run goes on at the usual distance of stamps,
    /// up to the `next` row where that is in order again, and does not repeat rows of before.
    pub(super) fn set_back_s(&self, series: &[Vec<f64>], next: Option<f64>) -> Option<f64> {
        let (time, first) = (&series[0], self.rows.first()?.0[0]);
        let before = time.len().saturating_sub(USUAL + 1);
        let (last, from) = (*time.last()?, time[before]);
        let usual_s = (last - from) / (time.len() - 1 - before) as f64;
        let stamps = self.rows.iter().map(|(row, _)| row[0]).chain(next);
        let end = stamps.clone().last()?;
        let mean_s = (end - first) / (stamps.clone().count() - 1) as f64;
        let rejoins = next.is_none_or(|next| next - self.rows[self.rows.len() - 1].0[0] <= 2.0 * usual_s);
        let repeats = self.rows.iter().all(|(row, _)| {
            let at = time.partition_point(|t| *t < row[0]);
            series.iter().zip(row).all(|(series, value)| series[at] == *value)
        });
        let goes_on = (0.5..=2.0).contains(&(mean_s / usual_s)) && rejoins && !repeats;
        goes_on.then(|| last + GAP_S.max(USUAL as f64 * usual_s) - first)
    }
}

use std::path::Path;

use crate::csv::ReadOptions;
use crate::csv::columns::Selected;
use crate::csv::header::Header;
use crate::{DroppedRow, RecordingError};

/// Corrupt rows of which line and reason are kept; of more, only the number.
const KEPT_DETAILS: usize = 10_000;

/// Magnitude of time stamps beyond which they are corrupt, in s.
const TIME_LIMIT_S: f64 = 1e20;

/// Magnitudes beyond which a value cannot be what a sensor measured.
#[derive(Debug, Clone, Copy)]
pub(super) struct Limits {
    position_rad: f64,
    velocity_rad_s: f64,
    measurement: f64,
}

impl Limits {
    pub(super) fn of(options: &ReadOptions) -> Self {
        Self {
            position_rad: options.position_limit_rad,
            velocity_rad_s: options.velocity_limit_rad_s,
            measurement: options.measurement_limit,
        }
    }
}

/// Rows as they are read, series by series, without those that cannot be true.
pub(super) struct Collector {
    series: Vec<Vec<f64>>,
    limits: Vec<f64>,
    rows: usize,
    /// Lines of the two rows kept last.
    lines: [usize; 2],
    dropped: Vec<Dropped>,
    dropped_rows: usize,
}

/// A row that was left out.
struct Dropped {
    line: usize,
    /// Place of the offending value in the row.
    place: usize,
    reason: Reason,
}

/// Why a row cannot be true.
#[derive(Clone, Copy)]
enum Reason {
    Absurd(f64),
    TimeBack { stamp: f64, before: f64 },
    TimeAhead { stamp: f64, after: f64 },
}

impl Collector {
    /// A collector of the selected columns, with room for about `rows` rows.
    pub(super) fn new(selected: &Selected, limits: Limits, rows: usize) -> Self {
        let joints = selected.position.len();
        let mut all = vec![TIME_LIMIT_S];
        all.extend(std::iter::repeat_n(limits.position_rad, joints));
        all.extend(selected.velocity.iter().flatten().map(|_| limits.velocity_rad_s));
        all.extend(selected.measurement.iter().flatten().map(|_| limits.measurement));
        Self {
            series: all.iter().map(|_| Vec::with_capacity(rows)).collect(),
            limits: all,
            rows: 0,
            lines: [0; 2],
            dropped: Vec::new(),
            dropped_rows: 0,
        }
    }

    /// Rows seen, dropped ones included.
    pub(super) fn rows(&self) -> usize {
        self.rows
    }

    /// Takes a row, unless it cannot be true.
    pub(super) fn add(&mut self, row: &[f64], line: usize) {
        self.rows += 1;
        if let Some(place) = row.iter().zip(&self.limits).position(|(v, limit)| v.abs() > *limit) {
            self.drop_row(line, place, Reason::Absurd(row[place]));
            return;
        }
        let time = &self.series[0];
        if let Some(last) = time.last().copied().filter(|last| row[0] < *last) {
            // One of the two stamps is wrong: the earlier one if it lies ahead of a series that goes on.
            let one_ahead = time.len() >= 2 && row[0] >= time[time.len() - 2];
            if !one_ahead {
                self.drop_row(line, 0, Reason::TimeBack { stamp: row[0], before: last });
                return;
            }
            self.drop_row(self.lines[1], 0, Reason::TimeAhead { stamp: last, after: row[0] });
            for series in &mut self.series {
                series.pop();
            }
            self.lines[1] = self.lines[0];
        }
        for (series, value) in self.series.iter_mut().zip(row) {
            series.push(*value);
        }
        self.lines = [self.lines[1], line];
    }

    fn drop_row(&mut self, line: usize, place: usize, reason: Reason) {
        self.dropped_rows += 1;
        if self.dropped.len() < KEPT_DETAILS {
            self.dropped.push(Dropped { line, place, reason });
        }
    }

    /// The series, time first, and the rows left out; an error if these are too many.
    pub(super) fn finish(
        self,
        path: &Path,
        header: &Header,
        selected: &Selected,
        max_share: f64,
    ) -> Result<(Vec<Vec<f64>>, Vec<DroppedRow>), RecordingError> {
        let columns = selected.all();
        let in_words = |d: &Dropped| {
            let name = header.name(columns[d.place]);
            match d.reason {
                Reason::Absurd(value) => format!("{name} = {value:e} cannot be true"),
                Reason::TimeBack { stamp, before } => {
                    format!("time goes back, from {before} s to {stamp} s")
                }
                Reason::TimeAhead { stamp, after } => {
                    format!("time leaps ahead to {stamp} s, the next row has {after} s")
                }
            }
        };
        let allowed = (max_share * self.rows as f64).floor() as usize;
        if let Some(first) = self.dropped.first()
            && self.dropped_rows > allowed
        {
            let column = columns[first.place];
            return Err(RecordingError::CorruptRows {
                path: path.to_owned(),
                line: first.line,
                column: column + 1,
                reason: in_words(first),
                rows: self.dropped_rows,
                total: self.rows,
                allowed,
                max_share,
            });
        }
        let dropped = self.dropped.iter().map(|d| DroppedRow { line: d.line, reason: in_words(d) }).collect();
        Ok((self.series, dropped))
    }
}

/// A remark if positions look like degrees: no arm turns that many times.
pub(super) fn remark_on_degrees(position_rad: &[Vec<f64>]) -> Option<String> {
    const TURNS_RAD: f64 = 30.0;
    let largest = position_rad
        .iter()
        .map(|q| q.iter().fold(0.0_f64, |m, v| m.max(v.abs())))
        .enumerate()
        .max_by(|a, b| a.1.total_cmp(&b.1));
    largest.filter(|(_, angle)| *angle > TURNS_RAD).map(|(joint, angle)| {
        format!("positions reach {angle:.1} on joint {joint}: they are taken as rad; were they degrees?")
    })
}

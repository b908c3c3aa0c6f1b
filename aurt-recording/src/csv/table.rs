//! Rows of numbers from anything but text, through the search for columns and the checks that text passes.

use std::path::Path;

use crate::csv::collector::{Collected, Collector};
use crate::csv::columns::Selected;
use crate::csv::header::Header;
use crate::csv::search::Search;
use crate::error::RecordingError;
use crate::format::Visit;
use crate::memory::Memory;
use crate::read_options::ReadOptions;
use crate::recording::RecordedJoints;
use crate::recording::{ReadReport, Recording};

/// Columns that an array or a list may have; longer ones have no number for each joint.
pub(crate) const MOST_COLUMNS: usize = 4096;

/// Rows, and numbers of all their columns, that room is made for at once; a file may claim more than it holds.
const ROOM_ROWS: usize = 1 << 16;
const ROOM_NUMBERS: usize = 1 << 22;

/// A table of numbers whose columns are known and whose rows are still to come.
pub(crate) struct Table<'a> {
    path: &'a Path,
    memory: Memory<'a>,
    options: &'a ReadOptions,
    header: Header,
    selected: Selected,
}

impl<'a> Table<'a> {
    /// Finds the columns that are needed; `names` is empty if the `columns` columns have none.
    ///
    /// # Errors
    /// Columns that are missing, ambiguous, or do not fit the robot.
    pub(crate) fn new(
        memory: Memory<'a>,
        names: Vec<String>,
        columns: usize,
        options: &'a ReadOptions,
    ) -> Result<Self, RecordingError> {
        let path = memory.path();
        let header = Header { names, columns, line: 0, is_data: false };
        let selected = Search { path, header: &header, options }.run()?;
        Ok(Self { path, memory, options, header, selected })
    }

    /// The columns that a row has, in its order.
    pub(crate) fn wanted(&self) -> Vec<usize> {
        self.selected.all()
    }

    /// The column of the time stamps, if they are read.
    pub(crate) const fn time(&self) -> Option<usize> {
        self.selected.time
    }

    pub(crate) fn belongs_to(&mut self, joints: RecordedJoints) {
        self.selected.joints = joints;
    }

    /// Adds what a person should know.
    pub(crate) fn remark(&mut self, remark: String) {
        self.selected.remarks.push(remark);
    }

    /// Refuses a table whose rows would not fit into memory, where they are not read in pieces.
    pub(crate) fn make_room(&self, rows: u64, piece_rows: usize) -> Result<(), RecordingError> {
        let width = self.selected.all().len() as u64 + 1;
        let held = rows.min(piece_rows as u64);
        self.memory.claim(&format!("its {rows} rows"), held.saturating_mul(8 * width))
    }

    /// Reads rows until `next` has no more: it fills the row and says whether there was one.
    ///
    /// # Errors
    /// A number that is not finite; too many rows that cannot be true; what `next` and `visit` return.
    pub(crate) fn read(
        mut self,
        format: String,
        piece_rows: usize,
        visit: Visit<'_>,
        next: &mut dyn FnMut(&mut [f64]) -> Result<bool, RecordingError>,
    ) -> Result<Recording, RecordingError> {
        let wanted = self.wanted();
        let first = usize::from(self.selected.time.is_none());
        let mut row = vec![0.0; first + wanted.len()];
        let remarks = std::mem::take(&mut self.selected.remarks);
        let room_rows = (ROOM_NUMBERS / row.len().max(1)).clamp(1, ROOM_ROWS);
        let mut collector = Collector::new(&self.selected, self.options, piece_rows.min(room_rows));
        while next(&mut row[first..])? {
            let needed = row.len() - self.selected.branches.len();
            let number = collector.rows() + 1;
            match row[first..needed].iter().position(|v| !v.is_finite()) {
                None => collector.add(&mut row, number),
                Some(place) if self.options.recorded.drops_rows() => collector.skip(number, wanted[place]),
                Some(place) => collector.refuse(RecordingError::Value {
                    path: self.path.to_owned(),
                    row: number,
                    name: self.header.name(wanted[place]),
                    value: row[first + place],
                    rows: 1,
                })?,
            }
            // Not every format says beforehand how many rows there are.
            if collector.held().is_multiple_of(room_rows) {
                self.make_room(collector.held() as u64, piece_rows)?;
            }
            if collector.held() >= piece_rows {
                let series = collector.piece(false);
                visit(&recording(self.path, &self.selected, series, ReadReport::default()))?;
            }
        }
        let rows = collector.rows();
        if rows == 0 {
            let found = "it has columns, but no rows".to_owned();
            return Err(RecordingError::NoRows { path: self.path.to_owned(), found });
        }
        let mut collected = collector.finish(self.path, &self.header, self.options.max_corrupt_share)?;
        let series = std::mem::take(&mut collected.series);
        let mut report = report(format, &self.header, &self.selected, rows, collected);
        report.remarks.splice(0..0, remarks);
        report.line_is_row = true;
        Ok(recording(self.path, &self.selected, series, report))
    }
}

pub(super) fn report(
    format: String,
    header: &Header,
    selected: &Selected,
    rows: usize,
    collected: Collected,
) -> ReadReport {
    let time = match (selected.time, selected.rate_hz) {
        (Some(time), _) => header.name(time),
        (None, rate) => format!("{} rows per second, as was stated", rate.unwrap_or_default()),
    };
    let mut columns = vec![format!("time: {time}")];
    if !selected.position.is_empty() {
        columns.push(format!("position: {}", header.span(&selected.position)));
    }
    if let Some(velocity) = &selected.velocity {
        columns.push(format!("velocity: {}", header.span(velocity)));
    }
    if let Some(measurement) = &selected.measurement {
        columns.push(format!("{}: {}", selected.unit.quantity(), header.span(measurement)));
    }
    ReadReport {
        format,
        rows,
        columns,
        dropped: collected.dropped,
        dropped_rows: collected.dropped_rows,
        rows_without_numbers: collected.rows_without_numbers,
        repeated_rows: collected.repeated_rows,
        absent: collected.absent,
        remarks: selected.remarks.iter().cloned().chain(collected.remarks).collect(),
        irregularities: selected.unread.iter().cloned().chain(collected.irregularities).collect(),
        origin_s: collected.origin_s,
        set_back_s: collected.set_back_s,
        branches: collected.branches,
        ..ReadReport::default()
    }
}

pub(super) fn recording(
    path: &Path,
    selected: &Selected,
    series: Vec<Vec<f64>>,
    report: ReadReport,
) -> Recording {
    // A file that is joined to another may have no positions.
    let mut series = series.into_iter();
    let mut family = |columns: &[usize]| series.by_ref().take(columns.len()).collect::<Vec<_>>();
    let time_s = family(&[0]).pop().unwrap_or_default();
    Recording {
        file: path.to_owned(),
        time_s,
        position_rad: family(&selected.position),
        velocity_rad_s: selected.velocity.as_deref().map(&mut family),
        measurement: selected.measurement.as_deref().map(&mut family),
        unit: selected.unit,
        joints: selected.joints.clone(),
        report,
    }
}

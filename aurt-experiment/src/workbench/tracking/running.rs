//! Rows as they come.

use std::fs::File;
use std::io;
use std::path::Path;

use aurt::CalibratedModel;
use aurt::data::{Loaded, Purpose, Source};
use aurt_calibration::{CalibrationError, Cut, DriftReference, drift_windows};
use aurt_recording::{PreprocessReport, Recording, RecordingError, read_running};

use super::{Alarm, Follower, prepared_of};
use crate::workbench::failure::Failure;

const ROWS: usize = 256;

const TABLE_ROW_S: f64 = 600.0;

/// Periods of the lower cut-off in which filters forget the ends of a piece, to e⁻⁷ of them: the slowest pole of a
/// Butterworth filter of fourth order decays by e⁻²·⁴ in each.
const SETTLING_PERIODS: f64 = 3.0;

const TOLD: usize = 5;

pub(super) struct Running<'a> {
    follower: &'a mut Follower,
    reference: &'a DriftReference<'a>,
    calibrated: &'a CalibratedModel,
    source: Source,
    settling_s: f64,
    /// Rows that are not done with.
    pending: Option<Recording>,
    origin_s: f64,
    /// Up to here rows have been taken in.
    done_s: f64,
    row_from_s: f64,
    rate_hz: Option<f64>,
    rates: Vec<String>,
    jumps: usize,
    missing_s: f64,
    resting_s: f64,
}

impl<'a> Running<'a> {
    pub(super) fn new(
        follower: &'a mut Follower,
        reference: &'a DriftReference<'a>,
        calibrated: &'a CalibratedModel,
        source: Source,
    ) -> Self {
        let filters = calibrated.pipeline().preprocessing;
        let lowest_hz = filters.effective_position_cutoff_hz().min(filters.effective_parallel_cutoff_hz());
        Self {
            follower,
            reference,
            calibrated,
            source,
            settling_s: SETTLING_PERIODS / lowest_hz,
            pending: None,
            origin_s: 0.0,
            done_s: 0.0,
            row_from_s: 0.0,
            rate_hz: None,
            rates: Vec::new(),
            jumps: 0,
            missing_s: 0.0,
            resting_s: 0.0,
        }
    }

    pub(super) fn follow(mut self, said: &mut dyn FnMut(&Alarm)) -> Result<(), Failure> {
        let name = Path::new("standard input").to_owned();
        let input = standard_input().map_err(|source| RecordingError::Unreadable {
            path: name.clone(),
            remedy: "pipe rows into it, as `tail -n +1 -f log.csv` does",
            source,
        })?;
        self.follower.begin(self.source.label.clone(), [f64::NAN; 2]);
        let joints = self.calibrated.pipeline().joints;
        let options = self.source.read_options(Some(&joints), Purpose::Calibration);
        let mut failed = None;
        let report = read_running(input, &name, &options, ROWS, &mut |piece| {
            self.push(piece, said).map_err(|failure| {
                failed = Some(failure);
                // Ends the reading; what is reported is the failure.
                RecordingError::NoRows { path: name.clone(), found: String::new() }
            })
        });
        if let Some(failure) = failed {
            return Err(failure);
        }
        let report = report?;
        self.take_until(f64::INFINITY, said)?;
        self.close()?;
        self.follower.tracked.notes.extend(report.notes());
        self.tell();
        Ok(())
    }

    /// Takes in rows, whose stamps do not go back.
    fn push(&mut self, piece: &Recording, said: &mut dyn FnMut(&Alarm)) -> Result<(), Failure> {
        let Some((first, last)) = piece.time_s.first().copied().zip(piece.time_s.last().copied()) else {
            return Ok(());
        };
        self.count_jumps(&piece.time_s);
        match &mut self.pending {
            None => {
                (self.origin_s, self.done_s, self.row_from_s) = (first, first, first);
                self.pending = Some(piece.clone());
            }
            Some(pending) => append(pending, piece),
        }
        // Windows that are preprocessed together.
        let length_s = self.follower.tracked.options.longest_pause_s();
        while last >= self.done_s + length_s + self.settling_s {
            let next_s = self.first_from(self.done_s);
            if next_s >= self.done_s + length_s {
                // Nothing lies within: time has jumped.
                self.done_s = next_s;
                self.follower.begin_motion();
                continue;
            }
            self.take_until(self.done_s + length_s, said)?;
            if self.follower.open_s() >= TABLE_ROW_S {
                self.close()?;
            }
        }
        Ok(())
    }

    /// Counts where time jumps, as preprocessing finds gaps: over 0.1 s or ten periods.
    fn count_jumps(&mut self, time_s: &[f64]) {
        let before = self.pending.as_ref().and_then(|p| p.time_s.last().copied());
        let stamps: Vec<f64> = before.into_iter().chain(time_s.iter().copied()).collect();
        let mut steps_s: Vec<f64> = stamps.windows(2).map(|w| w[1] - w[0]).collect();
        steps_s.sort_unstable_by(f64::total_cmp);
        let period_s = steps_s.get(steps_s.len() / 2).copied().unwrap_or(0.0);
        let most_s = self.calibrated.preprocessing.max_gap_s.unwrap_or(f64::max(0.1, 10.0 * period_s));
        for step_s in steps_s.iter().filter(|s| **s > most_s) {
            self.jumps += 1;
            self.missing_s += step_s;
        }
    }

    fn first_from(&self, stamp_s: f64) -> f64 {
        let time_s = self.pending.as_ref().map_or(&[][..], |p| &p.time_s);
        time_s.get(time_s.partition_point(|t| *t < stamp_s)).copied().unwrap_or(f64::INFINITY)
    }

    /// Takes in what lies before a stamp and was not taken in yet.
    fn take_until(&mut self, end_s: f64, said: &mut dyn FnMut(&Alarm)) -> Result<(), Failure> {
        let Some(pending) = &mut self.pending else { return Ok(()) };
        let span_s = [self.done_s, end_s];
        let [from_s, to_s] = [span_s[0] - self.settling_s, end_s + self.settling_s];
        cut_before(pending, from_s);
        let after = pending.time_s.partition_point(|t| *t <= to_s);
        let recording = beginning(pending, after);
        self.done_s = end_s;
        let Some(last_s) = recording.time_s.last().copied() else { return Ok(()) };
        let recording = recording.of_robot(&self.calibrated.pipeline().joints)?;
        let prepared = match prepared_of(self.calibrated, &Loaded { source: self.source.clone(), recording })
        {
            Ok(prepared) => prepared,
            Err(Failure::Library(aurt::Error::Recording(error)))
                if matches!(*error, RecordingError::TooShort { .. } | RecordingError::AtRest { .. }) =>
            {
                self.resting_s += (last_s.min(end_s) - span_s[0]).max(0.0);
                return Ok(());
            }
            Err(failure) => return Err(failure),
        };
        self.watch(&prepared.data.report, span_s);
        let cut =
            Cut { window_s: self.follower.tracked.options.window_s, span_s, origin_s: Some(self.origin_s) };
        for window in drift_windows(self.reference, &prepared, &[], cut)? {
            if let Some(alarm) = self.follower.take(&window)? {
                said(&alarm);
            }
        }
        Ok(())
    }

    /// Counts changes of the rate.
    fn watch(&mut self, report: &PreprocessReport, span_s: [f64; 2]) {
        let rate_hz = report.rate_hz;
        if let Some(before_hz) = self.rate_hz.filter(|b| (rate_hz / b - 1.0).abs() > 0.1) {
            let at_s = span_s[0] - self.origin_s;
            self.rates.push(format!("from {before_hz:.0} Hz to {rate_hz:.0} Hz at about {at_s:.0} s"));
        }
        self.rate_hz = Some(rate_hz);
    }

    /// Ends a row of the table, if there is something in it.
    fn close(&mut self) -> Result<(), CalibrationError> {
        if self.follower.open_s() == 0.0 {
            return Ok(());
        }
        let last_s = self.pending.as_ref().and_then(|p| p.time_s.last().copied()).unwrap_or(self.done_s);
        let end_s = self.done_s.min(last_s);
        let [from_s, to_s] = [self.row_from_s - self.origin_s, end_s - self.origin_s];
        let name = format!("{}, {from_s:.0} s to {to_s:.0} s", self.source.label);
        self.row_from_s = end_s;
        self.follower.close(name)
    }

    fn tell(self) {
        let Self { follower, source, rates, jumps, missing_s, resting_s, .. } = self;
        let (label, notes) = (source.label, &mut follower.tracked.notes);
        if jumps > 0 {
            notes.push(format!("{label}: time jumped {jumps} times, over {missing_s:.1} s together"));
        }
        if resting_s > 0.0 {
            notes.push(format!("{label}: {resting_s:.0} s at rest or in fragments say nothing"));
        }
        if !rates.is_empty() {
            let shown = rates[..rates.len().min(TOLD)].join("; ");
            notes.push(format!("{label}: the rate changed {} times: {shown}", rates.len()));
        }
    }
}

fn series(recording: &mut Recording) -> impl Iterator<Item = &mut Vec<f64>> {
    let Recording { time_s, position_rad, velocity_rad_s, measurement, .. } = recording;
    let families = [velocity_rad_s, measurement].into_iter().flatten().flatten();
    std::iter::once(time_s).chain(position_rad).chain(families)
}

fn append(pending: &mut Recording, piece: &Recording) {
    let mut piece = piece.clone();
    series(pending).zip(series(&mut piece)).for_each(|(all, more)| all.append(more));
}

fn cut_before(pending: &mut Recording, stamp_s: f64) {
    let first = pending.time_s.partition_point(|t| *t < stamp_s);
    series(pending).for_each(|s| drop(s.drain(..first)));
}

fn beginning(pending: &Recording, rows: usize) -> Recording {
    let mut beginning = pending.clone();
    series(&mut beginning).for_each(|s| s.truncate(rows));
    beginning
}

/// Standard input as a file, which formats read from.
fn standard_input() -> io::Result<File> {
    #[cfg(unix)]
    let owned = std::os::fd::AsFd::as_fd(&io::stdin()).try_clone_to_owned();
    #[cfg(windows)]
    let owned = std::os::windows::io::AsHandle::as_handle(&io::stdin()).try_clone_to_owned();
    Ok(File::from(owned?))
}

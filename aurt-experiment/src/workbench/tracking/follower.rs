use std::collections::VecDeque;

use aurt_calibration::{
    Baseline, CalibrationError, ChangePoint, Chart, DriftEstimate, DriftParameter, DriftReference,
    DriftWindow, Solution, System, Tracker, average_run_length, own_residuals, threshold_for,
};

use super::{Alarm, TrackOptions, Tracked, TrackedRecording};

#[derive(Debug, Clone, Copy)]
struct Place {
    source: usize,
    start_s: f64,
    end_s: f64,
}

/// A chart, and where the windows lie that it took in.
struct Charted {
    chart: Chart,
    /// Windows in which a change may have begun, and the index of the first of them.
    places: VecDeque<Place>,
    first: usize,
    is_silent: bool,
}

impl Charted {
    /// Takes in the next window; the places of a change that it makes certain.
    fn push(
        &mut self,
        baseline: &Baseline,
        window: &Solution,
        place: Place,
    ) -> Option<(ChangePoint, [Place; 2])> {
        let (is_taken, change) = self.chart.push(baseline, window);
        if is_taken {
            self.places.push_back(place);
        }
        let found = change.and_then(|c| Some((c, [*self.places.get(c.since - self.first)?, place])));
        let needed = self.chart.needed_from();
        while self.first < needed && self.places.pop_front().is_some() {
            self.first += 1;
        }
        let was_silent = self.is_silent;
        self.is_silent |= found.is_some();
        found.filter(|_| !was_silent)
    }
}

/// What has been seen so far; its size does not depend on how much that was, but for the rows of the table.
pub(super) struct Follower {
    pub(super) tracked: Tracked,
    sigma: Vec<f64>,
    columns: Vec<Vec<usize>>,
    tracker: Tracker,
    charts: Vec<Charted>,
    sources: Vec<String>,
    /// Last stamp of the recording before, s.
    ended_s: f64,
    /// The recording that is being taken in: its rows, their duration in s, and its windows.
    current: (Option<System>, f64, usize),
}

impl Follower {
    /// A chart for every joint's friction and gain and for the mass of the load, where the baseline determines it; their
    /// false alarms together come as seldom as asked for.
    pub(super) fn new(
        reference: &DriftReference<'_>,
        sigma: &[f64],
        options: TrackOptions,
        (baseline, baseline_recordings): (Baseline, Vec<String>),
        mut notes: Vec<String>,
    ) -> Self {
        let (parameters, columns) = (reference.parameters(), reference.columns());
        let is_charted = |k: &usize| {
            let p: &DriftParameter = &parameters[*k];
            p.joint.is_some() || p.unit == "kg"
        };
        let charted: Vec<usize> = (0..parameters.len()).filter(is_charted).collect();
        let known = charted.iter().filter(|k| Chart::new(**k, &baseline, 0.0).is_some()).count();
        let windows = options.false_alarm_h * 3600.0 / options.window_s;
        let threshold = threshold_for(Chart::ALLOWANCE, windows * (known * Chart::SUMS) as f64);
        let charts: Vec<Charted> = charted
            .into_iter()
            .filter_map(|parameter| Chart::new(parameter, &baseline, threshold))
            .map(|chart| Charted { chart, places: VecDeque::new(), first: 0, is_silent: false })
            .collect();
        if baseline.motions.iter().all(|m| *m < 2) {
            notes.push(
                "the unchanged machine is one recording: by how much another motion differs from it is not known, and may \
                 show as a change; list recordings of other motions"
                    .into(),
            );
        }
        Self {
            tracker: Tracker::new(parameters.len(), columns.clone(), sigma),
            tracked: Tracked {
                options,
                parameters,
                joint_names: reference.model.rigid_body().joint_names().to_vec(),
                baseline,
                baseline_recordings,
                charts: charts.len(),
                threshold,
                average_run_length_windows: average_run_length(Chart::ALLOWANCE, threshold),
                recordings: Vec::new(),
                alarms: Vec::new(),
                notes,
            },
            sigma: sigma.to_vec(),
            columns,
            charts,
            sources: Vec::new(),
            ended_s: f64::NEG_INFINITY,
            current: (None, 0.0, 0),
        }
    }

    /// The windows that follow are of this recording or stream with these first and last stamps.
    pub(super) fn begin(&mut self, source: String, span_s: [f64; 2]) {
        self.sources.push(source);
        if !self.tracked.options.continues(self.ended_s, span_s[0]) {
            self.begin_motion();
        }
        self.ended_s = span_s[1];
    }

    /// The windows that follow are of another motion.
    pub(super) fn begin_motion(&mut self) {
        self.charts.iter_mut().for_each(|c| c.chart.begin_motion());
    }

    /// Takes in the next window; the first alarm that it makes certain.
    pub(super) fn take(&mut self, window: &DriftWindow) -> Result<Option<Alarm>, CalibrationError> {
        let DriftEstimate { solution, rows } = DriftEstimate::of(&window.system, &self.sigma)?;
        self.current.1 += window.duration_s;
        self.tracker.forget(&self.kept(window.duration_s))?;
        self.tracker.add(&rows)?;
        match &mut self.current.0 {
            None => self.current.0 = Some(rows),
            Some(sum) => sum.merge(&rows)?,
        }
        if !window.whole {
            return Ok(None);
        }
        self.current.2 += 1;
        let source = self.sources.len().saturating_sub(1);
        let place = Place { source, start_s: window.start_s, end_s: window.start_s + window.duration_s };
        let Tracked { baseline, parameters, joint_names, alarms, .. } = &mut self.tracked;
        let before = alarms.len();
        for chart in &mut self.charts {
            if let Some((change, places)) = chart.push(baseline, &solution, place) {
                let parameter = &parameters[chart.chart.parameter];
                let named = |place: Place| self.sources.get(place.source).cloned().unwrap_or_default();
                alarms.push(Alarm {
                    group: parameter.group,
                    joint: parameter.joint,
                    joint_name: parameter.joint.and_then(|joint| joint_names.get(joint).cloned()),
                    parameter: parameter.name.clone(),
                    rose: change.rose,
                    since_recording: named(places[0]),
                    since_s: places[0].start_s,
                    certain_recording: named(places[1]),
                    certain_s: places[1].end_s,
                });
            }
        }
        Ok(alarms.get(before).cloned())
    }

    /// Ends a row of the table.
    pub(super) fn close(&mut self, name: String) -> Result<(), CalibrationError> {
        let (rows, duration_s, windows) = std::mem::take(&mut self.current);
        let Tracked { options, baseline, parameters, recordings, notes, .. } = &mut self.tracked;
        if windows == 0 {
            notes.push(format!(
                "{name} is shorter than a window of {} s: its drift is estimated, but not charted",
                options.window_s
            ));
        }
        let rows = rows.ok_or(CalibrationError::NothingToCalibrateOn)?;
        let n = parameters.len();
        let mut alone = Tracker::new(n, self.columns.clone(), &self.sigma);
        alone.add(&rows)?;
        let (mut alone, mut followed) = (alone.estimate()?, self.tracker.estimate()?);
        for (k, wider) in own_residuals(&rows, &alone, &self.sigma).into_iter().enumerate() {
            alone.covariance[k * n + k] *= wider;
            followed.covariance[k * n + k] *= wider;
        }
        let window_variances: Vec<f64> =
            (0..n).map(|k| alone.covariance[k * n + k] * windows.max(1) as f64).collect();
        let drift = |of: &Solution| (0..n).map(|k| baseline.drift(of, k, window_variances[k])).collect();
        recordings.push(TrackedRecording {
            recording: name,
            duration_s,
            windows,
            drift: drift(&alone),
            tracked: drift(&followed),
        });
        Ok(())
    }

    /// Seconds that were taken in since the last row of the table.
    pub(super) const fn open_s(&self) -> f64 {
        self.current.1
    }

    /// The share of its information that each parameter keeps over some seconds.
    fn kept(&self, duration_s: f64) -> Vec<f64> {
        let half_life_s = |p: &DriftParameter| self.tracked.options.half_life_s[p.group as usize];
        self.tracked.parameters.iter().map(|p| (-duration_s / half_life_s(p)).exp2()).collect()
    }
}

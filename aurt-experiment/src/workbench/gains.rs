//! Gains of the drives from an experiment: ratios from unloaded motion, the common factor from a load of known mass.

use crate::Experiment;
use aurt::Progress;
use aurt::data::Purpose;
use aurt::duplicates::SampleRegister;
use aurt_calibration::{Decided, Gain, Gains, GainsOf, KnownLoad, with_deviation};
use aurt_report::rendering::table::Table;
use aurt_traits::{MeasurementUnit, RobotNames};
use serde::Serialize;

use crate::workbench::experiments;
use crate::workbench::failure::Failure;

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Question {
    Estimate,
    /// What the recordings determine, before anything is estimated.
    Expectation,
}

/// Gains as an experiment's recordings show them.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct DriveGains {
    /// Gains over those that the experiment states; torque per measured value where it states none.
    pub gains: Gains,
    /// Unit of the measurement before the experiment's torque constants.
    pub measured_in: &'static str,
    pub stated_nm_per_a: Option<Vec<f64>>,
    /// Torque constants, where all are determined and currents were measured.
    pub torque_constants_nm_per_a: Option<Vec<f64>>,
    /// `gains` of `[instrument]`, where all are determined and torques were measured.
    pub instrument_gains: Option<Vec<f64>>,
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub joint_names: Vec<String>,
    pub recordings: Vec<String>,
    /// Whether this is what is expected, not what was estimated.
    #[serde(skip)]
    question: Question,
}

/// Estimates gains on the calibration recordings of an experiment, whose arm term `payload` is the load.
pub fn drive_gains(
    experiment: &Experiment,
    load: Option<KnownLoad>,
    question: Question,
    progress: &Progress,
) -> Result<DriveGains, Failure> {
    let job = experiments::job(experiment)?;
    let assigned = job.read(experiment.recordings.calibration.iter().cloned(), [], progress)?;
    SampleRegister::check(assigned.iter().map(|a| (&a.loaded, a.role.name())))?;
    let pipeline = job.pipeline();
    pipeline.common_unit(assigned.iter().map(|a| &a.loaded))?;
    let recordings = assigned
        .iter()
        .map(|a| pipeline.preprocess(&a.loaded, Purpose::Calibration))
        .collect::<Result<Vec<_>, _>>()?;
    progress.step("estimating");
    let of = GainsOf {
        model: &job.model,
        recordings: &recordings,
        scopes: &job.scopes,
        load,
        options: &job.options,
    };
    let mut gains = match question {
        Question::Estimate => aurt_calibration::estimate_gains(&of)?,
        Question::Expectation => aurt_calibration::decidable_gains(&of)?,
    };
    gains.warnings.extend(assigned.iter().flat_map(|a| a.loaded.warnings()));
    let unit = assigned.first().map_or_else(MeasurementUnit::default, |a| a.loaded.recording.unit);
    let stated = experiment.instrument.torque_constants_nm_per_a.clone();
    let is_whole = question == Question::Estimate && gains.joints.iter().all(|g| g.decided == Decided::Gain);
    let values = |of: &dyn Fn(usize, f64) -> f64| -> Option<Vec<f64>> {
        is_whole.then(|| gains.joints.iter().enumerate().map(|(j, g)| rounded(of(j, g.value))).collect())
    };
    let is_current = unit == MeasurementUnit::Ampere;
    let constants = values(&|j, factor| factor * stated.as_ref().map_or(1.0, |s| s[j]));
    let own = |j: usize| experiment.instrument.gains.as_ref().map_or(1.0, |g| g[j]);
    let instrument = values(&|j, factor| own(j) / factor);
    Ok(DriveGains {
        measured_in: unit.symbol(),
        torque_constants_nm_per_a: constants.filter(|_| is_current),
        instrument_gains: instrument.filter(|_| !is_current),
        stated_nm_per_a: stated.filter(|_| is_current),
        joint_names: job.model.rigid_body().joint_names().to_vec(),
        recordings: recordings.iter().map(|r| r.name.clone()).collect(),
        gains,
        question,
    })
}

/// Six digits, more than any recording determines.
fn rounded(value: f64) -> f64 {
    format!("{value:.5e}").parse().unwrap_or(value)
}

impl DriveGains {
    /// The table, what to write into the experiment, and what to know.
    pub fn to_text(&self) -> String {
        let expected = self.question == Question::Expectation;
        let reference = self.gains.reference;
        let names = RobotNames::of_joints(&self.joint_names);
        let scale = |j: usize| self.stated_nm_per_a.as_ref().map_or(1.0, |s| s[j]);
        let unit = if self.measured_in == "A" { "gain, Nm/A".to_owned() } else { "gain".to_owned() };
        let mut header = vec!["joint".to_owned(), unit];
        if self.stated_nm_per_a.is_some() {
            header.push("over the stated".into());
        }
        header.push(format!("ratio to {}", names.joint(reference)));
        if self.stated_nm_per_a.is_some() {
            header.push("over the stated".into());
        }
        let mut table = Table::new(header).left(usize::from(!self.joint_names.is_empty()));
        for (j, gain) in self.gains.joints.iter().enumerate() {
            let mut cells = vec![
                names.joint_cell(j),
                cell(gain.value * scale(j), self.absolute(gain, scale(j)), expected),
            ];
            if self.stated_nm_per_a.is_some() {
                cells.push(cell(gain.value, self.absolute(gain, 1.0), expected));
            }
            let relative = scale(j) / scale(reference);
            let ratio = |factor: f64| gain.ratio_std_dev.map(|s| s * factor.abs());
            cells.push(cell(gain.ratio * relative, ratio(relative), expected));
            if self.stated_nm_per_a.is_some() {
                cells.push(cell(gain.ratio, ratio(1.0), expected));
            }
            table.row(cells);
        }
        let of = match self.gains.mass_kg {
            Some(mass) => format!("some of them with a load of {mass} kg"),
            None => "without a known load: ratios only, the common factor is not determined".into(),
        };
        let said = if expected {
            "what these recordings determine, and the deviations that white noise would leave"
        } else {
            "gains of the drives"
        };
        let mut text = format!("{said}; {} recordings, {of}\n\n{}", self.recordings.len(), table.render());
        if let Some([x, y, z]) = self.gains.centre_of_mass_m.filter(|_| !expected) {
            text.push_str(&format!(
                "\ncentre of mass of the load in its link's frame: {x:.3} {y:.3} {z:.3} m\n"
            ));
        }
        if let Some(constants) = &self.torque_constants_nm_per_a {
            text.push_str(&format!("\nfor [robot]:\n  torque_constants_nm_per_a = {constants:?}\n"));
        }
        if let Some(gains) = &self.instrument_gains {
            text.push_str(&format!("\nfor [instrument]:\n  gains = {gains:?}\n"));
        }
        for warning in &self.gains.warnings {
            text.push_str(&format!("\nwarning: {warning}\n"));
        }
        text
    }

    fn absolute(&self, gain: &Gain, scale: f64) -> Option<f64> {
        gain.std_dev.map(|s| s * scale.abs())
    }
}

/// A value with its deviation; of what is only expected the deviation as a share.
fn cell(value: f64, deviation: Option<f64>, expected: bool) -> String {
    match deviation {
        None => "not determined".into(),
        Some(s) if expected => format!("± {:.1} %", 100.0 * s / value.abs()),
        Some(s) => with_deviation(value, s),
    }
}

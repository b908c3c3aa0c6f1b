//! Findings for faults of the recordings.

use crate::faults::Fault;
use crate::investigation::Investigation;
use crate::parameters::ParameterValue;
use crate::recordings::rows::Role;
use crate::request::Question;
use crate::verdict::{Evidence, Finding};
use crate::vocabulary::{Effect, Unit};

/// A fault is as certain as its probability says, but no verdict is surer than this.
const SUREST: f64 = 0.99;

/// Shares of faulty rows that differ by more than so many deviations are two.
const DIFFER: f64 = 3.0;

/// Findings for the faults that suffice to explain a mismatch, those of one effect together: where the targets have another share
/// of such rows than the calibration recordings, one for each.
pub(crate) fn fault_findings(question: &Question<'_>, investigation: &Investigation) -> Vec<Finding> {
    let mut effects: Vec<&'static Effect> = Vec::new();
    for fault in &investigation.faults {
        if !effects.iter().any(|e| e.id == fault.effect.id) {
            effects.push(fault.effect);
        }
    }
    let mut findings = Vec::new();
    for effect in effects {
        let roles = [Role::Calibration, Role::Target];
        let of_role = |role| Faulty::of(question, investigation, effect, role);
        let [reference, target] = roles.map(of_role);
        // How often a joint meets its limit is a matter of the motion.
        if effect.is_whole_arm && reference.differs(&target) {
            findings.extend([target, reference].iter().filter_map(|faulty| faulty.finding(question, effect)));
        } else {
            findings.extend(reference.with(target).finding(question, effect));
        }
    }
    findings
}

/// The faults of one effect in recordings of one role, or of both.
struct Faulty<'f> {
    faults: Vec<(&'f Fault, &'static str)>,
    /// Faulty rows, and all.
    rows: [f64; 2],
}

impl<'f> Faulty<'f> {
    fn of(question: &Question<'_>, investigation: &'f Investigation, effect: &Effect, role: Role) -> Self {
        let mut faulty = Self { faults: Vec::new(), rows: [0.0; 2] };
        let kind = if role == Role::Target { "target" } else { "calibration" };
        for recording in question.recordings.iter().filter(|r| r.role == role) {
            let samples = recording.raw.samples() as f64;
            faulty.rows[1] += samples;
            let own = |f: &&Fault| f.effect.id == effect.id && f.recording == recording.data.name;
            for fault in investigation.faults.iter().filter(own) {
                faulty.rows[0] += fault.share * samples;
                if fault.suffices {
                    faulty.faults.push((fault, kind));
                }
            }
        }
        faulty
    }

    /// Whether the shares of faulty rows are not the same but for chance.
    fn differs(&self, other: &Self) -> bool {
        let [[a, n], [b, m]] = [self.rows, other.rows];
        let share = (a + b) / (n + m);
        let deviation = (share * (1.0 - share) * (1.0 / n + 1.0 / m)).sqrt();
        n > 0.0 && m > 0.0 && (a / n - b / m).abs() > DIFFER * deviation
    }

    fn with(mut self, other: Self) -> Self {
        self.faults.extend(other.faults);
        self
    }

    /// The finding, with the numbers of the recording that has most of it.
    fn finding(&self, question: &Question<'_>, effect: &'static Effect) -> Option<Finding> {
        let (worst, _) = self.faults.iter().max_by(|a, b| a.0.share.total_cmp(&b.0.share))?;
        let mut joints: Vec<usize> = self.faults.iter().flat_map(|(f, _)| &f.joints).copied().collect();
        joints.sort_unstable();
        joints.dedup();
        let mut present_in: Vec<String> = self.faults.iter().map(|(_, kind)| (*kind).to_owned()).collect();
        present_in.dedup();
        let names = self.faults.iter().map(|(fault, _)| fault.recording.as_str());
        let mut others: Vec<&str> = names.filter(|name| *name != worst.recording).collect();
        others.dedup();
        let is_one = others.is_empty();
        let also: String = others.iter().map(|name| format!("; also in {name}")).collect();
        let window = match worst.windows_s.as_slice() {
            [only] if is_one => Some(*only),
            _ => None,
        };
        let parameters = worst.parameters.iter().map(|(name, parameter)| {
            let measured = effect.parameter(name).is_some_and(|p| p.unit == Unit::Measurement);
            let fitted = measured.then(|| in_unit_of_fit(question, worst, parameter)).flatten();
            (name.clone(), fitted.unwrap_or_else(|| parameter.clone()))
        });
        Some(Finding {
            present_in,
            recording: is_one.then(|| worst.recording.clone()),
            window_s: window,
            parameters: parameters.collect(),
            sentence: format!("{}{also}", worst.sentence),
            ..Finding::new(
                effect,
                joints,
                Evidence::of(-worst.log10_probability * std::f64::consts::LN_10, question.selection.score),
                (1.0 - 10.0_f64.powf(worst.log10_probability)).min(SUREST),
            )
        })
    }
}

/// A limit of a recorded measurement, after the gains that the fit is made with.
fn in_unit_of_fit(question: &Question<'_>, fault: &Fault, limit: &ParameterValue) -> Option<ParameterValue> {
    let recording = question.recordings.iter().find(|r| r.data.name == fault.recording)?;
    let gains = recording.options.gains.as_ref()?;
    Some(ParameterValue::exact(limit.value.as_f64()? * gains[*fault.joints.first()?].abs()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn shares_are_compared_by_what_chance_makes_of_them() {
        let of = |faulty, all| Faulty { faults: Vec::new(), rows: [faulty, all] };
        assert!(of(7.0, 7900.0).differs(&of(84.0, 4439.0)));
        assert!(!of(7.0, 7900.0).differs(&of(8.0, 4000.0)));
        assert!(!of(0.0, 0.0).differs(&of(84.0, 4439.0)), "nothing to compare with");
    }
}

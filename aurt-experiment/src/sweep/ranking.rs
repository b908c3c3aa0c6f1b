//! Points ranked by their errors on what they were not fitted to.

use aurt_traits::{MeasurementUnit, RobotNames};
use serde::Serialize;

use crate::sweep::comparison::{holm, paired, paired_overall};
use crate::sweep::result::{Evaluation, JointErrors, Outcome, Rows};
use crate::sweep::{Folder, Plan};

/// Differences count as explained by noise unless that has a probability below this, over all comparisons of a column
/// of the table together.
pub const LEVEL: f64 = 0.05;

/// The points of a sweep, best first.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Ranking {
    /// The rows that errors are taken over.
    pub rows: Rows,
    /// Unit of the measurement; of the reference, where points differ.
    pub unit: Option<MeasurementUnit>,
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub joint_names: Vec<String>,
    pub reference: Option<String>,
    /// What could be judged, best first.
    pub ranked: Vec<Ranked>,
    pub failed: Vec<Failed>,
    /// Numbers of points that have not been run.
    pub missing: Vec<usize>,
}

/// A point that could be judged.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Ranked {
    /// Its rank, from 1.
    pub rank: usize,
    /// Its number in the plan, from 1.
    pub number: usize,
    pub name: String,
    pub coefficients: usize,
    /// Number of shape parameters that were searched.
    pub shapes: usize,
    /// Geometric mean over the joints of MSE / MSE of the reference; absent where they cannot be compared.
    pub score: Option<f64>,
    /// Whether noise may explain its difference from the best point, over all joints together.
    pub tied_with_best: bool,
    pub joints: Vec<JointRank>,
    pub warnings: Vec<String>,
}

#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct JointRank {
    /// Mean squared error, unit of the measurement squared.
    pub mse: Option<f64>,
    /// Mean squared error over mean absolute measurement.
    pub nmse: Option<f64>,
    /// Root mean squared error over root mean squared measurement, percent.
    pub nrmse_percent: Option<f64>,
    /// By how much the MSE exceeds the reference's, percent.
    pub change_percent: Option<f64>,
    /// Whether noise does not explain the difference from the reference.
    pub beyond_noise: bool,
}

/// A point that could not be judged.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct Failed {
    /// Its number in the plan, from 1.
    pub number: usize,
    pub name: String,
    pub error: String,
}

/// A judged point with its sums.
struct Entry<'p> {
    number: usize,
    name: &'p str,
    evaluation: Evaluation,
    sums: Vec<JointErrors>,
    score: Option<f64>,
}

impl Ranking {
    pub fn of(folder: &Folder, plan: &Plan, rows: Rows) -> Self {
        let (mut entries, mut failed, mut missing) = (Vec::new(), Vec::new(), Vec::new());
        for (k, point) in plan.points.iter().enumerate() {
            let (number, name) = (k + 1, point.name.as_str());
            match folder.result(&point.key).map(|r| r.outcome) {
                Some(Outcome::Judged(evaluation)) => {
                    let sums = evaluation.pooled(rows);
                    entries.push(Entry { number, name, evaluation, sums, score: None });
                }
                Some(Outcome::Failed(error)) => failed.push(Failed { number, name: name.to_owned(), error }),
                None => missing.push(number),
            }
        }
        let joint_names = plan.joint_names.clone();
        // Where the reference has no result, the first point that has one stands in.
        let at = entries.iter().position(|e| e.number == plan.reference + 1).unwrap_or(0);
        let Some(reference) = entries.get(at) else {
            let ranked = Vec::new();
            return Self { rows, unit: None, joint_names, reference: None, ranked, failed, missing };
        };
        let (unit, name) = (reference.evaluation.unit, reference.name.to_owned());
        let sums = reference.sums.clone();
        for entry in entries.iter_mut().filter(|e| e.evaluation.unit == unit) {
            entry.score = score(&entry.sums, &sums);
        }
        let ranked = ranked(entries, &sums, unit);
        Self { rows, unit: Some(unit), joint_names, reference: Some(name), ranked, failed, missing }
    }
}

/// Geometric mean of the ratios of mean squared errors.
fn score(sums: &[JointErrors], reference: &[JointErrors]) -> Option<f64> {
    if sums.len() != reference.len() {
        return None;
    }
    let logs: Vec<f64> = sums
        .iter()
        .zip(reference)
        .map(|(a, b)| (a.mse() / b.mse()).ln())
        .filter(|log| log.is_finite())
        .collect();
    (!logs.is_empty()).then(|| (logs.iter().sum::<f64>() / logs.len() as f64).exp())
}

fn ranked(mut entries: Vec<Entry<'_>>, reference: &[JointErrors], unit: MeasurementUnit) -> Vec<Ranked> {
    entries.sort_by(|a, b| {
        let score = |e: &Entry<'_>| e.score.unwrap_or(f64::INFINITY);
        score(a).total_cmp(&score(b)).then(a.number.cmp(&b.number))
    });
    let scale: Vec<f64> = reference.iter().map(JointErrors::mse).collect();
    let against_best: Vec<Option<f64>> = match entries.first() {
        Some(best) => entries.iter().map(|e| paired_overall(&e.sums, &best.sums)).collect(),
        None => Vec::new(),
    };
    let worse_than_best = holm(&against_best, LEVEL);
    let joints = reference.len();
    let beyond: Vec<Vec<bool>> = (0..joints)
        .map(|j| {
            let tests: Vec<Option<f64>> =
                entries.iter().map(|e| paired(e.sums.get(j)?, &reference[j])).collect();
            holm(&tests, LEVEL)
        })
        .collect();
    let known = |value: f64| Some(value).filter(|v| v.is_finite());
    entries
        .iter()
        .enumerate()
        .map(|(k, entry)| {
            let comparable = entry.evaluation.unit == unit;
            let joint = |(j, sums): (usize, &JointErrors)| JointRank {
                mse: known(sums.mse()),
                nmse: known(sums.nmse()),
                nrmse_percent: known(100.0 * sums.nrmse()),
                change_percent: scale
                    .get(j)
                    .and_then(|of| known(100.0 * (sums.mse() / of - 1.0)))
                    .filter(|_| comparable),
                beyond_noise: comparable && beyond.get(j).is_some_and(|b| b[k]),
            };
            let mut warnings: Vec<String> =
                entry.evaluation.folds.iter().flat_map(|f| f.warnings.clone()).collect();
            warnings.sort();
            warnings.dedup();
            Ranked {
                rank: k + 1,
                number: entry.number,
                name: entry.name.to_owned(),
                coefficients: entry.evaluation.coefficients,
                shapes: entry.evaluation.shapes,
                score: entry.score,
                tied_with_best: k == 0 || (against_best[k].is_some() && !worse_than_best[k]),
                joints: entry.sums.iter().enumerate().map(joint).collect(),
                warnings,
            }
        })
        .collect()
}

impl Ranking {
    pub fn joint_headings(&self) -> impl Iterator<Item = String> + '_ {
        let joints = self.ranked.first().map_or(0, |r| r.joints.len());
        (0..joints).map(|joint| RobotNames::of_joints(&self.joint_names).joint(joint))
    }

    /// The table as CSV, one row a point; points that failed have their error in the last column.
    pub fn to_csv(&self) -> String {
        let joints = self.ranked.first().map_or(0, |r| r.joints.len());
        let mut header: Vec<String> =
            ["rank", "point", "name", "coefficients", "shapes", "score", "tied_with_best"]
                .map(str::to_owned)
                .to_vec();
        for column in ["mse", "nmse", "nrmse_percent", "change_percent", "beyond_noise"] {
            header.extend((0..joints).map(|j| format!("{column}_{j}")));
        }
        header.push("error".into());
        let mut csv = header.join(",") + "\n";
        let number = |x: Option<f64>| x.map_or_else(String::new, |x| x.to_string());
        for r in &self.ranked {
            let mut cells = vec![
                r.rank.to_string(),
                r.number.to_string(),
                quoted(&r.name),
                r.coefficients.to_string(),
                r.shapes.to_string(),
                number(r.score),
                r.tied_with_best.to_string(),
            ];
            cells.extend(r.joints.iter().map(|j| number(j.mse)));
            cells.extend(r.joints.iter().map(|j| number(j.nmse)));
            cells.extend(r.joints.iter().map(|j| number(j.nrmse_percent)));
            cells.extend(r.joints.iter().map(|j| number(j.change_percent)));
            cells.extend(r.joints.iter().map(|j| j.beyond_noise.to_string()));
            cells.push(String::new());
            csv.push_str(&(cells.join(",") + "\n"));
        }
        for failed in &self.failed {
            let mut cells = vec![String::new(); header.len()];
            cells[1] = failed.number.to_string();
            cells[2] = quoted(&failed.name);
            if let Some(last) = cells.last_mut() {
                *last = quoted(&failed.error);
            }
            csv.push_str(&(cells.join(",") + "\n"));
        }
        csv
    }
}

fn quoted(text: &str) -> String {
    if text.contains([',', '"', '\n', '\r']) {
        format!("\"{}\"", text.replace('"', "\"\"").replace(['\n', '\r'], " "))
    } else {
        text.to_owned()
    }
}

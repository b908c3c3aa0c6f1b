//! Laws that were found in the targets and that calibration recordings have as well: no change.

use crate::evidence::deviations::beyond_chance;
use crate::evidence::gram::dot;
use crate::hypotheses::group::{Group, Switch};
use crate::investigation::Investigation;
use crate::investigation::fitted::Fitted;

/// Says that a law of the targets is no change: fitted to all recordings as well, the calibration recordings have it and the targets do not
/// differ from them, both by Student's t of the blocks of time. Targets whose motion shows more of a law do not change it.
pub(super) fn is_in_all(investigation: &Investigation, group: &Group, level: f64) -> Option<String> {
    let Investigation { problem, floor, mean_independent_share, .. } = investigation;
    if !group.target_only() || !problem.has_reference() {
        return None;
    }
    let model = investigation.switches();
    let of_all = |s: &Switch| Switch { target_only: false, ..*s };
    let is_new = |s: &Switch| !model.iter().any(|m| m.column == s.column && !m.target_only);
    let added = group.switches.iter().map(of_all).filter(is_new);
    // By how much targets differ may have any sign.
    let free = |s: &Switch| Switch { nonnegative: s.nonnegative && !group.switches.contains(s), ..*s };
    let switches: Vec<Switch> = model.iter().map(free).chain(added).collect();
    let fitted = Fitted::of(problem, floor, *mean_independent_share, switches);
    let named = group.switches.iter().filter(|s| !group.accessory.contains(s));
    let place = |s: &Switch| Some([fitted.place(s.column, false)?, fitted.place(s.column, true)?]);
    let places: Vec<[usize; 2]> = named.filter_map(place).collect();
    let values = &fitted.fit.coefficients;
    let of_targets: Vec<f64> = places.iter().map(|at| at.iter().map(|k| values[*k]).sum()).collect();
    let columns: Vec<Switch> = places.iter().map(|[_, own]| fitted.switches[*own]).collect();
    let gram = problem.cross(problem.total(), &columns, &columns, &fitted.weights);
    let weights: Vec<f64> = gram.chunks_exact(places.len().max(1)).map(|row| dot(row, &of_targets)).collect();
    let [all, own] = [0, 1].map(|which| {
        let mut direction = vec![0.0; fitted.switches.len()];
        places.iter().zip(&weights).for_each(|(at, weight)| direction[at[which]] = *weight);
        dot(&direction, values) / fitted.deviation(problem, &direction, 1.0).max(f64::MIN_POSITIVE)
    });
    let least = beyond_chance(1.0, problem.blocks() as f64 - 1.0, level);
    (all > least && own.abs() < least).then(|| {
        format!(
            "the calibration recordings have it as well ({all:.1} σ), and the targets do not differ from them ({:.1} σ)",
            own.abs()
        )
    })
}

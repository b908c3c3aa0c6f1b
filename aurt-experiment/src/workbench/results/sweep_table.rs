//! The ranking of a sweep on the terminal.

use crate::sweep::{Ranked, Ranking, Rows};
use aurt_report::rendering::number::percent;
use aurt_report::rendering::style::{Emphasis, Style};
use aurt_report::rendering::table::Table;
use aurt_report::rendering::text::wrapped;

/// Points that a terminal shows.
const MOST: usize = 40;

/// What of a ranking a person reads: the best `most` points and the reference, as many of those that failed, and how many were
/// left out, in words; nothing is left out of the tables.
pub fn readable(ranking: &Ranking, most: usize) -> (Ranking, Vec<String>) {
    let mut shown = ranking.clone();
    let is_reference = |r: &&Ranked| ranking.reference.as_ref() == Some(&r.name);
    let reference = ranking.ranked.iter().skip(most).find(is_reference).cloned();
    shown.ranked.truncate(most);
    shown.ranked.extend(reference);
    shown.failed.truncate(most);
    let mut left_out = Vec::new();
    for (all, kept, what) in [
        (ranking.ranked.len(), shown.ranked.len(), "points that were judged"),
        (ranking.failed.len(), shown.failed.len(), "points that failed"),
    ] {
        if all > kept {
            left_out.push(format!("{} of {all} {what} are left out here; table.json has all", all - kept));
        }
    }
    (shown, left_out)
}

pub fn ranges(numbers: &[usize]) -> String {
    let all = crate::sweep::slurm::ranges(numbers);
    let parts: Vec<&str> = all.split(',').collect();
    if parts.len() <= MOST {
        return all;
    }
    format!("{} and {} further ranges", parts[..MOST].join(","), parts.len() - MOST)
}

/// The points, best first: how their mean squared errors compare with the reference's, and how large they are; of many,
/// the best.
pub fn to_text(ranking: &Ranking, style: Style) -> String {
    let (ranking, left_out) = readable(ranking, MOST);
    let ranking = &ranking;
    let mut text = String::new();
    if let Some(reference) = &ranking.reference {
        let rows = match ranking.rows {
            Rows::All => "all rows in motion",
            Rows::Moving => "rows at which the joint moves",
        };
        let title = format!("held-out MSE over {rows}, against \"{reference}\", %");
        text.push_str(&format!("{}\n", style.emphasise(Emphasis::Title, &title)));
        let change = |r: &Ranked, j: usize| {
            r.joints[j].change_percent.map_or_else(
                || "–".into(),
                |c| format!("{c:+.1}{}", if r.joints[j].beyond_noise { "*" } else { " " }),
            )
        };
        text.push_str(&table(ranking, "all", &overall, &change));
        text.push_str(&wrapped(
            "*: more than noise explains, by a paired comparison over blocks of time. =: over all joints, noise \
             may explain the difference from the best point. all: geometric mean over the joints. n: \
             coefficients + shape parameters.",
        ));
        let title = "held-out error, root mean square over that of the measurement, %";
        text.push_str(&format!("\n{}\n", style.emphasise(Emphasis::Title, title)));
        let size = |r: &Ranked, j: usize| {
            r.joints[j].nrmse_percent.map_or_else(|| "–".into(), |p| percent(p / 100.0))
        };
        let mean = |r: &Ranked| {
            let known: Vec<f64> = r.joints.iter().filter_map(|j| j.nrmse_percent).collect();
            percent(known.iter().sum::<f64>() / (100 * known.len()) as f64)
        };
        text.push_str(&table(ranking, "mean", &mean, &size));
    }
    if !ranking.failed.is_empty() {
        text.push_str(&format!("\n{}\n", style.emphasise(Emphasis::Warning, "points that failed")));
        for failed in &ranking.failed {
            text.push_str(&wrapped(&format!("{} {}: {}", failed.number, failed.name, failed.error)));
        }
    }
    // What holds for all points holds for their recordings; each point's own warnings are in the report.
    let is_shared = |w: &&String| ranking.ranked.iter().all(|r| r.warnings.contains(w));
    for warning in ranking.ranked.first().iter().flat_map(|r| &r.warnings).filter(is_shared) {
        let word = style.emphasise(Emphasis::Warning, "warning");
        text.push_str(&wrapped(&format!("{word}: {warning}")));
    }
    if !ranking.missing.is_empty() {
        text.push_str(&format!("\n{}\n", style.emphasise(Emphasis::Warning, "points without a result")));
        text.push_str(&wrapped(&ranges(&ranking.missing)));
    }
    text.extend(left_out.iter().map(|line| format!("\n{}", wrapped(line))));
    text
}

/// The change of the error over all joints, %.
pub fn overall(r: &Ranked) -> String {
    r.score.map_or_else(|| "–".into(), |s| format!("{:+.1}", 100.0 * (s - 1.0)))
}

fn table(
    ranking: &Ranking,
    total: &str,
    overall: &dyn Fn(&Ranked) -> String,
    cell: &dyn Fn(&Ranked, usize) -> String,
) -> String {
    let mut header = vec!["rank".to_owned(), "point".into(), "n".into(), total.into()];
    header.extend(ranking.joint_headings());
    let mut table = Table::new(header).left(2);
    for r in &ranking.ranked {
        let tied = if r.tied_with_best && r.rank > 1 { " =" } else { "" };
        let shapes = if r.shapes > 0 { format!("+{}", r.shapes) } else { String::new() };
        let mut cells = vec![
            format!("{}{tied}", r.rank),
            format!("{} {}", r.number, r.name),
            format!("{}{shapes}", r.coefficients),
            overall(r),
        ];
        cells.extend((0..r.joints.len()).map(|j| cell(r, j)));
        table.row(cells);
    }
    table.render()
}

#[cfg(test)]
mod tests {
    use crate::sweep::{Failed, JointRank};

    use super::*;

    /// A ranking of many points; the reference is the last.
    fn large(points: usize) -> Ranking {
        let joint = JointRank {
            mse: Some(0.5),
            nmse: Some(0.1),
            nrmse_percent: Some(12.0),
            change_percent: Some(-3.0),
            beyond_noise: true,
        };
        let ranked = |k: usize| Ranked {
            rank: k + 1,
            number: k + 1,
            name: format!("viscous.powers = [1, {k}]"),
            coefficients: 40,
            shapes: 1,
            score: Some(0.9),
            tied_with_best: true,
            joints: vec![joint.clone(); 6],
            warnings: vec!["the condition number is large".into()],
        };
        Ranking {
            rows: Rows::All,
            unit: None,
            joint_names: Vec::new(),
            reference: Some(format!("viscous.powers = [1, {}]", points - 1)),
            ranked: (0..points).map(ranked).collect(),
            failed: (0..points)
                .map(|k| Failed { number: k, name: format!("point {k}"), error: "no".into() })
                .collect(),
            missing: (0..points).map(|k| 2 * k).collect(),
        }
    }

    #[test]
    fn a_hundred_thousand_points_stay_readable() {
        let ranking = large(100_000);
        let text = to_text(&ranking, Style::PLAIN);
        assert!(text.lines().count() < 200, "{} lines", text.lines().count());
        assert!(text.contains("[1, 99999]"), "the reference is missing");
        assert!(text.contains("99959 of 100000 points that were judged are left out here"), "{text}");
        assert!(text.contains("and 99960 further ranges"), "{text}");
    }

    #[test]
    fn joints_with_names_are_called_by_them() {
        let mut ranking = large(2);
        assert!(to_text(&ranking, Style::PLAIN).contains("joint 5"));
        ranking.joint_names = (0..6).map(|j| format!("axis_{j}")).collect();
        let text = to_text(&ranking, Style::PLAIN);
        assert!(text.contains("axis_5") && !text.contains("joint 5"), "{text}");
    }

    #[test]
    fn of_a_few_points_nothing_is_left_out() {
        let (shown, left_out) = readable(&large(MOST), MOST);
        assert_eq!((shown.ranked.len(), left_out.len()), (MOST, 0));
    }
}

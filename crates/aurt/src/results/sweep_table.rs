//! The ranking of a sweep on the terminal.

use aurt_sweep::{Ranked, Ranking, Rows};

use crate::rendering::{
    number::percent,
    style::{Emphasis, Style},
    table::Table,
    text::wrapped,
};

/// The points, best first: how their mean squared errors compare with the reference's, and how large they are.
pub fn to_text(ranking: &Ranking, style: Style) -> String {
    let mut text = String::new();
    if let Some(reference) = &ranking.reference {
        let rows = match ranking.rows {
            Rows::All => "all rows in motion",
            Rows::Moving => "rows at which the joint moves",
        };
        let joints = ranking.ranked.first().map_or(0, |r| r.joints.len());
        let title = format!("held-out MSE over {rows}, against \"{reference}\", %");
        text.push_str(&format!("{}\n", style.emphasise(Emphasis::Title, &title)));
        let change = |r: &Ranked, j: usize| {
            r.joints[j].change_percent.map_or_else(
                || "–".into(),
                |c| format!("{c:+.1}{}", if r.joints[j].beyond_noise { "*" } else { " " }),
            )
        };
        text.push_str(&table(ranking, joints, "all", &overall, &change));
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
        text.push_str(&table(ranking, joints, "mean", &mean, &size));
    }
    if !ranking.failed.is_empty() {
        text.push_str(&format!("\n{}\n", style.emphasise(Emphasis::Warning, "points that failed")));
        for failed in &ranking.failed {
            text.push_str(&wrapped(&format!("{} {}: {}", failed.number, failed.name, failed.error)));
        }
    }
    if !ranking.missing.is_empty() {
        let numbers = aurt_sweep::slurm::ranges(&ranking.missing);
        text.push_str(&format!("\n{}\n", style.emphasise(Emphasis::Warning, "points without a result")));
        text.push_str(&wrapped(&numbers));
    }
    text
}

fn overall(r: &Ranked) -> String {
    r.score.map_or_else(|| "–".into(), |s| format!("{:+.1}", 100.0 * (s - 1.0)))
}

fn table(
    ranking: &Ranking,
    joints: usize,
    total: &str,
    overall: &dyn Fn(&Ranked) -> String,
    cell: &dyn Fn(&Ranked, usize) -> String,
) -> String {
    let mut header = vec!["rank".to_owned(), "point".into(), "n".into(), total.into()];
    header.extend((0..joints).map(|j| format!("joint {j}")));
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

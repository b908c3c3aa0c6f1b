//! The page of a sweep.

use crate::sweep::{Plan, Ranked, Ranking, Rows, Validate};
use aurt_files::output::pretty;
use aurt_report::rendering::number::{percent, significant};
use aurt_report::reports::parts;
use aurt_report::{BarGroup, Bars, Block, Cell, Figure, Page, Section, Style, Table, Tone, Verdict};
use serde_json::{Value, json};

use crate::workbench::results::sweep_table::{overall, ranges, readable};

/// Points that the page has in its tables.
const MOST: usize = 200;
const MOST_BARS: usize = 40;
const MOST_NAMED: usize = 5;

/// The page of a ranking; `definition` is the experiment with its section `sweep`.
pub fn page(ranking: &Ranking, plan: &Plan, definition: Option<&str>) -> Page {
    let (shown, left_out) = readable(ranking, MOST);
    let mut sections = vec![compared(&shown, &left_out), errors(&shown)];
    let troubles = troubles(&shown);
    if !troubles.is_empty() {
        sections.push(Section::new("Troubles", "", troubles));
    }
    if let Some(text) = definition {
        sections.push(parts::experiment("The experiment with its section sweep", text));
    }
    let mut provenance = parts::program("sweep");
    provenance.push(parts::entry("Experiment", plan.experiment.display().to_string()));
    provenance.push(parts::entry(
        "Judged on",
        match plan.validate {
            Validate::HeldOut => "the validation recordings",
            Validate::LeaveOneOut => "each calibration recording, by a fit to the others",
        },
    ));
    provenance.push(parts::entry("Rows", rows(ranking)));
    provenance.push(parts::entry(
        "Comparison",
        format!(
            "paired over blocks of {} s, Holm's correction over all points at level {}",
            plan.block_s,
            crate::sweep::LEVEL
        ),
    ));
    let mut document: Value = json!(shown);
    if !left_out.is_empty() {
        document["left_out"] = json!(left_out);
    }
    Page {
        title: "Sweep over variants of a robot model".into(),
        verdict: verdict(ranking),
        sections,
        provenance,
        results_json: pretty(&document),
    }
}

fn rows(ranking: &Ranking) -> &'static str {
    match ranking.rows {
        Rows::All => "all while the robot is in motion",
        Rows::Moving => "those at which the joint moves",
    }
}

fn verdict(ranking: &Ranking) -> Verdict {
    let (failed, missing) = (ranking.failed.len(), ranking.missing.len());
    let mut sentences = Vec::new();
    let headline = match (ranking.ranked.first(), &ranking.reference) {
        (Some(best), Some(reference)) if best.name == *reference => {
            format!("No variant is better than \"{reference}\"")
        }
        (Some(best), Some(reference)) => format!(
            "Best: \"{}\", held-out mean squared error {} % against \"{reference}\"",
            best.name,
            overall(best)
        ),
        _ => "No variant could be judged".into(),
    };
    let tied: Vec<String> = ranking
        .ranked
        .iter()
        .skip(1)
        .filter(|r| r.tied_with_best)
        .map(|r| format!("\"{}\"", r.name))
        .collect();
    if !tied.is_empty() {
        let mut named = tied[..tied.len().min(MOST_NAMED)].to_vec();
        if tied.len() > named.len() {
            named.push(format!("{} other points", tied.len() - named.len()));
        }
        sentences.push(format!(
            "Noise may explain the difference from {}.",
            aurt_report::rendering::text::listed(&named)
        ));
    }
    if failed > 0 {
        sentences.push(format!("{failed} points failed."));
    }
    if missing > 0 {
        sentences.push(format!("{missing} points have not been run."));
    }
    let tone = if ranking.ranked.is_empty() || failed + missing > 0 { Tone::Attention } else { Tone::Good };
    Verdict { tone, headline, sentences }
}

fn compared(ranking: &Ranking, left_out: &[String]) -> Section {
    let score = |r: &Ranked| r.score.map(|s| 100.0 * s);
    let bars = Bars {
        title: "held-out MSE, % of the reference's".into(),
        name: "scores".into(),
        caption: "Geometric mean over the joints; shorter is better.".into(),
        unit: "%".into(),
        series: vec![("variant".into(), Style::After)],
        level_name: "reference".into(),
        one_scale: true,
        groups: ranking
            .ranked
            .iter()
            .take(MOST_BARS)
            .map(|r| BarGroup {
                label: format!("{}. {}", r.rank, r.name),
                values: vec![score(r)],
                level: Some(100.0),
            })
            .collect(),
    };
    let mut columns: Vec<String> =
        ["rank", "<variant", "coefficients", "shapes", "all"].map(str::to_owned).to_vec();
    columns.extend(ranking.joint_headings());
    let mut table = Table::new("change of the held-out mean squared error, %", columns);
    for r in &ranking.ranked {
        let mut cells = vec![
            Cell::from(format!("{}{}", r.rank, if r.tied_with_best && r.rank > 1 { " =" } else { "" })),
            Cell::from(r.name.as_str()),
            Cell::from(r.coefficients.to_string()),
            Cell::from(r.shapes.to_string()),
            Cell::from(overall(r)),
        ];
        cells.extend(r.joints.iter().map(|j| Cell {
            text: j.change_percent.map_or_else(|| "–".into(), |c| format!("{c:+.1}")),
            strong: j.beyond_noise,
        }));
        table.row(cells);
    }
    Section::new(
        "Compared with the reference",
        "Bold: more than noise explains. =: over all joints, noise may explain the difference from the \
                       best.",
        [Block::Figure(Figure::Bars(bars)), Block::Table(table)]
            .into_iter()
            .chain(left_out.iter().map(|line| Block::Text(format!("{line}."))))
            .collect(),
    )
}

fn errors(ranking: &Ranking) -> Section {
    let mut columns = vec!["rank".to_owned(), "<variant".into()];
    columns.extend(ranking.joint_headings());
    let unit = ranking.unit.map_or("", |u| u.symbol());
    let mut relative = Table::new("root mean squared error over that of the measurement, %", columns.clone());
    let mut absolute = Table::new(format!("mean squared error, {unit}²"), columns);
    for r in &ranking.ranked {
        let first = || vec![r.rank.to_string(), r.name.clone()];
        let mut cells = first();
        cells.extend(
            r.joints.iter().map(|j| j.nrmse_percent.map_or_else(|| "–".into(), |p| percent(p / 100.0))),
        );
        relative.row(cells);
        let mut cells = first();
        cells.extend(r.joints.iter().map(|j| j.mse.map_or_else(|| "–".into(), |m| significant(m, 4))));
        absolute.row(cells);
    }
    Section::new("Errors on what was not fitted", "", vec![Block::Table(relative), Block::Table(absolute)])
}

fn troubles(ranking: &Ranking) -> Vec<Block> {
    let mut blocks = Vec::new();
    let failed: Vec<String> =
        ranking.failed.iter().map(|f| format!("{} {}: {}", f.number, f.name, f.error)).collect();
    if !failed.is_empty() {
        blocks.push(Block::Text("Points that failed:".into()));
        blocks.push(Block::List(failed));
    }
    if !ranking.missing.is_empty() {
        let numbers = ranges(&ranking.missing);
        blocks.push(Block::Text(format!("Points without a result: {numbers}.")));
    }
    for r in ranking.ranked.iter().filter(|r| !r.warnings.is_empty()) {
        blocks.push(Block::Folded {
            title: format!("Warnings of {}", r.name),
            open: false,
            blocks: vec![Block::List(r.warnings.clone())],
        });
    }
    blocks
}

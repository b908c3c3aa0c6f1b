//! `aurt sweep`: many variants of an experiment, fitted, judged and ranked.

use std::path::{Path, PathBuf};

use aurt_experiment::sweep::{Event, Folder, Plan, Ranking, Rows, Summary, run, run_point, slurm};
use aurt_experiment::workbench::failure::Failure;
use aurt_experiment::workbench::output::{OutputFolder, Outputs};
use aurt_experiment::workbench::results::sweep_table;
use aurt_report::reports;
use clap::{Args, Subcommand, ValueEnum};
use serde_json::{Value, json};

use super::Session;
use super::plots::PlotOptions;
use super::run::{delivered, written_text};
use crate::rendering::terminal::Report;
use crate::values::word;

/// Fit many variants of an experiment and rank them by their held-out error.
///
/// `[sweep]` in the experiment names the keys to vary and the values to try. An interrupted sweep continues where
/// it stopped when it is run again; nothing is computed twice.
#[derive(Debug, Args)]
#[command(after_help = "Example:\n  aurt sweep run experiment.toml --out sweep\n  \
    aurt sweep show sweep")]
pub struct Sweep {
    #[command(subcommand)]
    action: Action,
}

#[derive(Debug, Subcommand)]
enum Action {
    Run(RunSweep),
    Show(Show),
    Plan(PlanSweep),
    Point(RunPoint),
    Collect(Collect),
}

/// Who runs the points.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum Engine {
    /// This process, on all cores.
    Local,
    /// Slurm, as a job array.
    Slurm,
}

/// Run all points that have no result yet.
#[derive(Debug, Args)]
struct RunSweep {
    /// Experiment file with a section `sweep`
    #[arg(value_name = "EXPERIMENT.toml")]
    experiment: PathBuf,
    /// Folder of the sweep; created if it does not exist
    #[arg(long, value_name = "DIR")]
    out: PathBuf,
    /// Who runs the points
    #[arg(long, value_enum, default_value_t = Engine::Local)]
    engine: Engine,
    /// Argument for sbatch, such as --slurm-arg=--partition=short; can be given several times
    #[arg(long, value_name = "ARG", allow_hyphen_values = true)]
    slurm_arg: Vec<String>,
    #[command(flatten)]
    plots: PlotOptions,
}

/// Write the plan and one resolved experiment per point, and run nothing.
#[derive(Debug, Args)]
struct PlanSweep {
    /// Experiment file with a section `sweep`
    #[arg(value_name = "EXPERIMENT.toml")]
    experiment: PathBuf,
    /// Folder of the sweep; created if it does not exist
    #[arg(long, value_name = "DIR")]
    out: PathBuf,
}

/// Run single points of a planned sweep; others may do so at the same time.
#[derive(Debug, Args)]
struct RunPoint {
    /// Numbers of the points, from 1
    #[arg(value_name = "N", required = true)]
    numbers: Vec<usize>,
    /// Folder of the sweep
    #[arg(long, value_name = "DIR")]
    out: PathBuf,
}

/// Gather the results of all points into table.csv, table.json and report.html.
#[derive(Debug, Args)]
struct Collect {
    /// Folder of the sweep
    #[arg(long, value_name = "DIR")]
    out: PathBuf,
    #[command(flatten)]
    plots: PlotOptions,
}

/// Rank the points that have a result.
#[derive(Debug, Args)]
struct Show {
    /// Folder of the sweep
    #[arg(value_name = "DIR")]
    folder: PathBuf,
    /// Print the table as CSV
    #[arg(long)]
    csv: bool,
    /// Rows that errors are taken over: all while the robot is in motion, or those at which the joint moves
    #[arg(long, value_parser = word(&ROWS), default_value = "all")]
    rows: Rows,
}

const ROWS: [(&str, Rows); 2] = [("all", Rows::All), ("moving", Rows::Moving)];

impl Sweep {
    pub fn run(&self, session: &mut Session<'_>) -> Result<Report, Failure> {
        match &self.action {
            Action::Run(run) => run.run(session),
            Action::Plan(plan) => plan.run(session),
            Action::Point(point) => point.run(session),
            Action::Collect(Collect { out, plots }) => {
                let folder = Folder::planned(out)?;
                collected(
                    &folder,
                    &folder.plan()?,
                    session,
                    plots,
                    String::new(),
                    json!({ "command": "sweep collect" }),
                )
            }
            Action::Show(show) => show.run(session),
        }
    }
}

fn planned(
    experiment: &Path,
    out: &Path,
    session: &mut Session<'_>,
) -> Result<(aurt_experiment::sweep::Sweep, Plan, Folder), Failure> {
    let sweep = aurt_experiment::sweep::Sweep::read(experiment, &mut session.registry)?;
    let folder = Folder::for_sweep(out, &sweep)?;
    let plan = Plan::of(&sweep, &session.registry)?;
    folder.write_plan(&sweep, &plan)?;
    Ok((sweep, plan, folder))
}

/// Numbers of the points without a result.
fn missing(folder: &Folder, plan: &Plan) -> Vec<usize> {
    let lacks = |(k, p): (usize, &aurt_experiment::sweep::PlannedPoint)| {
        folder.result(&p.key).is_none().then_some(k + 1)
    };
    plan.points.iter().enumerate().filter_map(lacks).collect()
}

impl RunSweep {
    fn run(&self, session: &mut Session<'_>) -> Result<Report, Failure> {
        let (sweep, plan, folder) = planned(&self.experiment, &self.out, session)?;
        if self.engine == Engine::Slurm {
            return self.submit(folder, &plan, session);
        }
        let bar = session.terminal.points_bar(plan.points.len());
        let watch = |event: Event| match event {
            Event::Begin { present } => bar.skip(present),
            Event::Done => bar.advance(),
        };
        let summary = run(&sweep, &plan, &folder, &watch)?;
        drop(bar);
        let json = json!({ "command": "sweep run", "run": summary_json(&summary) });
        collected(&folder, &plan, session, &self.plots, summary_text(&summary), json)
    }

    fn submit(&self, folder: Folder, plan: &Plan, session: &Session<'_>) -> Result<Report, Failure> {
        let points = missing(&folder, plan);
        let path = folder.path().to_owned();
        if points.is_empty() {
            let text = "every point has its result already\n".to_owned();
            return Ok(Report {
                text,
                json: json!({ "command": "sweep run", "jobs": [], "points": [] }),
                findings: false,
            });
        }
        // The jobs lock the folder for themselves.
        drop(folder);
        let plugins: Vec<PathBuf> = session.registry.libraries().iter().map(|l| l.path.clone()).collect();
        let folder = Folder::shared(&path)?;
        let submission = slurm::submit(&folder, &points, session.program, &plugins, &self.slurm_arg)?;
        let text = format!(
            "{} of {} points submitted as job {} {}\n  their output: {}\n  when they are done: \
             aurt sweep collect --out {}\n  to submit those that a lost node left out: the same command again\n",
            points.len(),
            plan.points.len(),
            if submission.jobs.len() == 1 { "array" } else { "arrays" },
            submission.jobs.join(", "),
            submission.output.display(),
            path.display()
        );
        let json = json!({ "command": "sweep run", "jobs": submission.jobs, "points": submission.points });
        Ok(Report { text, json, findings: false })
    }
}

/// Points of a plan that the terminal lists.
const MOST_LISTED: usize = 200;

impl PlanSweep {
    fn run(&self, session: &mut Session<'_>) -> Result<Report, Failure> {
        let (_, plan, folder) = planned(&self.experiment, &self.out, session)?;
        let mut text = format!("{}\n", counted(plan.points.len()));
        for (k, point) in plan.points.iter().enumerate().take(MOST_LISTED) {
            text.push_str(&format!("  {:>4}  {}\n", k + 1, point.name));
        }
        if plan.points.len() > MOST_LISTED {
            text.push_str(&format!("  and {} further points\n", plan.points.len() - MOST_LISTED));
        }
        text.push_str(&written_text(&[folder.path().join("sweep.json"), folder.path().join("points")]));
        let json =
            json!({ "command": "sweep plan", "points": plan.points, "missing": missing(&folder, &plan) });
        Ok(Report { text, json, findings: false })
    }
}

impl RunPoint {
    fn run(&self, session: &mut Session<'_>) -> Result<Report, Failure> {
        let folder = Folder::shared(&self.out)?;
        let mut text = String::new();
        let mut failed = Vec::new();
        for number in &self.numbers {
            let judged = run_point(&folder, *number, &mut session.registry)?;
            text.push_str(&format!("point {number}: {}\n", if judged { "done" } else { "failed" }));
            failed.extend((!judged).then_some(*number));
        }
        let json = json!({ "command": "sweep point", "points": self.numbers, "failed": failed });
        Ok(Report { text, json, findings: !failed.is_empty() })
    }
}

impl Show {
    fn run(&self, session: &Session<'_>) -> Result<Report, Failure> {
        let folder = Folder::planned(&self.folder)?;
        let ranking = Ranking::of(&folder, &folder.plan()?, self.rows);
        let damaged = folder.damaged();
        let text = if self.csv {
            ranking.to_csv()
        } else {
            sweep_table::to_text(&ranking, session.terminal.style()) + &damaged_text(&damaged)
        };
        let mut json = json!({ "command": "sweep show", "damaged": damaged });
        json["ranking"] = json!(ranking);
        Ok(Report { text, json, findings: !damaged.is_empty() })
    }
}

/// Writes the table of what there is and reports it; points that failed or are missing are findings.
fn collected(
    folder: &Folder,
    plan: &Plan,
    session: &Session<'_>,
    plots: &PlotOptions,
    mut text: String,
    mut json: Value,
) -> Result<Report, Failure> {
    let ranking = Ranking::of(folder, plan, Rows::All);
    let document = format!("{:#}\n", json!(ranking));
    let plots = plots.folder()?;
    let definition = folder.path().join("experiment.toml");
    let definition = aurt_files::read_text(&definition, aurt_files::MOST_TEXT_BYTES).ok();
    let page = aurt_experiment::workbench::reports::sweep::page(&ranking, plan, definition.as_deref());
    let mut outputs = Outputs::default();
    outputs.folder(
        &OutputFolder::new("--out", folder.path())?,
        [
            (reports::FILE.to_owned(), page.to_html().into_bytes()),
            ("table.csv".to_owned(), ranking.to_csv().into_bytes()),
            ("table.json".to_owned(), document.into_bytes()),
        ],
    );
    let damaged = folder.damaged();
    text.push_str(&sweep_table::to_text(&ranking, session.terminal.style()));
    text.push_str(&damaged_text(&damaged));
    json["ranking"] = json!(ranking);
    json["damaged"] = json!(damaged);
    let findings = !ranking.failed.is_empty() || !ranking.missing.is_empty();
    delivered(outputs, &page, plots.as_ref(), Report { text, json, findings })
}

/// The results that were not what had been written; a run has made them again.
fn damaged_text(damaged: &[PathBuf]) -> String {
    let line = |path: &PathBuf| {
        format!(
            "warning: {} is not what was written, it is cut off, changed or another version's; it does not count, \
             and `aurt sweep run` makes it again\n",
            path.display()
        )
    };
    let mut text: String = damaged.iter().take(MOST_LISTED).map(line).collect();
    if damaged.len() > MOST_LISTED {
        text.push_str(&format!("warning: {} further results likewise\n", damaged.len() - MOST_LISTED));
    }
    text
}

fn summary_text(summary: &Summary) -> String {
    let mut text = format!(
        "{} run in {:.2} s, {} had their result already\n",
        counted(summary.run),
        summary.elapsed.as_secs_f64(),
        summary.present
    );
    if summary.run > 0 {
        text.push_str(&format!(
            "  {:.1} ms to read and prepare what points share, then {:.2} ms a point (mean, one core)\n",
            1e3 * summary.preparation.as_secs_f64(),
            1e3 * summary.points.as_secs_f64() / summary.run as f64
        ));
    }
    text.push('\n');
    text
}

fn counted(points: usize) -> String {
    if points == 1 { "1 point".into() } else { format!("{points} points") }
}

fn summary_json(summary: &Summary) -> Value {
    json!({
        "run": summary.run,
        "present": summary.present,
        "failed": summary.failed,
        "elapsed_s": summary.elapsed.as_secs_f64(),
        "families": summary.families,
        "preparation_s": summary.preparation.as_secs_f64(),
        "points_s": summary.points.as_secs_f64(),
    })
}

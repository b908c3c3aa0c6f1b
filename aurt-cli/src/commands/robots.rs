//! `aurt robots`: the robots that experiments can name.

use aurt_experiment::workbench::failure::Failure;
use aurt_rbd::robots::{JointLimits, KNOWN_ROBOTS, KnownRobot};
use aurt_report::rendering::table::Table;
use aurt_report::rendering::text::wrapped_at;
use clap::Args;
use serde_json::{Value, json};

use super::Session;
use crate::rendering::terminal::Report;

/// Columns of running text.
const WIDTH: usize = 78;

/// List the robots whose geometry and limits are known by name.
#[derive(Debug, Args)]
#[command(after_help = "Example:\n  aurt robots")]
pub struct Robots {}

impl Robots {
    pub fn run(&self, _: &Session<'_>) -> Result<Report, Failure> {
        let mut table = Table::new(["name", "robot", "joints"]).left(2);
        let mut sources = String::new();
        for robot in KNOWN_ROBOTS.iter() {
            table.row([robot.name.clone(), robot.title.clone(), robot.joints().to_string()]);
            sources +=
                &format!("{}\n", wrapped_at(&format!("{}: {}", robot.name, robot.source), WIDTH, "  "));
        }
        let example = KNOWN_ROBOTS.last().map_or("", |robot| &robot.name);
        let text = format!(
            "{}\nSources\n{sources}\nIn an experiment: [robot] name = \"{example}\"\n",
            table.render()
        );
        let robots: Vec<Value> = KNOWN_ROBOTS.iter().map(described).collect();
        Ok(Report { text, json: json!({ "command": "robots", "robots": robots }), findings: false })
    }
}

fn described(robot: &KnownRobot) -> Value {
    let limits = |of: &JointLimits| {
        json!({
            "position_rad": of.position_rad,
            "velocity_rad_s": of.velocity_rad_s,
            "torque_nm": of.torque_nm,
        })
    };
    let limits: Vec<Value> = robot.description().limits.iter().map(limits).collect();
    json!({ "name": robot.name, "title": robot.title, "source": robot.source, "limits": limits })
}

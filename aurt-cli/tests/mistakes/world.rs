//! A robot with three recordings and an experiment on them, and how mistakes get into these.

use std::{fs, ops::Range, path::Path};

/// A recording as a table of numbers.
#[derive(Debug, Clone)]
pub struct Log {
    pub header: Vec<String>,
    pub rows: Vec<Vec<f64>>,
    pub joints: usize,
}

/// Everything that a user has.
#[derive(Debug, Clone)]
pub struct World {
    /// Two to calibrate on, one held out.
    pub logs: Vec<Log>,
    /// The table: header and rows as written.
    pub table: Vec<Vec<String>>,
    /// `[robot]` below the geometry, line by line.
    pub robot: Vec<String>,
    pub geometry: String,
    /// `[recordings]` above the lists.
    pub recorded: Vec<String>,
    pub calibration: String,
    pub validation: String,
    pub f_dyn_hz: f64,
    pub rest: String,
    /// What is done to the text of each log before it is written.
    pub text: Option<fn(&str) -> String>,
}

/// Rows of a log that are used: 20 s and more.
const ROWS: usize = 2000;

pub const NAMES: [&str; 3] = ["monday.csv", "tuesday.csv", "friday.csv"];

impl Log {
    pub fn read(path: &Path, joints: usize) -> Self {
        let text = fs::read_to_string(path).unwrap();
        let mut lines = text.lines().filter(|l| !l.starts_with('#') && !l.trim().is_empty());
        let header: Vec<String> = lines.next().unwrap().split(',').map(str::to_owned).collect();
        let rows =
            lines.take(ROWS).map(|l| l.split(',').map(|c| c.trim().parse().unwrap()).collect()).collect();
        Self { header, rows, joints }
    }

    /// Columns: time, positions, velocities if there are any, measurements.
    pub fn position(&self, joint: usize) -> usize {
        1 + joint
    }

    pub fn positions(&self) -> Range<usize> {
        1..1 + self.joints
    }

    pub fn velocities(&self) -> Range<usize> {
        1 + self.joints..self.measurement(0).min(1 + 2 * self.joints)
    }

    pub fn measurements(&self) -> Range<usize> {
        self.measurement(0)..self.header.len()
    }

    pub fn measurement(&self, joint: usize) -> usize {
        self.header.len() - self.joints + joint
    }

    pub fn scale(&mut self, columns: impl IntoIterator<Item = usize>, factor: f64) {
        for column in columns {
            self.rows.iter_mut().for_each(|r| r[column] *= factor);
        }
    }

    pub fn add(&mut self, column: usize, offset: f64) {
        self.rows.iter_mut().for_each(|r| r[column] += offset);
    }

    /// Column j becomes what column `from[j]` was, over the columns of a quantity that start at `first`.
    pub fn reorder(&mut self, first: usize, from: &[usize]) {
        for row in &mut self.rows {
            let before: Vec<f64> = from.iter().map(|j| row[first + j]).collect();
            row[first..first + from.len()].copy_from_slice(&before);
        }
    }

    pub fn fill(&mut self, column: usize, value: f64) {
        self.rows.iter_mut().for_each(|r| r[column] = value);
    }

    pub fn repeat(&mut self, of: usize, at: usize) {
        self.rows.iter_mut().for_each(|r| r[at] = r[of]);
    }

    /// Measurements come so much late.
    pub fn delay(&mut self, time_s: f64) {
        let last = self.rows.len() - 1;
        let rows = (time_s * last as f64 / (self.rows[last][0] - self.rows[0][0])).round() as usize;
        let first = self.measurement(0);
        let before = self.rows.clone();
        for (k, row) in self.rows.iter_mut().enumerate() {
            let source = &before[k.saturating_sub(rows)];
            row[first..].copy_from_slice(&source[first..]);
        }
    }

    pub fn text(&self) -> String {
        let mut text = self.header.join(",") + "\n";
        for row in &self.rows {
            let cells: Vec<String> = row.iter().map(|v| format!("{v:?}")).collect();
            text.push_str(&cells.join(","));
            text.push('\n');
        }
        text
    }
}

impl World {
    pub fn each(&mut self, change: impl Fn(&mut Log)) {
        self.logs.iter_mut().for_each(change);
    }

    pub fn only(&mut self, log: usize, change: impl Fn(&mut Log)) {
        change(&mut self.logs[log]);
    }

    pub fn gravity(&mut self, g: &str) {
        self.set("gravity_m_s2", g);
    }

    pub fn set(&mut self, key: &str, value: &str) {
        self.robot.retain(|l| !l.starts_with(key));
        self.robot.push(format!("{key} = {value}"));
    }

    pub fn column(&mut self, name: &str, change: impl Fn(&str) -> String) {
        let at = self.table[0].iter().position(|n| n == name).unwrap();
        for row in &mut self.table[1..] {
            row[at] = change(&row[at]);
        }
    }

    pub fn write(&self, folder: &Path) {
        for (log, name) in self.logs.iter().zip(NAMES) {
            let text = log.text();
            fs::write(folder.join(name), self.text.map_or_else(|| text.clone(), |change| change(&text)))
                .unwrap();
        }
        let table: String = self.table.iter().map(|r| r.join(",") + "\n").collect();
        fs::write(folder.join("mdh.csv"), table).unwrap();
        let experiment = format!(
            "schema = 1\n[robot]\n{}\n{}\n[recordings]\n{}\ncalibration = {}\nvalidation = {}\n[preprocess]\n\
             f_dyn_hz = {:?}\n{}\n",
            self.geometry,
            self.robot.join("\n"),
            self.recorded.join("\n"),
            self.calibration,
            self.validation,
            self.f_dyn_hz,
            self.rest,
        );
        fs::write(folder.join("experiment.toml"), experiment).unwrap();
    }
}

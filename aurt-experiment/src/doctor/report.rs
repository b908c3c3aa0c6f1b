//! The page of a recording: `aurt check --out`.

use aurt_files::output::pretty;
use aurt_recording::{Preprocessed, Recording};
use aurt_report::{
    Axis, BarGroup, Bars, Block, Cell, Figure, Layer, Mark, Page, Panel, Plot, Section, Style, Table, Tone,
    Verdict,
    rendering::number::significant,
    reports::{
        figures::{Series, TimeFigure, file_name, points_per_series},
        parts::{self, joint_column},
    },
    subsample,
};
use aurt_traits::RobotNames;
use serde_json::Value;

use crate::doctor::inspection::joints::JointReport;

/// What a motion says of the parameters, by their names.
pub struct Excited<'a> {
    /// Determined, each with the share of its column that others cannot imitate.
    pub determined: Vec<(&'a str, f64)>,
    pub combined: Vec<&'a str>,
    pub silent: Vec<&'a str>,
    pub condition_number: f64,
}

pub struct Checked<'a> {
    pub name: &'a str,
    pub recording: &'a Recording,
    pub prepared: &'a Preprocessed,
    pub joints: &'a [JointReport],
    /// Which parameters the motion determines, where the geometry is known.
    pub excited: Option<Excited<'a>>,
    pub findings: &'a [String],
    /// What was found while it was read and put on its grid.
    pub notes: &'a [String],
    pub suitable_f_dyn_hz: Option<f64>,
    pub document: &'a Value,
}

impl Checked<'_> {
    pub fn page(&self) -> Page {
        let mut sections = vec![self.series(), self.coverage(), self.tables()];
        if let Some(excited) = &self.excited {
            sections.insert(0, excited.section());
        }
        let mut provenance = parts::program("check");
        provenance.extend(self.notes.iter().map(|n| parts::entry("Recording", n.as_str())));
        Page {
            title: format!("Check of {}", file_name(self.name)),
            verdict: self.verdict(),
            sections,
            provenance,
            results_json: pretty(self.document),
        }
    }

    fn verdict(&self) -> Verdict {
        let facts = format!(
            "{} samples over {} s, {} joints{}.",
            self.recording.samples(),
            significant(self.recording.duration_s(), 4),
            self.joints.len(),
            if self.recording.measurement.is_some() { "" } else { ", without measurement" }
        );
        let mut sentences: Vec<String> = self.findings.to_vec();
        sentences.push(facts);
        sentences.extend(
            self.suitable_f_dyn_hz.map(|f| format!("For an experiment on such motions: f_dyn_hz = {f}.")),
        );
        if self.findings.is_empty() {
            let headline = if self.recording.measurement.is_some() {
                "Ready to calibrate on this recording".into()
            } else {
                "Ready to predict for this recording; calibration needs measured currents or torques".into()
            };
            Verdict { tone: Tone::Good, headline, sentences }
        } else {
            let headline = match self.findings.len() {
                1 => "One finding before calibrating on this recording".into(),
                n => format!("{n} findings before calibrating on this recording"),
            };
            Verdict { tone: Tone::Attention, headline, sentences }
        }
    }

    fn names(&self) -> RobotNames<'_> {
        RobotNames::of_joints(self.recording.joints.names())
    }

    /// Time since the first stamp, first samples of stretches, and a series of every stretch.
    fn on_grid<'s>(&'s self, of: impl Fn(usize) -> &'s [f64]) -> (Vec<f64>, Vec<usize>, Vec<f64>) {
        let origin = self.recording.time_s.first().copied().unwrap_or(0.0);
        let (mut time, mut starts, mut values) = (Vec::new(), Vec::new(), Vec::new());
        for (k, segment) in self.prepared.segments.iter().enumerate() {
            starts.push(time.len());
            time.extend(segment.motion.view().time_s().iter().map(|t| t - origin));
            values.extend_from_slice(of(k));
        }
        (time, starts, values)
    }

    fn series(&self) -> Section {
        let unit = self.recording.unit;
        let points = points_per_series(3 * self.joints.len());
        let blocks = (0..self.joints.len())
            .map(|j| {
                let motion = |k: usize| self.prepared.segments[k].motion.view();
                let (time, starts, position) = self.on_grid(|k| motion(k).position_rad(j));
                let (_, _, velocity) = self.on_grid(|k| motion(k).velocity_rad_s(j));
                let series = |style, values| vec![Series { name: "", style, values }];
                let mut panels = vec![
                    (Axis::new("position", "rad"), series(Style::After, position.as_slice())),
                    (Axis::new("velocity", "rad/s"), series(Style::After, velocity.as_slice())),
                ];
                let raw: Option<Vec<f64>> = self
                    .prepared
                    .segments
                    .iter()
                    .map(|s| s.raw_measurement.as_ref().map(|m| m[j].clone()))
                    .collect::<Option<Vec<_>>>()
                    .map(|parts| parts.concat());
                let raw = raw.filter(|r| r.len() == time.len());
                if let Some(raw) = &raw {
                    panels.push((
                        Axis::new(unit.quantity(), unit.symbol()),
                        series(Style::Measured, raw.as_slice()),
                    ));
                }
                let moves = if self.joints[j].moves() { "" } else { ", at rest" };
                let figure = TimeFigure {
                    title: format!("{}{moves}", self.names().joint(j)),
                    name: format!("recording_joint_{j}"),
                    caption: String::new(),
                    time_s: &time,
                    segment_starts: &starts,
                    panels,
                    windows: &[],
                    link: "recording".into(),
                };
                Block::Folded {
                    title: format!("{}{moves}", self.names().joint(j)),
                    open: self.joints[j].moves(),
                    blocks: vec![Block::Figure(figure.figure(points))],
                }
            })
            .collect();
        Section {
            title: "Motion and measurement".into(),
            introduction:
                "On the uniform grid; positions filtered, the measurement as it is. Drag over a stretch to \
                           look closer, double-click for all."
                    .into(),
            blocks,
        }
    }

    fn coverage(&self) -> Section {
        const CLOUD: usize = 1200;
        let cloud = |title: String, name: String, x: (Axis, Vec<f64>), y: (Axis, Vec<f64>)| {
            let kept = subsample(x.1.len().min(y.1.len()), CLOUD);
            let pick = |of: &[f64]| kept.iter().map(|k| of[*k]).collect();
            let layer = Layer {
                name: String::new(),
                style: Style::After,
                mark: Mark::Points,
                x: pick(&x.1),
                y: pick(&y.1),
            };
            let panel = Panel { y: y.0, height: 130.0, layers: vec![layer], windows: Vec::new() };
            let (caption, link) = (String::new(), None);
            Figure::Plot(Plot { title, name, caption, x: x.0, panels: vec![panel], link, small: true })
        };
        let figures = (0..self.joints.len())
            .filter(|j| self.joints[*j].moves())
            .map(|j| {
                let motion = |k: usize| self.prepared.segments[k].motion.view();
                let position = self.on_grid(|k| motion(k).position_rad(j)).2;
                let velocity = self.on_grid(|k| motion(k).velocity_rad_s(j)).2;
                cloud(
                    self.names().joint(j),
                    format!("coverage_joint_{j}"),
                    (Axis::new("position", "rad"), position),
                    (Axis::new("velocity", "rad/s"), velocity),
                )
            })
            .collect();
        Section {
            title: "What the motion covers".into(),
            introduction:
                "Velocity over position of every joint that moves. Friction models need both directions and \
                           slow as well as fast motion; gravity needs different positions."
                    .into(),
            blocks: vec![Block::Figures(figures)],
        }
    }

    fn tables(&self) -> Section {
        let short = |value: f64| significant(value, 3);
        let maybe = |value: Option<f64>| value.map_or_else(|| "–".to_owned(), short);
        let unit = self.recording.unit.symbol();
        let joint = joint_column(self.names());
        let mut motion = Table::new(
            "motion",
            [joint, "from rad", "to rad", "|q̇| rad/s", "|q̈| rad/s²", "moving %", "reversals", "below Hz"],
        );
        let mut sensors = Table::new(
            "sensors: steps and white noise",
            [
                joint.to_owned(),
                "step rad".into(),
                "noise rad".into(),
                format!("from {unit}"),
                format!("to {unit}"),
                format!("rms {unit}"),
                format!("step {unit}"),
                format!("noise {unit}"),
            ],
        );
        for (j, joint) in self.joints.iter().enumerate() {
            motion.row([
                Cell::from(self.names().joint_cell(j)),
                short(joint.position_rad[0]).into(),
                short(joint.position_rad[1]).into(),
                short(joint.max_velocity_rad_s).into(),
                short(joint.max_acceleration_rad_s2).into(),
                Cell { text: format!("{:.0}", 100.0 * joint.moving_share), strong: !joint.moves() },
                joint.reversals.to_string().into(),
                maybe(joint.bandwidth_hz).into(),
            ]);
            let m = joint.measurement.as_ref();
            sensors.row([
                self.names().joint_cell(j),
                maybe(joint.position_step_rad),
                maybe(joint.position_noise_rad),
                maybe(m.map(|m| m.range[0])),
                maybe(m.map(|m| m.range[1])),
                maybe(m.map(|m| m.rms)),
                maybe(m.and_then(|m| m.step)),
                maybe(m.and_then(|m| m.noise)),
            ]);
        }
        Section {
            title: "Joints and sensors".into(),
            introduction: String::new(),
            blocks: vec![Block::Table(motion), Block::Table(sensors)],
        }
    }
}

impl Excited<'_> {
    fn section(&self) -> Section {
        let count = self.determined.len() + self.combined.len() + self.silent.len();
        let share = |n: usize| Some(n as f64);
        let bars = Bars {
            title: format!("{count} parameters"),
            name: "excitation".into(),
            caption: "Base parameters, Coulomb and viscous friction of every joint.".into(),
            unit: String::new(),
            series: vec![("parameters".into(), Style::After)],
            level_name: String::new(),
            one_scale: true,
            groups: [
                ("determined", self.determined.len()),
                ("determined in combinations only", self.combined.len()),
                ("out of reach", self.silent.len()),
            ]
            .map(|(label, n)| BarGroup { label: label.into(), values: vec![share(n)], level: None })
            .into(),
        };
        let mut blocks = vec![Block::Figure(Figure::Bars(bars))];
        blocks.push(Block::Text(format!(
            "Condition number of what is determined: {}.",
            significant(self.condition_number, 3)
        )));
        for (title, names) in [
            ("Out of reach: this motion needs none of them", &self.silent),
            ("Determined in combinations only", &self.combined),
        ] {
            if !names.is_empty() {
                blocks.push(Block::Folded {
                    title: format!("{title} ({})", names.len()),
                    open: true,
                    blocks: vec![Block::Text(names.join(", "))],
                });
            }
        }
        let mut table = Table::new(
            "determined; own share: the part of a parameter's torque that no combination of the others imitates",
            ["<parameter", "own share %"],
        );
        let mut determined = self.determined.clone();
        determined.sort_by(|a, b| a.1.total_cmp(&b.1));
        for (name, share) in determined {
            table.row([name.to_owned(), significant(100.0 * share, 3)]);
        }
        if !table.rows.is_empty() {
            blocks.push(Block::Folded {
                title: format!("Determined ({})", table.rows.len()),
                open: false,
                blocks: vec![Block::Table(table)],
            });
        }
        Section {
            title: "Which parameters this motion determines".into(),
            introduction: String::new(),
            blocks,
        }
    }
}

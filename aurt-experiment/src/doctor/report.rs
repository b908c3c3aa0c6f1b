//! The page of a recording: `aurt check --out`.

use aurt_files::output::pretty;
use aurt_report::rendering::number::significant;
use aurt_report::reports::figures::{Series, TimeFigure, file_name, points_per_series};
use aurt_report::reports::parts::{self, joint_column};
use aurt_report::{
    Axis, BarGroup, Bars, Block, Figure, Layer, Mark, Page, Panel, Plot, Section, Style, Table, Tone,
    Verdict, subsample,
};

use crate::doctor::inspection::inspected::Inspected;
use crate::doctor::inspection::joints::tables;
use crate::doctor::inspection::judged::Judged;

/// The column of the motion that says how long a joint moves.
const MOVING: usize = 5;

impl Inspected {
    pub fn page(&self) -> Page {
        let mut sections = vec![self.series(), self.coverage(), self.tables()];
        if let Some(judged) = &self.judged {
            sections.insert(0, excitation(judged));
        }
        let mut provenance = parts::program("check");
        provenance.extend(self.notes().into_iter().map(|n| parts::entry("Recording", n)));
        Page {
            title: format!("Check of {}", file_name(self.label())),
            verdict: self.verdict(),
            sections,
            provenance,
            results_json: pretty(&self.to_json()),
        }
    }

    fn verdict(&self) -> Verdict {
        let recording = &self.loaded.recording;
        let is_measured = recording.measurement.is_some();
        let facts = format!(
            "{} samples over {} s, {} joints{}.",
            recording.samples(),
            significant(recording.duration_s(), 4),
            self.joints.len(),
            if is_measured { "" } else { ", without measurement" }
        );
        let findings = self.findings();
        let mut sentences = findings.clone();
        sentences.push(facts);
        sentences.extend(
            self.suitable_f_dyn_hz().map(|f| format!("For an experiment on such motions: f_dyn_hz = {f}.")),
        );
        if findings.is_empty() {
            let headline = if is_measured {
                "Ready to calibrate on this recording".into()
            } else {
                "Ready to predict for this recording; calibration needs measured currents or torques".into()
            };
            Verdict { tone: Tone::Good, headline, sentences }
        } else {
            let headline = match findings.len() {
                1 => "One finding before calibrating on this recording".into(),
                n => format!("{n} findings before calibrating on this recording"),
            };
            Verdict { tone: Tone::Attention, headline, sentences }
        }
    }

    /// Time since the first stamp, first samples of stretches, and a series of every stretch.
    fn on_grid<'s>(&'s self, of: impl Fn(usize) -> &'s [f64]) -> (Vec<f64>, Vec<usize>, Vec<f64>) {
        let origin = self.loaded.recording.time_s.first().copied().unwrap_or(0.0);
        let (mut time, mut starts, mut values) = (Vec::new(), Vec::new(), Vec::new());
        for (k, segment) in self.prepared.segments.iter().enumerate() {
            starts.push(time.len());
            time.extend(segment.motion.view().time_s().iter().map(|t| t - origin));
            values.extend_from_slice(of(k));
        }
        (time, starts, values)
    }

    fn series(&self) -> Section {
        let unit = self.loaded.recording.unit;
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
        Section::new(
            "Motion and measurement",
            "On the uniform grid; positions filtered, the measurement as it is. Drag over a stretch to \
                           look closer, double-click for all.",
            blocks,
        )
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
        Section::new(
            "What the motion covers",
            "Velocity over position of every joint that moves. Friction models need both directions and \
                           slow as well as fast motion; gravity needs different positions.",
            vec![Block::Figures(figures)],
        )
    }

    fn tables(&self) -> Section {
        let unit = self.loaded.recording.unit;
        let [motion, sensors] = tables(&self.joints, unit, self.names());
        let block = |caption: &str, (mut headings, rows): (Vec<String>, Vec<Vec<String>>)| {
            headings[0] = joint_column(self.names()).to_owned();
            let mut table = Table::new(caption, headings);
            rows.into_iter().for_each(|row| table.row(row));
            table
        };
        let mut motion = block("motion", motion);
        for (row, joint) in motion.rows.iter_mut().zip(&self.joints) {
            row[MOVING].strong = !joint.moves();
        }
        let sensors = block("sensors: steps and white noise", sensors);
        Section::new("Joints and sensors", "", vec![Block::Table(motion), Block::Table(sensors)])
    }
}

/// Parameters that a motion determines, and others, by their names.
fn excitation(judged: &Judged) -> Section {
    let (mut determined, combined, silent) = (judged.determined(), judged.combined(), judged.silent());
    let count = determined.len() + combined.len() + silent.len();
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
            ("determined", determined.len()),
            ("determined in combinations only", combined.len()),
            ("out of reach", silent.len()),
        ]
        .map(|(label, n)| BarGroup { label: label.into(), values: vec![share(n)], level: None })
        .into(),
    };
    let mut blocks = vec![Block::Figure(Figure::Bars(bars))];
    blocks.push(Block::Text(format!(
        "Condition number of what is determined: {}.",
        significant(judged.excited.condition_number, 3)
    )));
    for (title, names) in [
        ("Out of reach: this motion needs none of them", &silent),
        ("Determined in combinations only", &combined),
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
    Section::new("Which parameters this motion determines", "", blocks)
}

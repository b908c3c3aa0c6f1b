//! The page of a tracked machine: drift of friction, gains and load, recording after recording.

use std::fmt::Write as _;

use aurt_calibration::{Drift, DriftGroup, DriftParameter};
use aurt_files::output::pretty;
use aurt_report::rendering::number::significant;
use aurt_report::reports::parts;
use aurt_report::{
    Axis, Block, Cell, Figure, Layer, Mark, Page, Panel, Plot, Section, Style, Table, Tone, Verdict,
};
use aurt_traits::RobotNames;
use serde_json::Value;

use crate::workbench::tracking::{Alarm, Tracked, TrackedRecording};

pub fn page(tracked: &Tracked, document: &Value) -> Page {
    let mut provenance = parts::program("track");
    let options = &tracked.options;
    provenance.push(parts::entry("Unchanged machine", tracked.baseline_recordings.join(", ")));
    provenance.push(parts::entry("Windows", format!("{} s", options.window_s)));
    provenance.push(parts::entry(
        "False alarms",
        format!("one in {} h of recording, over {} charts", options.false_alarm_h, tracked.charts),
    ));
    provenance.push(parts::entry(
        "Threshold of the CUSUM",
        format!(
            "{} deviations, one false alarm in {} windows of a chart",
            significant(tracked.threshold, 3),
            significant(tracked.average_run_length_windows, 3)
        ),
    ));
    provenance.push(parts::entry("Memory over windows", significant(tracked.baseline.memory, 3)));
    let [friction, gain, load] = options.half_life_s;
    provenance
        .push(parts::entry("Half-lives", format!("friction {friction} s, gains {gain} s, load {load} s")));
    Page {
        title: "How the machine has changed since its calibration".into(),
        verdict: Verdict {
            tone: if tracked.alarms.is_empty() { Tone::Good } else { Tone::Found },
            headline: headline(tracked),
            sentences: tracked.alarms.iter().map(sentence).chain(tracked.notes.iter().cloned()).collect(),
        },
        sections: vec![
            charts(tracked),
            Section::new(
                "Each recording alone",
                "Friction and gains are relative to the calibrated model's: 0.1 is 10 % more.",
                vec![Block::Table(table(tracked))],
            ),
        ],
        provenance,
        results_json: pretty(document),
    }
}

pub fn text(tracked: &Tracked) -> String {
    let mut text = format!("{}\n", headline(tracked));
    tracked.alarms.iter().for_each(|alarm| {
        let _ = writeln!(text, "  {}", sentence(alarm));
    });
    let _ = write!(text, "\n{}", table(tracked).to_text());
    tracked.notes.iter().for_each(|note| {
        let _ = writeln!(text, "note: {note}");
    });
    text
}

fn headline(tracked: &Tracked) -> String {
    let count = tracked.recordings.len();
    let over = format!("{count} recording{}", if count == 1 { "" } else { "s" });
    match tracked.alarms.len() {
        0 => format!("no change since the calibration in {over}"),
        1 => format!("1 change since the calibration in {over}"),
        more => format!("{more} parameters have changed since the calibration in {over}"),
    }
}

pub fn sentence(alarm: &Alarm) -> String {
    let of = |joint: usize| alarm.joint_name.clone().unwrap_or_else(|| format!("joint {joint}"));
    let what = match (alarm.group, alarm.joint) {
        (DriftGroup::Friction, Some(joint)) => format!("the friction of {}", of(joint)),
        (DriftGroup::Gain, Some(joint)) => format!("the gain of {}", of(joint)),
        _ => "the load on the last link".to_owned(),
    };
    let way = if alarm.rose { "rose" } else { "fell" };
    format!(
        "{what} {way} in {} at {} s, certain in {} at {} s",
        alarm.since_recording,
        significant(alarm.since_s, 3),
        alarm.certain_recording,
        significant(alarm.certain_s, 3)
    )
}

/// A parameter by the name of its joint, if that has one.
fn label(tracked: &Tracked, k: usize) -> String {
    let DriftParameter { group, joint, name, .. } = &tracked.parameters[k];
    let group = match group {
        DriftGroup::Friction => "friction",
        DriftGroup::Gain => "gain",
        DriftGroup::Load => "load",
    };
    let named = joint.filter(|joint| *joint < tracked.joint_names.len());
    let of = |joint| format!("{group} of {}", RobotNames::of_joints(&tracked.joint_names).joint(joint));
    named.map_or_else(|| name.clone(), of)
}

fn value(drift: &Drift) -> String {
    drift.value.map_or_else(|| "–".into(), |v| significant(v, 3))
}

fn interval(drift: &Drift) -> String {
    drift.interval_95.map_or_else(
        || "–".into(),
        |[low, high]| format!("{} to {}", significant(low, 2), significant(high, 2)),
    )
}

fn table(tracked: &Tracked) -> Table {
    let mut table = Table::new(
        "Change since the unchanged machine; 95 % intervals. Bold: zero lies outside.",
        ["<parameter", "<unit", "drift", "<95 % interval", "<recording"],
    );
    for recording in &tracked.recordings {
        for (k, drift) in recording.drift.iter().enumerate() {
            let is_off = drift.interval_95.is_some_and(|[low, high]| low > 0.0 || high < 0.0);
            table.row([
                Cell::from(label(tracked, k)),
                Cell::from(tracked.parameters[k].unit.as_str()),
                Cell { text: value(drift), strong: is_off },
                Cell::from(interval(drift)),
                Cell::from(recording.recording.as_str()),
            ]);
        }
    }
    table
}

/// One figure a group, one panel a parameter.
fn charts(tracked: &Tracked) -> Section {
    let groups = [
        (DriftGroup::Friction, "friction", "Friction of the joints"),
        (DriftGroup::Gain, "gain", "Gains of the joints"),
        (DriftGroup::Load, "load", "Load on the last link"),
    ];
    let figures = groups.into_iter().filter_map(|(group, name, title)| {
        let panels: Vec<Panel> = (0..tracked.parameters.len())
            .filter(|k| tracked.parameters[*k].group == group)
            .map(|k| panel(tracked, k))
            .collect();
        (!panels.is_empty()).then(|| {
            Figure::Plot(Plot {
                title: title.into(),
                name: format!("drift_{name}"),
                caption: String::new(),
                x: Axis::new("recording", ""),
                panels,
                link: Some("recordings".into()),
                small: false,
            })
        })
    });
    Section::new(
        "Drift",
        "Points: each recording alone, between the ends of its 95 % interval. Line: the tracked estimate, in \
                       which old rows fade.",
        figures.map(Block::Figure).collect(),
    )
}

fn panel(tracked: &Tracked, k: usize) -> Panel {
    let x: Vec<f64> = (1..=tracked.recordings.len()).map(|n| n as f64).collect();
    let series = |of: &dyn Fn(&TrackedRecording) -> Option<f64>| -> Vec<f64> {
        tracked.recordings.iter().map(|r| of(r).unwrap_or(f64::NAN)).collect()
    };
    let layer = |name: &str, style, mark, y| Layer { name: name.into(), style, mark, x: x.clone(), y };
    let end = |side: usize| series(&|r| r.drift[k].interval_95.map(|i| i[side]));
    let parameter = &tracked.parameters[k];
    let unit = if parameter.unit == "1" { "" } else { &parameter.unit };
    Panel {
        y: Axis::new(label(tracked, k), unit),
        height: 80.0,
        layers: vec![
            layer("95 % interval", Style::Floor, Mark::Line, end(0)),
            layer("95 % interval", Style::Floor, Mark::Line, end(1)),
            layer("tracked", Style::Predicted, Mark::Line, series(&|r| r.tracked[k].value)),
            layer("each recording", Style::Measured, Mark::Points, series(&|r| r.drift[k].value)),
        ],
        windows: Vec::new(),
    }
}

//! Rows of recordings: over time, and their residuals over coordinates.

use aurt_diagnosis::{RecordingSeries, Role};

use super::Diagnosed;
use crate::figure::Style;
use crate::page::{Block, Section};
use crate::reports::figures::{
    HOW_TO_LOOK, Series, TimeFigure, file_name, measured_axis, points_per_series, residuals_over, stem,
};

impl Diagnosed<'_> {
    /// Windows that are set off in one joint's figure: those of findings, and those in which the rest stands out.
    fn windows(&self, series: &RecordingSeries, joint: usize) -> Vec<([f64; 2], &'static str)> {
        let located = self.verdict.effects.iter().filter(|f| {
            f.recording.as_deref() == Some(series.name.as_str())
                && (f.joints.is_empty() || f.joints.contains(&joint))
        });
        let left = series.joints[joint].windows_s.iter().map(|w| (*w, "residual above the noise floor"));
        located.filter_map(|f| Some((f.window_s?, "located"))).chain(left).collect()
    }

    pub(super) fn over_time(&self) -> Section {
        let count: usize = self.series.iter().map(|s| s.joints.len()).sum();
        let points = points_per_series(5 * count);
        let mut order: Vec<&RecordingSeries> = self.series.iter().collect();
        // Held-out recordings convince most, then what was asked about.
        order.sort_by_key(|s| match s.role {
            Role::Validation => 0,
            Role::Target => 1,
            Role::Calibration => 2,
        });
        let names = self.verdict.names();
        let mut blocks = Vec::new();
        for (k, series) in order.into_iter().enumerate() {
            let figures = series.joints.iter().enumerate().map(|(j, joint)| {
                let mut panels = Vec::new();
                let predictions = joint.measured.as_ref().map(|measured| {
                    let less = |residual: &[f64]| -> Vec<f64> {
                        measured.iter().zip(residual).map(|(y, r)| y - r).collect()
                    };
                    (measured, less(&joint.before), less(&joint.after))
                });
                let line = |name, style, values| Series { name, style, values };
                let slides = self.improved.0.rigid_body().slides(j);
                if let Some((measured, before, after)) = &predictions {
                    panels.push((
                        measured_axis(None, self.unit, slides),
                        vec![
                            line("measured", Style::Measured, measured.as_slice()),
                            line("before", Style::Before, before.as_slice()),
                            line("after", Style::After, after.as_slice()),
                        ],
                    ));
                }
                panels.push((
                    measured_axis(Some("residual"), self.unit, slides),
                    vec![
                        line("before", Style::Before, joint.before.as_slice()),
                        line("after", Style::After, joint.after.as_slice()),
                    ],
                ));
                let figure = TimeFigure {
                    title: format!("{}, {}", names.joint(j), stem(&series.name)),
                    name: format!("{}_{}_joint_{j}", stem(&series.name), series.role.name()),
                    time_s: &series.time_s,
                    segment_starts: &series.segment_starts,
                    panels,
                    windows: &self.windows(series, j),
                    link: format!("recording {k}"),
                };
                Block::Figure(figure.figure(points))
            });
            let part = match (series.role, series.held_out_from < series.time_s.len()) {
                (Role::Validation, _) => "held out".to_owned(),
                (of, true) => format!(
                    "{}, held out from {:.1} s",
                    of.name(),
                    series.time_s.get(series.held_out_from).copied().unwrap_or(0.0)
                ),
                (of, false) => of.name().to_owned(),
            };
            blocks.push(Block::Folded {
                title: format!("{} ({part})", file_name(&series.name)),
                open: k == 0,
                blocks: figures.collect(),
            });
        }
        Section::new(
            "Measured and predicted",
            format!(
                "Filtered and decimated as in the fit. Interrupted lines: rows that do not count, because the joint is at rest or the \
                 recording is faulty. {HOW_TO_LOOK}"
            ),
            blocks,
        )
    }

    pub(super) fn over_coordinates(&self) -> Section {
        let bodies = self.improved.0.rigid_body();
        let judged: Vec<(&RecordingSeries, usize)> = self
            .series
            .iter()
            .map(|s| (s, s.held_out_from))
            .filter(|(s, from)| *from < s.time_s.len())
            .collect();
        let joints = self.series.first().map_or(0, |s| s.joints.len());
        let names = self.verdict.names();
        let worst = self
            .verdict
            .residual
            .iter()
            .max_by(|a, b| (a.baseline_rms / a.floor_rms).total_cmp(&(b.baseline_rms / b.floor_rms)));
        let blocks = (0..joints)
            .map(|j| {
                type Pick = fn(&RecordingSeries, usize) -> &[f64];
                let all = |of: Pick| -> Vec<f64> {
                    judged.iter().flat_map(|(s, from)| of(s, j)[*from..].iter().copied()).collect()
                };
                let before = all(|s, j| &s.joints[j].before);
                let after = all(|s, j| &s.joints[j].after);
                let coordinates: [Pick; 5] = [
                    |s, j| &s.joints[j].velocity_rad_s,
                    |s, j| &s.joints[j].position_rad,
                    |s, j| &s.joints[j].load_torque,
                    |s, j| &s.joints[j].acceleration_rad_s2,
                    |s, _| &s.time_s,
                ];
                let residuals = [
                    Series { name: "before", style: Style::Before, values: &before },
                    Series { name: "after", style: Style::After, values: &after },
                ];
                let open = worst.is_some_and(|w| w.joint == j);
                let unit = (self.unit, bodies.slides(j));
                residuals_over((j, names.joint(j)), open, coordinates.map(all), unit, &residuals)
            })
            .collect();
        Section::new(
            "What the residual follows",
            "Residuals of the held-out rows over each coordinate, with means over classes of equal count. \
             A trend that is present before and absent after is explained; one that remains after is still missing.",
            blocks,
        )
    }
}

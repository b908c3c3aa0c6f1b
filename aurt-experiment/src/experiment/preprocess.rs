use aurt_recording::PreprocessOptions;

use super::section::Section;

/// `[preprocess]`: from the raw recording to what is fitted (paper, section IV-A). All keys are optional.
pub(super) fn read(mut section: Section<'_, '_>) -> PreprocessOptions {
    let default = PreprocessOptions::default();
    let preprocess = PreprocessOptions {
        f_dyn_hz: section.positive("f_dyn_hz").unwrap_or(default.f_dyn_hz),
        sample_rate_hz: section.positive("sample_rate_hz"),
        position_cutoff_hz: section.positive("position_cutoff_hz"),
        parallel_cutoff_hz: section.positive("parallel_cutoff_hz"),
        rest_velocity_rad_s: section
            .not_negative("rest_velocity_rad_s")
            .unwrap_or(default.rest_velocity_rad_s),
        trim_rest: section.boolean("trim_rest").unwrap_or(default.trim_rest),
        count_ends: section.boolean("count_ends").unwrap_or(default.count_ends),
        max_gap_s: section.positive("max_gap_s"),
        ..default
    };
    section.finish();
    preprocess
}

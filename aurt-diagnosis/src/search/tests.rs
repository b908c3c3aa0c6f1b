//! Selection on rows whose physics is known.

use std::sync::Arc;

use super::ground::{Beside, Ground};
use super::selection::{Selection, Selector};
use crate::dice::Dice;
use crate::effects;
use crate::evidence::baseline::weighted_fit;
use crate::evidence::chance::Chance;
use crate::evidence::deviations::beside_given;
use crate::evidence::given::GivenCovariance;
use crate::evidence::gram::BlockMoments;
use crate::evidence::judge::Judge;
use crate::evidence::problem::Problem;
use crate::evidence::residuals::shares;
use crate::hypotheses::group::{Group, Switch};
use crate::recordings::divided::FitRows;
use crate::recordings::partition::Partition;
use crate::recordings::rows::{JointRows, Layout, RecordingRows, Role};
use crate::request::SelectionOptions;

const ROWS: usize = 900;
const NOISE: f64 = 0.1;

/// Rows of one joint over columns of its own making.
struct Rows {
    problem: Problem,
    rows: Vec<RecordingRows>,
    partition: Partition,
    layout: Layout,
}

/// Uniform values of unit variance.
fn noise(seed: u64) -> impl FnMut() -> f64 {
    let mut dice = Dice(seed);
    move || (dice.uniform() - 0.5) * 12f64.sqrt()
}

/// A recording whose columns are wanderings that have nothing to do with one another, measured as their sum with
/// coefficients.
fn recording(role: Role, seed: u64, coefficients: &[f64]) -> RecordingRows {
    let columns = coefficients.len();
    let mut data = Vec::new();
    for k in 0..columns {
        let mut draw = noise(seed * 100 + k as u64 + 1);
        let mut value = 0.0;
        data.extend((0..ROWS).map(|_| {
            value = 0.9 * value + 0.43 * draw();
            value
        }));
    }
    let mut draw = noise(seed * 100 + 77);
    let of_row = |row: usize| (0..columns).map(|k| coefficients[k] * data[k * ROWS + row]).sum::<f64>();
    let measurement = (0..ROWS).map(|row| of_row(row) + NOISE * draw()).collect();
    let joint = JointRows {
        velocity_rad_s: data[..ROWS].to_vec(),
        position_rad: vec![0.0; ROWS],
        acceleration_rad_s2: vec![0.0; ROWS],
        counts: vec![true; ROWS],
        rest_velocity: 0.0,
        measurement,
        data,
    };
    RecordingRows {
        name: format!("{role:?}"),
        role,
        rate_hz: 50.0,
        time_s: (0..ROWS).map(|k| k as f64 / 50.0).collect(),
        segment_starts: vec![0, ROWS],
        joints: vec![joint],
    }
}

impl Rows {
    fn new(rows: Vec<RecordingRows>) -> Self {
        let columns = rows[0].joints[0].data.len() / ROWS;
        let layout =
            Layout { coefficients: columns, rows: vec![(0..columns).collect()], first_instrument: columns };
        let partition = Partition::new(&rows, 6, 0.2, false);
        let problem = Problem::new(&layout, BlockMoments::accumulate(&rows, &partition));
        Self { problem, rows, partition, layout }
    }

    fn judge<'a>(&'a self, groups: &'a [Group], options: &'a SelectionOptions) -> Judge<'a> {
        Judge {
            problem: &self.problem,
            groups,
            rows: &self.rows,
            partition: &self.partition,
            layout: &self.layout,
            floor: &[NOISE * NOISE],
            options,
        }
    }

    fn select(&mut self, groups: &[Group]) -> Selection {
        let options = SelectionOptions::default();
        let baseline = [switch(0, false)];
        let floor = [NOISE * NOISE];
        let mut selector =
            Selector { ground: self, baseline: &baseline, groups, floor: &floor, options: &options };
        selector.run(|_| ())
    }
}

impl Ground for Rows {
    fn problem(&self) -> &Problem {
        &self.problem
    }

    fn independent_shares(&self, switches: &[Switch], coefficients: &[f64]) -> Vec<f64> {
        shares(&self.rows, &self.partition, &self.layout, switches, coefficients)
    }

    fn rows_per_s(&self) -> f64 {
        50.0
    }

    fn scores_by_chance(
        &self,
        groups: &[Group],
        switches: &[Switch],
        _floor: &[f64],
        options: &SelectionOptions,
    ) -> Chance {
        self.judge(groups, options).scores_by_chance(switches, &[1.0])
    }

    fn estimate(&mut self, _group: &Group, _beside: &Beside<'_>) -> bool {
        false
    }
}

const fn switch(column: usize, target_only: bool) -> Switch {
    Switch { column, target_only, nonnegative: false }
}

fn group(effect: &'static str, column: usize, target_only: bool) -> Group {
    Group {
        effect: effects::find(effect).unwrap(),
        joints: vec![0],
        candidate: column,
        switches: vec![switch(column, target_only)],
        accessory: Vec::new(),
        shapes: 0,
    }
}

#[test]
fn what_is_there_is_found_and_nothing_beside_it() {
    let mut rows = Rows::new(vec![recording(Role::Calibration, 1, &[1.0, 0.8, 0.0, 0.0])]);
    let groups = [group("spring", 1, false), group("rotor_inertia", 2, false), group("viscous", 3, false)];
    let found = rows.select(&groups);
    assert_eq!(found.chosen.iter().map(|c| c.group).collect::<Vec<_>>(), [0]);
    let only = &found.chosen[0];
    assert!(only.score > only.threshold && only.by_chance().is_some_and(|p| p < 0.05), "{only:?}");
    assert!(found.after[0] < 1.2 * NOISE * NOISE, "{found:?}");
}

#[test]
fn noise_alone_is_nothing() {
    let mut rows = Rows::new(vec![recording(Role::Calibration, 2, &[1.0, 0.0, 0.0])]);
    let found = rows.select(&[group("spring", 1, false), group("viscous", 2, false)]);
    assert!(found.chosen.is_empty(), "{found:?}");
}

#[test]
fn a_change_is_found_beside_the_structure_that_hides_it() {
    // Structure takes nearly all of the gain; the change is a twentieth of it.
    let mut rows = Rows::new(vec![
        recording(Role::Calibration, 3, &[1.0, 2.0, 0.0]),
        recording(Role::Target, 4, &[1.0, 2.0, 0.12]),
    ]);
    let groups = [
        group("presliding_hysteresis", 1, false),
        group("presliding_hysteresis", 1, true),
        group("spring", 2, false),
        group("spring", 2, true),
    ];
    let mut found: Vec<usize> = rows.select(&groups).chosen.iter().map(|c| c.group).collect();
    found.sort_unstable();
    assert_eq!(found, [0, 3]);
}

#[test]
fn two_changes_of_friction_are_one() {
    // Beside the spring that is still missing, the larger change does as well as both; beside the larger change, the smaller
    // one is found.
    let mut rows = Rows::new(vec![
        recording(Role::Calibration, 8, &[1.0, 0.0, 0.0, 0.5]),
        recording(Role::Target, 9, &[1.0, 1.0, 0.14, 0.5]),
    ]);
    let mut level = group("friction_level_changed", 1, true);
    level.switches.push(switch(2, true));
    let apart = [group("viscous", 1, true), group("coulomb", 2, true), group("spring", 3, false)];
    let mut chosen = |groups: &[Group]| {
        let mut found: Vec<usize> = rows.select(groups).chosen.iter().map(|c| c.group).collect();
        found.sort_unstable();
        found
    };
    assert_eq!(chosen(&apart), [0, 1, 2]);
    assert_eq!(chosen(&[&apart[..], &[level]].concat()), [2, 3]);
}

#[test]
fn two_effects_are_not_joined_by_what_one_of_them_does_alone() {
    // The second effect brings a fiftieth of the score, the second coefficient of the law nothing.
    let mut rows = Rows::new(vec![recording(Role::Calibration, 8, &[1.0, 3.0, 0.0, 0.04])]);
    let mut law = group("coulomb_asymmetry", 1, false);
    law.switches.push(switch(2, false));
    let groups = [group("coulomb", 1, false), law, group("viscous", 3, false)];
    let mut found: Vec<usize> = rows.select(&groups).chosen.iter().map(|c| c.group).collect();
    found.sort_unstable();
    assert_eq!(found, [0, 2]);
}

#[test]
fn a_simpler_law_wins_a_tie_that_the_blocks_leave_open() {
    // The second column brings a fiftieth of the score, in every block, or nothing.
    let chosen = |second: f64| {
        let mut rows = Rows::new(vec![
            recording(Role::Calibration, 8, &[1.0, 0.0, 0.0]),
            recording(Role::Target, 9, &[1.0, 3.0, second]),
        ]);
        let mut level = group("friction_level_changed", 1, true);
        level.switches.push(switch(2, true));
        let found = rows.select(&[group("viscous", 1, true), level]);
        found.chosen.iter().map(|c| c.group).collect::<Vec<_>>()
    };
    assert_eq!(chosen(0.04), [1]);
    assert_eq!(chosen(0.0), [0]);
}

#[test]
fn losses_that_do_not_differ_are_friction_by_load() {
    // The difference lowers the error by less than an effect must.
    let mut rows = Rows::new(vec![recording(Role::Calibration, 8, &[1.0, 3.0, 0.02])]);
    let mut losses = group("drive_efficiency", 1, false);
    losses.switches.push(switch(2, false));
    let found = rows.select(&[group("load_dependent_friction", 1, false), losses]);
    assert_eq!(found.chosen.iter().map(|c| c.group).collect::<Vec<_>>(), [0]);
}

#[test]
fn a_weak_effect_leaves_its_like_open_and_a_strong_one_does_not() {
    let seeds = 100..140;
    // At 0.8 three of forty are open, from 1.0 on none.
    for (strength, expected) in [(0.05, 32..=40), (1.2, 0..=0)] {
        let open = seeds.clone().filter(|seed| {
            let mut recording = recording(Role::Calibration, *seed, &[1.0, strength, 0.0]);
            let (before, like) = recording.joints[0].data.split_at_mut(2 * ROWS);
            like.iter_mut().zip(&before[ROWS..]).for_each(|(like, own)| *like = own + 0.05 * *like);
            let groups = [group("spring", 1, false), group("viscous", 2, false)];
            Rows::new(vec![recording]).select(&groups).chosen.iter().any(|c| c.rivals.iter().any(|r| r.open))
        });
        let open = open.count();
        assert!(expected.contains(&open), "{open} of {} at {strength}", seeds.clone().count());
    }
}

#[test]
fn held_out_rows_confirm_what_is_there_and_not_what_is_not() {
    let rows = Rows::new(vec![recording(Role::Calibration, 5, &[1.0, 0.8, 0.0])]);
    let options = SelectionOptions::default();
    let groups = [group("spring", 1, false), group("viscous", 2, false)];
    let all = [switch(0, false), switch(1, false), switch(2, false)];
    let (_, confirm) = FitRows::divide(rows.rows.clone(), &rows.partition);
    let judge = rows.judge(&groups, &options);
    let [there, not] =
        [0, 1].map(|k| judge.p_confirm(&confirm, (&all[..1], &all), &groups[k], (0.05, 1.0)).unwrap());
    assert!(there < 0.01 && not > 0.05, "{there} {not}");
}

/// A memory of 0 asks whether rows favour the effect, one without end whether errors follow it.
#[test]
fn rows_that_hold_little_of_an_effect_confirm_it_by_what_errors_follow() {
    let confirmed = |strength: f64, memory: f64| {
        let seeds = (200..240).filter(|seed| {
            let rows = Rows::new(vec![recording(Role::Calibration, *seed, &[1.0, strength])]);
            let (options, groups) = (SelectionOptions::default(), [group("spring", 1, false)]);
            let all = [switch(0, false), switch(1, false)];
            let (_, confirm) = FitRows::divide(rows.rows.clone(), &rows.partition);
            let judge = rows.judge(&groups, &options);
            judge.p_confirm(&confirm, (&all[..1], &all), &groups[0], (0.05, memory)).is_some_and(|p| p < 0.05)
        });
        seeds.count()
    };
    let [favour, follow] = [0.0, f64::INFINITY].map(|memory| confirmed(0.02, memory));
    assert!(follow > favour + 8, "{favour} {follow}");
    assert!(confirmed(0.0, f64::INFINITY) <= 5);
}

#[test]
fn a_renewed_column_has_the_moments_of_its_rows() {
    let mut rows = Rows::new(vec![recording(Role::Calibration, 6, &[1.0, 0.8, 0.3])]);
    let column = rows.rows[0].joints[0].data[..ROWS].to_vec();
    rows.rows[0].joints[0].data[2 * ROWS..].iter_mut().zip(&column).for_each(|(v, c)| *v += 0.5 * c * c);
    rows.problem.renew(&rows.rows, &rows.partition, 0, &[2]);
    let anew = Problem::new(&rows.layout, BlockMoments::accumulate(&rows.rows, &rows.partition));
    let close = |a: &[f64], b: &[f64]| a.iter().zip(b).all(|(a, b)| (a - b).abs() < 1e-9 * b.abs().max(1.0));
    for block in 0..6 {
        let ((rest, _), (rest_anew, _)) = (rows.problem.fold(block), anew.fold(block));
        assert!(close(&rest[0][0].gram, &rest_anew[0][0].gram));
        assert!(close(&rest[0][0].right, &rest_anew[0][0].right));
    }
}

#[test]
fn a_sign_holds_on_held_out_blocks_too() {
    let rows = Rows::new(vec![recording(Role::Calibration, 7, &[1.0, -0.8])]);
    let signed = [Switch { column: 1, target_only: false, nonnegative: true }];
    let nested = rows.problem.nest(&[switch(0, false)], &[1.0]);
    let [without, with] = [&[][..], &signed].map(|g| rows.problem.held_out(&nested, g)[0][0]);
    assert!((without - with).abs() < 1e-9 * without, "{without} {with}");
    let all = rows.problem.nest(&[switch(0, false), signed[0]], &[1.0]);
    assert!((rows.problem.held_out(&all, &[])[0][0] - without).abs() < 1e-9 * without);
}

#[test]
fn a_fit_without_an_error_is_finite() {
    let mut recording = recording(Role::Calibration, 8, &[1.0, 0.8]);
    let joint = &mut recording.joints[0];
    joint.measurement = joint.data[..ROWS].iter().map(|x| 2.0 * x).collect();
    let rows = Rows::new(vec![recording]);
    let (fit, weights) = weighted_fit(&rows.problem, &[switch(0, false)], &[0.0]);
    assert!((fit.coefficients[0] - 2.0).abs() < 1e-9 && weights[0].is_finite(), "{fit:?}");
}

/// A coefficient beside a given model takes up a part of its error: γ = (zᵀz)⁻¹zᵀx δ.
#[test]
fn a_given_model_that_may_be_off_widens_what_is_fitted_beside_it() {
    let given = GivenCovariance { n: 1, matrix: vec![0.04] };
    let mut rows = Rows::new(vec![recording(Role::Target, 9, &[0.0, 0.0])]);
    let joint = &rows.rows[0].joints[0];
    let (x, z) = joint.data.split_at(ROWS);
    let product = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
    let squares = given.sum_of_squares(joint, &[0, 1]);
    assert!((squares - 0.04 * product(x, x)).abs() < 1e-9 * squares, "{squares}");
    let fitted = rows.partition.fitted().flat_map(|(_, start, end)| start..end);
    let (zx, zz) = fitted.fold((0.0, 0.0), |(zx, zz), k| (zx + z[k] * x[k], zz + z[k] * z[k]));
    rows.problem.given = Some(Arc::new(given));
    let variance = beside_given(&rows.problem, &[switch(1, true)], &[1.0]).unwrap()[0];
    assert!((variance - 0.04 * (zx / zz).powi(2)).abs() < 1e-9 * variance && variance > 0.0, "{variance}");
}

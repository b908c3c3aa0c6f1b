//! Where an error is: the arm as lines, seen from the side, in a pose of its recordings.

use std::any::Any;

use aurt_diagnosis::QuestionedRecording;
use aurt_rbd::SerialChain;
use aurt_traits::{RobotModel, RobotNames};

use crate::figure::{Arm, Shade};
use crate::noise_report::{JointNoise, NoiseReport};

/// Samples of each recording among which the pose is chosen.
const POSES: usize = 40;
/// An arm that is flatter than this share of its length, seen from the side, is drawn from above.
const FLAT: f64 = 0.1;

/// A robot as it is drawn.
#[derive(Debug, Clone, PartialEq)]
pub struct Outline {
    /// The base and then every joint, in the plane of a drawing, m.
    pub points_m: Vec<[f64; 2]>,
    /// As in [`Arm::from`].
    pub from: Vec<usize>,
}

/// Base and joints in the pose, of some of all recordings, in which they take the most room. None where joints follow others
/// or the bodies are of a kind of their own.
pub fn outline(model: &RobotModel, recordings: &[QuestionedRecording]) -> Option<Outline> {
    let any: &dyn Any = &**model.rigid_body();
    let chain = any.downcast_ref::<SerialChain>()?;
    let mut best: Option<(f64, Vec<[f64; 2]>)> = None;
    let mut frames = Vec::new();
    for recording in recordings {
        let positions = &recording.raw.position_rad;
        for k in (0..recording.raw.samples()).step_by((recording.raw.samples() / POSES).max(1)) {
            let pose: Vec<f64> = positions.iter().map(|q| q[k]).collect();
            if pose.len() != model.joints() {
                return None;
            }
            chain.link_frames(&pose, &mut frames);
            let points: Vec<[f64; 3]> =
                std::iter::once([0.0; 3]).chain(frames.iter().map(|f| f.origin_m)).collect();
            let seen = seen(&points, model.rigid_body().gravity_m_s2());
            let [width, height] = [0, 1].map(|axis| extent(seen.iter().map(|p| p[axis])));
            let room = width * height;
            if best.as_ref().is_none_or(|(most, _)| room > *most) {
                best = Some((room, seen));
            }
        }
    }
    let from = (0..model.joints()).map(|joint| chain.parent(joint).map_or(0, |link| link + 1)).collect();
    let points_m = best.map(|(_, points)| points)?;
    points_m.iter().flatten().all(|x| x.is_finite()).then_some(Outline { points_m, from })
}

fn extent(values: impl Iterator<Item = f64> + Clone) -> f64 {
    values.clone().fold(f64::NEG_INFINITY, f64::max) - values.fold(f64::INFINITY, f64::min)
}

fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a.iter().zip(b).map(|(x, y)| x * y).sum()
}

fn cross(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

fn unit(a: [f64; 3]) -> Option<[f64; 3]> {
    let length = dot(a, a).sqrt();
    (length > 1e-9).then(|| a.map(|x| x / length))
}

/// Points from the side on which they are widest, gravity downwards; from above where they lie in a plane that is level.
fn seen(points: &[[f64; 3]], gravity: [f64; 3]) -> Vec<[f64; 2]> {
    let up = unit(gravity.map(|g| -g)).unwrap_or([0.0, 0.0, 1.0]);
    let aside = if up[0].abs() < 0.9 { [1.0, 0.0, 0.0] } else { [0.0, 1.0, 0.0] };
    let x = unit(cross(aside, up)).unwrap_or([0.0, 1.0, 0.0]);
    let y = cross(up, x);
    let level: Vec<[f64; 2]> = points.iter().map(|p| [dot(*p, x), dot(*p, y)]).collect();
    // The direction in which the level coordinates vary most.
    let n = level.len() as f64;
    let mean = [0, 1].map(|i| level.iter().map(|p| p[i]).sum::<f64>() / n);
    let moment = |i: usize, j: usize| level.iter().map(|p| (p[i] - mean[i]) * (p[j] - mean[j])).sum::<f64>();
    let angle = 0.5 * f64::atan2(2.0 * moment(0, 1), moment(0, 0) - moment(1, 1));
    let (sin, cos) = angle.sin_cos();
    let along = |p: &[f64; 2]| cos * p[0] + sin * p[1];
    let across = |p: &[f64; 2]| cos * p[1] - sin * p[0];
    let heights: Vec<f64> = points.iter().map(|p| dot(*p, up)).collect();
    let from_above = extent(heights.iter().copied()) < FLAT * extent(level.iter().map(along));
    level
        .iter()
        .zip(&heights)
        .map(|(p, height)| [along(p), if from_above { across(p) } else { *height }])
        .collect()
}

/// The drawing: errors over the noise floor.
pub fn figure(names: RobotNames<'_>, errors: &NoiseReport, outline: &Outline) -> Arm {
    let joints = outline.points_m.len().saturating_sub(1);
    let shades = |shade: &dyn Fn(&JointNoise) -> Option<Shade>| -> Vec<Option<Shade>> {
        (0..joints).map(|joint| errors.joints.get(joint).and_then(shade)).collect()
    };
    let rows = if errors.is_held_out { "on held-out data" } else { "on the rows that were fitted" };
    let marks = marks(names, joints);
    let key: Vec<String> = (0..joints)
        .filter(|j| !names.joints.is_empty() && !names.joint_cell(*j).ends_with(&marks[*j]))
        .map(|j| format!("{} {}", marks[j], names.joint_cell(j)))
        .collect();
    let key = if key.is_empty() { String::new() } else { format!(" {}.", key.join(", ")) };
    Arm {
        title: "where the error is".into(),
        name: "arm".into(),
        caption: format!(
            "Joints by their error {rows}, in multiples of the noise floor. A pose of the recordings; joints at one place \
             are drawn side by side.{key}"
        ),
        of: "noise".into(),
        points_m: outline.points_m.clone(),
        from: outline.from.clone(),
        joints: (0..joints).map(|j| (marks[j].clone(), names.joint(j))).collect(),
        states: vec![
            ("before".into(), shades(&|error| error.before.map(Shade::of))),
            ("after".into(), shades(&JointNoise::shade)),
        ],
    }
}

/// Characters that a circle has room for.
const ROOM: usize = 2;

/// What circles of joints show: that by which names differ, where there is room, else the number.
fn marks(names: RobotNames<'_>, joints: usize) -> Vec<String> {
    let numbers = || (0..joints).map(|j| j.to_string()).collect();
    let names = names.joints;
    let Some(first) = names.first().filter(|_| names.len() == joints) else { return numbers() };
    let common = |name: &String| first.chars().zip(name.chars()).take_while(|(a, b)| a == b).count();
    let same = names[1..].iter().map(common).min().unwrap_or(0);
    let marks: Vec<String> = names.iter().map(|name| name.chars().skip(same).collect()).collect();
    let fits = |mark: &String| !mark.is_empty() && mark.chars().count() <= ROOM;
    if marks.iter().all(fits) { marks } else { numbers() }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_arm_is_seen_from_its_widest_side_and_a_level_one_from_above() {
        let standing = [[0.0; 3], [0.0, 0.0, 0.2], [0.3, 0.4, 0.5], [0.6, 0.8, 0.1]];
        let side = seen(&standing, [0.0, 0.0, -9.81]);
        for (point, [along, height]) in [(1, [0.0, 0.2]), (2, [0.5, 0.5]), (3, [1.0, 0.1])] {
            assert!((side[point][0] - side[0][0]).abs() - along < 1e-12, "{side:?}");
            assert!((side[point][1] - height).abs() < 1e-12, "{side:?}");
        }
        let hanging = seen(&standing, [0.0, 0.0, 9.81]);
        assert!((hanging[1][1] + 0.2).abs() < 1e-12);
        let level = [[0.0; 3], [0.5, 0.0, 0.0], [0.5, 0.4, 0.0]];
        let above = seen(&level, [0.0, 0.0, -9.81]);
        let length = |a: usize, b: usize| f64::hypot(above[a][0] - above[b][0], above[a][1] - above[b][1]);
        assert!((length(0, 1) - 0.5).abs() < 1e-12 && (length(1, 2) - 0.4).abs() < 1e-12, "{above:?}");
    }
}

//! An arm, or a tree of them, as lines in a plane, its joints coloured by how far something exceeds a level, before and after.

use std::fmt::Write;

use super::Target;
use super::drawing::{self, Sample, text};
use super::scale::coordinate;
use crate::escape;

/// An arm, drawn once for each state of it.
#[derive(Debug, Clone, PartialEq)]
pub struct Arm {
    pub title: String,
    pub name: String,
    /// What stands below; may be empty.
    pub caption: String,
    /// What levels are multiples of, such as "noise".
    pub of: String,
    /// The base and then every joint, in the plane of the drawing, m, upwards and to the right.
    pub points_m: Vec<[f64; 2]>,
    /// Of every joint the point to which its parent link leads: 0 the base, j + 1 joint j.
    pub from: Vec<usize>,
    /// Of every joint what its circle shows, and its name.
    pub joints: Vec<(String, String)>,
    /// The states: a label, and a shade for each joint, absent where there is none.
    pub states: Vec<(String, Vec<Option<Shade>>)>,
}

#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Shade {
    pub multiple: f64,
    /// Its colour, from 0 to the number of colours.
    pub level: usize,
}

impl Shade {
    pub fn of(multiple: f64) -> Self {
        Self { multiple, level: LEVELS.iter().filter(|l| multiple > **l).count() }
    }
}

/// An error up to this multiple of the noise floor is within noise.
pub const NOISE_LIMIT: f64 = 1.5;
/// Multiples up to which each colour reaches; beyond the last one there is one more.
pub const LEVELS: [f64; 3] = [NOISE_LIMIT, 3.0, 6.0];

const WIDTH: f64 = 460.0;
const HEIGHT: f64 = 300.0;
const MARGIN: f64 = 28.0;
/// Room above for the label of a state.
const LABEL: f64 = 20.0;
const RADIUS: f64 = 9.5;

fn class(level: usize) -> &'static str {
    ["level0", "level1", "level2", "level3"][level.min(LEVELS.len())]
}

impl Arm {
    pub(crate) fn legend(&self) -> Vec<(String, Sample)> {
        let of = &self.of;
        let [a, b, c] = LEVELS;
        let names = [format!("≤ {a} × {of}"), format!("≤ {b}"), format!("≤ {c}"), "more".to_owned()];
        names.into_iter().enumerate().map(|(k, name)| (name, Sample::Level(class(k)))).collect()
    }

    pub(crate) fn draw(&self, target: Target) -> String {
        let mut svg = String::new();
        let panel = WIDTH / self.states.len().max(1) as f64;
        let lines = self.placed(panel);
        let joints = apart(&lines[1.min(lines.len())..], panel);
        for (k, (label, shades)) in self.states.iter().enumerate() {
            let left = panel * k as f64;
            let _ = write!(svg, "<g transform=\"translate({} 0)\">", coordinate(left));
            svg.push_str(&text(panel / 2.0, 13.0, "middle", "axis", label));
            if let Some([x, y]) = lines.first() {
                let (x, y) = (coordinate(*x), coordinate(*y));
                let _ = write!(svg, "<path class=\"ground\" d=\"M{x} {y}m-14 0h28\"/>");
            }
            let at = |point: usize| lines.get(point).map_or([0.0; 2], |p| *p).map(coordinate).join(" ");
            let mut path = format!("M{}", at(0));
            for (joint, from) in self.from.iter().enumerate() {
                if *from != joint {
                    let _ = write!(path, "M{}", at(*from));
                }
                let _ = write!(path, "L{}", at(joint + 1));
            }
            let _ = write!(svg, "<path class=\"link\" d=\"{path}\"/>");
            for (joint, [x, y]) in joints.iter().enumerate() {
                let shade = shades.get(joint).copied().flatten().filter(|s| s.multiple.is_finite());
                let colour = shade.map_or("levelless", |s| class(s.level));
                let said = shade
                    .map_or_else(|| "no error known".into(), |s| format!("{:.1} × {}", s.multiple, self.of));
                let (mark, name) = self.joints.get(joint).map_or(("", ""), |(mark, name)| (mark, name));
                let _ = write!(
                    svg,
                    "<g class=\"joint {colour}\"><title>{}</title><circle cx=\"{}\" cy=\"{}\" r=\"{RADIUS}\"/>",
                    escape::text(&format!("{name}, {label}: {said}")),
                    coordinate(*x),
                    coordinate(*y)
                );
                svg.push_str(&text(*x, y + 4.0, "middle", "number", mark));
                svg.push_str("</g>");
            }
            svg.push_str("</g>");
        }
        match target {
            Target::File => drawing::file(WIDTH, HEIGHT, &self.title, &self.legend(), &svg),
            Target::Page => format!(
                "<svg viewBox=\"0 0 {WIDTH} {HEIGHT}\" role=\"img\" aria-label=\"{}\">{svg}</svg>",
                escape::text(&self.title)
            ),
        }
    }

    /// The points in a panel of that width, one scale for both directions.
    fn placed(&self, width: f64) -> Vec<[f64; 2]> {
        let range = |axis: usize| {
            let values = self.points_m.iter().map(|p| p[axis]);
            values.fold([f64::INFINITY, f64::NEG_INFINITY], |[a, b], v| [a.min(v), b.max(v)])
        };
        let (x, y) = (range(0), range(1));
        let room = [width - 2.0 * MARGIN, HEIGHT - LABEL - 2.0 * MARGIN];
        let scale = f64::min(room[0] / (x[1] - x[0]).max(1e-9), room[1] / (y[1] - y[0]).max(1e-9));
        let centre = [0.5 * (x[0] + x[1]), 0.5 * (y[0] + y[1])];
        let middle = [width / 2.0, LABEL + (HEIGHT - LABEL) / 2.0];
        self.points_m
            .iter()
            .map(|p| [middle[0] + scale * (p[0] - centre[0]), middle[1] - scale * (p[1] - centre[1])])
            .collect()
    }
}

/// Circles that would cover one another, moved towards the middle of a panel of that width.
fn apart(points: &[[f64; 2]], width: f64) -> Vec<[f64; 2]> {
    let mut placed: Vec<[f64; 2]> = Vec::new();
    for point in points {
        let mut at = *point;
        let step = if at[0] > 0.5 * width { -2.0 } else { 2.0 };
        while placed.iter().any(|p| f64::hypot(p[0] - at[0], p[1] - at[1]) < 2.0 * RADIUS) {
            at[0] += step;
        }
        placed.push(at);
    }
    placed
}

#[cfg(test)]
mod tests {
    use super::*;

    fn arm(points_m: Vec<[f64; 2]>) -> Arm {
        let joints = points_m.len() - 1;
        Arm {
            title: "where".into(),
            name: "arm".into(),
            caption: String::new(),
            of: "noise".into(),
            points_m,
            from: (0..joints).collect(),
            joints: (0..joints).map(|j| (j.to_string(), format!("joint {j}"))).collect(),
            states: vec![
                ("before".into(), (0..joints).map(|j| Some(Shade::of(1.0 + 3.0 * j as f64))).collect()),
                ("after".into(), vec![None; joints]),
            ],
        }
    }

    #[test]
    fn every_joint_has_a_circle_with_its_colour_in_each_state_and_no_two_cover_each_other() {
        let shown = arm(vec![[0.0, 0.0], [0.0, 0.2], [0.0, 0.2], [0.6, 0.5], [1.1, 0.4]]);
        let svg = shown.draw(Target::Page);
        assert_eq!(svg.matches("<circle").count(), 8);
        for (class, count) in [("level0", 1), ("level1", 0), ("level2", 1), ("level3", 2), ("levelless", 4)] {
            assert_eq!(svg.matches(&format!("joint {class}\"")).count(), count, "{class}");
        }
        let placed = apart(&shown.placed(230.0)[1..], 230.0);
        for (k, a) in placed.iter().enumerate() {
            assert!(a[0] > RADIUS && a[0] < 230.0 - RADIUS && a[1] > LABEL && a[1] < HEIGHT, "{a:?}");
            assert!(placed[..k].iter().all(|b| f64::hypot(a[0] - b[0], a[1] - b[1]) >= 2.0 * RADIUS));
        }
    }

    #[test]
    fn branches_begin_where_their_parent_link_ends() {
        let mut two = arm(vec![[0.0, 0.0], [0.0, 1.0], [1.0, 2.0], [-1.0, 2.0]]);
        let chain = two.draw(Target::Page);
        two.from = vec![0, 1, 1];
        let tree = two.draw(Target::Page);
        let path = |svg: &str| {
            svg.split("class=\"link\" d=\"").nth(1).map(|d| d.split('"').next().map(str::to_owned))
        };
        let [chain, tree] = [chain, tree].map(|svg| path(&svg).flatten().unwrap_or_default());
        assert_eq!([chain.matches('M').count(), chain.matches('L').count()], [1, 3], "{chain}");
        assert_eq!([tree.matches('M').count(), tree.matches('L').count()], [2, 3], "{tree}");
    }

    #[test]
    fn an_arm_without_extent_is_drawn() {
        assert!(!arm(vec![[0.3, 0.3]; 3]).draw(Target::Page).contains("NaN"));
    }
}

//! Boxes that the arm stays out of.

use aurt_rbd::{Joint, JointKind, LinkFrame, SerialChain};
use aurt_simulation::{SimulationError, Trajectory};

/// A box along the axes of the base frame.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct KeepOut {
    /// The corner with the least coordinates, m.
    pub low_m: [f64; 3],
    /// The corner with the greatest coordinates, m.
    pub high_m: [f64; 3],
}

impl KeepOut {
    /// True if a straight line between two points meets the box: its parameters within each pair of faces overlap.
    fn meets(&self, from_m: [f64; 3], to_m: [f64; 3]) -> bool {
        let (mut first, mut last) = (0.0_f64, 1.0_f64);
        for axis in 0..3 {
            let (from, along) = (from_m[axis], to_m[axis] - from_m[axis]);
            let faces = [self.low_m[axis], self.high_m[axis]];
            if along == 0.0 {
                if from < faces[0] || from > faces[1] {
                    return false;
                }
                continue;
            }
            let [a, b] = faces.map(|face| (face - from) / along);
            (first, last) = (first.max(a.min(b)), last.min(a.max(b)));
        }
        first <= last
    }
}

/// The check of an arm's motions against boxes.
#[derive(Debug)]
pub(super) struct KeepOutCheck {
    pub(super) chain: SerialChain,
    pub(super) boxes: Vec<KeepOut>,
}

/// Poses per second at which a motion is looked at: at 2 m/s a point moves 2 cm in between.
const LOOKS_HZ: f64 = 100.0;

impl KeepOutCheck {
    /// True if some line of the arm moves.
    pub(super) fn has_lines(&self) -> bool {
        let slides = |joint: &Joint| joint.kind == JointKind::Prismatic;
        self.chain.joints().len() > 1 || self.chain.joints().iter().any(slides)
    }

    /// True if lines between the origins of neighbouring links stay out of all boxes during a motion. The line from the base to a
    /// link on it counts where that link slides; otherwise it does not move.
    pub(super) fn allow(&self, motion: &Trajectory) -> Result<bool, SimulationError> {
        let mut allowed = true;
        let mut frames: Vec<LinkFrame> = Vec::new();
        motion.rows(LOOKS_HZ, |_, q_rad, _, _| {
            if !allowed {
                return;
            }
            self.chain.link_frames(q_rad, &mut frames);
            let lines = (0..frames.len()).filter_map(|link| {
                let from_m = match self.chain.parent(link) {
                    Some(parent) => frames[parent].origin_m,
                    None if self.chain.joints()[link].kind == JointKind::Prismatic => [0.0; 3],
                    None => return None,
                };
                Some([from_m, frames[link].origin_m])
            });
            allowed = !lines.into_iter().any(|[from, to]| self.boxes.iter().any(|b| b.meets(from, to)));
        })?;
        Ok(allowed)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_line_meets_a_box_that_it_passes_through_touches_or_lies_in() {
        let low = KeepOut { low_m: [-1.0, -1.0, -1.0], high_m: [1.0, 1.0, 0.0] };
        for [from, to] in [
            [[-2.0, 0.0, -0.5], [2.0, 0.0, -0.5]],
            [[0.0, 0.0, -0.5], [0.1, 0.0, -0.4]],
            [[0.5, 0.5, 0.0], [0.5, 0.5, 2.0]],
            [[-2.0, 0.0, 1.0], [2.0, 0.0, -1.0]],
        ] {
            assert!(low.meets(from, to) && low.meets(to, from), "{from:?} {to:?}");
        }
        for [from, to] in [
            [[-2.0, 0.0, 0.5], [2.0, 0.0, 0.5]],
            [[0.0, 0.0, 0.1], [0.0, 0.0, 2.0]],
            [[-3.0, 0.0, -0.5], [-2.0, 0.0, -0.5]],
            [[-2.0, 0.0, 1.5], [2.0, 3.0, -1.0]],
        ] {
            assert!(!low.meets(from, to) && !low.meets(to, from), "{from:?} {to:?}");
        }
    }
}

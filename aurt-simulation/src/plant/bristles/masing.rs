use serde::{Deserialize, Serialize};

use crate::plant::{Bristle, Stretch};

/// Number of remembered reversals; older ones are forgotten.
const REMEMBERED: usize = 24;

/// Rate-independent hysteresis by Masing's rules (1926) with Madelung's closure of inner loops.
///
/// From rest the torque follows the virgin curve, level · x / (x_s + |x|); after a reversal at (x_r, F_r) it
/// follows F_r + 2 f((x − x_r)/2); a loop that closes is forgotten. Unlike a sum of finitely many slip
/// elements it is smooth between reversals and remembers every one of them.
///
/// State: position, direction, number of reversals, then their (position, share) pairs.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Masing {
    /// x_s, rad: at this distance from rest the virgin curve has reached half its level.
    pub half_way_rad: f64,
}

/// Where a branch began: position and share of the level.
type Reversal = [f64; 2];

impl Masing {
    /// The virgin curve as a share of the level.
    fn virgin(&self, x_rad: f64) -> f64 {
        x_rad / (self.half_way_rad + x_rad.abs())
    }

    fn on_branch(&self, reversals: &[Reversal], x_rad: f64) -> f64 {
        match reversals.last() {
            None => self.virgin(x_rad),
            Some([x_r, share]) => share + 2.0 * self.virgin(0.5 * (x_rad - x_r)),
        }
    }

    /// Position, direction, reversals and share of the level after a move.
    fn after(&self, state: &[f64], moved_rad: f64) -> (f64, f64, [Reversal; REMEMBERED], usize, f64) {
        let (position, mut direction, mut count) = (state[0], state[1], state[2] as usize);
        let mut reversals = [[0.0; 2]; REMEMBERED];
        for (r, pair) in reversals.iter_mut().zip(state[3..].as_chunks::<2>().0) {
            *r = *pair;
        }
        let x = position + moved_rad;
        let now = if moved_rad == 0.0 { direction } else { moved_rad.signum() };
        if direction != 0.0 && now != direction {
            let share = self.on_branch(&reversals[..count], position);
            if count == REMEMBERED {
                reversals.rotate_left(2);
                count -= 2;
            }
            reversals[count] = [position, share];
            count += 1;
        }
        direction = now;
        // A branch that passes the reversal before its own has closed a loop: both are forgotten. The virgin
        // curve's mirror image counts as the reversal before the first.
        loop {
            let closes_at = match count {
                0 => break,
                1 => -reversals[0][0],
                _ => reversals[count - 2][0],
            };
            if direction * (x - closes_at) <= 0.0 {
                break;
            }
            count = count.saturating_sub(2);
        }
        let share = self.on_branch(&reversals[..count], x);
        (x, direction, reversals, count, share)
    }
}

impl Bristle for Masing {
    fn state_len(&self) -> usize {
        3 + 2 * REMEMBERED
    }

    fn torque_nm(&self, state: &[f64], way: Stretch) -> [f64; 2] {
        let (.., share) = self.after(state, way.moved_rad);
        [way.level_nm * share, 0.0]
    }

    fn advance(&self, state: &mut [f64], way: Stretch) {
        let (x, direction, reversals, count, _) = self.after(state, way.moved_rad);
        [state[0], state[1], state[2]] = [x, direction, count as f64];
        for (pair, r) in state[3..].as_chunks_mut::<2>().0.iter_mut().zip(&reversals) {
            *pair = *r;
        }
    }

    fn stiffness_nm_rad(&self, level_nm: f64) -> f64 {
        level_nm / self.half_way_rad
    }
}

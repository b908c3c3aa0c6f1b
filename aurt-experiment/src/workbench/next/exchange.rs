use aurt_diagnosis::discrimination::{Discriminator, Doubt, Outlook};
use aurt_simulation::{Robot, Trajectory};
use rayon::prelude::*;

use super::{FULL_PIECES, GENERIC, NO_DOUBT, PIECES, Piece, Planner, SHARE};
use crate::workbench::failure::Failure;

/// Fedorov's exchange of pieces.
pub(super) struct Exchange<'e, D: Discriminator> {
    pub(super) planner: &'e Planner<'e, D>,
    pub(super) pieces: &'e [Piece<D::Planned>],
    pub(super) open: &'e [usize],
    pub(super) robot: Robot,
}

impl<D: Discriminator> Exchange<'_, D> {
    /// The expected number of settled doubts, and the evidence where all are as good as settled. Nobody knows whether any of the
    /// absorbed effects is there: together they count as one doubt.
    fn value(&self, motion: &D::Planned) -> f64 {
        let Planner { discrimination, .. } = self.planner;
        let is_absorbed = |k: &usize| matches!(discrimination.doubts()[*k], Doubt::Absorbed(_));
        let absorbed = self.open.iter().filter(|k| is_absorbed(k)).count().max(1) as f64;
        let outlook = discrimination.outlook_of(self.open, motion);
        let worth = |(k, o): (&usize, &Outlook)| {
            let settled = o.settled + NO_DOUBT * o.evidence.max(f64::MIN_POSITIVE).ln();
            if is_absorbed(k) { settled / absorbed } else { settled }
        };
        self.open.iter().zip(&outlook).map(worth).sum()
    }

    /// The motion that settles most, with its pieces: those that the exchange finds, or the generic one where it is on offer and
    /// settles more, the ways between the pieces counted.
    pub(super) fn motion(
        &self,
        generic: &D::Planned,
    ) -> Result<(Vec<usize>, Trajectory, D::Planned), Failure> {
        let chosen = self.exchanged();
        let trajectory = self.sequence(&chosen);
        if !self.planner.arm.is_of_drives {
            trajectory.check(&self.robot)?;
        }
        let planned = self.planner.moments(&trajectory)?;
        match self.pieces.iter().position(|piece| piece.words == GENERIC) {
            Some(k) if self.value(generic) > self.value(&planned) => {
                Ok((vec![k], self.pieces[k].trajectory.clone(), generic.clone()))
            }
            _ => Ok((chosen, trajectory, planned)),
        }
    }

    /// The pieces that together settle most within the duration. No exchange leads from one long piece to several short ones:
    /// it begins once for each length, with no longer pieces.
    fn exchanged(&self) -> Vec<usize> {
        let lengths = self.pieces.iter().map(|piece| piece.trajectory.duration_s()).enumerate();
        let shortest = lengths.min_by(|a, b| a.1.total_cmp(&b.1)).map(|(k, _)| k);
        let of_count = |count: usize| self.of_pieces_up_to(self.planner.options.duration_s / count as f64);
        let better = |a: (f64, Vec<usize>), b: (f64, Vec<usize>)| if b.0 > a.0 { b } else { a };
        let best = (1..=FULL_PIECES).map(of_count).reduce(better).unwrap_or_default().1;
        if best.is_empty() { shortest.into_iter().collect() } else { best }
    }

    fn sequence(&self, chosen: &[usize]) -> Trajectory {
        let parts = chosen.iter().map(|k| self.pieces[*k].trajectory.clone()).collect();
        Trajectory::sequence(&self.robot, SHARE, parts)
    }

    fn fits(&self, chosen: &[usize]) -> bool {
        let motion = self.sequence(chosen);
        motion.duration_s() <= self.planner.options.duration_s && self.planner.is_allowed(&motion)
    }

    /// The best piece at a place, of those up to a length with which the motion is short enough.
    fn best(&self, chosen: &[usize], place: usize, longest_s: f64) -> (f64, Vec<usize>) {
        let all = (0..self.pieces.len()).into_par_iter().filter_map(|k| {
            let mut with = chosen.to_vec();
            with[place] = k;
            let is_short = self.pieces[k].trajectory.duration_s() <= longest_s;
            let sum = || self.planner.together(with.iter().map(|k| &self.pieces[*k]));
            let sum = (is_short && self.fits(&with)).then(sum).flatten()?;
            Some((self.value(&sum), with))
        });
        all.reduce(|| (f64::NEG_INFINITY, Vec::new()), |a, b| if b.0 > a.0 { b } else { a })
    }

    /// The value of the best motion that is found of pieces up to a length, and its pieces.
    fn of_pieces_up_to(&self, longest_s: f64) -> (f64, Vec<usize>) {
        let (mut most, mut chosen): (f64, Vec<usize>) = (f64::NEG_INFINITY, Vec::new());
        while chosen.len() < PIECES {
            let mut longer = chosen.clone();
            longer.push(0);
            let (value, with) = self.best(&longer, chosen.len(), longest_s);
            if with.is_empty() {
                break;
            }
            (most, chosen) = (value, with);
        }
        loop {
            let before = most;
            for place in 0..chosen.len() {
                let (value, with) = self.best(&chosen, place, longest_s);
                if value > most {
                    (most, chosen) = (value, with);
                }
            }
            if most <= before {
                return (most, chosen);
            }
        }
    }
}

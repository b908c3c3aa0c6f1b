//! The best stretch for a force on one link.

use super::scan::{Background, Prefix, Stretch, scan};
use super::{Contact, ContactRows};

/// Lengths of the stretches that are compared, s.
const LENGTHS_S: [f64; 9] = [0.3, 0.45, 0.7, 1.0, 1.5, 2.2, 3.2, 4.7, 7.0];

/// Stretches longer than this share of their recording are no passing contact.
const LONGEST_SHARE: f64 = 0.35;

/// A touch that shrinks to this length cannot be told from an outlier, s.
const SHORTEST_S: f64 = 0.2;

/// A joint shows the contact if the force explains this share of what it explains on the joint that shows most.
const SHOWN: f64 = 0.05;

/// Least fall of a joint's whitened sum of squares, over the inflation, for the joint to show a contact: three
/// standard deviations.
const LEAST_OF_JOINT: f64 = 9.0;

/// T/V that the best of some hundred stretches of white noise reaches.
const CHANCE: f64 = 15.0;

/// A contact that one link's force would explain.
pub(super) struct Candidate {
    pub(super) contact: Contact,
    /// T of its stretch.
    pub(super) explained: f64,
}

/// The search for a force on one link.
pub(super) struct LinkSearch<'a> {
    link: usize,
    recordings: &'a [ContactRows<'a>],
    usable: &'a [Vec<Vec<bool>>],
    /// Noise levels, `[recording][joint]`.
    sigma: &'a [Vec<f64>],
    prefixes: Vec<Prefix>,
}

impl<'a> LinkSearch<'a> {
    pub(super) fn new(
        link: usize,
        recordings: &'a [ContactRows<'a>],
        usable: &'a [Vec<Vec<bool>>],
        sigma: &'a [Vec<f64>],
    ) -> Self {
        let prefixes = recordings
            .iter()
            .zip(usable)
            .zip(sigma)
            .map(|((r, u), sigma)| Prefix::new(&r.forces[link], r.residual, u, sigma))
            .collect();
        Self { link, recordings, usable, sigma, prefixes }
    }

    /// The stretch of largest T/V over all recordings and lengths, refined.
    pub(super) fn best(&self) -> Option<Candidate> {
        let scans: Vec<Vec<Vec<Stretch>>> = LENGTHS_S.iter().map(|l| self.scans(*l)).collect();
        let statistics = |of: &[Vec<Stretch>]| of.iter().flatten().map(|s| s.statistic).collect::<Vec<_>>();
        let background =
            Background::new(scans.iter().map(|of| Background::inflation(statistics(of))).collect());
        let mut best: Option<(f64, usize, Stretch)> = None;
        for (which, of_length) in scans.iter().enumerate() {
            for (r, stretches) in of_length.iter().enumerate() {
                for stretch in stretches {
                    let ratio = stretch.statistic / background.of_length(which);
                    if best.is_none_or(|(most, ..)| ratio > most) {
                        best = Some((ratio, r, *stretch));
                    }
                }
            }
        }
        let (_, r, stretch) = best?;
        self.refine(r, stretch.span(), &background)
    }

    /// All stretches of a length, recording by recording.
    fn scans(&self, length_s: f64) -> Vec<Vec<Stretch>> {
        self.recordings
            .iter()
            .zip(&self.prefixes)
            .map(|(recording, prefix)| {
                let length = (length_s * recording.rows.rate_hz).round() as usize;
                let longest = LONGEST_SHARE * recording.rows.rows() as f64;
                if length < 2 || length as f64 > longest { Vec::new() } else { scan(prefix, length) }
            })
            .collect()
    }

    /// Moves both edges to where T is largest, and describes the contact. The inflation grows with length, by less
    /// than a true force adds: edges are found at one inflation.
    fn refine(&self, r: usize, span: [usize; 2], background: &Background) -> Option<Candidate> {
        let (recording, prefix) = (&self.recordings[r], &self.prefixes[r]);
        let rows = recording.rows;
        let mut span = span;
        let shortest = (SHORTEST_S * rows.rate_hz).ceil().max(2.0) as usize;
        let better = |a: &[usize; 2], b: &[usize; 2]| prefix.statistic(*a).total_cmp(&prefix.statistic(*b));
        // Each edge moves by up to its stretch's length; two rounds, since the second edge may free the first.
        for _ in 0..2 {
            let reach = (span[1] - span[0]).max(rows.rate_hz.ceil() as usize);
            let starts = span[0].saturating_sub(reach)..(span[1] + 1).saturating_sub(shortest);
            span = starts.map(|start| [start, span[1]]).max_by(better)?;
            let ends = span[0] + shortest..(span[1] + reach).min(rows.rows()) + 1;
            span = ends.map(|end| [span[0], end]).max_by(better)?;
        }
        if span[1] - span[0] <= shortest {
            return None;
        }
        let length_s = (span[1] - span[0]) as f64 / rows.rate_hz;
        let inflation = background.at(&LENGTHS_S, length_s);
        let explained = prefix.statistic(span);
        let by_joint = prefix.explained_by_joint(
            &recording.forces[self.link],
            recording.residual,
            &self.usable[r],
            &self.sigma[r],
            span,
        );
        let most = by_joint.iter().copied().fold(0.0, f64::max);
        let shows = |j: &usize| by_joint[*j] > (SHOWN * most).max(LEAST_OF_JOINT * inflation);
        let time = |row: usize| rows.time_s[row.min(rows.rows() - 1)] - recording.origin_s;
        let half_row_s = 0.5 / rows.rate_hz;
        let contact = Contact {
            recording: r,
            window_s: [time(span[0]) - half_row_s, time(span[1] - 1) + half_row_s],
            link: self.link,
            joints: (0..by_joint.len()).filter(shows).collect(),
            score: 0.5 * explained / inflation,
            distinction: explained / self.rival(r, span, length_s).max(CHANCE * inflation),
            force_n: prefix.force(span),
            force_std_n: Some(prefix.force_deviation(span, inflation)),
        };
        Some(Candidate { contact, explained })
    }

    /// The largest T of any stretch of a length that does not meet `span` of recording `r`.
    fn rival(&self, r: usize, span: [usize; 2], length_s: f64) -> f64 {
        let of_recording = |(other, (recording, prefix)): (usize, (&ContactRows<'_>, &Prefix))| {
            let length = (length_s * recording.rows.rate_hz).round().max(2.0) as usize;
            let stretches = scan(prefix, length);
            let apart = stretches.iter().filter(|s| other != r || !s.meets(span));
            apart.map(|s| s.statistic).fold(0.0, f64::max)
        };
        self.recordings.iter().zip(&self.prefixes).enumerate().map(of_recording).fold(0.0, f64::max)
    }
}

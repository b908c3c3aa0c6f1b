use aurt_traits::{MotionView, RegressorTile};

use super::block::{Block, possible_entries};
use super::lanes::Lanes;
use super::motion::{Branching, Kept, Place};
use crate::joint::Joint;
use crate::{INERTIAL_PARAMETERS, SerialChain};

/// One call's work, prepared for the lanes.
#[derive(Debug)]
pub(super) struct Plan<'a> {
    pub gravity_m_s2: [f64; 3],
    pub joints: &'a [Joint],
    pub places: &'a [Place],
    /// The paths of all links, one after the other.
    pub paths: &'a [usize],
    /// Position, velocity and acceleration of each joint.
    pub series: Vec<[&'a [f64]; 3]>,
    pub samples: usize,
    /// The blocks of link after link, of each the joints of its path.
    blocks: Vec<Block>,
    /// An offset that none in `blocks` exceeds; `None` if nothing is wanted.
    largest_offset: Option<usize>,
}

impl<'a> Plan<'a> {
    pub fn new(chain: &'a SerialChain, motion: MotionView<'a>, tile: &mut RegressorTile<'_>) -> Self {
        let joints = chain.joints();
        let (destinations, stride, _) = tile.raw_mut();
        // One more than the largest destination: an entry that is not wanted wraps around to 0.
        let destinations_end = destinations.iter().map(|d| d.wrapping_add(1)).max().unwrap_or(0);
        let mut blocks = Vec::with_capacity(chain.paths().len());
        // One group of ten destinations for each (joint, link).
        let (groups, _) = destinations.as_chunks::<INERTIAL_PARAMETERS>();
        for link in 0..joints.len() {
            for joint in chain.path(link).iter().copied() {
                let possible =
                    possible_entries(joints[joint].kind, joint == link, chain.path(link).len() == 1);
                blocks.push(Block::new(&groups[joint * joints.len() + link], possible, stride));
            }
        }
        let largest_offset = (destinations_end as usize).checked_sub(1).map(|d| d * stride);
        Self { blocks, largest_offset, ..Self::without_tile(chain, motion) }
    }

    /// The work without the regressor's blocks.
    pub fn without_tile(chain: &'a SerialChain, motion: MotionView<'a>) -> Self {
        let joints = chain.joints();
        Self {
            gravity_m_s2: chain.gravity_m_s2(),
            joints,
            places: chain.places(),
            paths: chain.paths(),
            series: (0..joints.len())
                .map(|j| [motion.position_rad(j), motion.velocity_rad_s(j), motion.acceleration_rad_s2(j)])
                .collect(),
            samples: motion.samples(),
            blocks: Vec::new(),
            largest_offset: None,
        }
    }

    /// The blocks of a link and the joints of its path.
    #[inline(always)]
    pub fn blocks_of(&self, link: usize) -> &[Block] {
        let Branching { path, depth, .. } = self.places[link].branching;
        &self.blocks[path..=path + depth]
    }

    /// The joints that carry a link beside its own, base first.
    #[inline(always)]
    pub fn carriers_of(&self, link: usize) -> &[usize] {
        let Branching { path, depth, .. } = self.places[link].branching;
        &self.paths[path..path + depth]
    }

    /// Room for what is kept of links from which further branches go on.
    #[inline(always)]
    pub fn kept<T: Lanes>(&self) -> Vec<Kept<T>> {
        let mut kept = Vec::new();
        for place in self.places {
            if let Some(number) = place.branching.kept {
                kept.resize(kept.len().max(number + 1), Kept::zero(0));
                kept[number] = Kept::zero(place.branching.depth);
            }
        }
        kept
    }

    /// Refuses work whose columns do not have `end` samples in `length` values.
    #[inline(always)]
    pub fn assert_fits(&self, end: usize, length: usize) {
        assert!(
            self.largest_offset.is_none_or(|offset| offset + end <= length),
            "a column ends outside the tile"
        );
    }

    pub fn is_empty(&self) -> bool {
        self.samples == 0 || self.largest_offset.is_none()
    }

    /// Copies of all series, each filled up with zeros to `lanes` values.
    pub fn padded_series(&self, lanes: usize) -> Vec<f64> {
        let mut padded = vec![0.0; 3 * self.joints.len() * lanes];
        for (from, to) in self.series.iter().flatten().zip(padded.chunks_exact_mut(lanes)) {
            to[..self.samples].copy_from_slice(from);
        }
        padded
    }

    /// The same work on [`Self::padded_series`], with its columns side by side, `lanes` apart; and where each
    /// of these columns belongs.
    pub fn on_padded(mut self, padded: &'a [f64], lanes: usize) -> (Self, Vec<usize>) {
        let mut targets = Vec::new();
        for block in &mut self.blocks {
            block.map_offsets(|offset| {
                targets.push(offset);
                (targets.len() - 1) * lanes
            });
        }
        let largest_offset = targets.len().checked_sub(1).map(|last| last * lanes);
        (Plan { largest_offset, ..self }.with_series(padded, lanes), targets)
    }

    /// The same work on [`Self::padded_series`].
    pub fn with_series<'b>(&self, padded: &'b [f64], lanes: usize) -> Plan<'b>
    where
        'a: 'b,
    {
        let of_joint = |s: &'b [f64]| [&s[..lanes], &s[lanes..2 * lanes], &s[2 * lanes..]];
        Plan {
            gravity_m_s2: self.gravity_m_s2,
            joints: self.joints,
            places: self.places,
            paths: self.paths,
            series: padded.chunks_exact(3 * lanes).map(of_joint).collect(),
            samples: lanes,
            blocks: self.blocks.clone(),
            largest_offset: self.largest_offset,
        }
    }
}

//! What a sweep's folder says about its points.

use std::path::PathBuf;

use crate::Experiment;
use aurt_plugins::Registry;
use rayon::prelude::*;
use serde::{Deserialize, Serialize};

use crate::sweep::definition::Validate;
use crate::sweep::identity::{Digests, key};
use crate::sweep::{Point, Sweep, SweepError};

pub const SCHEMA: u32 = 1;

/// `sweep.json`: the points of a sweep and the keys of their results.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Plan {
    pub schema: u32,
    /// The experiment's file; a folder belongs to one.
    pub experiment: PathBuf,
    pub validate: Validate,
    /// Length of the blocks of time over which errors are summed, s.
    pub block_s: f64,
    /// Index of the point that others are compared with, from 0.
    pub reference: usize,
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub joint_names: Vec<String>,
    pub points: Vec<PlannedPoint>,
}

#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PlannedPoint {
    pub name: String,
    pub key: String,
}

impl Plan {
    pub fn of(sweep: &Sweep, registry: &Registry) -> Result<Self, SweepError> {
        let experiment = sweep.path.canonicalize().unwrap_or_else(|_| sweep.path.clone());
        let digests = Digests::default();
        let judging = (sweep.definition.validate, sweep.definition.block_s);
        let points = sweep
            .points
            .par_iter()
            .map(|Point { name, text, experiment }| {
                let key = key(text, experiment, judging, registry, &digests)?;
                Ok(PlannedPoint { name: name.clone(), key })
            })
            .collect::<Result<_, SweepError>>()?;
        Ok(Self {
            schema: SCHEMA,
            experiment,
            validate: sweep.definition.validate,
            block_s: sweep.definition.block_s,
            reference: sweep.reference,
            joint_names: sweep
                .points
                .first()
                .map_or_else(Vec::new, |point| point.experiment.robot.robot_joints().names),
            points,
        })
    }

    /// Whether a resolved experiment still has the key that was planned.
    pub(crate) fn is_current(
        &self,
        index: usize,
        text: &str,
        experiment: &Experiment,
        registry: &Registry,
    ) -> Result<bool, SweepError> {
        let found = key(text, experiment, (self.validate, self.block_s), registry, &Digests::default())?;
        Ok(self.points.get(index).is_some_and(|p| p.key == found))
    }
}

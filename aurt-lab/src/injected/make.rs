//! Case folders of real recordings, with an effect or as they are.

use std::fmt::Write as _;

use aurt_recording::Recording;
use aurt_traits::MeasurementUnit;
use serde_json::json;

use aurt_simulation::effects::{self, Family};
use aurt_simulation::inject::{Added, Built, Kind, Law, Presence, Rows, Split, applied, mean_square};
use aurt_simulation::{Random, Rotors, SimulationError};

use super::build::build;
use super::requests::{InjectedRequest, InjectedWorld};
use crate::case::{Case, CaseRequest, CaseType, TrueEffect, Truth, ValidationFloor, World};
use crate::strength::Strength;

/// Share of the strongest joint's error from which a joint counts as one whose error a whole-arm effect makes, and the
/// least such error over what is left; as in simulated cases.
const CONCERNED: (f64, f64) = (0.2, 0.1);
/// An effect that is less than this share of the wanted strength in all recordings is drawn as a change instead.
const ABSORBED: f64 = 0.5;

impl InjectedWorld {
    /// The recordings as they are, in the roles that the name says.
    pub fn reference(&self, name: &str) -> Result<Case, SimulationError> {
        let split = self.splits().into_iter().find(|s| s.reference_name(&self.injection.real().name) == name);
        let split = split.ok_or_else(|| {
            SimulationError::unreadable(
                name,
                format!("is no reference of these recordings; there are {}", self.references().join(", ")),
            )
        })?;
        let request = CaseRequest {
            robot: self.injection.real().name.clone(),
            case_type: CaseType::Null,
            effects: Vec::new(),
            strength: Strength::Medium,
        };
        self.case(name, &request, 0, &split, &[], None)
    }

    /// Makes one case from its seed: the effects in the targets and what is held out, or in all recordings. A null is the
    /// recordings as they are, in other roles than those of its reference.
    pub fn make(&self, request: &InjectedRequest, seed: u64, name: &str) -> Result<Case, SimulationError> {
        match &request.roles {
            Some(roles) => self.null(&request.case, roles, seed, name),
            None => self.with_effects(&request.case, seed, name),
        }
    }

    fn null(
        &self,
        request: &CaseRequest,
        roles: &Split,
        seed: u64,
        name: &str,
    ) -> Result<Case, SimulationError> {
        let others: Vec<String> = Split::all(self.injection.recorded().len(), roles.presence)
            .iter()
            .filter(|split| !split.has_roles_of(roles))
            .map(|split| split.reference_name(&self.injection.real().name))
            .collect();
        let reference = Random::labelled(seed, "injected null").choose(&others).cloned();
        self.case(name, request, seed, roles, &[], reference)
    }

    fn with_effects(&self, request: &CaseRequest, seed: u64, name: &str) -> Result<Case, SimulationError> {
        let kinds = request.effects.iter().map(|e| Kind::named(e)).collect::<Result<Vec<_>, _>>()?;
        let mut random = Random::labelled(seed, "injected");
        let mut wished = self.presence(&kinds, &mut random)?;
        let mut refusal = None;
        for _ in 0..2 {
            let splits = Split::all(self.injection.recorded().len(), wished);
            let Some(split) = random.choose(&splits) else { break };
            let built = self.built(&kinds, split, request.strength, &mut random)?;
            match built {
                Ok(built) => {
                    let reference = split.reference_name(&self.injection.real().name);
                    return self.case(name, request, seed, split, &built, Some(reference));
                }
                Err(reason) => refusal = Some(reason),
            }
            // What the structure absorbs in all recordings can be seen as a change.
            wished = Presence::Changed;
        }
        Err(SimulationError::unreadable(name, refusal.unwrap_or_else(|| {
                format!(
                    "{} can only be a change, which needs two recordings, and there is one; split it by `window_s`",
                    request.effects.join(" and ")
                )
            })))
    }

    fn built(
        &self,
        kinds: &[Kind],
        split: &Split,
        strength: Strength,
        random: &mut Random,
    ) -> Result<Result<Vec<Built>, String>, SimulationError> {
        let mut built: Vec<Built> = Vec::new();
        for kind in kinds {
            if !kind.fits(self.injection.real().unit) {
                return Ok(Err(format!(
                    "`{}` joins torques of several joints; give `torque_constants_nm_per_a`",
                    kind.identifier
                )));
            }
            let taken: Vec<usize> = built.iter().flat_map(|b| b.added.own_joints(b.kind.whole_arm)).collect();
            match build(&self.injection, *kind, split, strength, &taken, random)? {
                Some(one) if one.reached >= ABSORBED => built.push(one),
                _ => {
                    return Ok(Err(format!(
                        "no joint of these recordings can have `{}` of strength {}",
                        kind.identifier,
                        strength.name()
                    )));
                }
            }
        }
        Ok(Ok(built))
    }

    /// Changed or in all: where the effects can only be, else by chance.
    fn presence(&self, kinds: &[Kind], random: &mut Random) -> Result<Presence, SimulationError> {
        let chance = random.chance(0.5);
        let later = kinds.iter().any(|k| k.presence == effects::Presence::Later);
        Ok(match self.injection.recorded().len() {
            1 if !later => Presence::All,
            _ if later || chance => Presence::Changed,
            _ => Presence::All,
        })
    }

    fn case(
        &self,
        name: &str,
        request: &CaseRequest,
        seed: u64,
        split: &Split,
        built: &[Built],
        reference: Option<String>,
    ) -> Result<Case, SimulationError> {
        let first_target = split.target.first().copied();
        let altered = split
            .files()
            .into_iter()
            .map(|(k, affected)| {
                let recorded = &self.injection.recorded()[k];
                let here = |b: &&Built| affected && (!b.added.is_local() || first_target == Some(k));
                let here: Vec<&Added> = built.iter().filter(here).map(|b| &b.added).collect();
                applied(&here, &recorded.scene, &recorded.recording)
            })
            .collect::<Result<Vec<Recording>, SimulationError>>()?;
        let mut files = vec![
            ("experiment.toml".to_owned(), self.experiment(split).into_bytes()),
            ("mdh.csv".to_owned(), self.injection.real().mdh_csv.clone().unwrap_or_default().into_bytes()),
        ];
        files.extend(
            altered.iter().enumerate().map(|(k, r)| (file_name(k), csv(r, self.injection.real().unit))),
        );
        let truth = Truth {
            case: name.to_owned(),
            world: World::Injected,
            seed,
            robot: self.injection.real().name.clone(),
            rotors: Rotors::Geared,
            case_type: request.case_type,
            strength: request.strength,
            effects: built.iter().map(|b| self.true_effect(b, split)).collect(),
            background: built.iter().filter_map(|b| self.other_name(b, split)).collect(),
            reference,
            noise_nm: self.injection.model().left_rms().to_vec(),
            validation: self.floors(split, &altered)?,
        };
        Ok(Case { name: name.to_owned(), files, truth })
    }

    fn experiment(&self, split: &Split) -> String {
        let mut text = self.injection.real().experiment_toml.trim_end().to_owned() + "\n\n[recordings]\n";
        let mut next = 0;
        for (key, list) in [
            ("calibration", &split.calibration),
            ("target", &split.target),
            ("validation", &split.validation),
        ] {
            let files: Vec<String> =
                (next..next + list.len()).map(|k| format!("\"{}\"", file_name(k))).collect();
            next += list.len();
            if !files.is_empty() {
                let _ = writeln!(text, "{key} = [{}]", files.join(", "));
            }
        }
        text
    }

    fn true_effect(&self, built: &Built, split: &Split) -> TrueEffect {
        let strongest = built.achieved.iter().copied().fold(0.0, f64::max);
        let threshold = (CONCERNED.0 * strongest).max(CONCERNED.1);
        let joints = if built.kind.whole_arm {
            (0..built.achieved.len()).filter(|j| built.achieved[*j] >= threshold).collect()
        } else {
            built.added.own_joints(false)
        };
        let window_s = match &built.added.law {
            Law::ExternalContact { window_s, .. } => Some(*window_s),
            _ => None,
        };
        TrueEffect {
            effect: built.kind.identifier.to_owned(),
            family: built.kind.family,
            in_vocabulary: built.kind.in_vocabulary,
            joints,
            present_in: vec![present_in(split).to_owned()],
            recording: window_s.map(|_| file_name(split.calibration.len())),
            window_s,
            parameters: built.added.parameters(&self.injection.recorded()[0].scene),
            achieved: built.achieved.clone(),
            fields: json!(built.added),
        }
    }

    /// More dry or viscous friction than at calibration has a second name that is as right.
    fn other_name(&self, built: &Built, split: &Split) -> Option<TrueEffect> {
        let friction = matches!(built.added.law, Law::Coulomb | Law::Viscous);
        (friction && split.presence == Presence::Changed).then(|| TrueEffect {
            effect: "friction_level_changed".into(),
            family: Family::F,
            parameters: Vec::new(),
            ..self.true_effect(built, split)
        })
    }

    /// What the experiment's structure, calibrated, leaves of what is held out: with the effects and without.
    fn floors(&self, split: &Split, altered: &[Recording]) -> Result<Vec<ValidationFloor>, SimulationError> {
        let files: Vec<usize> = split.files().into_iter().map(|(k, _)| k).collect();
        let calibration = split.calibration.len();
        let calm: Vec<_> = split.calibration.iter().map(|k| &self.injection.recorded()[*k].rows).collect();
        let calm_fit = self.injection.model().fitted(&calm, |r, j| &calm[r].measured[j]);
        // Rows that are lost may leave nothing to preprocess; what such a recording shows is its rows, not torque.
        let rows = |place: usize| {
            self.injection
                .real()
                .preprocessed(&altered[place])
                .and_then(|data| self.injection.model().rows_of(&data))
                .ok()
        };
        let stirred: Option<Vec<_>> = (0..calibration).map(rows).collect();
        let stirred_fit = stirred.as_ref().map(|stirred| {
            let refs: Vec<_> = stirred.iter().collect();
            self.injection.model().fitted(&refs, |r, j| &refs[r].measured[j])
        });
        let first = calibration + split.target.len();
        let floors = (first..files.len()).map(|place| {
            let left = |rows: &Rows, fit: &[f64]| -> Vec<f64> {
                (0..self.injection.joints())
                    .map(|j| {
                        mean_square(&self.injection.model().left_over(rows, &rows.measured[j], j, fit)).sqrt()
                    })
                    .collect()
            };
            let floor_nm = left(&self.injection.recorded()[files[place]].rows, &calm_fit);
            let before_nm = match (rows(place), &stirred_fit) {
                (Some(rows), Some(fit)) => left(&rows, fit),
                _ => floor_nm.clone(),
            };
            ValidationFloor { recording: file_name(place), before_nm, floor_nm }
        });
        Ok(floors.collect())
    }
}

const fn present_in(split: &Split) -> &'static str {
    match split.presence {
        Presence::Changed => "target",
        Presence::All => "calibration",
    }
}

fn file_name(place: usize) -> String {
    format!("recording_{}.csv", place + 1)
}

/// The recording as plain comma-separated text; every number reads back as it is.
fn csv(recording: &Recording, unit: MeasurementUnit) -> Vec<u8> {
    let measured = match unit {
        MeasurementUnit::NewtonMetre => "torque",
        MeasurementUnit::Ampere => "current",
    };
    let joints = recording.joints();
    let names = (0..joints).map(|j| format!(",q_{j}")).chain((0..joints).map(|j| format!(",{measured}_{j}")));
    let mut text = String::from("t") + &names.collect::<String>() + "\n";
    for (k, t) in recording.time_s.iter().enumerate() {
        let _ = write!(text, "{t}");
        for series in recording.position_rad.iter().chain(recording.measurement.iter().flatten()) {
            let _ = write!(text, ",{}", series[k]);
        }
        text.push('\n');
    }
    text.into_bytes()
}

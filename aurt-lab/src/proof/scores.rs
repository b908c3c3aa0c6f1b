//! Verdicts compared with the truth.

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};

use crate::case::{CaseType, Truth};
use crate::product::Failure;
use crate::score::{CaseScore, Claim, ClaimSet, score};

use super::variants::Variant;
use super::{FAILED, Place, VERDICT};

#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Verdicts {
    Own,
    /// Those of diagnoses that were not allowed to know the effect; references are verdicts of the diagnosis.
    Removed {
        own: PathBuf,
    },
    /// Those of diagnoses that examined the effect alone; references are verdicts of the diagnosis.
    Oracle {
        own: PathBuf,
    },
}

/// The folder of the verdict on the recordings without effects, among the verdicts.
pub fn reference_folder(name: &str) -> String {
    format!("reference_{name}")
}

/// Scores the verdicts of a folder; a case without a verdict is left out, one whose diagnosis failed is wrong.
pub fn read_scores(sealed: &Path, verdicts: &Path, whose: &Verdicts) -> Result<Vec<CaseScore>, Failure> {
    if truths(sealed)?.is_empty() {
        return Err(Failure::argument(
            "--sealed",
            format!("{} holds no truths", sealed.display()),
            "name the folder that `aurt-lab conceal --sealed` wrote",
        ));
    }
    let scores = scores_so_far(sealed, verdicts, whose)?;
    if scores.is_empty() {
        return Err(Failure::argument(
            "--verdicts",
            format!("{} holds no verdict on a case of {}", verdicts.display(), sealed.display()),
            "each case needs a folder of its name with a verdict.json, and cases of real recordings one named \
                     reference_NAME with the verdict on these as they are",
        ));
    }
    Ok(scores)
}

/// Claims made of a robot without concealed effects.
struct KnownClaims {
    own: Claim,
    /// The same, and the structure that other references of this robot show: which of them passes a test is a matter of chance, and
    /// whether the robot has it, is not.
    elsewhere: Claim,
}

/// The claims of a reference, and those of structure of the other references of the same robot.
fn elsewhere(place: &Path, name: &str, own: &Claim) -> Result<Claim, Failure> {
    // ROBOT_QUESTION_NUMBER.
    let robot = |name: &str| name.rsplitn(3, '_').nth(2).map(str::to_owned);
    let mut known = own.clone();
    let entries = fs::read_dir(place).into_iter().flatten().flatten();
    let mut names: Vec<String> = entries.filter_map(|entry| entry.file_name().into_string().ok()).collect();
    names.sort_unstable();
    for other in names.iter().filter_map(|folder| folder.strip_prefix(&reference_folder(""))) {
        if other != name && robot(other) == robot(name) {
            let claim = claim(&place.join(reference_folder(other)))?;
            known.effects.extend(claim.into_iter().flat_map(|c| c.effects).filter(|e| !e.is_change()));
        }
    }
    Ok(known)
}

/// The same of a proof that may not have come to its first verdict.
pub fn scores_so_far(sealed: &Path, verdicts: &Path, whose: &Verdicts) -> Result<Vec<CaseScore>, Failure> {
    let mut scores = Vec::new();
    let mut references: BTreeMap<String, Option<KnownClaims>> = BTreeMap::new();
    for path in truths(sealed)? {
        let truth = Truth::read(&path)?;
        let Some(claim) = claim(&verdicts.join(&truth.case))? else { continue };
        let known = match &truth.reference {
            Some(name) => {
                if !references.contains_key(name) {
                    let place = match whose {
                        Verdicts::Removed { own } | Verdicts::Oracle { own } => own.as_path(),
                        Verdicts::Own => verdicts,
                    };
                    let own = self::claim(&place.join(reference_folder(name)))?;
                    let known = match own {
                        Some(own) => Some(KnownClaims { elsewhere: elsewhere(place, name, &own)?, own }),
                        None => None,
                    };
                    references.insert(name.clone(), known);
                }
                // Without it nothing says what is news.
                match references.get(name).and_then(Option::as_ref) {
                    Some(known) if truth.case_type == CaseType::Null => Some(&known.own),
                    Some(known) => Some(&known.elsewhere),
                    None => continue,
                }
            }
            None => None,
        };
        let removed = truth.effects.first().filter(|_| matches!(whose, Verdicts::Removed { .. }));
        scores.push(score(&truth, &claim, removed.map(|e| e.effect.as_str()), known));
    }
    Ok(scores)
}

/// Adds to scores what the oracle saw of their cases; `own` has the verdicts of the diagnosis, `oracle` those of diagnoses
/// that examined the true effect alone.
pub fn add_oracle(scores: &mut [CaseScore], sealed: &Path, own: &Path, oracle: &Path) -> Result<(), Failure> {
    let whose = Verdicts::Oracle { own: own.to_owned() };
    for of_oracle in scores_so_far(sealed, oracle, &whose)? {
        if let Some(score) = scores.iter_mut().find(|s| s.case == of_oracle.case) {
            score.seen = Some(of_oracle.sees());
        }
    }
    Ok(())
}

/// Adds to scores the claims by which the variants of their cases differ from them, as far as these were diagnosed.
pub fn add_variants(scores: &mut [CaseScore], place: &Place) -> Result<(), Failure> {
    let claims = |folder: PathBuf| -> Result<Option<ClaimSet>, Failure> {
        Ok(claim(&folder)?.map(|claim| ClaimSet::of(&claim)))
    };
    for score in scores {
        let of = |variant: Variant| claims(place.variants().join(variant.name()).join(&score.case));
        if let (Some(first), Some(second)) = (of(Variant::FirstHalf)?, of(Variant::SecondHalf)?)
            && !(first.is_failed() && second.is_failed())
        {
            score.halves = Some(second.structure().difference(&first.structure()));
        }
        let own = claims(place.verdicts().join(&score.case))?.filter(|own| !own.is_failed());
        let Some(own) = own else { continue };
        let mut variants = BTreeMap::new();
        for variant in Variant::ALL.into_iter().filter(|v| !v.is_half()) {
            if let Some(varied) = of(variant)? {
                variants.insert(variant.name().to_owned(), varied.difference(&own));
            }
        }
        score.variants = variants;
    }
    Ok(())
}

fn claim(folder: &Path) -> Result<Option<Claim>, Failure> {
    let file = folder.join(VERDICT);
    Ok(if file.exists() {
        Some(Claim::read(file)?)
    } else if folder.join(FAILED).exists() {
        Some(Claim::failed())
    } else {
        None
    })
}

fn truths(sealed: &Path) -> Result<Vec<PathBuf>, Failure> {
    let entries = fs::read_dir(sealed).map_err(|error| {
        Failure::argument(
            "--sealed",
            format!("{} cannot be read: {error}", sealed.display()),
            "name the folder that `aurt-lab conceal --sealed` wrote",
        )
    })?;
    let mut paths: Vec<PathBuf> = entries
        .filter_map(Result::ok)
        .map(|entry| entry.path())
        .filter(|path| path.extension().is_some_and(|e| e == "json"))
        .collect();
    paths.sort();
    Ok(paths)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn structure_is_known_from_all_references_of_a_robot() {
        let place = tempfile::tempdir().unwrap();
        let write = |name: &str, effect: &str, present_in: &[&str]| {
            let folder = place.path().join(reference_folder(name));
            fs::create_dir_all(&folder).unwrap();
            let effects = serde_json::json!([{ "effect": effect, "joints": [1], "present_in": present_in }]);
            let verdict = serde_json::json!({ "verdict": "named", "effects": effects });
            fs::write(folder.join(VERDICT), verdict.to_string()).unwrap();
        };
        write("ur10e_all_1", "rotor_inertia", &["calibration"]);
        write("ur10e_all_2", "viscous_nonlinear", &["calibration"]);
        write("ur10e_changed_1", "coulomb", &["target"]);
        write("kr300_all_1", "spring", &["calibration"]);
        let own = claim(&place.path().join(reference_folder("ur10e_all_1"))).unwrap().unwrap();
        let known = elsewhere(place.path(), "ur10e_all_1", &own).unwrap();
        let effects: Vec<&str> = known.effects.iter().map(|e| e.effect.as_str()).collect();
        assert_eq!(effects, ["rotor_inertia", "viscous_nonlinear"]);
    }
}

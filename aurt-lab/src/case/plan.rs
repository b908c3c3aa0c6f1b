use std::path::Path;

use serde::{Deserialize, Serialize};

use super::layout::RecordingSettings;
use super::make::case_type;
use super::request::CaseRequest;
use crate::effects::{kind, unknown_effects};
use crate::strength::Strength;
use aurt_simulation::effects::{EffectKind, catalogue};
use aurt_simulation::robots::Robot;
use aurt_simulation::{Random, SimulationError};

/// Which cases to make.
///
/// ```
/// let plan = aurt_lab::case::Plan::parse(r#"
///     [singles]
///     robots = ["ur10e"]
///     effects = ["stribeck", "payload"]
///     strengths = ["medium", "strong"]
///     trials = 2
///     [nulls]
///     count = 3
/// "#, "plan.toml")?;
/// assert_eq!(plan.requests(1)?.len(), 2 * 2 * 2 + 3);
/// # Ok::<(), aurt_simulation::SimulationError>(())
/// ```
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, Default)]
#[serde(default, deny_unknown_fields)]
pub struct Plan {
    pub recordings: RecordingSettings,
    pub singles: Option<SinglePlan>,
    #[serde(alias = "strangers")]
    pub unknown_effects: Option<SinglePlan>,
    /// Cases of two effects of the vocabulary.
    pub pairs: Option<PairPlan>,
    pub nulls: Option<NullPlan>,
}

/// Robots × effects × strengths × trials. Every trial takes another robot of the list in turn.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct SinglePlan {
    /// Names of robots; empty for all with six or more joints.
    pub robots: Vec<String>,
    /// Identifiers; empty for all.
    pub effects: Vec<String>,
    pub strengths: Vec<Strength>,
    pub trials: usize,
}

impl Default for SinglePlan {
    fn default() -> Self {
        Self { robots: Vec::new(), effects: Vec::new(), strengths: Strength::ALL.to_vec(), trials: 1 }
    }
}

#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct PairPlan {
    /// Names of robots; empty for all with six or more joints.
    pub robots: Vec<String>,
    /// Identifiers that may be paired; empty for all.
    pub effects: Vec<String>,
    pub strength: Strength,
    pub count: usize,
}

impl Default for PairPlan {
    fn default() -> Self {
        Self { robots: Vec::new(), effects: Vec::new(), strength: Strength::Medium, count: 0 }
    }
}

/// Cases without effects.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize, Default)]
#[serde(default, deny_unknown_fields)]
pub struct NullPlan {
    /// Names of robots; empty for all with six or more joints.
    pub robots: Vec<String>,
    pub count: usize,
}

/// Cases of the largest plan; case numbers have four digits up to 9999 and grow beyond.
const MOST_CASES: usize = 1_000_000;

/// Draws after which a pair that fits a robot is given up.
const MOST_DRAWS: usize = 200;

impl Plan {
    /// Reads a plan; `path` is what errors call it.
    pub fn parse(text: &str, path: impl AsRef<Path>) -> Result<Self, SimulationError> {
        SimulationError::refuse_tables(path.as_ref(), text)?;
        let plan: Self =
            toml::from_str(text).map_err(|error| SimulationError::syntax(path.as_ref(), text, &error))?;
        plan.requests(0).map_err(|error| match error {
            SimulationError::Unreadable { reason, .. } => {
                SimulationError::Unreadable { path: path.as_ref().into(), reason }
            }
            // A name stands in quotes where it is written.
            SimulationError::UnknownRobot { ref name, .. }
            | SimulationError::UnknownEffect { ref name, .. } => {
                let begin = text.find(&format!("\"{name}\"")).unwrap_or(0);
                SimulationError::at(path.as_ref(), text, begin, error.to_string())
            }
            other => other,
        })?;
        Ok(plan)
    }

    /// Reads a plan from a file.
    pub fn read(path: impl AsRef<Path>) -> Result<Self, SimulationError> {
        let path = path.as_ref();
        let text = SimulationError::text_of(path)?;
        Self::parse(&text, path)
    }

    /// Every effect once at medium strength, two unknown effects, two pairs, four nulls.
    pub fn small() -> Self {
        let medium = |effects: &[&str]| SinglePlan {
            effects: effects.iter().map(|e| (*e).to_owned()).collect(),
            strengths: vec![Strength::Medium],
            ..SinglePlan::default()
        };
        Self {
            recordings: RecordingSettings::default(),
            singles: Some(medium(&[])),
            unknown_effects: Some(medium(&["cable_drag", "periodic_disturbance"])),
            pairs: Some(PairPlan { count: 2, ..PairPlan::default() }),
            nulls: Some(NullPlan { count: 4, ..NullPlan::default() }),
        }
    }

    /// The cases, in an order that reveals nothing.
    pub fn requests(&self, seed: u64) -> Result<Vec<CaseRequest>, SimulationError> {
        self.check_counts()?;
        let mut random = Random::labelled(seed, "plan");
        let mut requests = Vec::new();
        if let Some(plan) = &self.singles {
            plan.add(catalogue(), &mut requests)?;
        }
        if let Some(plan) = &self.unknown_effects {
            plan.add(unknown_effects(), &mut requests)?;
        }
        if let Some(plan) = &self.pairs {
            let robots = robots(&plan.robots)?;
            let kinds = chosen(&plan.effects, catalogue())?;
            for count in 0..plan.count {
                requests.push(pair(&robots, &kinds, plan.strength, count, &mut random)?);
            }
        }
        if let Some(plan) = &self.nulls {
            let robots = robots(&plan.robots)?;
            requests
                .extend((0..plan.count).map(|k| request(&robots[k % robots.len()], &[], Strength::Medium)));
        }
        random.shuffle(&mut requests);
        Ok(requests)
    }
}

impl Plan {
    /// Refuses plans of more cases than anybody makes before there is a list of them.
    fn check_counts(&self) -> Result<(), SimulationError> {
        let of = |plan: &Option<SinglePlan>, known: &[EffectKind]| {
            plan.as_ref().map_or(0, |plan| {
                let effects = if plan.effects.is_empty() { known.len() } else { plan.effects.len() };
                effects.saturating_mul(plan.strengths.len()).saturating_mul(plan.trials)
            })
        };
        let cases = of(&self.singles, catalogue())
            .saturating_add(of(&self.unknown_effects, unknown_effects()))
            .saturating_add(self.pairs.as_ref().map_or(0, |plan| plan.count))
            .saturating_add(self.nulls.as_ref().map_or(0, |plan| plan.count));
        if cases <= MOST_CASES {
            return Ok(());
        }
        Err(SimulationError::unreadable(
            "plan",
            format!(
                "asks for {cases} cases, a plan has at most {MOST_CASES}; lower `trials` or `count`, or make several \
                 plans with seeds of their own"
            ),
        ))
    }
}

impl SinglePlan {
    fn add(
        &self,
        known: &'static [EffectKind],
        requests: &mut Vec<CaseRequest>,
    ) -> Result<(), SimulationError> {
        let robots = robots(&self.robots)?;
        let mut turn = 0;
        for kind in chosen(&self.effects, known)? {
            let able: Vec<&Robot> =
                robots.iter().filter(|robot| CaseRequest::is_possible(robot, &[kind])).collect();
            if able.is_empty() {
                return Err(SimulationError::unreadable(
                    "plan",
                    format!("none of the robots can have `{}`", kind.identifier),
                ));
            }
            for strength in &self.strengths {
                for _ in 0..self.trials {
                    requests.push(request(able[turn % able.len()], &[kind], *strength));
                    turn += 1;
                }
            }
        }
        Ok(())
    }
}

fn robots(names: &[String]) -> Result<Vec<Robot>, SimulationError> {
    if names.is_empty() {
        return Ok(Robot::all().into_iter().filter(|robot| robot.joints() >= 6).collect());
    }
    names.iter().map(|name| Robot::named(name)).collect()
}

fn chosen(
    names: &[String],
    known: &'static [EffectKind],
) -> Result<Vec<&'static EffectKind>, SimulationError> {
    if names.is_empty() {
        return Ok(known.iter().collect());
    }
    names.iter().map(|name| kind(name)).collect()
}

fn request(robot: &Robot, kinds: &[&EffectKind], strength: Strength) -> CaseRequest {
    CaseRequest {
        robot: robot.name.clone(),
        case_type: case_type(kinds),
        effects: kinds.iter().map(|kind| kind.identifier.to_owned()).collect(),
        strength,
    }
}

fn pair(
    robots: &[Robot],
    kinds: &[&'static EffectKind],
    strength: Strength,
    count: usize,
    random: &mut Random,
) -> Result<CaseRequest, SimulationError> {
    let robot = &robots[count % robots.len()];
    for _ in 0..MOST_DRAWS {
        let (first, second) = (random.index(kinds.len()), random.index(kinds.len()));
        if first != second && CaseRequest::is_possible(robot, &[kinds[first], kinds[second]]) {
            return Ok(request(robot, &[kinds[first], kinds[second]], strength));
        }
    }
    Err(SimulationError::unreadable(
        "plan",
        format!("no two of the effects can be on {} at once", robot.name),
    ))
}

use crate::case::{NullPlan, PairPlan, Plan, SinglePlan, World};
use crate::strength::Strength;

/// A proof of every world in some minutes: that everything works, not how well. Effects that differ in what finds them:
/// a column, the pose, faults of rows, and what is above the filters.
pub fn small(world: World) -> Plan {
    let strong = |effects: &[&str]| SinglePlan {
        robots: vec!["ur10e".into()],
        effects: effects.iter().map(|e| (*e).to_owned()).collect(),
        strengths: vec![Strength::Strong],
        trials: 1,
    };
    let robots = || vec!["ur10e".to_owned()];
    let (singles, nulls): (&[&str], usize) = match world {
        World::Clean => (&["payload", "torque_ripple", "saturation", "joint_elasticity"], 2),
        World::Rough => (&["payload", "stribeck", "time_delay"], 3),
        World::Mujoco => (&["payload", "spring"], 2),
        World::Injected => (&["coulomb", "torque_ripple"], 1),
        World::Servo => (&["time_delay", "coulomb"], 1),
    };
    let unknown = match world {
        World::Clean | World::Rough => Some(strong(&["periodic_disturbance"])),
        // Their unknown effects have names of their own.
        World::Mujoco | World::Injected | World::Servo => None,
    };
    Plan {
        singles: Some(strong(singles)),
        unknown_effects: unknown,
        pairs: (world == World::Clean).then(|| PairPlan {
            robots: robots(),
            effects: vec!["spring".into(), "viscous".into()],
            count: 1,
            ..PairPlan::default()
        }),
        nulls: Some(NullPlan { robots: robots(), count: nulls }),
        ..Plan::default()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn small_plans_can_be_made() {
        for world in World::ALL {
            let requests = small(world).requests(1).unwrap();
            assert!((3..=9).contains(&requests.len()), "{world:?}: {}", requests.len());
        }
    }
}

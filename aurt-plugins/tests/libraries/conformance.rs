//! Models of libraries pass the same checks as linked ones: what the traits ask of every model, and what each model
//! declares of itself.

use std::path::Path;

use aurt_friction::conformance::joint::Slotted;
use aurt_friction::conformance::{arm, joint};
use aurt_plugins::{Node, Origin, Registry, SlotModel};
use aurt_rbd::{MdhRows, MdhTable, SerialChain};
use aurt_traits::{ArmTerm, CoulombModel, HysteresisModel, Slot, ViscousBasis};

use crate::built;

const SEEDS: std::ops::Range<u64> = 0..10;

fn example(registry: &Registry, slot: Slot, name: &str) -> Node {
    let example = &registry.model(slot, name).unwrap().example;
    let table: toml::Table = toml::from_str(&format!("model = {example}")).unwrap();
    Node::from(&serde_json::to_value(&table["model"]).unwrap())
}

fn check<M: SlotModel + ?Sized>(registry: &Registry, config: &Node, seed: u64)
where
    Box<M>: Slotted,
{
    let model = registry.build::<M>(config).unwrap();
    joint::check(model.model(), seed).unwrap();
    joint::check_shape(&model, seed).unwrap();
}

/// Checks every model of a library, made from its example; their number.
fn check_all(library: &Path) -> usize {
    let registry = built::with(library);
    let table =
        MdhTable::parse("alpha,a,d\n0,0.5,0\npi/2,0.4,0\n0,0.3,0.1\n", "mdh.csv", MdhRows::Next).unwrap();
    let body = SerialChain::from_mdh(&table, [0.0, 0.0, -9.81]).unwrap();
    let listings: Vec<_> = registry.models().filter(|m| matches!(m.origin, Origin::Library(_))).collect();
    for listing in &listings {
        let config = example(&registry, listing.slot, &listing.name);
        for seed in SEEDS {
            match listing.slot {
                Slot::Coulomb => check::<dyn CoulombModel>(&registry, &config, seed),
                Slot::Hysteresis => check::<dyn HysteresisModel>(&registry, &config, seed),
                Slot::Viscous => check::<dyn ViscousBasis>(&registry, &config, seed),
                Slot::ArmTerm => {
                    let term = registry.build::<dyn ArmTerm>(&config).unwrap();
                    arm::check(&*term, &body, seed).unwrap();
                    arm::check_shape(&term, &body, seed).unwrap();
                }
            }
        }
    }
    listings.len()
}

#[test]
fn the_rust_library_does_what_it_declares() {
    assert_eq!(check_all(&built::rust_example()), 4);
}

#[test]
fn the_c_library_does_what_it_declares() {
    if let Some(library) = built::c_example() {
        assert_eq!(check_all(&library), 1);
    }
}

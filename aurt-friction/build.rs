//! Every file in the folder of a slot is a module; cargo has to look again when one is added.

fn main() {
    for folder in ["arm_terms", "coulomb", "hysteresis", "viscous"] {
        println!("cargo::rerun-if-changed=src/{folder}");
    }
}

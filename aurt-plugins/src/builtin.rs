//! The models that come with AURT. A crate that no code names is not linked, and its models are then silently
//! absent; this is the one place that names it.

use aurt_friction as _;

#[cfg(test)]
mod tests {
    use aurt_traits::Slot;

    use crate::Registry;

    #[test]
    fn the_builtin_models_are_linked() {
        let registry = Registry::linked().unwrap();
        let names = |slot| registry.names(slot);
        for name in ["absolute", "constant", "square"] {
            assert!(names(Slot::Coulomb).iter().any(|n| n == name), "{name} is not linked");
        }
        assert!(names(Slot::Hysteresis).iter().any(|n| n == "sign"));
        assert!(names(Slot::Viscous).iter().any(|n| n == "polynomial"));
    }
}

//! The Rust example plugin, linked statically: the same models without a library.

use aurt_plugin_example as _;
use aurt_plugins::{Error, Origin, Registry};
use aurt_traits::{Slot, ViscousBasis};
use serde_json::json;

#[test]
fn linked_models_need_no_library() {
    let registry = Registry::linked().unwrap();
    let listing = registry.model(Slot::Viscous, "eyring").unwrap();
    assert_eq!(listing.origin, Origin::Crate("aurt-plugin-example"));
    let config = json!({ "model": "eyring", "transition_velocity_rad_s": 0.5 });
    let model = registry.build_from_json::<dyn ViscousBasis>(&config).unwrap();
    // Linked models are saved without the name of a library.
    assert_eq!(serde_json::to_value(&*model).unwrap(), config);
}

#[test]
fn a_library_with_the_same_models_is_refused() {
    let folder = std::env::current_exe().unwrap().parent().unwrap().to_owned();
    let (prefix, suffix) = (std::env::consts::DLL_PREFIX, std::env::consts::DLL_SUFFIX);
    let library = folder.join(format!("{prefix}aurt_plugin_example{suffix}"));
    let mut registry = Registry::linked().unwrap();
    let error = registry.load_library(&library).unwrap_err();
    let Error::DuplicateModel { first, second, .. } = &error else { panic!("{error}") };
    assert_eq!(first, "crate aurt-plugin-example");
    assert!(second.starts_with("library aurt-plugin-example 0.1.0 ("), "{second}");
    assert!(registry.libraries().is_empty());
}

//! Parameter files of any text.

use std::path::Path;

use aurt_rbd::robots::{ParameterFile, Part, parse};
use proptest::prelude::*;

const ARM: &str = r#"<mujoco><worldbody><body name="a"><inertial pos="0 0 0.2" mass="2" diaginertia="0.03 0.02 0.01"/>
    <joint name="j"/></body></worldbody></mujoco>"#;

proptest! {
    #[test]
    fn any_lines_are_read_into_finite_numbers_or_refused(
        lines in prop::collection::vec(
            prop_oneof![
                "(j|a|)[_/]?(armature|damping|mass|ipos|inertia|delay):",
                "  (value|frozen|name|volume): ?(\\[|true)?[0-9.,-]*\\]?",
                "  (- )*[0-9.e:-]{0,4}",
                ".{0,12}",
            ],
            0..30,
        )
    ) {
        let Ok(file) = ParameterFile::parse(&lines.join("\n"), Path::new("p.yaml")) else { return Ok(()) };
        let Ok(robot) = parse(ARM, "arm.xml", None, &Part::All, Some(&file)) else { return Ok(()) };
        let standard = robot.standard_parameters.unwrap();
        prop_assert!(standard.iter().chain(&robot.armature_kg_m2).all(|value| value.is_finite()), "{lines:?}");
    }
}

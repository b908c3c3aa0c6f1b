//! `include/aurt_plugin.h` and `aurt_traits::abi` must say the same, byte for byte.

#![expect(clippy::unwrap_used, reason = "a test fails by panicking")]

use std::fmt::Write;
use std::fs;
use std::mem::offset_of;
use std::path::Path;
use std::process::Command;

use aurt_traits::Invariant;
use aurt_traits::abi::{
    self, ColumnDescription, Declaration, Description, ErrorBuffer, ModelTable, Series, ShapeDescription,
};

/// A number of the interface: as C calls it, and what Rust says it is.
type Number = (String, u64);

fn constants() -> Vec<Number> {
    let mut numbers: Vec<Number> = [
        ("AURT_MAGIC", abi::MAGIC),
        ("AURT_ABI_MAJOR", abi::ABI_MAJOR.into()),
        ("AURT_ABI_MINOR", abi::ABI_MINOR.into()),
        ("AURT_OK", abi::OK as u64),
        ("AURT_FAILED", abi::FAILED as u64),
        ("AURT_PANICKED", abi::PANICKED as u64),
        ("AURT_COULOMB", abi::COULOMB.into()),
        ("AURT_HYSTERESIS", abi::HYSTERESIS.into()),
        ("AURT_VISCOUS", abi::VISCOUS.into()),
        ("AURT_ARM_TERM", abi::ARM_TERM.into()),
        ("AURT_LINEAR", abi::LINEAR.into()),
        ("AURT_LOGARITHMIC", abi::LOGARITHMIC.into()),
    ]
    .map(|(name, value)| (name.to_owned(), value))
    .into();
    numbers.extend(Invariant::ALL.iter().enumerate().map(|(bit, invariant)| {
        let name = serde_json::to_value(invariant).unwrap().as_str().unwrap().to_uppercase();
        (format!("AURT_{name}"), 1 << bit)
    }));
    numbers
}

macro_rules! layout {
    ($($rust:ty as $c:literal { $($field:ident),* $(,)? })*) => {
        fn layout() -> Vec<Number> {
            vec![$(
                (format!("sizeof({})", $c), size_of::<$rust>() as u64),
                $((format!("offsetof({}, {})", $c, stringify!($field)), offset_of!($rust, $field) as u64),)*
            )*]
        }
    };
}

layout! {
    ErrorBuffer as "aurt_error" { message, capacity }
    Series as "aurt_series" {
        size, samples, joints, stride, load_stride, time_s, position_rad, velocity_rad_s, acceleration_rad_s2,
        load_torque,
    }
    ColumnDescription as "aurt_column" { name, unit }
    ShapeDescription as "aurt_shape" { name, unit, value, lower, upper, scale, reserved }
    Description as "aurt_description" {
        column_count, columns, shape_count, shapes, state_len, invariants, is_load, joint_count, joints, acts_on,
    }
    ModelTable as "aurt_model" {
        slot, reserved, name, summary, equation, use_when, source, example, create, destroy, describe, set_shape,
        initial_state, evaluate,
    }
    Declaration as "aurt_declaration" {
        magic, abi_major, abi_minor, declaration_size, model_size, description_size, series_size, name, version,
        model_count, models,
    }
}

fn header() -> &'static Path {
    Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/include"))
}

#[test]
fn sizes_offsets_and_constants_agree() {
    let numbers: Vec<Number> = constants().into_iter().chain(layout()).collect();
    let mut program = String::from("#include \"aurt_plugin.h\"\nint main(void) {\n");
    for (name, _) in &numbers {
        writeln!(program, "    printf(\"%llu\\n\", (unsigned long long)({name}));").unwrap();
    }
    program.push_str("    return 0;\n}\n");
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR"));
    let (source, binary) = (folder.join("abi_header.c"), folder.join("abi_header"));
    fs::write(&source, program).unwrap();
    let compiled = Command::new("cc")
        .args(["-std=c99", "-Wall", "-Wextra", "-Werror", "-pedantic", "-I"])
        .arg(header())
        .arg(&source)
        .arg("-o")
        .arg(&binary)
        .output();
    let Ok(compiled) = compiled else {
        println!("skipped: there is no C compiler `cc` to read the header with");
        return;
    };
    assert!(compiled.status.success(), "{}", String::from_utf8_lossy(&compiled.stderr));
    let output = Command::new(&binary).output().unwrap();
    let printed = String::from_utf8(output.stdout).unwrap();
    let found: Vec<Number> = numbers
        .iter()
        .zip(printed.lines())
        .map(|((name, _), c)| (name.clone(), c.parse().unwrap()))
        .collect();
    assert_eq!(found, numbers);
}

#[test]
fn the_header_has_every_constant() {
    // This holds without a compiler too.
    let text = fs::read_to_string(header().join("aurt_plugin.h")).unwrap();
    for (name, _) in constants() {
        assert!(text.contains(&format!("#define {name} ")), "{name} is missing");
    }
}

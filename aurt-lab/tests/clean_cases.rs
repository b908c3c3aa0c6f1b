//! Cases of the clean world stay what they are, byte for byte: tables of earlier versions were made from them. The last is a delay, whose
//! size is measured between samples since 26 November 2026.

use aurt_lab::case::{Plan, World};

const PLAN: &str = include_str!("clean_cases.toml");

/// FNV-1a over names and contents of a case's files.
fn hash(files: &[(String, Vec<u8>)]) -> u64 {
    let bytes = files.iter().flat_map(|(name, content)| name.bytes().chain(content.iter().copied()));
    bytes.fold(0xCBF2_9CE4_8422_2325, |hash, byte| {
        (hash ^ u64::from(byte)).wrapping_mul(0x0000_0100_0000_01B3)
    })
}

#[test]
fn clean_cases_are_what_they_were() {
    let plan = Plan::parse(PLAN, "plan.toml").unwrap();
    let hashes: Vec<u64> = (0..5).map(|k| hash(&plan.make(World::Clean, 3, k).unwrap().files)).collect();
    let before = [
        0x9248_dc57_a41f_25f9,
        0x98a3_289d_7cb3_8974,
        0x0ba4_0159_0433_0dd7,
        0x96d8_272b_b784_9230,
        0xbbc4_f90d_b90d_9499,
    ];
    assert_eq!(hashes, before);
}

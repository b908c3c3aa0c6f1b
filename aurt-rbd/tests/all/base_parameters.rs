//! Base parameters of known robots.

use crate::robots;

use aurt_rbd::{MdhRows, MdhTable, SerialChain, base_parameters};
use robots::{DOWN, PANDA, TILTED, TWO_LINK, TX40, UR3E, UR5E, UR10E, robot};

#[test]
fn counts_of_known_robots() {
    for (name, mdh, gravity, count) in [
        ("UR5e, tilted", UR5E, TILTED, 38),
        ("UR10e", UR10E, DOWN, 36),
        ("UR3e", UR3E, DOWN, 36),
        ("TX40", TX40, DOWN, 36),
        ("Panda", PANDA, DOWN, 43),
    ] {
        let chain = robot(mdh, gravity);
        for seed in [0, 1, 42, u64::MAX] {
            assert_eq!(base_parameters(&chain, seed).unwrap().len(), count, "{name}, seed {seed}");
        }
    }
}

#[test]
fn another_seed_gives_the_same_parameters() {
    let chain = robot(UR10E, DOWN);
    let one = base_parameters(&chain, 1).unwrap();
    let other = base_parameters(&chain, 2).unwrap();
    assert_eq!(one.columns, other.columns);
    for (a, b) in one.combinations.iter().zip(&other.combinations) {
        assert_eq!(a.len(), b.len());
        for ((i, x), (k, y)) in a.iter().zip(b) {
            assert_eq!(i, k);
            assert!((x - y).abs() < 1e-9);
        }
    }
    assert_eq!(one, base_parameters(&chain, 1).unwrap());
}

/// Two links with parallel axes, distance L = 1 m, gravity in the plane, by hand: the second link moves as
/// ZZ_1, mX_1, mY_1; the first collects ZZ_0 + L² m_1, mX_0 + L m_1, mY_0.
#[test]
fn two_link_by_hand() {
    // In the other reading the table's length leads to a third joint, so that L = 0.
    let chain = robot(TWO_LINK, [0.0, -9.81, 0.0]);
    let base = base_parameters(&chain, 3).unwrap();
    assert_eq!(base.columns, [5, 6, 7, 15, 16, 17]);
    assert!(base.combinations.iter().all(|c| c.len() == 1), "{:?}", base.combinations);

    let table = MdhTable::parse(TWO_LINK, "mdh.csv", MdhRows::Previous).unwrap();
    let chain = SerialChain::from_mdh(&table, [0.0, -9.81, 0.0]).unwrap();
    let base = base_parameters(&chain, 3).unwrap();
    assert_eq!(base.columns, [5, 6, 7, 15, 16, 17]);
    assert_eq!(
        base.combinations,
        [
            vec![(5, 1.0), (19, 1.0)],
            vec![(6, 1.0), (19, 1.0)],
            vec![(7, 1.0)],
            vec![(15, 1.0)],
            vec![(16, 1.0)],
            vec![(17, 1.0)],
        ]
    );
}

#[test]
fn rounded_right_angles_are_noted() {
    let rounded = UR5E.replace("pi/2", "1.5708");
    let table = MdhTable::parse(&rounded, "mdh.csv", MdhRows::Next).unwrap();
    assert_eq!(table.notes().len(), 3);
    assert!(table.notes()[0].contains("alpha = 1.5708"), "{:?}", table.notes());
    let exact = MdhTable::parse(UR5E, "mdh.csv", MdhRows::Next).unwrap();
    assert!(exact.notes().is_empty());
}

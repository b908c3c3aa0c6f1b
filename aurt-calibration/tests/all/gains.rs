//! Gains of drives from unloaded motion and a known load, on a robot of which everything is known.

use crate::known_robot;

use aurt_calibration::{
    CalibrationOptions, Decided, Gains, GainsError, GainsOf, KnownLoad, NamedRecording, Rest, TermScopes,
    decidable_gains, estimate_gains,
};
use aurt_rbd::LinkBody;
use known_robot::{KnownRobot, Noise, measured};

const GAINS: [f64; 6] = [11.976, 12.3, 9.839, 10.763, -10.2, 11.1];
const MASS_KG: f64 = 2.8;
const CENTRE_M: [f64; 3] = [0.02, -0.03, 0.06];
const LOAD: LinkBody = LinkBody {
    mass_kg: MASS_KG,
    com_m: CENTRE_M,
    inertia_at_com_kg_m2: [0.006, 0.0, 0.0, 0.006, 0.0, 0.004],
};

/// Currents of an unloaded and a loaded recording.
struct Currents {
    robot: KnownRobot,
    recordings: Vec<NamedRecording>,
    scopes: TermScopes,
}

fn currents(seed: u64, level: f64) -> Currents {
    let mut robot = KnownRobot::new(Some(&LOAD));
    let unloaded = measured(&KnownRobot::new(None).clean(0, 20.0), "free", seed, Noise::White, level, None);
    let loaded = measured(&robot.clean(1, 20.0), "loaded", seed + 1000, Noise::White, level, None);
    let recordings = [unloaded, loaded].map(in_amperes).to_vec();
    let scopes = TermScopes::new(vec![Some(vec!["loaded".into()])]);
    Currents { robot, recordings, scopes }
}

fn in_amperes(mut recording: NamedRecording) -> NamedRecording {
    for segment in &mut recording.data.segments {
        for (series, gain) in segment.measurement.as_mut().unwrap().iter_mut().zip(GAINS) {
            series.iter_mut().for_each(|y| *y /= gain);
        }
    }
    recording
}

const KNOWN: KnownLoad = KnownLoad { mass_kg: MASS_KG, mass_std_kg: 0.0, centre_of_mass_m: None };

impl Currents {
    fn of<'a>(&'a self, load: Option<KnownLoad>, options: &'a CalibrationOptions) -> GainsOf<'a> {
        GainsOf {
            model: &self.robot.model,
            recordings: &self.recordings,
            scopes: &self.scopes,
            load,
            options,
        }
    }

    fn estimate(&self, load: Option<KnownLoad>) -> Result<Gains, GainsError> {
        estimate_gains(&self.of(load, &CalibrationOptions::default()))
    }
}

#[test]
fn without_noise_the_gains_are_the_true_ones() {
    let world = currents(1, 1e-6);
    let options = CalibrationOptions { rest: Rest::Exclude, ..CalibrationOptions::default() };
    let gains = estimate_gains(&world.of(Some(KNOWN), &options)).unwrap();
    for (gain, truth) in gains.joints.iter().zip(GAINS) {
        assert_eq!(gain.decided, Decided::Gain);
        // Velocities and accelerations are those of filtered positions, which is no noise, but misfit.
        assert!((gain.value / truth - 1.0).abs() < 2e-2, "{gain:?} {truth}");
        assert!((gain.value - truth).abs() < 3.0 * gain.std_dev.unwrap(), "{gain:?} {truth}");
        assert!((gain.ratio / (truth / GAINS[gains.reference]) - 1.0).abs() < 2e-2, "{gain:?}");
    }
    for (found, truth) in gains.centre_of_mass_m.unwrap().into_iter().zip(CENTRE_M) {
        assert!((found - truth).abs() < 4e-3, "{found} {truth}");
    }
    assert!(
        gains.warnings.iter().any(|w| w.contains("joint 4 has the opposite sign")),
        "{:?}",
        gains.warnings
    );
}

#[test]
fn intervals_hold_the_true_gains_and_ratios() {
    let (mut held, mut ratios, mut count) = (0, 0, 0);
    let mut worst: f64 = 0.0;
    for seed in 0..12 {
        let gains = currents(seed, 1.0).estimate(Some(KNOWN)).unwrap();
        for (j, (gain, truth)) in gains.joints.iter().zip(GAINS).enumerate() {
            worst = worst.max((gain.value / truth - 1.0).abs());
            count += 1;
            held += usize::from((gain.value - truth).abs() < 1.96 * gain.std_dev.unwrap());
            let ratio = truth / GAINS[gains.reference];
            let deviation = gain.ratio_std_dev.unwrap();
            ratios += usize::from(j == gains.reference || (gain.ratio - ratio).abs() < 1.96 * deviation);
        }
    }
    // 72 intervals of which gains of one recording err together: 95 % of them but for chance.
    assert!(held >= 62 && ratios >= 62, "{held} {ratios} of {count}, worst {worst}");
    assert!(worst < 0.2, "{worst}");
}

#[test]
fn a_doubled_mass_doubles_the_gains_and_an_unsure_one_widens_them() {
    let world = currents(3, 1.0);
    let once = world.estimate(Some(KNOWN)).unwrap();
    let twice = world.estimate(Some(KnownLoad { mass_kg: 2.0 * MASS_KG, ..KNOWN })).unwrap();
    let unsure = world.estimate(Some(KnownLoad { mass_std_kg: 0.28, ..KNOWN })).unwrap();
    for ((a, b), c) in once.joints.iter().zip(&twice.joints).zip(&unsure.joints) {
        assert!((b.value / a.value - 2.0).abs() < 1e-6 && (b.ratio - a.ratio).abs() < 1e-6);
        let [own, wider] = [a, c].map(|g| g.std_dev.unwrap() / g.value.abs());
        assert!((wider.powi(2) - own.powi(2) - 0.01).abs() < 1e-9, "{own} {wider}");
        assert_eq!(a.ratio_std_dev, c.ratio_std_dev);
    }
}

#[test]
fn a_known_centre_of_mass_makes_gains_no_less_sure() {
    let world = currents(5, 1.0);
    let sum = |g: &Gains| g.joints.iter().map(|g| (g.std_dev.unwrap() / g.value).powi(2)).sum::<f64>();
    let without = world.estimate(Some(KNOWN)).unwrap();
    let with = world.estimate(Some(KnownLoad { centre_of_mass_m: Some(CENTRE_M), ..KNOWN })).unwrap();
    assert!(sum(&with) < sum(&without), "{} {}", sum(&with), sum(&without));
    assert_eq!(
        with.centre_of_mass_m.unwrap().map(|c| (c * 1e9).round()),
        CENTRE_M.map(|c| (c * 1e9).round())
    );
    for (gain, truth) in with.joints.iter().zip(GAINS) {
        assert!((gain.value - truth).abs() < 4.0 * gain.std_dev.unwrap(), "{gain:?} {truth}");
    }
}

#[test]
fn without_a_known_load_there_are_ratios_only() {
    let world = currents(7, 1.0);
    let gains = world.estimate(None).unwrap();
    for (gain, truth) in gains.joints.iter().zip(GAINS) {
        assert_eq!((gain.decided, gain.std_dev), (Decided::Ratio, None));
        let expected = truth / GAINS[gains.reference];
        assert!(
            (gain.ratio - expected).abs() < 4.0 * gain.ratio_std_dev.unwrap() + 2e-3,
            "{gain:?} {expected}"
        );
        assert_eq!(gain.value, gain.ratio);
    }
}

#[test]
fn decidability_is_known_beforehand() {
    let world = currents(2, 1.0);
    let options = CalibrationOptions::default();
    for load in [None, Some(KNOWN)] {
        let before = decidable_gains(&world.of(load, &options)).unwrap();
        let after = estimate_gains(&world.of(load, &options)).unwrap();
        for (a, b) in before.joints.iter().zip(&after.joints) {
            assert_eq!(a.decided, b.decided);
            if let Some((expected, found)) = a.std_dev.zip(b.std_dev) {
                let (expected, found) = (expected / a.value.abs(), found / b.value.abs());
                assert!(found / expected < 2.0 && expected / found < 2.0, "{expected} {found}");
            }
        }
    }
}

/// A joint that stands still weighs nothing that another joint would feel with it.
#[test]
fn a_gain_that_nothing_shows_is_said_to_be_undetermined() {
    let mut world = currents(4, 1.0);
    for recording in &mut world.recordings {
        for segment in &mut recording.data.segments {
            segment.measurement.as_mut().unwrap()[2].fill(0.0);
        }
    }
    let gains = world.estimate(Some(KNOWN));
    // A joint that measures nothing has no gain: an infinite one explains it.
    assert!(gains.is_err() || gains.unwrap().warnings.iter().any(|w| w.contains("joint 2")));
}

#[test]
fn loads_that_show_no_scale_are_refused() {
    let mut world = currents(1, 1.0);
    for mass_kg in [0.0, -2.8, f64::NAN, f64::INFINITY] {
        let refused = world.estimate(Some(KnownLoad { mass_kg, ..KNOWN }));
        assert!(matches!(refused, Err(GainsError::Mass { .. })), "{refused:?}");
    }
    let refused = world.estimate(Some(KnownLoad { mass_std_kg: -1.0, ..KNOWN }));
    assert!(matches!(refused, Err(GainsError::MassDeviation { .. })), "{refused:?}");
    let refused = world.estimate(Some(KnownLoad { centre_of_mass_m: Some([0.0, f64::NAN, 0.0]), ..KNOWN }));
    assert!(matches!(refused, Err(GainsError::CentreOfMass)), "{refused:?}");
    world.scopes = TermScopes::new(vec![Some(vec!["other".into()])]);
    assert!(matches!(world.estimate(Some(KNOWN)), Err(GainsError::NeverWith)));
    world.scopes = TermScopes::everywhere();
    assert!(matches!(world.estimate(Some(KNOWN)), Err(GainsError::NeverWithout)));
    world.robot = KnownRobot::new(None);
    assert!(matches!(world.estimate(Some(KNOWN)), Err(GainsError::Loads { found: 0 })));
    world.recordings.clear();
    let refused = world.estimate(None);
    assert!(refused.is_err(), "{refused:?}");
}

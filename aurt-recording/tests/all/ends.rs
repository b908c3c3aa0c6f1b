//! A recording that is cut by the clock is, where it counts, what it would be if it went on.

use aurt_recording::{PreprocessOptions, Preprocessed, Recording, preprocess};
use aurt_traits::MeasurementUnit;

const RATE_HZ: f64 = 500.0;
const F_DYN_HZ: f64 = 10.0;

/// Position, acceleration and a torque with a step of dry friction.
fn truth(t: f64) -> [f64; 3] {
    let [mut q, mut v, mut a] = [0.0; 3];
    for (amplitude, hz, phase) in [(0.6, 0.31, 0.4), (0.25, 0.77, 1.3), (0.05, 1.9, 2.1)] {
        let w = std::f64::consts::TAU * hz;
        let (sin, cos) = f64::sin_cos(w * t + phase);
        q += amplitude * sin;
        v += amplitude * w * cos;
        a -= amplitude * w * w * sin;
    }
    [q, a, 2.0 * a + 30.0 * q.cos() + 4.0 * v.signum()]
}

/// What stands at the stamps of a span that `kept` keeps; noise of an encoder of 6 µrad.
fn recorded(span_s: [f64; 2], kept: impl Fn(f64) -> bool) -> Recording {
    let stamp = |k: usize| k as f64 / RATE_HZ;
    let time: Vec<f64> =
        (0..).map(stamp).take_while(|t| *t < span_s[1]).filter(|t| *t >= span_s[0]).collect();
    let time: Vec<f64> = time.into_iter().filter(|t| kept(*t)).collect();
    let of = |which: usize| time.iter().map(|t| truth(*t)[which]).collect::<Vec<f64>>();
    let lattice = of(0).iter().map(|q| (q / 6e-6).round() * 6e-6).collect();
    Recording::from_arrays(time.clone(), vec![lattice])
        .unwrap()
        .with_measurement(vec![of(2)], MeasurementUnit::NewtonMetre)
        .unwrap()
}

fn prepared(recording: &Recording, count_ends: bool, whole_motion: bool) -> Preprocessed {
    let options =
        PreprocessOptions { count_ends, whole_motion, trim_rest: false, ..PreprocessOptions::new(F_DYN_HZ) };
    preprocess(recording, &options).unwrap()
}

/// Largest difference of rows from those of the recording that goes on: measurement, and acceleration behind the filter.
fn worst(cut: &Preprocessed, whole: &Preprocessed) -> [f64; 2] {
    let rows = |data: &Preprocessed| -> Vec<[f64; 3]> {
        let of = |s: &aurt_recording::Segment| {
            let motion = s.motion.view();
            let acceleration = s.filtered(&[motion.acceleration_rad_s2(0)]).unwrap().remove(0);
            let time = s.at_rows(motion.time_s());
            let measured = s.measurement.as_ref().unwrap()[0].clone();
            time.into_iter().zip(measured).zip(acceleration).map(|((t, y), a)| [t, y, a]).collect::<Vec<_>>()
        };
        data.segments.iter().flat_map(of).collect()
    };
    let (known, mut worst, mut compared) = (rows(whole), [0.0_f64; 2], 0);
    for [t, y, a] in rows(cut) {
        let Some(row) = known.iter().find(|row| (row[0] - t).abs() < 1e-6) else { continue };
        worst = [worst[0].max((row[1] - y).abs()), worst[1].max((row[2] - a).abs())];
        compared += 1;
    }
    assert!(compared > 50, "{compared} rows have a partner");
    worst
}

#[test]
fn rows_of_a_recording_that_is_cut_are_those_of_one_that_goes_on() {
    let whole = recorded([0.0, 40.0], |_| true);
    let in_gap = |t: f64| [9.0, 13.0, 17.0, 21.0, 25.0].iter().any(|from| (*from..from + 0.3).contains(&t));
    // Rows are every tenth sample of a grid that begins with the segment: cut where the grids agree.
    let cut = recorded([5.0, 30.0], |t| !in_gap(t));
    for (count_ends, least, most) in [(false, 0.0, [0.03, 0.02]), (true, 1.0, [f64::INFINITY; 2])] {
        // The whole recording as a dense grid of rows.
        let dense = PreprocessOptions { trim_rest: false, ..PreprocessOptions::new(F_DYN_HZ) };
        let mut known = preprocess(&whole, &dense).unwrap();
        for segment in &mut known.segments {
            let raw = segment.raw_measurement.clone().unwrap();
            segment.decimation = 1;
            segment.kept_rows = 200..segment.motion.samples() - 200;
            segment.measurement = Some(segment.filtered(&raw).unwrap());
        }
        let [measured, acceleration] = worst(&prepared(&cut, count_ends, false), &known);
        println!("count_ends {count_ends}: measurement {measured:.4}, acceleration {acceleration:.4}");
        assert!(measured < most[0] && acceleration < most[1], "{measured} {acceleration}");
        assert!(acceleration >= least, "the treatment of the paper errs: {acceleration}");
    }
}

/// The motion up to the ends, by which predictions are made.
#[test]
fn accelerations_up_to_the_ends() {
    let mut worst = [0.0_f64; 2];
    let mut largest = 0.0_f64;
    for cut in 0..40 {
        let from_s = 1.0 + 0.173 * f64::from(cut);
        let recording = recorded([from_s, from_s + 3.0], |_| true);
        for (count_ends, worst) in [false, true].into_iter().zip(&mut worst) {
            let data = prepared(&recording, count_ends, true);
            let motion = data.segments[0].motion.view();
            assert_eq!(motion.samples(), recording.samples() - 2);
            for (t, a) in motion.time_s().iter().zip(motion.acceleration_rad_s2(0)) {
                *worst = worst.max((truth(*t)[1] - a).abs());
                largest = largest.max(truth(*t)[1].abs());
            }
        }
    }
    println!("largest {largest:.1}, error {:.2}, as in the paper {:.1} rad/s²", worst[0], worst[1]);
    assert!(worst[0] < 0.1 * largest, "{worst:?} of {largest}");
    assert!(worst[1] > largest, "{worst:?} of {largest}");
}

#[test]
fn a_run_shorter_than_the_memory_has_a_motion_and_no_rows() {
    for gap_to_s in [1.2, 1.5, 1.7, 1.8, 1.9, 1.93] {
        let recording = recorded([0.0, 2.0], |t| !(0.9..gap_to_s).contains(&t));
        let data = prepared(&recording, false, true);
        let Some(last) = data.segments.get(1) else { continue };
        assert_eq!(last.motion.samples(), ((2.0 - gap_to_s) * RATE_HZ).round() as usize - 2);
        assert_eq!(last.measurement.as_ref().unwrap()[0].len(), last.rows());
        assert!(gap_to_s < 1.7 || last.rows() == 0, "{gap_to_s} s: {} rows", last.rows());
    }
}

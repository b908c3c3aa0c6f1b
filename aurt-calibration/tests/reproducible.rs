//! The same recordings give the same bits however many threads work, and at the baseline on every machine; other
//! instruction sets agree to rounding. One test alone, because the instruction set is chosen for the whole process.
#![expect(clippy::unwrap_used, reason = "a test may panic")]

#[path = "../benches/workload/mod.rs"]
mod workload;

use aurt_calibration::{Calibration, CalibrationOptions, NamedRecording, calibrate};
use aurt_recording::{PreprocessOptions, preprocess};
use aurt_traits::{Dispatch, MeasurementUnit};

/// Preprocesses and calibrates with so many threads: two recordings, one of them with a gap.
fn calibration(threads: usize, count_ends: bool) -> Calibration {
    let model = workload::model(6);
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
    pool.install(|| {
        let prepared: Vec<NamedRecording> = [3000, 2200]
            .into_iter()
            .map(|samples| {
                let mut recording = workload::recording(6, samples);
                if samples == 3000 {
                    recording.time_s[1700..].iter_mut().for_each(|t| *t += 3.0);
                }
                let data =
                    preprocess(&recording, &PreprocessOptions { count_ends, ..PreprocessOptions::new(10.0) })
                        .unwrap();
                NamedRecording { name: samples.to_string(), data }
            })
            .collect();
        assert_eq!(prepared[0].data.segments.len(), 2);
        let options = CalibrationOptions::default();
        calibrate(&model, &prepared, MeasurementUnit::NewtonMetre, 10.0, &options).unwrap()
    })
}

fn bits(calibration: &Calibration) -> u64 {
    let parameters = calibration.parameters.iter().flat_map(|p| [p.value, p.std_dev.unwrap_or(-1.0)]);
    let rest = calibration.sigma.iter().copied().chain([calibration.condition_number]);
    parameters.chain(rest).fold(0, |x, v| x.rotate_left(1) ^ v.to_bits())
}

/// Whether the processor has AVX2 and fused products.
fn fuses() -> bool {
    #[cfg(target_arch = "x86_64")]
    return is_x86_feature_detected!("avx2") && is_x86_feature_detected!("fma");
    #[cfg(not(target_arch = "x86_64"))]
    false
}

#[test]
fn threads_do_not_show_and_the_baseline_is_the_same_everywhere() {
    let mut reference: Option<Calibration> = None;
    let mut fused: Option<u64> = None;
    for level in Dispatch::available() {
        level.select().unwrap();
        let one = calibration(1, false);
        for threads in [2, 3, 8] {
            assert_eq!(bits(&calibration(threads, false)), bits(&one), "{level}, {threads} threads");
        }
        let reference = reference.get_or_insert_with(|| one.clone());
        for (a, b) in one.parameters.iter().zip(&reference.parameters) {
            // What an estimate can be off by rounding is a share of its own uncertainty.
            let scale = b.std_dev.unwrap_or(0.0).max(b.value.abs());
            assert!(
                (a.value - b.value).abs() <= 1e-9 * scale,
                "{level}, {}: {} {}",
                a.name,
                a.value,
                b.value
            );
        }
        if level == Dispatch::Baseline {
            // The bits are part of the contract: another machine, another processor, the same number. With faer, which
            // chooses by the processor itself, that holds among processors with AVX2 and FMA.
            let paper = bits(&calibration(1, true));
            let known = fuses().then_some([0x00bd_77a3_c31a_a045, 0x545c_0acf_f848_d519]);
            if let Some(known) = known {
                assert_eq!([bits(&one), paper], known, "{:#x} {paper:#x}", bits(&one));
            }
        } else {
            assert_eq!(bits(&one), *fused.get_or_insert(bits(&one)), "{level}");
        }
    }
}

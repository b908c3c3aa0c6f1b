//! What a process of its own costs a library's model: the time of a batch, loaded into this process and in the library's.
//!
//! `cargo run --release -p aurt-plugins --example price_of_isolation -- libstop_c.so`

use std::{path::PathBuf, process::ExitCode, time::Instant};

use aurt_plugins::{Registry, Worker};
use aurt_traits::{Columns, HysteresisModel, JointSeries, Slot};

/// Batches that are timed; the median is shown.
const TIMES: usize = 51;

fn median_us(model: &dyn HysteresisModel, samples: usize) -> Result<f64, Box<dyn std::error::Error>> {
    let of = |scale: f64| (0..samples).map(|s| (scale * s as f64).sin()).collect::<Vec<_>>();
    let (time, position, velocity) =
        ((0..samples).map(|s| 1e-3 * s as f64).collect::<Vec<_>>(), of(1e-2), of(2e-2));
    let (acceleration, load) = (of(3e-2), of(4e-2));
    let series = JointSeries {
        time_s: &time,
        position_rad: &position,
        velocity_rad_s: &velocity,
        acceleration_rad_s2: &acceleration,
        load_torque: &load,
    };
    let columns = model.columns().len();
    let mut data = vec![0.0; columns * samples];
    let mut state = model.initial_state(&series.slice(0..1));
    let mut times = Vec::with_capacity(TIMES);
    // Guards and declarations are looked at in the first batches alone.
    for _ in 0..TIMES + 4 {
        let begin = Instant::now();
        model.evaluate(&series, &mut state, &mut Columns::new(&mut data, columns, samples, samples))?;
        times.push(begin.elapsed().as_secs_f64() * 1e6);
    }
    let mut times = times.split_off(4);
    times.sort_by(f64::total_cmp);
    Ok(times[TIMES / 2])
}

fn measure(library: &PathBuf) -> Result<(), Box<dyn std::error::Error>> {
    let built = |isolating: bool| -> Result<Box<dyn HysteresisModel>, Box<dyn std::error::Error>> {
        let mut registry = Registry::linked()?;
        registry.serve_with(Worker::this_program()?);
        registry.isolate(isolating);
        registry.load_library(library)?;
        let listing = registry.models_of(Slot::Hysteresis).find(|m| !m.origin.is_builtin());
        let example = listing.ok_or("the library has no hysteresis model")?.example_table()?;
        Ok(registry.build::<dyn HysteresisModel>(&example).map_err(|errors| errors[0].clone())?)
    };
    let begin = Instant::now();
    let isolated = built(true)?;
    println!(
        "a process for the library and an instance in it: {:.1} ms",
        begin.elapsed().as_secs_f64() * 1e3
    );
    let loaded = built(false)?;
    println!("samples a batch   in this process   in its own   (us, medians of {TIMES})");
    for samples in [1, 100, 1_000, 10_000, 100_000, 1_000_000] {
        let (here, there) = (median_us(&*loaded, samples)?, median_us(&*isolated, samples)?);
        println!("{samples:>15} {here:>17.1} {there:>12.1}");
    }
    Ok(())
}

fn main() -> ExitCode {
    if let Some(status) = aurt_plugins::serve_if_asked() {
        return status;
    }
    let Some(library) = std::env::args_os().nth(1) else {
        eprintln!("give the path of a library with a hysteresis model");
        return ExitCode::from(2);
    };
    match measure(&library.into()) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("Error: {error}");
            ExitCode::from(2)
        }
    }
}

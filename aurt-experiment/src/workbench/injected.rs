//! Experiments with real recordings as what effects are added to: gains undone, windows cut, one plain form.

use crate::Experiment;
use crate::experiment::Geometry;
use aurt::data::Purpose;
use aurt::duplicates::SampleRegister;
use aurt_files::escaped;
use aurt_recording::Recording;
use aurt_simulation::inject::{JointStructure, RealExperiment, RealRecording, Structure};

use crate::workbench::experiments::{undone, windowed, with_window};
use crate::workbench::failure::Failure;

/// An experiment and its recordings as plain data, those of every part in the order of writing, each once.
pub fn plain(experiment: &Experiment) -> Result<RealExperiment, Failure> {
    let refuse = |reason: &str, remedy: &str| Failure::unfit(experiment.path.clone(), reason, remedy);
    if !experiment.recordings.simulated.is_empty() {
        return Err(refuse(
            "asks about another simulator's predictions, which an effect added to the measurement would not change",
            "leave out `simulated`",
        ));
    }
    if experiment.arm_term_recordings.iter().any(Option::is_some) {
        return Err(refuse(
            "has arm terms that act in some recordings alone, and an injection changes the recordings' roles",
            "leave out the arm term and the recordings that have it",
        ));
    }
    let pipeline = experiment.pipeline();
    let sources = experiment.recordings.each_once().into_iter();
    let loaded = sources
        .map(|source| pipeline.read(source.clone(), Purpose::Validation))
        .collect::<Result<Vec<_>, _>>()?;
    SampleRegister::check(loaded.iter().map(|loaded| (loaded, "recordings")))?;
    let unit = pipeline.common_unit(&loaded)?.unwrap_or_default();
    let mut recordings = Vec::new();
    for loaded in &loaded {
        let options = pipeline.options(loaded.recording.unit, Purpose::Calibration);
        let whole = windowed(loaded)?;
        let measurement = whole.measurement.as_deref().map(|measured| undone(measured, &options));
        let recording = Recording { velocity_rad_s: None, measurement, unit, ..whole };
        let name = with_window(&loaded.source.label, loaded.source.window_s);
        recordings.push(RealRecording { name, recording });
    }
    let mut options = pipeline.options(unit, Purpose::Calibration);
    (options.gains, options.offsets) = (None, None);
    let mdh_csv = match &experiment.robot.geometry {
        Geometry::Mdh { path, .. } => Some(
            aurt_files::read_text(path, aurt_files::MOST_TEXT_BYTES)
                .map_err(|source| aurt_plugins::model::Error::Read { path: path.clone(), source })?,
        ),
        Geometry::Urdf { .. } | Geometry::Known(_) => None,
    };
    Ok(RealExperiment {
        name: experiment.path.file_stem().map_or_else(String::new, |s| s.to_string_lossy().into_owned()),
        mdh_csv,
        bodies: experiment.robot.rigid_body()?,
        unit,
        experiment_toml: without_recordings(experiment).map_err(|reason| refuse(&reason, "simplify it"))?,
        options,
        structure: structure(experiment)?,
        recordings,
    })
}

/// The experiment's text without its recordings, with the geometry beside it and the gains undone.
fn without_recordings(experiment: &Experiment) -> Result<String, String> {
    let mut table: toml::Table = toml::from_str(&experiment.source_text).map_err(|e| e.to_string())?;
    table.remove("recordings");
    table.remove("sweep");
    if let Some(robot) = table.get_mut("robot").and_then(toml::Value::as_table_mut) {
        robot.insert("mdh".into(), "mdh.csv".into());
        robot.remove("torque_constants_nm_per_a");
    }
    if let Some(instrument) = table.get_mut("instrument").and_then(toml::Value::as_table_mut) {
        instrument.retain(|key, _| key == "delay_s");
    }
    if let Some(plugins) = table.get_mut("plugins").and_then(toml::Value::as_table_mut) {
        let libraries = experiment.libraries.iter().map(|library| {
            let absolute = std::path::absolute(library).unwrap_or_else(|_| library.clone());
            toml::Value::from(escaped(&absolute.to_string_lossy()))
        });
        plugins.insert("libraries".into(), toml::Value::Array(libraries.collect()));
    }
    toml::to_string(&table).map_err(|e| e.to_string())
}

/// What each joint's row has beyond rigid bodies, as far as a small least squares can follow.
fn structure(experiment: &Experiment) -> Result<Structure, Failure> {
    let joints = experiment.joints();
    let stacks = experiment.joint_dynamics.stacks(joints).map_err(aurt_plugins::model::Error::Assembly)?;
    let rotors: Vec<usize> = experiment
        .arm_terms
        .iter()
        .filter(|term| term.name() == "rotor_inertia")
        .flat_map(|term| term.joints(joints))
        .collect();
    let of_joint = |(j, stack): (usize, &aurt_traits::JointStack)| {
        let coulomb = stack.coulomb().columns();
        let with_load = |name: &str| name.starts_with("F_C1") || name.starts_with("F_C2");
        JointStructure {
            coulomb: !coulomb.is_empty(),
            viscous: !stack.viscous().columns().is_empty(),
            rotor: rotors.contains(&j),
            load: coulomb.iter().any(|p| with_load(&p.name)),
        }
    };
    Ok(Structure { joints: stacks.iter().enumerate().map(of_joint).collect() })
}

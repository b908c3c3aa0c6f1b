use aurt_rbd::RbdError;
use thiserror::Error;

/// Why a model cannot be exported.
#[derive(Debug, Error)]
#[non_exhaustive]
#[expect(missing_docs, reason = "the messages name the fields")]
pub enum ExportError {
    #[error(
        "the model predicts currents in A, and the target needs torques in Nm; write `torque_constants_nm_per_a` \
         in the table `robot` of the experiment and calibrate again"
    )]
    Amperes,
    #[error(
        "joints of the model follow others, or its rigid bodies are of a kind of their own; chains and trees whose joints all move \
         on their own can be exported"
    )]
    NoChain,
    #[error(
        "the name `{name}` {reason}; name the robot with letters of a to z, digits and `_`, a letter first"
    )]
    Name { name: String, reason: &'static str },
    #[error("{place}: the model `{model}` cannot be exported: {reason}; known: {known}")]
    Model { place: String, model: String, reason: &'static str, known: String },
    #[error(
        "the model has no mass, centre of mass and inertia for every link, only base parameters; calibrate with \
         `estimator = \"consistent\"`"
    )]
    NoBodies,
    #[error(
        "the standard parameters are those of no machine: {complaints}; calibrate with `estimator = \"consistent\"`"
    )]
    Impossible { complaints: String },
    #[error("{what}: expected {expected}, got {found}")]
    Count { what: &'static str, expected: usize, found: usize },
    #[error("the coefficient `{name}` is {value}; calibrate again")]
    NotFinite { name: String, value: f64 },
    #[error("{place}: its model cannot be described: {source}")]
    Description { place: String, source: serde_json::Error },
    #[error(
        "the mass matrix of the model is not positive definite at q = {position}, so torques do not determine its motion; \
         calibrate with `estimator = \"consistent\"`, or export the inverse dynamics"
    )]
    MassMatrix { position: String },
    #[error("the archive of the FMU cannot be made: {0}")]
    Archive(#[from] zip::result::ZipError),
    #[error(transparent)]
    Robot(aurt_rbd::robots::RobotErrors),
    #[error("the file is no well-formed XML: {0}")]
    Xml(roxmltree::Error),
    #[error(
        "the chain of the file is not that of the model: {reason}; calibrate with `mjcf` or `urdf` in the table `robot` naming this file, \
         or choose the chain with `--base` and `--tip`"
    )]
    OtherChain { reason: String },
    #[error(
        "behind joint {joint} its body has another joint, so the mass between them has no place in the file; give each joint a \
         body of its own"
    )]
    Between { joint: String },
    #[error(
        "link {link}: without what the file states of {carried}, nothing is left that a body could be for `{body}`; correct their \
         `inertial`, or remove them for the calibration"
    )]
    Remainder { link: usize, body: String, carried: String },
    #[error(
        "the file has `inertiafromgeom=\"true\"`, by which MuJoCo overrules every <inertial> with the masses of shapes; write \
         `inertiafromgeom=\"auto\"` in <compiler>"
    )]
    FromShapes,
    #[error(transparent)]
    RigidBody(#[from] RbdError),
}

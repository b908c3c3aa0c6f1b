//! Locating the mismatch between a robot model and recordings, and naming the physics left out.
//!
//! The rooms stand in the order of the walk of the data; each imports only from those before it:
//!
//! | room | what it does |
//! |---|---|
//! | [`recordings`] | rows of the recordings, and which of them fit and which judge |
//! | [`vocabulary`] | what an effect consists of: descriptor, parameters, proposals |
//! | [`effects`] | the physics that can be missing, one effect a file |
//! | [`faults`] | clipped measurements and bad rows, found in recordings as read |
//! | [`drives`] | which structures of drives and joints positions need |
//! | [`request`] | what is asked, and the settings that decide |
//! | [`noise`] | what noise alone leaves |
//! | [`hypotheses`] | what effects propose, and registered models, as columns |
//! | [`evidence`] | second moments of all columns; nested fits and cross-validation |
//! | [`search`] | which hypotheses describe the recordings |
//! | [`transmission`] | what lies above the filters: elastic gears, backlash |
//! | [`contact`] | external forces, local in time |
//! | [`investigation`] | the walk through all rooms |
//! | [`remainder`] | what a black box predicts beyond the improved model |
//! | [`verdict`] | what may be said of what was found |
//! | [`injection`] | what would be said if an effect were added to the measurement |
//! | [`discrimination`] | the motion that decides what is left open |
//! | [`mod@improvement`] | the experiment with what was found |

#![expect(missing_docs, reason = "names that say all need no sentence")]

pub mod contact;
mod dice;
pub mod discrimination;
pub mod drives;
pub mod effects;
mod error;
pub mod evidence;
pub mod faults;
pub mod hypotheses;
pub mod improvement;
pub mod injection;
pub mod investigation;
pub mod noise;
mod parameters;
pub mod recordings;
pub mod remainder;
pub mod request;
pub mod search;
pub mod transmission;
pub mod verdict;
pub mod vocabulary;

pub use contact::{
    Contact, ContactOptions, ContactRows, ForceColumns, StandingRows, find_contacts, find_standing_contacts,
    force_columns,
};
pub use discrimination::{
    DeviationGoal, Discrimination, Discriminator, Doubt, DriveDiscrimination, DriveMoments, Interval,
    MotionMoments, Outlook, Subject,
};
pub use error::DiagnosisError;
pub use evidence::{Baseline, Problem};
pub use faults::{Fault, RecordingFaults, without_unusable_rows};
pub use hypotheses::{Candidate, Group, RegisteredModel, Switch};
pub use improvement::{Improvement, improved_experiment, improvement};
pub use injection::{Prepared, SeenFault};
pub use investigation::{BeforeGears, Delay, Indicated, Investigation, Late, investigate};
pub use parameters::{FittedColumn, ParameterValue, Parameters};
pub use recordings::{ConfirmRows, Fit, FitRows, Instrument, Layout, Partition, RecordingRows, Role};
pub use remainder::{Follows, Remainder, Rest, Share};
pub use request::{
    CommonScale, Question, QuestionedRecording, SelectionOptions, Spoilt, from_folder, with_file_names,
};
pub use search::{Chosen, Selection};
pub use transmission::{FullRate, Gears, PoseColumns, Shaking, VisibleGear, find_gears};
pub use verdict::{
    Alternative, Answer, Curves, Evidence, Finding, HeldOut, HeldOutDifference, Indication, JointResidual,
    JointSeriesRows, LEARNT_SCHEMA, Learnt, LearntFrom, NotDecidable, NotExamined, Rate, RecordingSeries,
    RegisteredFinding, SCHEMA, SCORE, Shift, Verdict, interpolated, series, write_verdict,
};

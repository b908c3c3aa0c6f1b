use std::collections::BTreeMap;

use aurt_files::suggestion::likely;

use crate::bag::records::{Container, Ending, Record, Records, Scan};
use crate::error::RecordingError;

/// What ROS 1 and ROS 2 call the messages that are read.
const JOINT_STATE: [&str; 2] = ["sensor_msgs/msg/JointState", "sensor_msgs/JointState"];
const JOINT_TRAJECTORY: &str = "trajectory_msgs/msg/JointTrajectory";
const USUAL: &str = "/joint_states";

#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Topic {
    pub(super) name: String,
    /// Messages are planned motions instead of states.
    pub(super) is_planned: bool,
    /// Its channels in ascending order; several nodes may publish under one name.
    pub(super) channels: Vec<u64>,
    /// The other topics with joint states.
    pub(super) others: Vec<String>,
}

/// Topics and types that a file may list; in MCAP there are no more numbers for them.
const MOST_LISTED: usize = 1 << 16;

#[derive(Debug, Default)]
struct Listing {
    schemas: BTreeMap<u64, String>,
    /// Topic, schema and encoding of each channel.
    channels: BTreeMap<u64, (String, u64, String)>,
}

impl Listing {
    fn read(records: &mut dyn Records) -> (Self, Option<Ending>) {
        let mut listing = Self::default();
        loop {
            let more = records.next(&mut |record| match record {
                Record::Schema { id, name } => {
                    listing.schemas.insert(id, name);
                }
                Record::Channel { id, schema, topic, encoding } => {
                    listing.channels.insert(id, (topic, schema, encoding));
                }
                Record::Message { .. } | Record::Other => {}
            });
            match more {
                Ok(true) if listing.schemas.len().max(listing.channels.len()) > MOST_LISTED => {
                    let reason = format!("it lists more than {MOST_LISTED} topics");
                    return (listing, Some(Ending::Wrong(reason)));
                }
                Ok(true) => {}
                Ok(false) => return (listing, None),
                Err(ending) => return (listing, Some(ending)),
            }
        }
    }

    /// The topics with the type of their messages and their encoding; where a topic has several types, joint states are
    /// meant.
    fn topics(&self) -> BTreeMap<&str, (&str, &str)> {
        let mut topics = BTreeMap::new();
        for (topic, schema, code) in self.channels.values() {
            let kind = self.kind(*schema);
            if JOINT_STATE.contains(&kind) || !topics.contains_key(topic.as_str()) {
                topics.insert(topic.as_str(), (kind, code.as_str()));
            }
        }
        topics
    }

    fn kind(&self, schema: u64) -> &str {
        self.schemas.get(&schema).map_or("unknown type", String::as_str)
    }
}

impl Topic {
    /// The topic to be read, and what a person should know about the choice. Planned motions are read if they `may_be_planned` and
    /// there are no joint states.
    pub(super) fn choose(
        container: &dyn Container,
        stated: Option<&str>,
        may_be_planned: bool,
    ) -> Result<(Self, Option<String>), RecordingError> {
        // Most files list their topics at the end; chunks are looked into only if this one does not.
        let (mut listing, mut ending) = Listing::read(&mut *container.records(Scan::Summary)?);
        if listing.channels.is_empty() || ending.is_some() {
            (listing, ending) = Listing::read(&mut *container.records(Scan::Topics)?);
        }
        let malformed = |reason: String, remedy: String| {
            RecordingError::malformed(container.path(), "its topics", reason, remedy)
        };
        if listing.channels.is_empty() {
            let reason = match ending {
                Some(Ending::BreaksOff) => "the file ends before its first topic".to_owned(),
                Some(Ending::Wrong(error)) => format!("the file cannot be read: {error}"),
                None => "the file has none".to_owned(),
            };
            return Err(malformed(reason, "record or copy the file again".to_owned()));
        }
        let topics = listing.topics();
        let listed = |of: &BTreeMap<&str, (&str, &str)>| {
            let shown: Vec<String> =
                of.iter().take(20).map(|(t, (kind, _))| format!("{t} ({kind})")).collect();
            shown.join(", ")
        };
        let mut states = topics.clone();
        states.retain(|_, (kind, _)| JOINT_STATE.contains(kind));
        if states.is_empty() && may_be_planned {
            states = topics.clone();
            states.retain(|_, (kind, _)| *kind == JOINT_TRAJECTORY);
        }
        let mut remark = None;
        let (name, (kind, encoding)) = match stated {
            Some(stated) => match topics.get_key_value(stated) {
                Some((name, found)) => (*name, *found),
                None => {
                    let meant = likely(stated, topics.keys().copied());
                    let meant = meant.map(|t| format!("did you mean `{t}`? ")).unwrap_or_default();
                    let remedy = format!("{meant}the file has {}", listed(&topics));
                    return Err(malformed(format!("there is no topic `{stated}`"), remedy));
                }
            },
            None => match (states.len(), states.get_key_value(USUAL)) {
                (0, _) => {
                    let reason = "no topic has messages of the type sensor_msgs/msg/JointState".to_owned();
                    return Err(malformed(reason, format!("record one; the file has {}", listed(&topics))));
                }
                (2.., None) => {
                    let reason = format!("several topics contain joint states: {}", listed(&states));
                    return Err(malformed(
                        reason,
                        "state which to read, e.g. topic = \"/joint_states\"".into(),
                    ));
                }
                (2.., Some((name, found))) => {
                    remark = Some(format!("of the topics {}, {USUAL} is read", listed(&states)));
                    (*name, *found)
                }
                (_, _) => match states.first_key_value() {
                    Some((name, found)) => (*name, *found),
                    None => return Err(malformed("the file has none".into(), "record it again".into())),
                },
            },
        };
        let is_planned = may_be_planned && kind == JOINT_TRAJECTORY;
        if !is_planned && !JOINT_STATE.contains(&kind) {
            let reason = format!("the messages of {name} are of the type {kind}");
            return Err(malformed(reason, "messages are read if they are sensor_msgs/msg/JointState".into()));
        }
        if encoding != "cdr" {
            let reason =
                format!("the messages of {name} are encoded as `{encoding}`, and CDR (ROS 2) is read");
            return Err(malformed(reason, "convert bags of ROS 1 with `rosbags-convert`".into()));
        }
        let of_topic = listing.channels.iter().filter(|(_, (topic, schema, code))| {
            topic == name && listing.kind(*schema) == kind && code == encoding
        });
        let channels: Vec<u64> = of_topic.map(|(id, _)| *id).collect();
        let others = listing.channels.values().filter(|(topic, ..)| topic == name).count() - channels.len();
        if others > 0 {
            let also = format!("{name} also has messages of other types, which are skipped");
            remark = Some(remark.map_or_else(|| also.clone(), |said| format!("{said}; {also}")));
        }
        let others = states.keys().filter(|other| **other != name).map(|&other| other.to_owned()).collect();
        Ok((Self { name: name.to_owned(), is_planned, channels, others }, remark))
    }
}

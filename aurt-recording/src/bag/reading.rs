use crate::bag::joints::Joints;
use crate::bag::messages::Messages;
use crate::bag::records::Container;
use crate::bag::topics::Topic;
use crate::csv::table::Table;
use crate::error::RecordingError;
use crate::format::Reading;
use crate::memory::Memory;
use crate::read_options::ReadOptions;
use crate::recording::Recording;

pub(super) fn read(
    memory: Memory<'_>,
    files: Vec<Box<dyn Container + '_>>,
    reading: Reading<'_>,
) -> Result<Recording, RecordingError> {
    let options = reading.options;
    let mut chosen = Vec::<(Box<dyn Container + '_>, Topic)>::new();
    let (mut said, mut missing) = (Vec::new(), None);
    let (path, count) = (memory.path(), files.len());
    for file in files {
        let stated = chosen.first().map(|(_, topic)| topic.name.as_str());
        let stated = stated.or(options.recorded.topic.as_deref());
        match Topic::choose(&*file, stated, options.accepts_plan) {
            Ok((topic, remark)) => {
                said.extend(remark);
                chosen.push((file, topic));
            }
            // A part of a bag may lack a topic that others have.
            Err(error) if count > 1 => {
                said.push(format!("not read: {error}"));
                missing = missing.or(Some(error));
            }
            Err(error) => return Err(error),
        }
    }
    let Some((first, topic)) = chosen.first() else {
        let found = "it has no files".to_owned();
        return Err(missing.unwrap_or(RecordingError::NoRows { path: path.to_owned(), found }));
    };
    let messages = Messages::new(path, chosen.iter().map(|(file, topic)| (&**file, topic)));
    let opened = Joints::open(messages, path, topic, options);
    let mut joints = opened.map_err(|error| on_several_topics(error, &**first, topic))?;
    let names = joints.columns();
    let width = names.len();
    let mut table = Table::new(memory, names, width, options)?;
    table.belongs_to(options.joints_read(joints.names()));
    said.dedup();
    said.into_iter().for_each(|r| table.remark(r));
    joints.remarks().into_iter().for_each(|r| table.remark(r));
    let wanted = table.wanted();
    let format = match chosen.len() {
        1 => format!("{}, topic {}", first.kind(), topic.name),
        n => format!("{} in {n} files, topic {}", first.kind(), topic.name),
    };
    let mut all = vec![0.0; width];
    let mut rows = 0;
    let mut recording = table.read(format, reading, &mut |row| {
        if !joints.next(&mut all)? {
            return joints.never_finite(rows).map_or(Ok(false), |of| {
                Err(RecordingError::malformed(
                    path,
                    format!("topic {}", topic.name),
                    format!("no message has numbers alone: {of} is NaN"),
                    "record what that joint measures, or take a chain without it (tip and joint_names in an experiment, \
                     --tip and --joint-names on the command line)",
                ))
            });
        }
        rows += 1;
        for (value, column) in row.iter_mut().zip(&wanted) {
            *value = all[*column];
        }
        Ok(true)
    })?;
    recording.report.irregularities.extend(joints.irregularities());
    recording.report.origin_s = joints.origin_s();
    recording.report.branches = joints.branches();
    Ok(recording)
}

/// Topics that are looked into for joints that the chosen one lacks.
const MOST_TOPICS: usize = 20;

fn on_several_topics(error: RecordingError, file: &dyn Container, topic: &Topic) -> RecordingError {
    let RecordingError::JointNames { path, recorded, wanted, lacking } = error else { return error };
    let names = |name: &String| {
        let other = Topic::choose(file, Some(name), topic.is_planned).ok()?.0;
        let messages = Messages::new(&path, std::iter::once((file, &other)));
        let joints = Joints::open(messages, &path, &other, &ReadOptions::default()).ok()?;
        Some((name.clone(), joints.names().to_vec()))
    };
    let others: Vec<(String, Vec<String>)> =
        topic.others.iter().take(MOST_TOPICS).filter_map(names).collect();
    let is_there =
        |name: &String| recorded.contains(name) || others.iter().any(|(_, own)| own.contains(name));
    if !wanted.iter().all(is_there) {
        return RecordingError::JointNames { path, recorded, wanted, lacking };
    }
    let topics = std::iter::once((topic.name.clone(), recorded)).chain(others);
    let listed: Vec<String> = topics.map(|(name, own)| format!("{name} has {}", own.join(", "))).collect();
    RecordingError::malformed(
        &path,
        format!("topic {}", topic.name),
        format!("no message has all joints: {}", listed.join("; ")),
        "rows need all joints at one time: publish them in one message (joint_state_publisher with source_list \
                 does), or write positions and efforts of all joints into one CSV file",
    )
}

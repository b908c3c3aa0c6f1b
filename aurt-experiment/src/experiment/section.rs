//! Reading the tables of an experiment: typed, with every complaint collected at its place.

use std::cell::RefCell;
use std::path::{Path, PathBuf};

use aurt_files::clipped;
use aurt_plugins::{Node, NodeKind, Span, suggestion};
use aurt_recording::is_recording_folder;

use super::errors::Complaint;
use super::joint_count::JointCheck;
use super::paths;

/// Unknown keys of one table that are complained about; whoever has more has another problem than a slip of the pen.
const MOST_UNKNOWN_KEYS: usize = 50;

/// What all sections share while an experiment is read.
#[derive(Debug, Default)]
pub(super) struct Reader {
    pub folder: PathBuf,
    complaints: RefCell<Vec<Complaint>>,
    checks: RefCell<Vec<JointCheck>>,
    notes: RefCell<Vec<String>>,
}

impl Reader {
    pub(super) fn new(folder: PathBuf) -> Self {
        Self { folder, ..Self::default() }
    }

    pub(super) fn complain(&self, complaint: impl Into<Complaint>) {
        self.complaints.borrow_mut().push(complaint.into());
    }

    /// Notes something that can be checked as soon as the number of joints is known.
    pub(super) fn check_joints(&self, check: JointCheck) {
        self.checks.borrow_mut().push(check);
    }

    /// Notes something that a person should know of how the experiment was read, once.
    pub(super) fn note(&self, note: String) {
        let mut notes = self.notes.borrow_mut();
        if !notes.contains(&note) {
            notes.push(note);
        }
    }

    pub(super) fn notes(&self) -> Vec<String> {
        self.notes.borrow().clone()
    }

    pub(super) fn into_complaints(self) -> (Vec<Complaint>, Vec<JointCheck>) {
        (self.complaints.into_inner(), self.checks.into_inner())
    }
}

/// A table whose keys are read one by one; [`Self::finish`] complains about those that nobody asked for.
#[derive(Debug)]
pub(super) struct Section<'n, 'r> {
    pub reader: &'r Reader,
    node: &'n Node,
    /// The table as a message calls it: `[robot]`.
    title: String,
    asked: Vec<String>,
}

impl<'n, 'r> Section<'n, 'r> {
    pub(super) fn new(reader: &'r Reader, node: &'n Node, title: impl Into<String>) -> Option<Self> {
        let title = title.into();
        if !matches!(node.kind, NodeKind::Table(_)) {
            let message = format!("{title}: expected a table, found {}", node.kind_name());
            reader.complain(Complaint::new(node.span.clone(), message));
            return None;
        }
        Some(Self { reader, node, title, asked: Vec::new() })
    }

    pub(super) const fn span(&self) -> &Span {
        &self.node.span
    }

    pub(super) fn take(&mut self, key: &str) -> Option<&'n Node> {
        if !self.asked.iter().any(|asked| asked == key) {
            self.asked.push(key.to_owned());
        }
        self.node.get(key)
    }

    pub(super) fn require(&mut self, key: &'static str, example: &str) -> Option<&'n Node> {
        let value = self.take(key);
        if value.is_none() {
            // A mistyped key is reported by `finish`, which names this one as what was meant.
            let mistyped = self.node.entries().iter().any(|e| suggestion::likely(&e.key, [key]).is_some());
            if !mistyped {
                let message = format!("{} lacks the key `{key}`", self.title);
                self.reader.complain(
                    Complaint::new(self.node.span.clone(), message).help(format!("for example: {example}")),
                );
            }
        }
        value
    }

    /// A complaint about a key that has another name today.
    pub(super) fn renamed(&mut self, key: &str, today: &str, meaning: &str) {
        let Some(node) = self.node.get(key) else { return };
        self.asked.push(key.to_owned());
        self.complain(key, node, &format!("is called `{today}` today"), Some(meaning.to_owned()));
    }

    /// A complaint about a value of this table.
    pub(super) fn complain(&self, key: &str, at: &Node, message: &str, help: Option<String>) {
        let mut complaint = Complaint::new(at.span.clone(), format!("`{key}` {message}"));
        complaint.help = help;
        self.reader.complain(complaint);
    }

    pub(super) fn expected(&self, key: &str, at: &Node, what: &str) {
        self.complain(key, at, &format!("expects {what}, found {}", at.kind_name()), None);
    }

    pub(super) fn number_of(&self, key: &str, node: &Node) -> Option<f64> {
        match node.as_number() {
            None => self.expected(key, node, "a number"),
            Some(x) if !x.is_finite() => self.complain(key, node, &format!("must be finite, is {x}"), None),
            Some(x) => return Some(x),
        }
        None
    }

    /// An optional list of one number for each joint.
    pub(super) fn per_joint(&mut self, key: &str) -> Option<Vec<f64>> {
        let node = self.take(key)?;
        let values = self.numbers_of(key, node)?;
        self.one_per_joint(key, node, values.len());
        Some(values)
    }

    /// A list of one number for each joint, none of them zero.
    pub(super) fn factors(&mut self, key: &str) -> Option<Vec<f64>> {
        let values = self.per_joint(key)?;
        self.without_zero(key, values)
    }

    pub(super) fn without_zero(&mut self, key: &str, values: Vec<f64>) -> Option<Vec<f64>> {
        if values.contains(&0.0)
            && let Some(node) = self.take(key)
        {
            self.complain(key, node, "must not be zero", None);
            return None;
        }
        Some(values)
    }

    /// Notes that a list has to have one entry for each joint.
    pub(super) fn one_per_joint(&self, key: &str, node: &Node, found: usize) {
        let (key, span) = (key.to_owned(), node.span.clone());
        self.reader.check_joints(JointCheck::Length { key, found, span });
    }

    /// A complaint about what is neither the name of a recording nor its table.
    pub(super) fn no_recording(&self, key: &str, node: &Node) {
        self.expected(key, node, "file names or tables such as { file = \"…\" }");
    }

    pub(super) fn positive(&mut self, key: &str) -> Option<f64> {
        let node = self.take(key)?;
        let value = self.number_of(key, node)?;
        if value > 0.0 {
            return Some(value);
        }
        self.complain(key, node, &format!("must be above zero, is {value}"), None);
        None
    }

    pub(super) fn not_negative(&mut self, key: &'static str) -> Option<f64> {
        let node = self.take(key)?;
        let value = self.number_of(key, node)?;
        if value >= 0.0 {
            return Some(value);
        }
        self.complain(key, node, &format!("must not be negative, is {value}"), None);
        None
    }

    pub(super) fn numbers_of(&self, key: &str, node: &Node) -> Option<Vec<f64>> {
        let NodeKind::Array(items) = &node.kind else {
            self.expected(key, node, "a list of numbers");
            return None;
        };
        // Every item is looked at, so that every wrong one is reported.
        let numbers: Vec<Option<f64>> = items.iter().map(|item| self.number_of(key, item)).collect();
        numbers.into_iter().collect()
    }

    pub(super) fn numbers_exactly<const N: usize>(
        &self,
        key: &str,
        node: &Node,
        what: &str,
    ) -> Option<[f64; N]> {
        let numbers = self.numbers_of(key, node)?;
        <[f64; N]>::try_from(numbers)
            .map_err(|numbers| {
                self.complain(
                    key,
                    node,
                    &format!("expects {N} numbers ({what}), found {}", numbers.len()),
                    None,
                );
            })
            .ok()
    }

    pub(super) fn indices_of(&self, key: &str, node: &Node, what: &str) -> Option<Vec<usize>> {
        let NodeKind::Array(items) = &node.kind else {
            self.expected(key, node, &format!("a list of {what}"));
            return None;
        };
        let indices: Vec<Option<usize>> = items.iter().map(|item| self.index_of(key, item, what)).collect();
        indices.into_iter().collect()
    }

    pub(super) fn index_of(&self, key: &str, node: &Node, what: &str) -> Option<usize> {
        match &node.kind {
            NodeKind::Integer(n) => {
                let index = usize::try_from(*n).ok();
                if index.is_none() {
                    self.complain(key, node, &format!("counts {what} from 0, found {n}"), None);
                }
                index
            }
            _ => {
                self.expected(key, node, &format!("whole numbers ({what}, from 0)"));
                None
            }
        }
    }

    pub(super) fn boolean(&mut self, key: &'static str) -> Option<bool> {
        let node = self.take(key)?;
        if let NodeKind::Boolean(value) = node.kind {
            return Some(value);
        }
        self.expected(key, node, "true or false");
        None
    }

    pub(super) fn text_of<'t>(&self, key: &str, node: &'t Node) -> Option<&'t str> {
        let text = node.as_str();
        if text.is_none() {
            self.expected(key, node, "a string");
        }
        text
    }

    /// An optional word out of few.
    pub(super) fn choice<T: Copy>(&mut self, key: &'static str, choices: &[(&str, T)]) -> Option<T> {
        let node = self.take(key)?;
        let word = self.text_of(key, node)?;
        let found = choices.iter().find(|(name, _)| *name == word);
        if found.is_none() {
            let help = suggestion::help(word, "values", choices.iter().map(|(name, _)| *name));
            self.complain(key, node, &format!("cannot be \"{word}\""), Some(help));
        }
        found.map(|(_, value)| *value)
    }

    /// A path of an existing file: environment variables expanded, relative to the experiment's folder.
    pub(super) fn file_of(&self, key: &str, node: &Node) -> Option<PathBuf> {
        self.path_of(key, node, "a file", &|_| false)
    }

    /// The file of a recording, or the folder of a LeRobot data set.
    pub(super) fn recording_of(&self, key: &str, node: &Node) -> Option<PathBuf> {
        self.path_of(
            key,
            node,
            "a file, a bag of ROS 2 (with metadata.yaml) or a LeRobot data set (with meta/info.json)",
            &is_recording_folder,
        )
    }

    fn path_of(
        &self,
        key: &str,
        node: &Node,
        expected: &str,
        accepted: &dyn Fn(&Path) -> bool,
    ) -> Option<PathBuf> {
        let path = match paths::resolve(self.text_of(key, node)?, &self.reader.folder) {
            Ok(path) => path,
            Err(unset) => {
                self.complain(key, node, &unset.to_string(), Some(unset.help()));
                return None;
            }
        };
        let problem = match std::fs::metadata(&path) {
            Ok(entry) if entry.is_dir() && !accepted(&path) => format!("is a folder, {expected} is expected"),
            Ok(_) => return Some(path),
            Err(e) if e.kind() == std::io::ErrorKind::NotFound => "does not exist".to_owned(),
            Err(e) => format!("cannot be read: {e}"),
        };
        let help = "relative paths start at the experiment's folder".to_owned();
        self.complain(key, node, &format!("names the file {}, which {problem}", path.display()), Some(help));
        None
    }

    pub(super) fn section(&mut self, key: &'static str) -> Option<Section<'n, 'r>> {
        let node = self.take(key)?;
        Section::new(self.reader, node, format!("[{key}]"))
    }

    pub(super) fn tables(&mut self, key: &'static str) -> &'n [Node] {
        let Some(node) = self.take(key) else { return &[] };
        if let NodeKind::Array(tables) = &node.kind {
            return tables;
        }
        self.complain(
            key,
            node,
            &format!("expects tables, found {}", node.kind_name()),
            Some("write two brackets on either side of the table's name: [[…]]".to_owned()),
        );
        &[]
    }

    /// Complains about keys that nobody asked for.
    pub(super) fn finish(self) {
        // Keys that stand already are no candidates for what another one was meant to be.
        let free: Vec<&str> =
            self.asked.iter().map(String::as_str).filter(|k| self.node.get(k).is_none()).collect();
        let mut known = self.asked.clone();
        known.sort_unstable();
        let known = known.iter().map(|k| format!("`{k}`")).collect::<Vec<_>>().join(", ");
        let unknown = self.node.entries().iter().filter(|e| !self.asked.contains(&e.key));
        for entry in unknown.take(MOST_UNKNOWN_KEYS) {
            let meant =
                suggestion::likely(&entry.key, free.iter().copied()).map(|k| format!("did you mean `{k}`? "));
            let key = clipped(&entry.key);
            self.reader.complain(
                Complaint::new(entry.key_span.clone(), format!("{} has no key `{key}`", self.title))
                    .help(format!("{}known keys: {known}", meant.unwrap_or_default())),
            );
        }
    }
}

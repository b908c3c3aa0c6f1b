//! Running the command in a folder of its own.

use std::env::consts::{DLL_PREFIX, DLL_SUFFIX};
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};
use std::sync::LazyLock;

use aurt_lab::case::{Plan, World};
use serde_json::Value;
use tempfile::TempDir;

use crate::programs::aurt;

/// A folder that is gone after the test.
pub struct Folder(TempDir);

impl Folder {
    pub fn new() -> Self {
        Self(tempfile::tempdir().unwrap())
    }

    pub fn path(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }

    pub fn write(&self, name: &str, text: &str) -> PathBuf {
        let path = self.path(name);
        fs::write(&path, text).unwrap();
        path
    }

    pub fn read(&self, name: &str) -> String {
        fs::read_to_string(self.path(name)).unwrap_or_else(|e| panic!("{name}: {e}"))
    }

    pub fn json(&self, name: &str) -> Value {
        serde_json::from_str(&self.read(name)).unwrap()
    }

    /// Names of what lies in the folder, sorted.
    pub fn names(&self) -> Vec<String> {
        let mut names: Vec<String> = fs::read_dir(self.0.path())
            .unwrap()
            .map(|e| e.unwrap().file_name().into_string().unwrap())
            .collect();
        names.sort();
        names
    }

    pub fn with_demo(self, names: &[&str]) -> Self {
        for name in names {
            fs::copy(DEMO.path("demo").join(name), self.path(name)).unwrap();
        }
        self
    }

    pub fn with_whole_demo(self) -> Self {
        self.with_demo(&WHOLE_DEMO)
    }

    pub fn with_bag(self, names: &[&str]) -> Self {
        let example = Path::new(env!("CARGO_MANIFEST_DIR")).join("../examples/urdf-bag");
        for name in names {
            fs::copy(example.join(name), self.path(name)).unwrap();
        }
        self
    }

    /// Makes the cases of a plan here, in `cases`, and their truths in `sealed`.
    pub fn with_concealed(self, plan: &str, seed: u64) -> Self {
        let plan = Plan::parse(plan, "plan.toml").unwrap();
        let places = ["cases", "sealed"].map(|name| self.path(name));
        places.iter().for_each(|place| fs::create_dir(place).unwrap());
        for index in 0..plan.requests(seed).unwrap().len() {
            plan.make(World::Clean, seed, index).unwrap().write(&places[0], &places[1]).unwrap();
        }
        self
    }

    /// A library of models compiled here from C, the source seen from the repository's root; nothing, with a reason printed, where there
    /// is no C compiler.
    pub fn library(&self, name: &str, source: &str, options: &[&str]) -> Option<PathBuf> {
        let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
        let library = self.path(&format!("{DLL_PREFIX}{name}{DLL_SUFFIX}"));
        let compiler = Command::new("cc")
            .args(["-shared", "-fPIC", "-I"])
            .arg(root.join("aurt-traits/include"))
            .args(options)
            .arg(root.join(source))
            .arg("-o")
            .arg(&library)
            .arg("-lm")
            .output();
        let Ok(output) = compiler else {
            println!("skipped: there is no C compiler `cc`");
            return None;
        };
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
        Some(library)
    }

    /// A library of a model with a fault, as [`library`](Self::library) compiles it.
    pub fn faulty(&self, fault: &str) -> Option<PathBuf> {
        self.library(fault, "aurt-plugins/tests/fixtures/faulty.c", &[&format!("-D{fault}")])
    }

    /// Changes a file of this folder, which has to become another one.
    pub fn edit(&self, name: &str, change: impl FnOnce(&str) -> String) {
        let text = self.read(name);
        let changed = change(&text);
        assert_ne!(text, changed, "{name} is as it was");
        self.write(name, &changed);
    }

    /// Runs `aurt` in this folder with the words of a line.
    pub fn run(&self, line: impl AsRef<str>) -> Run {
        self.aurt(line.as_ref().split_whitespace())
    }

    /// Runs `aurt` in this folder.
    pub fn aurt<S: AsRef<std::ffi::OsStr>>(&self, arguments: impl IntoIterator<Item = S>) -> Run {
        self.aurt_with([], arguments)
    }

    /// Runs `aurt` in this folder with a text on its standard input.
    pub fn aurt_fed<S: AsRef<std::ffi::OsStr>>(
        &self,
        input: String,
        arguments: impl IntoIterator<Item = S>,
    ) -> Run {
        let mut child = Command::new(aurt())
            .args(arguments)
            .current_dir(self.0.path())
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .stderr(Stdio::piped())
            .spawn()
            .unwrap();
        let mut pipe = child.stdin.take().unwrap();
        // A command that refuses its input stops reading it.
        let writer = std::thread::spawn(move || drop(std::io::Write::write_all(&mut pipe, input.as_bytes())));
        let output = child.wait_with_output().unwrap();
        writer.join().unwrap();
        Run(output)
    }

    /// Runs `aurt` in this folder with some variables in its environment.
    pub fn aurt_with<'e, S: AsRef<std::ffi::OsStr>>(
        &self,
        environment: impl IntoIterator<Item = (&'e str, &'e str)>,
        arguments: impl IntoIterator<Item = S>,
    ) -> Run {
        let mut command = Command::new(aurt());
        command
            .args(arguments)
            .current_dir(self.0.path())
            .env_remove("NO_COLOR")
            // Tests' own libraries; what is not trusted has a test of its own.
            .env("AURT_TRUST", "all")
            .envs(environment);
        Run::of(command)
    }
}

/// All that the demo's experiment needs.
pub const WHOLE_DEMO: [&str; 5] =
    ["mdh.csv", "experiment.toml", "exciting_motion.csv", "other_motion.csv", "point_to_point.csv"];

/// A demo that has run, in the folder `demo`.
pub static DEMO: LazyLock<Folder> = LazyLock::new(|| {
    let folder = Folder::new();
    folder.aurt(["demo", "--out", "demo", "--quiet"]).succeeded();
    folder
});

/// Lines of a text, of which one is changed: number from 1.
pub fn with_line(text: &str, number: usize, change: impl Fn(&str) -> String) -> String {
    let mut lines: Vec<String> = text.lines().map(str::to_owned).collect();
    lines[number - 1] = change(&lines[number - 1]);
    lines.join("\n") + "\n"
}

/// A line of comma-separated cells, of which one is replaced: number from 1.
pub fn with_cell(line: &str, number: usize, cell: &str) -> String {
    let mut cells: Vec<&str> = line.split(',').collect();
    cells[number - 1] = cell;
    cells.join(",")
}

pub struct Run(Output);

impl Run {
    pub fn of(mut command: Command) -> Self {
        Self(command.output().unwrap())
    }

    pub fn stdout(&self) -> String {
        String::from_utf8(self.0.stdout.clone()).unwrap()
    }

    pub fn stderr(&self) -> String {
        String::from_utf8(self.0.stderr.clone()).unwrap()
    }

    #[track_caller]
    pub fn json(&self) -> Value {
        serde_json::from_str(&self.stdout()).unwrap_or_else(|e| panic!("{e}: {}", self.stdout()))
    }

    pub fn status(&self) -> i32 {
        self.0.status.code().unwrap()
    }

    #[track_caller]
    pub fn succeeded(self) -> Self {
        assert_eq!(self.status(), 0, "{}{}", self.stdout(), self.stderr());
        self
    }

    /// Asserts that a check or a diagnosis found something: status 1.
    #[track_caller]
    pub fn found(self) -> Self {
        assert_eq!(self.status(), 1, "{}{}", self.stdout(), self.stderr());
        self
    }

    /// Asserts that all went well and that all of `words` were said; hands over what was said.
    #[track_caller]
    pub fn says(self, words: &[&str]) -> String {
        let said = self.succeeded().stdout();
        assert_has(&said, words);
        said
    }

    /// Asserts that the command refused with status 2 and said all of `words`; hands over what it said.
    #[track_caller]
    pub fn refused(self, words: &[&str]) -> String {
        let said = self.stderr();
        assert_eq!(self.status(), 2, "{}{said}", self.stdout());
        assert_eq!(self.stdout(), "", "a refusal belongs to standard error");
        assert_has(&said, words);
        assert!(!said.contains("panicked"), "{said}");
        said
    }
}

/// The folder of real recordings, or a printed reason why a test is skipped.
pub fn real_recordings(test: &str) -> Option<PathBuf> {
    let folder = std::env::var_os("AURT_DATA").map(PathBuf::from);
    match folder {
        Some(folder) if folder.is_dir() => Some(folder),
        _ => {
            println!(
                "skipped: {test} needs real recordings in the folder AURT_DATA (docs/real-recordings.md)"
            );
            None
        }
    }
}

/// A list of numbers in a JSON document.
#[track_caller]
pub fn numbers(value: &Value) -> Vec<f64> {
    let list = value.as_array().unwrap_or_else(|| panic!("no list: {value}"));
    list.iter().map(|v| v.as_f64().unwrap()).collect()
}

#[track_caller]
pub fn assert_has(text: &str, words: &[&str]) {
    for word in words {
        assert!(text.contains(word), "`{word}` is missing in:\n{text}");
    }
}

pub fn one_line(text: &str) -> String {
    text.split_whitespace().collect::<Vec<_>>().join(" ")
}

/// A table, its cells changed below the header where `change` gives another for a row and a column, both from 0.
pub fn with_cells(table: &str, change: impl Fn(usize, usize, &str) -> Option<String>) -> String {
    let (header, rows) = table.split_once('\n').unwrap();
    let row = |(row, line): (usize, &str)| {
        let cell = |(column, cell)| change(row, column, cell).unwrap_or_else(|| cell.to_owned());
        line.split(',').enumerate().map(cell).collect::<Vec<_>>().join(",") + "\n"
    };
    format!("{header}\n") + &rows.lines().enumerate().map(row).collect::<String>()
}

pub fn first_columns(table: &str, count: usize) -> String {
    table.lines().map(|line| line.split(',').take(count).collect::<Vec<_>>().join(",") + "\n").collect()
}

/// The numbers of a table below its header, row by row.
pub fn rows(table: &str) -> Vec<Vec<f64>> {
    table.lines().skip(1).map(|l| l.split(',').map(|cell| cell.parse().unwrap()).collect()).collect()
}

#[track_caller]
pub fn column(table: &str, name: &str) -> Vec<f64> {
    let at = table.lines().next().unwrap().split(',').position(|h| h == name);
    let at = at.unwrap_or_else(|| panic!("{name} is no column"));
    table.lines().skip(1).map(|line| line.split(',').nth(at).unwrap().parse().unwrap()).collect()
}

/// A document with something else in the place of the first of its tables that has this header.
pub fn with_table(toml: &str, header: &str, other: &str) -> String {
    let begin = toml.find(header).unwrap();
    let end = toml[begin + 1..].find("\n[").map_or(toml.len(), |at| begin + at + 2);
    format!("{}{other}{}", &toml[..begin], &toml[end..])
}

pub fn without_constants(toml: &str) -> String {
    toml.lines().filter(|l| !l.starts_with("torque_constants")).map(|l| format!("{l}\n")).collect()
}

/// A path as TOML and command lines take it.
pub fn text(path: &Path) -> String {
    path.to_str().unwrap().to_owned()
}

//! What the documentation shows is true: experiments parse, links lead somewhere, output is what comes out.

use std::fs;
use std::path::{Path, PathBuf};

use aurt_experiment::Experiment;
use aurt_plugins::Registry;

const ROOT: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/..");

fn pages() -> Vec<PathBuf> {
    let root = Path::new(ROOT);
    let mut pages: Vec<PathBuf> =
        ["README.md", "ARCHITECTURE.md", "CONTRIBUTING.md", "CHANGELOG.md"].map(|p| root.join(p)).into();
    for folder in [
        "docs",
        "docs/decisions",
        "examples",
        "examples/1-demo",
        "examples/2-unknown-load",
        "examples/3-friction-sweep",
        "examples/4-mujoco",
        "examples/5-servo",
        "examples/plugin-c",
        "examples/plugin-rust",
        "aurt-calibration/src/drives",
        "aurt-lab/mujoco",
    ] {
        let entries = fs::read_dir(root.join(folder)).into_iter().flatten();
        pages.extend(entries.map(|e| e.unwrap().path()).filter(|p| p.extension().is_some_and(|e| e == "md")));
    }
    pages
}

fn blocks(page: &str, language: &str) -> Vec<String> {
    page.split("\n```")
        .skip(1)
        .step_by(2)
        .filter_map(|block| block.strip_prefix(language)?.strip_prefix('\n'))
        .map(|block| block.to_owned() + "\n")
        .collect()
}

#[test]
fn experiments_in_the_documentation_are_accepted() {
    let mut found = 0;
    for page in pages() {
        let text = fs::read_to_string(&page).unwrap();
        for block in blocks(&text, "toml").into_iter().filter(|b| b.starts_with("schema")) {
            let folder = tempfile::tempdir().unwrap();
            // The files that it names, as far as an experiment looks at them.
            for name in
                block.split('"').skip(1).step_by(2).filter(|n| n.ends_with(".csv") || n.ends_with(".mcap"))
            {
                let contents = if name.ends_with("mdh.csv") {
                    "alpha,a,d\npi/2,0,0.18\n0,-0.61,0\n0,-0.57,0\npi/2,0,0.17\n-pi/2,0,0.12\n0,0,0.12\n"
                } else {
                    ""
                };
                fs::write(folder.path().join(name), contents).unwrap();
            }
            for name in block.split('"').skip(1).step_by(2).filter(|n| n.ends_with(".urdf")) {
                let example = Path::new(ROOT).join("examples/urdf-bag").join(name);
                fs::copy(&example, folder.path().join(name))
                    .unwrap_or_else(|e| panic!("{}: {e}", example.display()));
            }
            let path = folder.path().join("experiment.toml");
            let experiment = Experiment::parse(&block, &path, &mut Registry::linked().unwrap());
            let experiment = experiment.unwrap_or_else(|e| panic!("{}: {e}", page.display()));
            experiment.robot_model().unwrap_or_else(|e| panic!("{}: {e}", page.display()));
            found += 1;
        }
    }
    assert!(found > 0, "no experiment was found");
}

/// A name that has changed would run nothing.
#[test]
fn modules_of_the_reference_tests_exist() {
    let script = fs::read_to_string(Path::new(ROOT).join(".ci/instruction-sets")).unwrap();
    let names = script.split_once("modules=(").and_then(|(_, rest)| rest.split_once(')')).expect("a list").0;
    let crates: Vec<PathBuf> = fs::read_dir(ROOT).unwrap().map(|entry| entry.unwrap().path()).collect();
    for name in names.split_whitespace() {
        let file = format!("tests/all/{name}.rs");
        assert!(crates.iter().any(|folder| folder.join(&file).exists()), "no crate has {file}");
    }
}

#[test]
fn links_lead_somewhere() {
    for page in pages() {
        let text = fs::read_to_string(&page).unwrap();
        for target in text.split("](").skip(1).filter_map(|rest| rest.split(')').next()) {
            let (file, anchor) = target.split_once('#').unwrap_or((target, ""));
            if target.starts_with("http") {
                continue;
            }
            let linked = if file.is_empty() { page.clone() } else { page.parent().unwrap().join(file) };
            assert!(linked.exists(), "{}: there is no {target}", page.display());
            if !anchor.is_empty() {
                let headings = fs::read_to_string(&linked).unwrap();
                let mut headings = headings.lines().filter(|l| l.starts_with('#')).map(as_anchor);
                assert!(headings.any(|h| h == anchor), "{}: there is no {target}", page.display());
            }
        }
    }
}

fn as_anchor(heading: &str) -> String {
    let text = heading.trim_start_matches('#').trim().to_lowercase();
    text.chars()
        .filter(|c| c.is_alphanumeric() || *c == '-' || *c == '_' || *c == ' ')
        .collect::<String>()
        .replace(' ', "-")
}

#[test]
fn commands_in_the_documentation_exist() {
    let commands =
        |crate_: &str| fs::read_to_string(Path::new(ROOT).join(crate_).join("src/commands/mod.rs")).unwrap();
    let (product, laboratory) = (commands("aurt-cli"), commands("aurt-lab"));
    for page in pages() {
        let text = fs::read_to_string(&page).unwrap();
        for line in blocks(&text, "sh").iter().flat_map(|b| b.lines()) {
            let words: Vec<&str> = line.split_whitespace().collect();
            // What stands behind `--` is ours only where cargo runs the program itself.
            let runs = line.contains("cargo run") && !line.contains("--example");
            for (program, commands) in [("aurt", &product), ("aurt-lab", &laboratory)] {
                let command = words.windows(2).find_map(|pair| {
                    let named = pair[0] == program || program == "aurt" && runs && pair[0] == "--";
                    (named && !line.contains(&format!("-p {program} "))).then_some(pair[1])
                });
                let Some(command) = command.filter(|c| c.chars().all(|c| c.is_ascii_lowercase() || c == '-'))
                else {
                    continue;
                };
                let module = format!("mod {};", command.replace('-', "_"));
                assert!(commands.contains(&module), "{}: there is no command in `{line}`", page.display());
            }
        }
    }
}

#[test]
fn pages_stay_short() {
    let pages = pages().into_iter().filter(|page| page.starts_with(Path::new(ROOT).join("docs")));
    let lines: usize = pages.map(|page| fs::read_to_string(page).unwrap().lines().count()).sum();
    assert!(
        (500..=3000).contains(&lines),
        "docs/ has {lines} lines; 3000 are what a reader may be asked for"
    );
}

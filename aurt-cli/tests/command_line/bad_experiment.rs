//! Experiments with mistakes: all of them are told at once, each underlined.

use crate::support::Folder;

#[test]
fn all_mistakes_are_told_at_once_with_their_places() {
    let folder = Folder::new().with_demo(&["mdh.csv", "experiment.toml", "exciting_motion.csv"]);
    let toml = folder
        .read("experiment.toml")
        .replace("model = \"absolute\"", "model = \"absolut\"")
        .replace("powers = [1]", "powers = [\"one\"]")
        .replace("f_dyn_hz", "fdyn_hz")
        .replace("-9.81]", "-9.81, 0.0]");
    folder.write("experiment.toml", &toml);
    let said = folder.run("run experiment.toml --out out").refused(&[
        "experiment.toml:7:16",
        "3 numbers",
        "`absolut`",
        "did you mean `absolute`",
        "has no key `fdyn_hz`",
        "did you mean `f_dyn_hz`",
        "other_motion.csv",
        "does not exist",
        "powers",
    ]);
    assert!(said.contains("fdyn_hz = 5.0"), "the line is not shown in\n{said}");
    assert!(!folder.path("out").exists());
}

#[test]
fn what_is_no_toml_or_not_there() {
    let folder = Folder::new();
    let place = folder.path("").canonicalize().unwrap();
    let place = place.to_str().unwrap().trim_end_matches('/');
    folder.run("run nope.toml --out out").refused(&["nope.toml", "no such file", "aurt demo", place]);
    folder.run("diagnose no/where.toml --out out").refused(&["no folder no either"]);
    folder.write("broken.toml", "schema = 1\n[robot\n");
    folder.run("run broken.toml --out out").refused(&["broken.toml:2", "not TOML"]);
    let near = ["brokn.toml", "there is no such file", "did you mean broken.toml?"];
    folder.run("run brokn.toml --out out").refused(&near);
    let said = folder.run("run nowhere.toml --out out").refused(&["there is no such file"]);
    assert!(said.contains("that folder has broken.toml") && !said.contains("did you mean"), "{said}");
    folder.write("future.toml", "schema = 9\n");
    folder.run("run future.toml --out out").refused(&["future.toml:1:10", "reads schema 1", "[robot]"]);
}

/// Times grew with the square of the number of mistakes.
#[test]
fn a_hundred_thousand_mistakes_are_told_like_one() {
    let folder = Folder::new();
    let tables = (0..50_000).map(|k| format!("[a{k}.b]\n[a{k}]\n"));
    let terms = "[[arm_terms]]\nmodel = \"rotor_inertia\"\n".repeat(3000);
    for (text, line, said) in [
        ("k = ,\n".repeat(100_000), 1, "99900 more problems are not shown"),
        ("x\n".repeat(100_000), 1, "99900 more problems are not shown"),
        ("a.b.c = 1\n".repeat(100_000), 2, "99899 more problems are not shown"),
        (format!("a = {{{}}}", ",".repeat(1_000_000)), 1, "not TOML"),
        (tables.collect(), 4001, "at most 4000 tables"),
        (format!("schema = 1\n{terms}"), 2002, "at most 1000 arm terms, this one 3000"),
    ] {
        folder.write("broken.toml", &text);
        let begin = std::time::Instant::now();
        let place = format!("broken.toml:{line}:");
        folder.run("run broken.toml --out out").refused(&[&place, said]);
        assert!(begin.elapsed().as_secs() < 20, "{said}: {:?}", begin.elapsed());
    }
}

#[test]
fn a_variable_that_is_not_set() {
    let folder = Folder::new().with_demo(&["experiment.toml"]);
    folder.edit("experiment.toml", |text| text.replace("\"mdh.csv\"", "\"${AURT_TEST_UNSET}/mdh.csv\""));
    folder.run("run experiment.toml --out out").refused(&["AURT_TEST_UNSET", "not set"]);
}

//! `aurt-lab prove` and `aurt-lab score`: a small proof in parts, its continuation, what it teaches, and what is refused.

use serde_json::Value;

use crate::lab::{lab, lab_with};
use crate::support::Folder;

const PLAN: &str = "[recordings]\nduration_s = 20.0\nrate_hz = 500.0\n\
    [singles]\nrobots = ['ur10e']\neffects = ['payload', 'torque_ripple', 'saturation']\n\
    strengths = ['strong']\ntrials = 1\n\
    [unknown_effects]\nrobots = ['ur10e']\neffects = ['periodic_disturbance']\nstrengths = ['strong']\ntrials = 1\n\
    [nulls]\nrobots = ['ur10e']\ncount = 2\n";

fn share(of: &Value) -> (Option<u64>, Option<u64>) {
    (of["count"].as_u64(), of["of"].as_u64())
}

/// What the diagnosis is told is a folder of recordings; what it says is compared with what was sealed.
#[test]
fn a_small_proof_in_parts_is_right_and_goes_on_where_it_was() {
    let folder = Folder::new();
    folder.write("plan.toml", PLAN);
    let prove = ["prove", "--world", "clean", "--plan", "plan.toml", "--seed", "5", "--out"];
    for part in ["1/2", "2/2"] {
        let out = format!("part{}", &part[..1]);
        let of = lab(&folder, prove.into_iter().chain([out.as_str(), "--shard", part])).succeeded();
        assert!(of.stdout().contains("clean: 3 of 6 cases, seed 5"), "{}", of.stdout());
    }
    lab(&folder, ["prove", "--collect", "part1", "part2", "--out", "proof"]).succeeded();
    let board = folder.json("proof/scoreboard.json");
    let clean = &board["board"]["worlds"]["clean"];
    let strong = &clean["singles"]["strong"];
    assert_eq!(share(&strong["first_label"]), (Some(3), Some(3)), "{clean:#}");
    assert_eq!(share(&strong["right"]), (Some(3), Some(3)), "{clean:#}");
    assert_eq!(strong["beside"], 0.0, "{clean:#}");
    assert_eq!(share(&clean["nulls_flagged"]), (Some(0), Some(2)));
    assert_eq!(share(&clean["unknown_effects"]), (Some(1), Some(1)));
    assert_eq!(share(&clean["removed"]), (Some(3), Some(3)), "{clean:#}");
    assert!(!folder.path("part1/clean/cases/case_0001").exists(), "recordings are not kept");

    // One verdict is lost: only its case is made again, and the board is the same.
    let text = folder.read("proof/scoreboard.md");
    let kept = folder.path("proof/clean/verdicts/case_0002/verdict.json");
    let written = std::fs::metadata(&kept).unwrap().modified().unwrap();
    std::fs::remove_dir_all(folder.path("proof/clean/verdicts/case_0001")).unwrap();
    let so_far = lab(&folder, ["prove", "--so-far", "--out", "proof"]).succeeded();
    assert!(so_far.stdout().contains("5 of 6 cases"), "{}", so_far.stdout());
    assert!(!folder.path("proof/clean/verdicts/case_0001").exists());
    // A killed proof leaves recordings of cases whose diagnosis ended after it, half-made cases, and claims of diagnoses
    // that were killed when their verdict was in its place.
    let left = ["cases/case_0002", ".aurt-killed.part", "verdicts/case_0002/.aurt-.part"]
        .map(|name| folder.path("proof/clean").join(name));
    for folder in &left {
        std::fs::create_dir_all(folder).unwrap();
        #[cfg(unix)]
        std::fs::set_permissions(folder, std::os::unix::fs::PermissionsExt::from_mode(0o700)).unwrap();
    }
    std::fs::write(left[2].join("lock"), "").unwrap();
    lab(&folder, prove.into_iter().chain(["proof"])).succeeded();
    assert_eq!(folder.read("proof/scoreboard.md"), text);
    assert_eq!(std::fs::metadata(&kept).unwrap().modified().unwrap(), written);
    assert!(!left.iter().any(|folder| folder.exists()), "{left:?}");

    let (sealed, verdicts) = ("proof/clean/sealed", "proof/clean/verdicts");
    let scored = lab(&folder, ["score", "--sealed", sealed, "--verdicts", verdicts, "--json"]).succeeded();
    let scored: Value = serde_json::from_str(&scored.stdout()).unwrap();
    assert_eq!(scored["board"]["worlds"]["clean"]["singles"], clean["singles"]);

    let other =
        lab(&folder, ["prove", "--world", "clean", "--plan", "plan.toml", "--seed", "6", "--out", "proof"]);
    assert_eq!(other.status(), 2);
    assert!(other.stderr().contains("another plan or seed"), "{}", other.stderr());

    // A diagnosis that gives no verdict is no right one.
    std::fs::remove_file(&kept).unwrap();
    folder.write("proof/clean/verdicts/case_0002/failed.txt", "error: it broke");
    let failed = lab(&folder, ["prove", "--so-far", "--out", "proof", "--learn", "learnt.json"]);
    assert_eq!(failed.status(), 1);
    assert!(failed.stdout().contains("clean case_0002: error: it broke"), "{}", failed.stdout());
    assert_eq!(folder.json("proof/scoreboard.json")["board"]["worlds"]["clean"]["failed"], 1);

    // What was learnt says from what, and a diagnosis reads it.
    let learnt = folder.json("learnt.json");
    assert_eq!(learnt["learnt_from"][0]["world"], "clean");
    assert_eq!(
        (&learnt["learnt_from"][0]["seed"], &learnt["learnt_from"][0]["cases"]),
        (&5.into(), &6.into())
    );
    lab(&folder, ["prove", "--learn", "again.json", "--proof", "proof"]).succeeded();
    assert_eq!(folder.read("again.json"), folder.read("learnt.json"));
}

/// Cases are diagnosed again in each variant, some or all of them; of the variants the verdicts stay.
#[test]
fn variants_of_cases_are_counted_and_their_recordings_go() {
    let folder = Folder::new();
    folder.write(
        "plan.toml",
        "[recordings]\nduration_s = 12.0\nrate_hz = 250.0\n[nulls]\nrobots = ['two_link']\ncount = 2\n",
    );
    let prove = ["prove", "--world", "clean", "--plan", "plan.toml", "--seed", "5", "--no-removal"];
    let invariance = |more: &[&str]| {
        let run = lab(
            &folder,
            prove.into_iter().chain(["--out", "proof", "--invariance"]).chain(more.iter().copied()),
        );
        assert!(run.succeeded().stdout().contains("| `other_order` | "));
        folder.json("proof/scoreboard.json")["board"]["worlds"]["clean"]["invariance"].clone()
    };
    let one = invariance(&["1"]);
    assert_eq!((&one["same"]["of"], &one["halves"]["of"]), (&5.into(), &1.into()), "{one:#}");
    let kept = folder.path("proof/clean/variants/half_rate/case_0001/verdict.json");
    let written = std::fs::metadata(&kept).unwrap().modified().unwrap();
    let all = invariance(&[]);
    assert_eq!((&all["same"]["of"], &all["halves"]["of"]), (&10.into(), &2.into()), "{all:#}");
    assert_eq!(std::fs::metadata(&kept).unwrap().modified().unwrap(), written);
    assert_eq!(std::fs::read_dir(folder.path("proof/clean/cases")).unwrap().count(), 0);
}

#[test]
fn a_world_that_cannot_be_made_here_is_skipped_with_a_line() {
    let folder = Folder::new();
    folder.write("world.py", "");
    let nowhere = [("AURT_PYTHON", "no-such-python"), ("AURT_MUJOCO_WORLD", "world.py")];
    let skipped = lab_with(
        &folder,
        nowhere,
        ["prove", "--small", "--world", "mujoco", "--world", "injected", "--seed", "1", "--out", "p"],
    )
    .succeeded();
    let said = skipped.stdout();
    assert!(said.contains("world mujoco: skipped: no-such-python cannot import mujoco"), "{said}");
    assert!(said.contains("world injected: skipped: "), "{said}");
    assert!(said.contains("| what is counted | mujoco | injected |"), "{said}");
}

#[test]
fn a_proof_that_makes_no_sense_is_refused() {
    let folder = Folder::new();
    let refused = |arguments: &[&str], why: &str| {
        let run = lab(&folder, std::iter::once("prove").chain(arguments.iter().copied()));
        assert_eq!(run.status(), 2, "{arguments:?}");
        assert!(run.stderr().contains(why), "{arguments:?}: {}", run.stderr());
    };
    refused(&["--world", "moon", "--seed", "1", "--out", "p"], "known are clean, rough, mujoco, injected");
    refused(&["--shard", "9/8", "--seed", "1", "--out", "p"], "write 3/8");
    refused(&["--so-far", "--out", "p"], "holds no proof");
    refused(&["--collect", "q", "--out", "p"], "holds no proof");
    refused(&["--proof", "q"], "--learn");
    refused(&["--out", "p"], "--seed");
}

#[test]
fn a_verdict_that_says_something_else_or_too_much_is_scored_as_wrong() {
    let folder = Folder::new().with_concealed(
        "[singles]\nrobots = ['ur10e']\neffects = ['payload']\nstrengths = ['strong']\ntrials = 1\n",
        1,
    );
    let present = &folder.json("sealed/case_0001.json")["effects"][0]["present_in"];
    let said = |word: &str, effects: &[&str]| {
        std::fs::create_dir_all(folder.path("said/case_0001")).unwrap();
        let effects: Vec<String> = effects
            .iter()
            .map(|e| format!(r#"{{"effect": "{e}", "joints": [1], "present_in": {present}}}"#))
            .collect();
        let text = format!(r#"{{"verdict": "{word}", "effects": [{}]}}"#, effects.join(", "));
        folder.write("said/case_0001/verdict.json", &text);
        lab(&folder, ["score", "--sealed", "sealed", "--verdicts", "said", "--out", "board.json"])
            .succeeded();
        let strong = folder.json("board.json")["board"]["worlds"]["clean"]["singles"]["strong"].clone();
        let count = |what: &str| strong[what]["count"].as_u64().unwrap();
        (count("right"), count("first_label"), strong["beside"].as_f64().unwrap())
    };
    assert_eq!(said("named", &["payload"]), (1, 1, 0.0));
    assert_eq!(said("unexplained", &["payload"]), (0, 1, 0.0));
    assert_eq!(said("named", &["base_tilt"]), (0, 0, 1.0));
    assert_eq!(said("named", &["payload", "stribeck"]), (0, 1, 1.0));
    let nothing = lab(&folder, ["score", "--sealed", "sealed", "--verdicts", "cases"]);
    assert_eq!(nothing.status(), 2);
    let nowhere = lab(&folder, ["score", "--sealed", "no", "--verdicts", "said"]);
    assert_eq!(nowhere.status(), 2);
}

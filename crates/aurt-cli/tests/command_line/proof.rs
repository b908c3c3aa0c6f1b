//! `aurt prove` and `aurt score`: a small proof, its continuation, and what they refuse.

use crate::support::Folder;

const PLAN: &str = "[recordings]\nduration_s = 20.0\nrate_hz = 500.0\n\
    [singles]\nrobots = ['ur10e']\neffects = ['payload', 'torque_ripple', 'saturation']\n\
    strengths = ['strong']\ntrials = 1\n\
    [strangers]\nrobots = ['ur10e']\neffects = ['periodic_disturbance']\nstrengths = ['strong']\ntrials = 1\n\
    [nulls]\nrobots = ['ur10e']\ncount = 2\n";

/// What the diagnosis is told is a folder of recordings; what it says is compared with what was sealed.
#[test]
fn a_small_proof_is_right_and_goes_on_where_it_was() {
    let folder = Folder::new();
    folder.write("plan.toml", PLAN);
    let prove = ["prove", "--plan", "plan.toml", "--seed", "5", "--out", "proof"];
    folder.aurt(prove).succeeded();
    let board = folder.json("proof/scoreboard.json");
    let count = |of: &str| (board["board"][of]["count"].as_u64(), board["board"][of]["of"].as_u64());
    assert_eq!(board["board"]["singles"]["strong"]["count"], 3, "{board:#}");
    assert_eq!(count("nulls_flagged"), (Some(0), Some(2)));
    assert_eq!(count("strangers"), (Some(1), Some(1)));
    assert_eq!(count("removed"), (Some(3), Some(3)), "{board:#}");
    assert!(!folder.path("proof/cases/case_0001").exists(), "recordings are not kept");
    assert!(board["methods"]["lasso"].is_object());

    // One verdict is lost: only its case is made again, and the board is the same.
    let text = folder.read("proof/scoreboard.md");
    let kept = folder.path("proof/verdicts/case_0002/verdict.json");
    let written = std::fs::metadata(&kept).unwrap().modified().unwrap();
    std::fs::remove_dir_all(folder.path("proof/verdicts/case_0001")).unwrap();
    let so_far = folder.aurt(prove.into_iter().chain(["--so-far"])).succeeded();
    assert!(so_far.stdout().contains("5 of 6 cases"), "{}", so_far.stdout());
    assert!(!folder.path("proof/verdicts/case_0001").exists());
    folder.aurt(prove).succeeded();
    assert_eq!(folder.read("proof/scoreboard.md"), text);
    assert_eq!(std::fs::metadata(&kept).unwrap().modified().unwrap(), written);

    let scored = folder
        .aurt(["score", "--sealed", "proof/sealed", "--verdicts", "proof/verdicts", "--json"])
        .succeeded();
    let scored: serde_json::Value = serde_json::from_str(&scored.stdout()).unwrap();
    assert_eq!(scored["board"]["singles"], board["board"]["singles"]);

    let other = folder.aurt(["prove", "--plan", "plan.toml", "--seed", "6", "--out", "proof"]);
    assert_eq!(other.status(), 2);
    assert!(other.stderr().contains("another plan or seed"), "{}", other.stderr());
}

#[test]
fn a_verdict_that_says_something_else_is_scored_as_wrong() {
    let folder = Folder::new();
    folder.write(
        "plan.toml",
        "[singles]\nrobots = ['ur10e']\neffects = ['payload']\nstrengths = ['strong']\ntrials = 1\n",
    );
    folder
        .aurt(["conceal", "--plan", "plan.toml", "--seed", "1", "--cases", "cases", "--sealed", "sealed"])
        .succeeded();
    let verdict = |effect: &str| {
        std::fs::create_dir_all(folder.path("said/case_0001")).unwrap();
        let text = format!(r#"{{"verdict": "named", "effects": [{{"effect": "{effect}", "joints": [1]}}]}}"#);
        folder.write("said/case_0001/verdict.json", &text);
        folder.aurt(["score", "--sealed", "sealed", "--verdicts", "said", "--out", "board.json"]).succeeded();
        folder.json("board.json")["board"]["singles"]["strong"]["count"].as_u64()
    };
    assert_eq!(verdict("payload"), Some(1));
    assert_eq!(verdict("base_tilt"), Some(0));
    let nothing = folder.aurt(["score", "--sealed", "sealed", "--verdicts", "cases"]);
    assert_eq!(nothing.status(), 2);
    let nowhere = folder.aurt(["score", "--sealed", "no", "--verdicts", "said"]);
    assert_eq!(nowhere.status(), 2);
}

//! `aurt diagnose --without EFFECT`: removed means removed.

use serde_json::Value;

use crate::support::Folder;

const PLAN: &str = "[recordings]\nduration_s = 10.0\n[singles]\nrobots = ['ur10e', 'tx40']\neffects = ['backlash']\n\
                    strengths = ['strong']\ntrials = 4\n";

/// The diagnosis that may not name play does not look for it either: it has no reason to say that something is
/// unexplained but what it shows, which is structure on a joint, an effect or a registered model.
#[test]
fn an_effect_that_is_withheld_is_not_looked_for() {
    let folder = Folder::new().with_concealed(PLAN, 3);
    for case in ["case_0001", "case_0004"] {
        let experiment = format!("cases/{case}/experiment.toml");
        folder.run(format!("diagnose {experiment} --verdict-only --without backlash --out said"));
        let verdict = folder.json("said/verdict.json");
        let some = |key: &str| verdict[key].as_array().is_some_and(|list| !list.is_empty());
        assert!(!names(&verdict).contains(&"backlash".to_owned()), "{verdict:#}");
        let left = verdict["residual"].as_array().unwrap().iter().any(|r| r["structure_left"] == true);
        let has_reason = left || some("effects") || some("registered_models");
        assert!(
            verdict["verdict"] != "unexplained" || has_reason,
            "{case} is unexplained without a reason: {verdict:#}"
        );
    }
}

fn names(verdict: &Value) -> Vec<String> {
    let name = |e: &Value| e["effect"].as_str().unwrap_or_default().to_owned();
    verdict["effects"].as_array().into_iter().flatten().map(name).collect()
}

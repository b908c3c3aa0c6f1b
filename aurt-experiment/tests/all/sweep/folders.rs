//! What is kept, what is found again, and who may work in a folder.

use std::fs;

use aurt_experiment::sweep::{Folder, Outcome, Plan, Ranking, Rows, SweepError, run_point};

use super::bench::{Bench, contents, registry};

const GRID: &str = "[sweep.grid]\n\"joint_dynamics.coulomb.model\" = [\"none\", \"square\", \"absolute\"]\n\
                    \"joint_dynamics.viscous.powers\" = [[1], [1, 3]]\n";

#[test]
fn nothing_is_computed_twice_and_what_is_lost_is_made_again() {
    let bench = Bench::new(GRID);
    let (plan, first) = bench.run("out");
    assert_eq!((first.run, first.present), (6, 0));
    let whole = contents(&bench.path("out"));
    assert_eq!((bench.run("out").1.run, bench.run("out").1.present), (0, 6));
    for (k, spoiled) in [("gone", None), ("half", Some("{\"schema\": 1, \"key\""))].into_iter().enumerate() {
        let path = bench.path(&format!("out/results/{}.json", plan.points[k].key));
        match spoiled.1 {
            None => fs::remove_file(&path).unwrap(),
            Some(text) => fs::write(&path, text).unwrap(),
        }
    }
    // What a killed process was writing is no result and goes.
    let left = bench.path("out/results/.aurt-abc.part");
    fs::create_dir(&left).unwrap();
    make_private(&left);
    fs::write(left.join("lock"), "").unwrap();
    fs::write(left.join("1-0"), "{").unwrap();
    assert_eq!(bench.run("out").1.run, 2);
    assert_eq!(contents(&bench.path("out")), whole);
}

/// Gives a folder the permissions of one for unfinished results.
fn make_private(folder: &std::path::Path) {
    #[cfg(unix)]
    fs::set_permissions(folder, std::os::unix::fs::PermissionsExt::from_mode(0o700)).unwrap();
    #[cfg(not(unix))]
    let _ = folder;
}

#[test]
fn an_extended_sweep_keeps_what_it_has() {
    let bench = Bench::new(GRID);
    bench.run("out");
    bench.write(&GRID.replace("[[1], [1, 3]]", "[[1], [1, 3], [1, 2, 3]]"));
    let (plan, summary) = bench.run("out");
    assert_eq!((summary.run, summary.present, plan.points.len()), (3, 6, 9));
    bench.write(&GRID.replace("[[1], [1, 3]]", "[[1]]"));
    let (plan, summary) = bench.run("out");
    assert_eq!((summary.run, plan.points.len()), (0, 3));
    assert!(!bench.path("out/points/0004.toml").exists() && bench.path("out/points/0003.toml").exists());
}

#[test]
fn a_key_covers_recordings_geometry_and_judging() {
    let bench = Bench::new(GRID);
    let keys = || -> Vec<String> {
        let sweep = bench.read().unwrap();
        Plan::of(&sweep, &registry()).unwrap().points.into_iter().map(|p| p.key).collect()
    };
    let first = keys();
    assert_eq!(first, keys());
    let mut all = first.clone();
    all.sort();
    all.dedup();
    assert_eq!(all.len(), 6);
    for file in ["a.csv", "d.csv", "mdh.csv"] {
        let path = bench.path(file);
        let text = fs::read_to_string(&path).unwrap();
        fs::write(&path, format!("{text}\n")).unwrap();
        assert!(keys().iter().all(|k| !first.contains(k)), "{file}");
        fs::write(&path, text).unwrap();
    }
    assert_eq!(first, keys());
    bench.write(&format!("[sweep]\nblock_s = 2.0\n{GRID}"));
    assert!(keys().iter().all(|k| !first.contains(k)));
    bench.write(&format!("[sweep]\nvalidate = \"leave_one_out\"\n{GRID}"));
    assert!(keys().iter().all(|k| !first.contains(k)));
    // A comment changes nothing.
    bench.write(&format!("# words\n{GRID}"));
    assert_eq!(first, keys());
}

#[test]
fn one_sweep_at_a_time_works_in_a_folder() {
    let bench = Bench::new(GRID);
    let sweep = bench.read().unwrap();
    let out = bench.path("out");
    let held = Folder::for_sweep(&out, &sweep).unwrap();
    assert!(matches!(Folder::for_sweep(&out, &sweep), Err(SweepError::Locked { .. })));
    held.write_plan(&sweep, &Plan::of(&sweep, &registry()).unwrap()).unwrap();
    assert!(matches!(Folder::shared(&out), Err(SweepError::Locked { .. })));
    assert!(Folder::planned(&out).is_ok());
    drop(held);
    // Jobs of an array work side by side, but not beside the whole sweep.
    let (one, two) = (Folder::shared(&out).unwrap(), Folder::shared(&out).unwrap());
    assert!(matches!(Folder::for_sweep(&out, &sweep), Err(SweepError::Locked { .. })));
    drop((one, two));
    assert!(Folder::for_sweep(&out, &sweep).is_ok());
}

#[test]
fn folders_of_others_are_refused() {
    let (bench, other) = (Bench::new(GRID), Bench::new(GRID));
    bench.run("out");
    let error = Folder::for_sweep(&bench.path("out"), &other.read().unwrap()).unwrap_err();
    assert!(error.to_string().contains("another experiment"), "{error}");
    let error = Folder::for_sweep(bench.folder.path(), &bench.read().unwrap()).unwrap_err();
    assert!(error.to_string().contains("no sweep's"), "{error}");
    let error = Folder::for_sweep(&bench.path("a.csv"), &bench.read().unwrap()).unwrap_err();
    assert!(error.to_string().contains("is a file"), "{error}");
    assert!(Folder::planned(bench.folder.path()).is_err());
}

#[test]
fn points_by_themselves_make_what_the_whole_makes() {
    let bench = Bench::new(GRID);
    bench.run("whole");
    let sweep = bench.read().unwrap();
    let planned = Folder::for_sweep(&bench.path("parts"), &sweep).unwrap();
    planned.write_plan(&sweep, &Plan::of(&sweep, &registry()).unwrap()).unwrap();
    drop(planned);
    let folder = Folder::shared(&bench.path("parts")).unwrap();
    for number in [3, 1, 6, 2, 5, 4, 4] {
        assert!(run_point(&folder, number, &mut registry()).unwrap());
    }
    assert_eq!(contents(&bench.path("parts")), contents(&bench.path("whole")));
    let refused = |number| run_point(&folder, number, &mut registry()).unwrap_err();
    assert!(matches!(refused(0), SweepError::NoPoint { .. }));
    assert!(matches!(refused(7), SweepError::NoPoint { points: 6, .. }));
    // A recording that has changed since the plan makes another point of it.
    fs::write(bench.path("a.csv"), fs::read_to_string(bench.path("a.csv")).unwrap() + "\n").unwrap();
    assert!(matches!(refused(1), SweepError::Stale { index: 1, .. }));
}

#[test]
fn points_without_recordings_fail_and_say_why() {
    let bench = Bench::new(GRID);
    let sweep = bench.read().unwrap();
    let folder = Folder::for_sweep(&bench.path("out"), &sweep).unwrap();
    let plan = Plan::of(&sweep, &registry()).unwrap();
    folder.write_plan(&sweep, &plan).unwrap();
    fs::remove_file(bench.path("a.csv")).unwrap();
    let summary = aurt_experiment::sweep::run(&sweep, &plan, &folder, &|_| ()).unwrap();
    assert_eq!((summary.run, summary.failed), (6, 6));
    let result = folder.result(&plan.points[0].key).unwrap();
    assert!(matches!(&result.outcome, Outcome::Failed(e) if e.contains("a.csv")));
}

#[test]
fn a_sweep_that_was_ended_while_it_was_planned_is_planned_again() {
    let bench = Bench::new(GRID);
    bench.run("whole");
    let whole = contents(&bench.path("whole"));
    // Everything that a sweep makes before its plan, in the order in which it makes it.
    let made: [&[&str]; 4] = [
        &["lock"],
        &["lock", "points/0001.toml", "points/.aurt-abc.part/lock"],
        &["lock", "points/0001.toml", "results/.aurt-abc.part/lock", "experiment.toml"],
        &[
            "lock",
            "points/0001.toml",
            "results/.aurt-abc.part/lock",
            "experiment.toml",
            ".aurt-abc.part/lock",
        ],
    ];
    for (k, files) in made.into_iter().enumerate() {
        let out = format!("out{k}");
        for file in files {
            let path = bench.path(&format!("{out}/{file}"));
            fs::create_dir_all(path.parent().unwrap()).unwrap();
            fs::write(&path, "").unwrap();
            if file.ends_with("/lock") {
                make_private(path.parent().unwrap());
            }
        }
        bench.run(&out);
        assert!(contents(&bench.path(&out)) == whole, "{files:?}");
    }
    // A folder of somebody else's that merely has such names is not taken.
    fs::create_dir_all(bench.path("mine/points")).unwrap();
    fs::write(bench.path("mine/experiment.toml"), "").unwrap();
    assert!(Folder::for_sweep(&bench.path("mine"), &bench.read().unwrap()).is_err());
}

#[test]
fn a_result_that_was_changed_is_none() {
    let bench = Bench::new(GRID);
    let (plan, _) = bench.run("out");
    let whole = contents(&bench.path("out"));
    let path = bench.path(&format!("out/results/{}.json", plan.points[1].key));
    let text = fs::read_to_string(&path).unwrap();
    let at = text.find("\"squared_error\": ").unwrap() + "\"squared_error\": ".len();
    let digit = if &text[at..=at] == "9" { "1" } else { "9" };
    fs::write(&path, format!("{}{digit}{}", &text[..at], &text[at + 1..])).unwrap();
    let folder = Folder::planned(&bench.path("out")).unwrap();
    let ranking = Ranking::of(&folder, &plan, Rows::All);
    assert_eq!((ranking.missing, folder.damaged()), (vec![2], vec![path]));
    assert_eq!(bench.run("out").1.run, 1);
    assert!(contents(&bench.path("out")) == whole);
}

#[test]
fn a_plan_whose_reference_is_no_point_is_refused() {
    let bench = Bench::new(GRID);
    bench.run("out");
    let path = bench.path("out/sweep.json");
    let text = fs::read_to_string(&path).unwrap();
    for number in ["6", "18446744073709551615"] {
        fs::write(&path, text.replace("\"reference\": 0", &format!("\"reference\": {number}"))).unwrap();
        let error = Folder::planned(&bench.path("out")).unwrap().plan().unwrap_err().to_string();
        assert!(error.contains("sweep.json") && error.contains(&format!("point {number}")), "{error}");
    }
}

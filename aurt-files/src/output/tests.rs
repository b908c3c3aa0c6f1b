use std::collections::BTreeMap;
use std::fs;
use std::path::Path;

use super::*;

fn contents(folder: &Path) -> BTreeMap<String, String> {
    let entries = fs::read_dir(folder).unwrap().map(|entry| entry.unwrap());
    entries
        .map(|entry| {
            let text = fs::read_to_string(entry.path()).unwrap_or_else(|_| "a folder".into());
            (entry.file_name().to_string_lossy().into_owned(), text)
        })
        .collect()
}

fn listed<const N: usize>(entries: [(&str, &str); N]) -> BTreeMap<String, String> {
    entries.map(|(name, text)| (name.to_owned(), text.to_owned())).into()
}

#[test]
fn files_are_replaced_and_nothing_is_left_beside_them() {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("a"), "old").unwrap();
    fs::write(folder.path().join("other"), "stays").unwrap();
    write_folder(folder.path(), &[("a", "1"), ("b", "2")]).unwrap();
    assert_eq!(contents(folder.path()), listed([("a", "1"), ("b", "2"), ("other", "stays")]));
}

#[test]
fn an_error_takes_back_what_was_renamed_before_it() {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("a"), "old").unwrap();
    // A folder cannot be replaced by a file; that is noticed when the file before it is renamed already.
    fs::create_dir(folder.path().join("c")).unwrap();
    let error = write_folder(folder.path(), &[("a", "1"), ("b", "2"), ("c", "3")]).unwrap_err();
    assert!(error.path.ends_with("c"), "{error}");
    assert_eq!(contents(folder.path()), listed([("a", "old"), ("c", "a folder")]));
}

#[test]
fn a_new_folder_appears_whole_with_folders_below() {
    let parent = tempfile::tempdir().unwrap();
    let folder = parent.path().join("results");
    write_folder(&folder, &[("a", "1"), ("below/b", "2")]).unwrap();
    assert_eq!(fs::read_to_string(folder.join("below/b")).unwrap(), "2");
    assert_eq!(contents(parent.path()).len(), 1);
}

#[test]
fn a_folder_that_cannot_be_filled_does_not_appear() {
    let parent = tempfile::tempdir().unwrap();
    let folder = parent.path().join("results");
    assert!(write_folder(&folder, &[("a", "1"), ("a/b", "2")]).is_err());
    assert!(contents(parent.path()).is_empty());
}

#[test]
fn a_staged_folder_that_an_interruption_removed_is_not_made_again() {
    let parent = tempfile::tempdir().unwrap();
    let staged = parent.path().join("staged");
    fs::create_dir(&staged).unwrap();
    make_below(&staged, Path::new("a/b/file")).unwrap();
    make_below(&staged, Path::new("a/file")).unwrap();
    assert!(staged.join("a/b").is_dir());
    fs::remove_dir_all(&staged).unwrap();
    assert!(make_below(&staged, Path::new("a/file")).is_err());
    make_below(&staged, Path::new("file")).unwrap();
    assert!(contents(parent.path()).is_empty());
}

fn private_folder(path: &Path) {
    fs::create_dir(path).unwrap();
    #[cfg(unix)]
    fs::set_permissions(path, std::os::unix::fs::PermissionsExt::from_mode(0o700)).unwrap();
}

/// A claim as a killed process leaves it: nobody holds its lock.
fn abandoned(folder: &Path, name: &str) {
    let claim = folder.join(name);
    private_folder(&claim);
    fs::write(claim.join("lock"), "").unwrap();
    fs::write(claim.join("1-0"), "half").unwrap();
    fs::create_dir(claim.join("1-1")).unwrap();
    fs::write(claim.join("1-1/metrics.json"), "half").unwrap();
}

#[test]
fn what_a_killed_process_left_is_removed_by_whoever_writes_to_that_place_or_clears_its_folder() {
    let parent = tempfile::tempdir().unwrap();
    let folder = parent.path().canonicalize().unwrap();
    abandoned(&folder, ".aurt-a.part");
    write_file(&folder.join("a"), b"1").unwrap();
    assert_eq!(take_cleared().remove(&folder), Some(1));
    assert_eq!(contents(&folder), listed([("a", "1")]));
    // It was killed while it staged a folder that somebody has made since then, and within that.
    abandoned(&folder, ".aurt-out.part");
    fs::create_dir(folder.join("out")).unwrap();
    abandoned(&folder.join("out"), ".aurt-.part");
    write_folder(&folder.join("out"), &[("b", "2")]).unwrap();
    assert_eq!(contents(&folder), listed([("a", "1"), ("out", "a folder")]));
    assert_eq!(contents(&folder.join("out")), listed([("b", "2")]));
    // It was killed before it had locked anything, and while it staged something else.
    private_folder(&folder.join(".aurt-c.part"));
    abandoned(&folder, ".aurt-1-7.part");
    assert_eq!(take_cleared().remove(&folder), Some(1));
    clear_unfinished(&folder);
    assert_eq!(contents(&folder), listed([("a", "1"), ("out", "a folder")]));
    assert_eq!(take_cleared().remove(&folder), Some(1));
}

#[test]
fn what_somebody_holds_is_refused_and_stays() {
    let parent = tempfile::tempdir().unwrap();
    let folder = parent.path().canonicalize().unwrap();
    let held = folder.join(".aurt-a.part");
    abandoned(&folder, ".aurt-a.part");
    // Another description of the lock, as another process has one.
    let other = fs::File::options().write(true).open(held.join("lock")).unwrap();
    other.lock().unwrap();
    clear_unfinished(&folder);
    let error = write_file(&folder.join("a"), b"1").unwrap_err();
    assert_eq!(error.source.kind(), io::ErrorKind::ResourceBusy);
    assert!(error.to_string().contains("another run writes there"), "{error}");
    assert!(held.join("1-0").exists() && !folder.join("a").exists());
    drop(other);
    write_file(&folder.join("a"), b"1").unwrap();
    assert_eq!(contents(&folder), listed([("a", "1")]));
    // Threads of one process share what it holds.
    let _held = Claim::folder(&folder).unwrap();
    write_folder(&folder, &[("b", "2")]).unwrap();
    assert!(folder.join(".aurt-.part/lock").is_file());
}

#[test]
fn a_journal_of_somebody_else_is_not_read() {
    let parent = tempfile::tempdir().unwrap();
    let folder = parent.path();
    let at = |name: &str| folder.join(name);
    fs::write(at("victim"), "stays").unwrap();
    fs::write(at("forged"), "forged").unwrap();
    let (forged, victim) = (at("forged"), at("victim"));
    let journal = format!("{}\0{}\0\0complete\n", forged.display(), victim.display());
    private_folder(&at(".aurt-a.part"));
    for place in [".aurt-1.journal", ".aurt-a.part/journal", ".aurt-1.part"] {
        fs::write(at(place), &journal).unwrap();
    }
    #[cfg(unix)]
    std::os::unix::fs::symlink(&victim, at(".aurt-2.part")).unwrap();
    write_file(&at("a"), b"1").unwrap();
    write_folder(folder, &[("b", "2")]).unwrap();
    clear_unfinished(folder);
    assert_eq!(fs::read_to_string(victim).unwrap(), "stays");
    assert_eq!(fs::read_to_string(forged).unwrap(), "forged");
    // What is not made like ours stays; what is named like ours for `a` is ours.
    assert!(at(".aurt-1.journal").exists() && at(".aurt-1.part").exists() && !at(".aurt-a.part").exists());
}

#[cfg(unix)]
#[test]
fn a_place_for_unfinished_results_that_others_may_change_is_not_used() {
    use std::os::unix::fs::{PermissionsExt, symlink};
    let parent = tempfile::tempdir().unwrap();
    let at = |name: &str| parent.path().join(name);
    fs::create_dir(at("elsewhere")).unwrap();
    fs::write(at("elsewhere/precious"), "stays").unwrap();
    symlink(at("elsewhere"), at(".aurt-a.part")).unwrap();
    fs::create_dir(at(".aurt-b.part")).unwrap();
    fs::set_permissions(at(".aurt-b.part"), fs::Permissions::from_mode(0o777)).unwrap();
    for name in ["a", "b"] {
        let error = write_file(&at(name), b"1").unwrap_err().to_string();
        assert!(error.contains("no folder of yours alone"), "{error}");
    }
    // A lock that is no file is removed, not opened.
    private_folder(&at(".aurt-c.part"));
    let pipe = at(".aurt-c.part/lock");
    assert!(std::process::Command::new("mkfifo").arg(&pipe).status().unwrap().success());
    write_file(&at("c"), b"1").unwrap();
    assert_eq!(fs::read_to_string(at("elsewhere/precious")).unwrap(), "stays");
}

#[cfg(unix)]
#[test]
fn a_link_among_the_files_of_a_folder_is_replaced() {
    let parent = tempfile::tempdir().unwrap();
    let at = |name: &str| parent.path().join(name);
    fs::create_dir(at("out")).unwrap();
    fs::write(at("recording"), "stays").unwrap();
    std::os::unix::fs::symlink(at("recording"), at("out/metrics.json")).unwrap();
    write_folder(&at("out"), &[("metrics.json", "{}"), ("below/figure", "f")]).unwrap();
    assert_eq!(fs::read_to_string(at("recording")).unwrap(), "stays");
    assert_eq!(contents(&at("out")), listed([("metrics.json", "{}"), ("below", "a folder")]));
    assert_eq!(contents(&at("out/below")), listed([("figure", "f")]));
}

#[test]
fn names_of_any_length_have_a_place() {
    let parent = tempfile::tempdir().unwrap();
    let name = "x".repeat(255);
    write_folder(&parent.path().join(&name), &[(&name, "1")]).unwrap();
    write_file(&parent.path().join(&name).join(&name), b"2").unwrap();
    assert_eq!(contents(&parent.path().join(&name)), listed([(&name, "2")]));
}

#[cfg(unix)]
#[test]
fn new_files_and_folders_get_the_permissions_of_any_new_one() {
    use std::os::unix::fs::PermissionsExt;
    let parent = tempfile::tempdir().unwrap();
    let at = |name: &str| parent.path().join(name);
    fs::create_dir(at("plain")).unwrap();
    fs::write(at("plain/file"), "").unwrap();
    write_folder(&at("ours"), &[("file", "")]).unwrap();
    write_file(&at("ours/other"), b"").unwrap();
    let mode = |name: &str| fs::metadata(at(name)).unwrap().permissions().mode();
    assert_eq!(mode("ours"), mode("plain"));
    assert_eq!(mode("ours/file"), mode("plain/file"));
    assert_eq!(mode("ours/other"), mode("plain/file"));
}

#[cfg(unix)]
#[test]
fn a_pipe_without_a_reader_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    let pipe = folder.path().join("pipe");
    assert!(std::process::Command::new("mkfifo").arg(&pipe).status().unwrap().success());
    let file = folder.path().join("a");
    let output = |path| Output { path, folder: None, contents: b"1" };
    let error = write_outputs(&[output(&file), output(&pipe)]).unwrap_err().to_string();
    assert!(error.contains("it is a pipe"), "{error}");
    assert!(!folder.path().join("a").exists());
}

#[cfg(unix)]
#[test]
fn a_link_to_nothing_keeps_its_place_and_gets_its_file() {
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name);
    std::os::unix::fs::symlink("file", at("link")).unwrap();
    std::os::unix::fs::symlink("second", at("first")).unwrap();
    std::os::unix::fs::symlink("third", at("second")).unwrap();
    write_file(&at("link"), b"new").unwrap();
    assert!(fs::symlink_metadata(at("link")).unwrap().is_symlink());
    assert_eq!(fs::read_to_string(at("file")).unwrap(), "new");
    let error = write_file(&at("first"), b"new").unwrap_err().to_string();
    assert!(error.contains("a link to a link that leads nowhere"), "{error}");
    assert!(!at("third").exists());
}

#[cfg(unix)]
#[test]
fn a_link_keeps_its_place() {
    let folder = tempfile::tempdir().unwrap();
    let (file, link) = (folder.path().join("file"), folder.path().join("link"));
    fs::write(&file, "old").unwrap();
    std::os::unix::fs::symlink(&file, &link).unwrap();
    write_file(&link, b"new").unwrap();
    assert!(fs::symlink_metadata(&link).unwrap().is_symlink());
    assert_eq!(fs::read_to_string(&file).unwrap(), "new");
}

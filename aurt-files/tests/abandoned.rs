//! An interruption: a process of its own, since nothing can be written after it.

use std::time::Duration;
use std::{fs, thread};

use aurt_files::output::{StagedFolder, abandon, write_file, write_folder};

/// Threads that write into a staged folder after the interruption do not make it again.
#[test]
fn nothing_is_begun_after_it() {
    let parent = tempfile::tempdir().unwrap();
    let staged = StagedFolder::new(parent.path()).unwrap();
    let case = staged.path().join("cases/case");
    write_folder(&case, &[("a", "1"), ("below/b", "2")]).unwrap();
    let truth = staged.path().join("sealed/truth");
    // Its end waits for ever, as that of whoever still writes.
    std::mem::forget(staged);
    assert_eq!(abandon(), 2);
    assert_eq!(fs::read_dir(parent.path()).unwrap().count(), 0);
    thread::spawn(move || write_file(&truth, b"3"));
    thread::spawn(move || write_folder(&case, &[("a", "1")]));
    thread::sleep(Duration::from_millis(300));
    assert_eq!(fs::read_dir(parent.path()).unwrap().count(), 0);
}

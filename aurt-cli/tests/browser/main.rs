//! Reports in a real browser: opened from disk, at two widths, light and dark.
#![expect(clippy::unwrap_used, clippy::expect_used, reason = "a test that panics has failed")]

mod devtools;

use std::path::{Path, PathBuf};
use std::process::Command;

use devtools::Browser;
use serde_json::Value;
use tempfile::TempDir;

fn browser() -> Option<Browser> {
    let program = devtools::program();
    if program.is_none() {
        println!("skipped: no Chromium is installed, and CHROMIUM names none");
    }
    program.map(|p| Browser::start(&p))
}

fn aurt(folder: &Path, line: &str) {
    let mut command = Command::new(env!("CARGO_BIN_EXE_aurt"));
    let status = command.args(line.split(' ')).arg("--quiet").current_dir(folder).status().unwrap();
    // A diagnosis that finds something leaves with 1.
    assert!(matches!(status.code(), Some(0 | 1)), "{line}: {status}");
}

fn demo() -> (TempDir, PathBuf) {
    let folder = tempfile::tempdir().unwrap();
    aurt(folder.path(), "demo --out demo");
    let report = folder.path().join("demo/report.html");
    (folder, report)
}

/// What is wrong with the layout: parts that are wider than the page, and text of plots that overlaps other text or
/// leaves its drawing.
const FAULTS: &str = include_str!("faults.js");

/// Opens a report at both widths and in both schemes and leaves pictures of it in the folder for temporary files of
/// tests.
fn look(browser: &mut Browser, report: &Path, name: &str) {
    let mut papers = Vec::new();
    for scheme in ["light", "dark"] {
        for width in [1280, 390] {
            browser.open(report, width, scheme);
            browser.value("document.querySelectorAll('details').forEach((d) => { d.open = true; }), 0");
            browser.drawn();
            let faults = browser.value(FAULTS);
            assert_eq!(faults, serde_json::json!([]), "{name}, {width} pixels, {scheme}");
            assert_eq!(browser.complaints(), [""; 0], "{name}, {width} pixels, {scheme}");
            let height = browser.value("document.documentElement.scrollHeight").as_f64().unwrap();
            let picture = browser.picture(height.min(14_000.0), width);
            assert!(picture.starts_with(b"\x89PNG") && picture.len() > 20_000, "{} bytes", picture.len());
            let file = format!("report_{name}_{width}_{scheme}.png");
            std::fs::write(Path::new(env!("CARGO_TARGET_TMPDIR")).join(file), picture).unwrap();
        }
        papers.push(browser.value("getComputedStyle(document.body).backgroundColor"));
    }
    assert_ne!(papers[0], papers[1], "light and dark look alike");
}

#[test]
fn the_demo_report_is_readable() {
    let Some(mut browser) = browser() else { return };
    let (_folder, report) = demo();
    look(&mut browser, &report, "demo");
}

#[test]
fn a_check_and_a_diagnosis_of_a_real_robot_are_readable() {
    let Some(mut browser) = browser() else { return };
    let Some(data) = std::env::var_os("AURT_DATA").map(PathBuf::from).filter(|d| d.join("ur10e").is_dir())
    else {
        println!("skipped: AURT_DATA names no folder with recordings of a UR10e");
        return;
    };
    let folder = tempfile::tempdir().unwrap();
    let root = concat!(env!("CARGO_MANIFEST_DIR"), "/..");
    aurt(folder.path(), &format!("diagnose {root}/examples/diagnose_ur10e_payload.toml --out payload"));
    look(&mut browser, &folder.path().join("payload/report.html"), "ur10e_payload");
    let ur3e = data.join("ur3e");
    let line = format!("check {0}/wave_joint_1.csv --mdh {0}/mdh.csv --out check", ur3e.display());
    aurt(folder.path(), &line);
    look(&mut browser, &folder.path().join("check/report.html"), "ur3e_check");
}

/// First and last label along the coordinate of the `k`-th plot.
fn shown(browser: &mut Browser, k: usize) -> [f64; 2] {
    let labels = browser.value(&format!(
        "(() => {{ const svg = document.querySelectorAll('figure.large svg.plot')[{k}]; \
         return [...svg.querySelectorAll('.tick[text-anchor=middle]')].map((t) => t.textContent.replace('−', '-')); \
         }})()"
    ));
    let numbers: Vec<f64> =
        labels.as_array().unwrap().iter().map(|t| t.as_str().unwrap().parse().unwrap()).collect();
    [numbers[0], numbers[numbers.len() - 1]]
}

fn extent([first, last]: [f64; 2]) -> f64 {
    last - first
}

#[test]
fn plots_can_be_zoomed_moved_and_read() {
    let Some(mut browser) = browser() else { return };
    let (_folder, report) = demo();
    browser.open(&report, 1280, "light");
    let whole = shown(&mut browser, 0);

    let click = |browser: &mut Browser, sign: &str| {
        browser.value(&format!(
            "[...document.querySelectorAll('figure.large')[0].querySelectorAll('button')]\
             .find((b) => b.textContent === '{sign}').click(), 0"
        ));
    };
    click(&mut browser, "+");
    let closer = shown(&mut browser, 0);
    assert!(extent(closer) < 0.6 * extent(whole), "{closer:?} of {whole:?}");
    assert_eq!(shown(&mut browser, 1), closer, "the next joint does not follow");
    click(&mut browser, "▸");
    assert!(shown(&mut browser, 0)[0] > closer[0], "later is not later");
    click(&mut browser, "all");
    assert_eq!(shown(&mut browser, 0), whole);

    let frame = browser.value(
        "(() => { const svg = document.querySelector('figure.large svg.plot'); svg.scrollIntoView({ block: 'center' }); \
         const box = svg.querySelector('.area').getBoundingClientRect(); \
         return [box.left, box.top, box.width, box.height]; })()",
    );
    let number = |k: usize| frame[k].as_f64().unwrap();
    let at = |share: f64| (number(0) + share * number(2), number(1) + 0.5 * number(3));
    let (from, to) = (at(0.25), at(0.5));
    browser.mouse("mouseMoved", from.0, from.1, 0);
    let said = browser.value("document.querySelector('figure.large .readout').textContent");
    let said = said.as_str().unwrap();
    assert!(said.contains("measured") && said.contains("predicted"), "{said}");
    browser.mouse("mousePressed", from.0, from.1, 1);
    browser.mouse("mouseMoved", to.0, to.1, 1);
    browser.mouse("mouseReleased", to.0, to.1, 1);
    let chosen = shown(&mut browser, 0);
    assert!(extent(chosen) < 0.3 * extent(whole) && chosen[0] > whole[0], "{chosen:?} of {whole:?}");
    // What is shown of the line is the stretch that was chosen, at its own scale.
    let boxes = browser.value(
        "[...document.querySelector('figure.large svg.plot').querySelectorAll('.area')]\
         .map((a) => a.getAttribute('viewBox').split(' ').map(Number))",
    );
    for view in boxes.as_array().unwrap() {
        assert!(view.as_array().unwrap().iter().all(Value::is_number), "{boxes}");
    }
    browser.mouse("mousePressed", to.0, to.1, 1);
    browser.mouse("mouseReleased", to.0, to.1, 1);
    browser.mouse("mousePressed", to.0, to.1, 2);
    browser.mouse("mouseReleased", to.0, to.1, 2);
    assert_eq!(shown(&mut browser, 0), whole, "a double click does not show all");

    browser.value("document.querySelector('figure.large svg.plot').focus(), 0");
    for kind in ["keyDown", "keyUp"] {
        let key = serde_json::json!({ "type": kind, "key": "+", "text": "+" });
        browser.call("Input.dispatchKeyEvent", key);
    }
    assert!(extent(shown(&mut browser, 0)) < 0.6 * extent(whole), "the keyboard does nothing");
    assert_eq!(browser.complaints(), [""; 0]);
}

#[test]
fn without_a_script_everything_is_drawn() {
    let Some(mut browser) = browser() else { return };
    let (_folder, report) = demo();
    browser.call("Emulation.setScriptExecutionDisabled", serde_json::json!({ "value": true }));
    browser.load(&report, 1280, "light");
    browser.call("Emulation.setScriptExecutionDisabled", serde_json::json!({ "value": false }));
    let labels = browser.value("document.querySelectorAll('svg.plot .tick').length").as_u64().unwrap();
    let buttons = browser.value("document.querySelectorAll('.tools').length");
    assert!(labels > 100, "{labels} labels");
    assert_eq!(buttons, 0, "the script has run");
}

//! Pages of grades with pictures of the findings.

use std::path::Path;
use std::process::Command;

use serde_json::Value;
use sulcus_support::Resource;

use super::display;

/// Page of a demo in virtual time with a heavy hand, and its JSON.
fn demo(folder: &Path, more: &[(&str, &str)]) -> (String, Value) {
    let output = Command::new(env!("CARGO_BIN_EXE_sulcus-client"))
        .args(["demo", "--virtual", "--exercise", "probing", "--json"])
        .args(["--habit", "heavy-hand", "--pictures", "--recordings"])
        .arg(folder)
        .env("XDG_CONFIG_HOME", folder)
        .env("HOME", folder)
        .env("XDG_RUNTIME_DIR", folder)
        .envs(more.iter().copied())
        .output()
        .expect("ran");
    let told = String::from_utf8_lossy(&output.stderr).into_owned();
    assert!(output.status.success(), "{told}");
    let text = String::from_utf8_lossy(&output.stdout).into_owned();
    let last = text.lines().last().unwrap_or_else(|| panic!("{told}"));
    let json: Value = serde_json::from_str(last).expect("one object");
    let page = json["page"].as_str().unwrap_or_else(|| panic!("{told}"));
    (std::fs::read_to_string(page).expect("a page"), json)
}

#[test]
fn a_page_has_a_picture_with_a_sentence_for_each_finding() {
    let _turn = display::turn();
    if Resource::Adapter.or_skip(display::adapter()).is_none() {
        return;
    }
    let folder = tempfile::tempdir().expect("folder");
    let (page, json) = demo(folder.path(), &[]);
    let figures: Vec<&str> = page.split("<figure>").skip(1).collect();
    assert!((1..=6).contains(&figures.len()), "{}", figures.len());
    for figure in &figures {
        // The signature of a PNG file in base64.
        assert!(figure.contains("src=\"data:image/png;base64,iVBORw0KGgo"));
        assert!(figure.contains("alt=\"36 "), "an alternative text");
        assert!(figure.contains("pressed with"), "the fault of a heavy hand");
    }
    let sites = json["grade"]["sites"].as_array().expect("sites");
    assert!(figures.len() <= sites.len());
    assert!(page.len() < 8_000_000, "{} bytes", page.len());
}

#[test]
fn a_page_without_an_adapter_says_so_and_the_grade_is_there() {
    let _turn = display::turn();
    let folder = tempfile::tempdir().expect("folder");
    let none = [
        ("VK_ICD_FILENAMES", "/nowhere"),
        ("VK_DRIVER_FILES", "/nowhere"),
        ("__EGL_VENDOR_LIBRARY_FILENAMES", "/nowhere"),
    ];
    let (page, json) = demo(folder.path(), &none);
    assert!(page.contains("No pictures of the findings: "), "{page}");
    assert!(!page.contains("<img"));
    assert!(json["grade"]["score"].is_number(), "{json}");
}

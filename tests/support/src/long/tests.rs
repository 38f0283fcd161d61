use std::path::Path;

use super::*;

#[test]
fn a_selection_is_all_or_names() {
    assert_eq!(chosen(""), Ok(vec![]));
    assert_eq!(chosen("all").expect("all").len(), LONG.len());
    let two = format!("{}, {}", LONG[0].name, LONG[1].name);
    assert_eq!(chosen(&two), Ok(vec![LONG[0].name, LONG[1].name]));
    for wrong in ["slice:7", "everything", "change"] {
        assert!(chosen(wrong).is_err(), "{wrong}");
    }
}

/// Every row has one test, in its package. A row without a test, or a test without a row, would go unnoticed.
#[test]
fn every_row_of_the_table_is_one_test_of_its_package_in_a_module_named_long() {
    let keys = passed::keys().expect("keys");
    let package = |path: &Path| {
        let of = keys.iter().filter(|(_, key)| path.starts_with(&key.folder));
        let inmost = of.max_by_key(|(_, key)| key.folder.components().count());
        inmost.expect("a package").0.clone()
    };
    let mut uses: Vec<(String, String)> = Vec::new();
    let mut folders = vec![passed::root()];
    while let Some(folder) = folders.pop() {
        for entry in std::fs::read_dir(&folder).expect("a folder") {
            let path = entry.expect("an entry").path();
            let name = path.file_name().expect("a name").to_string_lossy();
            if path.is_dir() && name != "target" && !name.starts_with('.') {
                folders.push(path.clone());
            }
            if !name.ends_with(".rs") {
                continue;
            }
            let text = std::fs::read_to_string(&path).expect("a source");
            for rest in text.split("long::selected(\"").skip(1) {
                let long = rest.split('"').next().expect("a name");
                uses.push((long.to_owned(), package(&path)));
                let in_module = path.components().any(|part| part.as_os_str() == "long")
                    || name == "long.rs"
                    || text.contains("mod long {");
                assert!(in_module, "{}: not in a module `long`", path.display());
            }
        }
    }
    // The pattern of this test itself.
    uses.retain(|(long, _)| long != ").skip(1) {");
    uses.sort();
    let row = |long: &Long| (long.name.to_owned(), long.package.to_owned());
    let mut table: Vec<_> = LONG.iter().map(row).collect();
    table.sort();
    assert_eq!(uses, table);
}

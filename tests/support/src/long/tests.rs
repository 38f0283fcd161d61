use std::collections::BTreeMap;
use std::path::Path;

use super::*;

#[test]
fn every_proof_is_in_one_slice_and_no_slice_is_longer_than_ci_allows() {
    let slices = slices();
    let all: Vec<_> = slices.iter().flatten().copied().collect();
    assert_eq!(all, LONG.iter().map(|long| long.name).collect::<Vec<_>>());
    for slice in &slices {
        let minutes: f64 = LONG
            .iter()
            .filter(|long| slice.contains(&long.name))
            .map(|long| long.minutes)
            .sum();
        assert!(minutes <= SLICE_MINUTES, "{slice:?}: {minutes} minutes");
    }
}

#[test]
fn a_selection_is_all_a_slice_modulo_their_number_or_names() {
    let number = slices().len();
    assert_eq!(chosen(""), Ok(vec![]));
    assert_eq!(chosen("all").expect("all").len(), LONG.len());
    assert_eq!(chosen(&format!("slice:{}", 5 * number)), chosen("slice:0"));
    assert_eq!(chosen("slice:0").expect("a slice"), slices()[0]);
    let two = format!("{}, {}", LONG[0].name, LONG[1].name);
    assert_eq!(chosen(&two), Ok(vec![LONG[0].name, LONG[1].name]));
    for wrong in ["slice:", "slice:x", "everything", "slice"] {
        assert!(chosen(wrong).is_err(), "{wrong}");
    }
}

/// Every row has one test. A row without a test, or a test without a row, would go unnoticed.
#[test]
fn every_row_of_the_table_is_one_test_in_a_module_named_long() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    let mut uses: BTreeMap<String, usize> = BTreeMap::new();
    let mut folders = vec![root];
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
                *uses.entry(long.to_owned()).or_default() += 1;
                let in_module = path.components().any(|part| part.as_os_str() == "long")
                    || name == "long.rs"
                    || text.contains("mod long {");
                assert!(in_module, "{}: not in a module `long`", path.display());
            }
        }
    }
    // The pattern of this test itself.
    uses.remove(").skip(1) {");
    let table: BTreeMap<_, _> = LONG.iter().map(|long| (long.name.to_owned(), 1)).collect();
    assert_eq!(uses, table);
}

//! Hand-written files are read in one way only.

use crate::sources::{MEMBERS, root, walk};

/// Sources that may name the reader of TOML: the four ways to [`sulcus_core::exactly`], and the reader of a recording's
/// patient, which looks at single values of a table.
const READERS: [&str; 5] = [
    "client/haptics/src/exact.rs",
    "server/scene/src/hand_written.rs",
    "server/src/exact.rs",
    "sessions/src/grade/patient.rs",
    "sessions/src/record/written.rs",
];

/// TOML's own reader drops what a list has beyond its field's length. A file that is read past the exact reader would again.
#[test]
fn nothing_reads_toml_past_the_exact_reader() {
    let (mut seen, mut found) = (0, Vec::new());
    for member in MEMBERS {
        walk(&root().join(member), &mut |path, text| {
            seen += 1;
            let reads = [
                "toml::from_str",
                "toml::from_slice",
                "toml::de",
                "toml::Deserializer",
            ];
            if reads.iter().any(|call| text.contains(call)) {
                let path = path.strip_prefix(root()).expect("below it");
                found.push(path.to_string_lossy().into_owned());
            }
        });
    }
    assert!(seen > 300, "{seen} sources");
    found.retain(|path| !path.ends_with("tests/it/hand_written.rs"));
    found.sort();
    assert_eq!(found, READERS);
}

//! Files for the viewer, written or refused as a whole.

use std::path::Path;

use sulcus_view::{LevelPicture, TreePicture, ViewError, write_tree};

/// A tetrahedron with two levels.
fn picture() -> TreePicture {
    let level = |level: u8, spheres: usize| LevelPicture {
        level,
        vertex_colours: vec![[200, 100, 0]; 4],
        centres: vec![[1.0, 2.0, 3.0]; spheres],
        radii: vec![0.5; spheres],
        sphere_colours: vec![[250, 236, 208]; spheres],
        caption: format!("**Level {level}**"),
    };
    TreePicture {
        name: "tetrahedron".into(),
        vertices: vec![[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]],
        normals: vec![[0.0, 0.0, 1.0]; 4],
        triangles: vec![[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]],
        levels: vec![level(0, 1), level(1, 300)],
    }
}

#[test]
fn a_file_is_complete_when_the_call_returns_and_grows_with_what_is_in_it() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let size = |name: &str, picture: &TreePicture| {
        let path = folder.path().join(name);
        write_tree(&path, picture).expect("writes");
        let bytes = std::fs::read(&path).expect("reads");
        assert!(bytes.starts_with(b"RRF"), "{name}");
        // The footer is written last.
        assert!(bytes.ends_with(b"FOOT") || bytes.windows(4).rev().take(64).any(|w| w == b"FOOT"));
        bytes.len()
    };
    let small = size("small.rrd", &picture());
    let mut more = picture();
    for k in 2..6 {
        let level = LevelPicture {
            level: k,
            ..more.levels[1].clone()
        };
        more.levels.push(level);
    }
    assert!(size("more.rrd", &more) > small + 4 * 500);
}

#[test]
fn lists_that_do_not_fit_together_are_refused_before_anything_is_written() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let path = folder.path().join("tree.rrd");
    let mut wrong = picture();
    wrong.levels[1].radii.pop();
    let error = write_tree(&path, &wrong).expect_err("299 radii");
    assert_eq!(
        error.to_string(),
        "level 1: radii has 299 entries, expected 300"
    );
    assert!(!path.exists());
    let mut wrong = picture();
    wrong.levels[0].vertex_colours.push([0; 3]);
    let error = write_tree(&path, &wrong).expect_err("5 colours");
    assert!(matches!(error, ViewError::Shape { level: 0, .. }));
}

#[test]
fn a_place_that_cannot_be_written_is_named() {
    let error =
        write_tree(Path::new("no/such/folder/tree.rrd"), &picture()).expect_err("no folder");
    let told = error.to_string();
    assert!(
        told.starts_with("no/such/folder/tree.rrd: cannot write"),
        "{told}"
    );
}

//! OBJ files of real programs: comments anywhere, any end of a line, continued lines.

use std::path::Path;

use sulcus_scene::mesh::TriMesh;
use sulcus_scene::mesh::load::{Unit, load_mesh, parse_mesh};

use crate::ngons::input;

fn parse(text: &str) -> Result<TriMesh, String> {
    let read = parse_mesh(
        text.as_bytes().to_vec(),
        Path::new("a.obj"),
        Unit::Millimetre,
    );
    read.map(|loaded| loaded.mesh)
        .map_err(|error| error.to_string())
}

#[test]
fn comments_behind_faces_and_cr_alone_give_the_same_mesh() {
    let good = load_mesh(&input("obj/good.obj"), Unit::Millimetre).expect("good");
    assert_eq!(good.mesh.triangles.len(), 952);
    for name in ["face_comment.obj", "cr_only.obj"] {
        let found = load_mesh(&input("obj").join(name), Unit::Millimetre).expect(name);
        assert_eq!(found, good, "{name}");
    }
}

#[test]
fn comments_continued_lines_and_ends_of_lines_may_be_mixed() {
    let plain = "v 0 0 0\nv 4 0 0\nv 0 4 0\nv 0 0 4\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 3 1 4\n";
    let clean = parse(plain).expect("plain");
    assert!(clean.signed_volume() > 0.0);
    let odd = "# from C:\\scans\\\nv 0 0 0 # first\nv 4 \\\n 0 0#second\n#f 1 1 1\nv 0 4 0\t# third\nv 0 0 4\nf 1 3 2 # a\nf 1 2 \\\n\\\n4\nf 2/1 3/1/1 4//1# b \\\nf 3 1 4 #\n";
    let ends: [&[&str]; 5] = [
        &["\n"],
        &["\r"],
        &["\r\n"],
        &["\n", "\r\n", "\r"],
        &["\r", "\r\n"],
    ];
    for end in ends {
        let mut ends = end.iter().cycle();
        let text: String = odd
            .lines()
            .flat_map(|line| [line, ends.next().expect("endless")])
            .collect();
        assert_eq!(parse(&text).expect("odd"), clean, "{end:?}");
    }
}

#[test]
fn lines_are_counted_alike_whatever_ends_them() {
    let wrong = "v 0 0 0\nv 1 0 0\nv 0 1 \\\n0\n# a\nf 1 2 3\nf 1 2 x # b\n";
    for text in [
        wrong.to_owned(),
        wrong.replace('\n', "\r\n"),
        wrong.replace('\n', "\r"),
    ] {
        let said = parse(&text).expect_err("refused");
        assert!(said.contains("`x` in line 7"), "{said}");
    }
    let said = parse("v 0 0 0\rv 1 0 0\r\nv 0 1 0\rv 0 0 1\nv 9 9 9\rf 1 2 3\rf 1 2 3 4 3\r")
        .expect_err("refused");
    assert!(
        said.contains("corners 3 and 5 are the same vertex in line 7"),
        "{said}"
    );
}

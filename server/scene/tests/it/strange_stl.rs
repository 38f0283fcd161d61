//! STL files of real programs: bytes behind the triangles, headers that begin with `solid`, wrong counts.

use std::path::Path;

use proptest::prelude::*;
use sulcus_core::Vec3;
use sulcus_scene::mesh::load::{Loaded, Unit, load_mesh, parse_mesh, to_stl};
use sulcus_scene::mesh::shapes::{cuboid, icosphere};
use sulcus_scene::read_solid;

use crate::ngons::input;

fn parse(bytes: Vec<u8>) -> Result<Loaded, String> {
    parse_mesh(bytes, Path::new("a.stl"), Unit::Millimetre).map_err(|error| error.to_string())
}

fn with_header(mut bytes: Vec<u8>, header: &str, fill: u8) -> Vec<u8> {
    bytes[..80].fill(fill);
    bytes[..header.len()].copy_from_slice(header.as_bytes());
    bytes
}

const HEADERS: [(&str, u8); 5] = [
    ("", 0),
    ("solid exported by a lab scanner", 0),
    ("solid padded with spaces facet normal", b' '),
    ("SOLID", b' '),
    ("binary STL", 0),
];

#[test]
fn bytes_behind_the_triangles_are_noted_and_the_mesh_is_the_same() {
    let good = load_mesh(&input("stl/good.stl"), Unit::Millimetre).expect("good");
    assert_eq!((good.mesh.triangles.len(), good.notes.len()), (952, 0));
    for (name, noted) in [
        (
            "trailing_newline",
            "1 bytes behind the last of 952 triangles were not read (white space)",
        ),
        (
            "trailing_zeros_512",
            "444 bytes behind the last of 952 triangles were not read (zeros)",
        ),
        (
            "trailing_metadata",
            "30 bytes behind the last of 952 triangles were not read (`<scanner model=\"x\" id=\"0001\"/>`)",
        ),
        (
            "solid_header_trailing",
            "bytes behind the last of 952 triangles were not read",
        ),
    ] {
        let file = input("stl").join(name).with_extension("stl");
        let solid = read_solid(&file, Unit::Millimetre).expect(name);
        assert_eq!(solid.mesh, good.mesh, "{name}");
        assert!(solid.repairs.is_empty(), "{name}");
        assert_eq!(solid.notes.len(), 1, "{name}");
        assert!(solid.notes[0].contains(noted), "{name}: {}", solid.notes[0]);
    }
}

#[test]
fn any_header_before_and_any_bytes_behind_are_read_alike() {
    let box_ = to_stl(&cuboid(Vec3::new(0.004, 0.003, 0.002)));
    let behind: [&[u8]; 8] = [
        b"\n",
        b"\r\n\r\n",
        &[0; 50],
        &[0; 428],
        b"\x1a",
        &[255; 100],
        b"COLOR=\x01\x02\x03\x04,MATERIAL=",
        "Größe".as_bytes(),
    ];
    for (header, fill) in HEADERS {
        let clean = parse(with_header(box_.clone(), header, fill)).expect(header);
        assert_eq!(
            (clean.mesh.triangles.len(), clean.notes.len()),
            (12, 0),
            "{header}"
        );
        for bytes in behind {
            let file = [with_header(box_.clone(), header, fill), bytes.to_vec()].concat();
            // The name of the file has no effect.
            for name in ["a.stl", "a", "a.obj", "a.txt"] {
                let found =
                    parse_mesh(file.clone(), Path::new(name), Unit::Millimetre).expect(header);
                assert_eq!(found.mesh, clean.mesh, "{header}");
                let note = &found.notes[0];
                assert!(
                    note.starts_with(&format!("{} bytes behind the last of 12", bytes.len())),
                    "{note}"
                );
            }
        }
    }
}

#[test]
fn a_cut_file_and_a_count_that_lies_are_refused_with_the_true_reason_whatever_the_header_says() {
    let refused = |name: &str| {
        let error = read_solid(&input("stl").join(name), Unit::Millimetre).expect_err(name);
        error.to_string()
    };
    let said = refused("count_zero.stl");
    assert!(
        said.contains("announces 0 triangles before 47600 bytes of data (952 triangles would fit)"),
        "{said}"
    );
    let said = refused("truncated.stl");
    assert!(
        said.contains(
            "47611 bytes where the header announces 47684 (952 triangles, of which 950 are whole)"
        ),
        "{said}"
    );

    let ball = icosphere(0.005, 2);
    for (header, fill) in HEADERS {
        let whole = with_header(to_stl(&ball), header, fill);
        for cut in [1, 2, 49, 50, 51, 5000] {
            let said = parse(whole[..whole.len() - cut].to_vec()).expect_err("cut");
            assert!(
                said.contains("where the header announces 16084 (320 triangles, of which"),
                "{header}, {cut}: {said}"
            );
        }
        let mut none = whole.clone();
        none[80..84].fill(0);
        let said = parse(none).expect_err("no count");
        assert!(
            said.contains("announces 0 triangles before 16000 bytes"),
            "{said}"
        );
        let mut few = whole.clone();
        few[80..84].copy_from_slice(&300_u32.to_le_bytes());
        let said = parse(few).expect_err("a low count");
        assert!(
            said.contains("announces 300 triangles, and more triangles behind them (320 would fit"),
            "{said}"
        );
    }
    assert!(
        parse(with_header(vec![0; 83], "solid", 0))
            .expect_err("short")
            .contains("found 83 bytes")
    );
}

#[test]
fn a_fault_in_an_ascii_file_is_told_with_its_line_and_whatever_ends_the_lines() {
    let facet = "facet normal 0 0 1\n outer loop\n  vertex 0 0 0\n  vertex 1 0 0\n  vertex 0 1 0\n endloop\nendfacet\n";
    let text = format!("solid a\n{}endsolid a\n", facet.repeat(4));
    for (from, to, line, told) in [
        (
            "vertex 1 0 0",
            "vertex 1 o 0",
            5,
            "found `o` in line 5, expected a finite number",
        ),
        (
            "vertex 1 0 0",
            "vertex 1 0",
            5,
            "found `vertex 1 0` in line 5, expected `vertex` and three numbers",
        ),
        ("vertex 1 0 0", "vertex 1 inf 0", 5, "found `inf` in line 5"),
        (
            "  vertex 0 1 0\n",
            "",
            6,
            "found `endloop` in line 6, expected `vertex` and three numbers (a facet has three)",
        ),
        (
            " endloop\n",
            "",
            7,
            "found `endfacet` in line 7, expected `endloop`",
        ),
        (
            "endfacet\n",
            "",
            8,
            "found `facet normal 0 0 1` in line 8, expected `endfacet`",
        ),
        (
            " outer loop",
            " inner loop",
            3,
            "found `inner loop` in line 3, expected `outer loop`",
        ),
        (
            "endsolid a",
            "",
            29,
            "ends in line 29 before `endsolid` (its solid begins in line 1)",
        ),
        (
            "endsolid a",
            "solid b",
            30,
            "a solid in line 30 within the solid of line 1",
        ),
        (
            "endsolid a",
            "endsolid a\nvertex 1 2 3",
            31,
            "`vertex 1 2 3` in line 31 after the end",
        ),
    ] {
        let wrong = text.replacen(from, to, 1);
        for (name, wrong) in [
            ("LF", wrong.clone()),
            ("CR LF", wrong.replace('\n', "\r\n")),
            ("CR", wrong.replace('\n', "\r")),
        ] {
            let said = parse(wrong.into_bytes()).expect_err(told);
            assert!(said.contains(told), "{name}, line {line}: {said}");
        }
    }
    // Normals are not needed. For triangles without area they are often NaN.
    for normal in ["nan nan nan", "-nan(ind) 0 0", "inf 0 0"] {
        let odd = text.replace("normal 0 0 1", &format!("normal {normal}"));
        assert_eq!(
            parse(odd.into_bytes()).expect(normal).mesh.triangles.len(),
            4
        );
    }
    let padded = format!("{text}{}", "\0".repeat(200));
    let found = parse(padded.into_bytes()).expect("padded");
    assert_eq!(found.mesh.triangles.len(), 4);
    assert!(found.notes[0].contains("200 bytes"), "{:?}", found.notes);
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 128, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn whatever_is_behind_whole_triangles_they_are_read_or_the_count_is_doubted(
        behind in proptest::collection::vec(any::<u8>(), 1..300),
        solid in any::<bool>(),
    ) {
        let clean = to_stl(&cuboid(Vec3::repeat(0.003)));
        let clean = with_header(clean, if solid { "solid" } else { "" }, 0);
        match parse([clean, behind].concat()) {
            Ok(found) => prop_assert!(found.mesh.triangles.len() == 12 && found.notes.len() == 1),
            Err(said) => prop_assert!(said.contains("more triangles behind them"), "{}", said),
        }
    }
}

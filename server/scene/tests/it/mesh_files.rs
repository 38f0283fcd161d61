//! STL, OBJ and PLY files give the same mesh, are refused in one sentence, and never cause a panic.

use std::fmt::Write;
use std::path::Path;

use proptest::prelude::*;
use sulcus_core::Vec3;
use sulcus_scene::mesh::TriMesh;
use sulcus_scene::mesh::load::{LoadError, Unit, load_mesh, parse_mesh, to_stl};
use sulcus_scene::mesh::repair::repair;
use sulcus_scene::mesh::shapes::{cuboid, icosphere};

fn parse(bytes: impl Into<Vec<u8>>, name: &str) -> Result<TriMesh, LoadError> {
    parse_mesh(bytes.into(), Path::new(name), Unit::Millimetre).map(|loaded| loaded.mesh)
}

fn refused(bytes: impl Into<Vec<u8>>, name: &str) -> String {
    let message = parse(bytes, name).expect_err("refused").to_string();
    assert!(message.starts_with(&format!("{name}: ")), "{message}");
    assert!(message.contains("expected"), "{message}");
    assert!(!message.contains('\n') && message.len() < 400, "{message}");
    message
}

fn ascii_stl(mesh: &TriMesh) -> String {
    let mut text = "solid tooth\n".to_owned();
    for t in 0..mesh.triangles.len() {
        text.push_str("facet normal 0 0 0\n outer loop\n");
        for v in mesh.corners(t) {
            let _ = writeln!(
                text,
                "  vertex {:e} {:e} {:e}",
                v.x * 1e3,
                v.y * 1e3,
                v.z * 1e3
            );
        }
        text.push_str(" endloop\nendfacet\n");
    }
    text + "endsolid tooth\n"
}

fn obj(mesh: &TriMesh) -> String {
    let mut text = "# a comment\nmtllib nowhere.mtl\no tooth\n".to_owned();
    for v in &mesh.vertices {
        let _ = writeln!(text, "v {} {} {}", v.x * 1e3, v.y * 1e3, v.z * 1e3);
    }
    text.push_str("vn 0 0 1\nusemtl enamel\ns off\n");
    for [a, b, c] in &mesh.triangles {
        let _ = writeln!(text, "f {}//1 {}//1 {}//1", a + 1, b + 1, c + 1);
    }
    text
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum Order {
    Ascii,
    Little,
    Big,
}

fn ply(mesh: &TriMesh, order: Order) -> Vec<u8> {
    let format = match order {
        Order::Ascii => "ascii",
        Order::Little => "binary_little_endian",
        Order::Big => "binary_big_endian",
    };
    let mut bytes = format!(
        "ply\nformat {format} 1.0\ncomment made for a test\nelement vertex {}\nproperty double x\nproperty double y\nproperty double z\nproperty uchar red\nelement face {}\nproperty list uchar int vertex_indices\nproperty float quality\nelement camera 1\nproperty list uint short settings\nend_header\n",
        mesh.vertices.len(),
        mesh.triangles.len()
    )
    .into_bytes();
    macro_rules! number {
        ($x:expr) => {
            match order {
                Order::Ascii => bytes.extend(format!("{} ", $x).bytes()),
                Order::Little => bytes.extend($x.to_le_bytes()),
                Order::Big => bytes.extend($x.to_be_bytes()),
            }
        };
    }
    let line = |bytes: &mut Vec<u8>| {
        if order == Order::Ascii {
            bytes.push(b'\n');
        }
    };
    for v in &mesh.vertices {
        for x in v.iter() {
            let mm = x * 1e3;
            number!(mm);
        }
        number!(200_u8);
        line(&mut bytes);
    }
    for t in &mesh.triangles {
        number!(3_u8);
        for &v in t {
            number!((v as i32));
        }
        number!(0.5_f32);
        line(&mut bytes);
    }
    number!(2_u32);
    number!(1_i16);
    number!(-1_i16);
    line(&mut bytes);
    bytes
}

/// Returns every format with its name.
fn files(mesh: &TriMesh) -> Vec<(&'static str, Vec<u8>)> {
    vec![
        ("binary.stl", to_stl(mesh)),
        ("ascii.stl", ascii_stl(mesh).into_bytes()),
        ("a.obj", obj(mesh).into_bytes()),
        ("ascii.ply", ply(mesh, Order::Ascii)),
        ("little.ply", ply(mesh, Order::Little)),
        ("big.ply", ply(mesh, Order::Big)),
    ]
}

#[test]
fn every_format_gives_the_same_solid_under_any_name_and_unit() {
    let mesh = icosphere(0.005, 2).placed(1.0, Vec3::new(0.001, -0.002, 0.003));
    for (name, bytes) in files(&mesh) {
        let mut marked = b"\xef\xbb\xbf".to_vec();
        marked.extend(&bytes);
        let marked = if name == "binary.stl" {
            bytes.clone()
        } else {
            marked
        };
        for called in [name, "nameless", "wrong.stl", "wrong.OBJ", "wrong.ply"] {
            let bytes = if called == name { &marked } else { &bytes };
            let read = parse(bytes.clone(), called).expect(name);
            assert_eq!(read.triangles.len(), mesh.triangles.len(), "{name}");
            assert_eq!(read.vertices.len(), mesh.vertices.len(), "{name}");
            for t in 0..mesh.triangles.len() {
                for (a, b) in read.corners(t).iter().zip(mesh.corners(t)) {
                    assert!((a - b).norm() < 1e-9, "{name}: {a} is not {b}");
                }
            }
            assert!(repair(read).1.is_empty(), "{name} needs no repair");
        }
        let metres = parse_mesh(bytes, Path::new(name), Unit::Metre)
            .expect(name)
            .mesh;
        let longest = metres.bounds().1.x;
        assert!((longest - 6.0).abs() < 1e-5, "{name}: {longest} m");
    }
}

#[test]
fn files_on_disk_are_read_and_missing_ones_named() {
    let dir = tempfile::tempdir().expect("temporary directory");
    let mesh = cuboid(Vec3::new(0.001, 0.002, 0.003));
    for (name, bytes) in files(&mesh) {
        let file = dir.path().join(name);
        std::fs::write(&file, bytes).expect("written");
        let read = load_mesh(&file, Unit::Millimetre).expect(name).mesh;
        assert!((read.signed_volume() / mesh.signed_volume() - 1.0).abs() < 1e-6);
    }
    for missing in [Path::new("no/such.ply"), dir.path()] {
        let said = load_mesh(missing, Unit::Metre)
            .expect_err("missing")
            .to_string();
        assert!(
            said.starts_with(&format!("{}: cannot read the file", missing.display())),
            "{said}"
        );
    }
}

#[test]
fn polygons_become_triangles_and_groups_one_mesh() {
    let text = "g bottom\nv 0 0 0 1\nv 1 0 0 0.5 0.5 0.5\nv 1 1 0\nv 0 1 0\ng top\nv 0 0 1\nf 4 3 2 1\n\
        g sides\nf 1/1/1 2/2/2 -1\nf 2 3 \\\n 5\nf 3 4 5\nf 4 1 5\nl 1 2\np 1\n";
    let pyramid = parse(text, "pyramid.obj").expect("an OBJ file");
    assert_eq!((pyramid.vertices.len(), pyramid.triangles.len()), (5, 6));
    assert!((pyramid.signed_volume() * 1e9 - 1.0 / 3.0).abs() < 1e-12);

    let text = "ply\nformat ascii 1.0\nelement vertex 5\nproperty int x\nproperty short y\nproperty float z\n\
        element face 5\nproperty list uchar uint vertex_index\nend_header\n\
        0 0 0\n1 0 0\n1 1 0\n\n0 1 0\n0 0 1\n4 3 2 1 0\n3 0 1 4\n3 1 2 4\n3 2 3 4\n3 3 0 4";
    let same = parse(text, "pyramid.ply").expect("a PLY file");
    assert_eq!((same.vertices.len(), same.triangles.len()), (5, 6));
    assert!((same.signed_volume() * 1e9 - 1.0 / 3.0).abs() < 1e-12);
}

#[test]
fn several_ascii_solids_are_one_mesh_and_spelling_does_not_matter() {
    let box_ = cuboid(Vec3::repeat(0.002));
    let one = ascii_stl(&box_);
    let moved = ascii_stl(&box_.clone().placed(1.0, Vec3::new(0.01, 0.0, 0.0)));
    let two = parse(format!("{one}{moved}"), "two.stl").expect("STL");
    assert_eq!((two.vertices.len(), two.triangles.len()), (16, 24));
    for text in [
        one.to_uppercase(),
        one.replace("solid tooth", "solid"),
        one.replace('\n', "\r\n"),
        format!("\n  {one}\n"),
    ] {
        assert_eq!(parse(text, "a.stl").expect("STL").triangles.len(), 12);
    }
}

#[test]
fn binary_stl_may_begin_with_solid() {
    let mut bytes = to_stl(&cuboid(Vec3::repeat(0.002)));
    bytes[..6].copy_from_slice(b"solid ");
    assert_eq!(parse(bytes, "a.stl").expect("STL").triangles.len(), 12);
}

#[test]
fn broken_stl_is_refused_with_what_was_found() {
    let mesh = cuboid(Vec3::repeat(0.01));
    assert!(refused(b"v 0 0".to_vec(), "a.stl").contains("found 5 bytes"));
    let mut short = to_stl(&mesh);
    short.pop();
    assert!(refused(short, "a.stl").contains("683 bytes where the header announces 684"));
    let text = ascii_stl(&mesh);
    assert!(refused(text.replace("endsolid tooth", ""), "a.stl").contains("before `endsolid`"));
    assert!(refused(text.replacen("endloop", "", 1), "a.stl").contains("endloop"));
    assert!(
        refused(text.replacen("vertex 1e1", "vertex one", 1), "a.stl").contains("`one` in line ")
    );
    assert!(refused(format!("{text}facet normal 0 0 0"), "a.stl").contains("after the end"));
    assert!(
        refused(format!("solid a\n{text}endsolid\n"), "a.stl")
            .contains("a solid in line 2 within the solid of line 1")
    );
}

#[test]
fn broken_obj_is_refused_with_the_line() {
    let good = obj(&cuboid(Vec3::repeat(0.01)));
    let with = |line: &str| refused(format!("{good}{line}\n"), "a.obj");
    assert!(with("f 1 2 9").contains("vertex 9 named in line 27 of a file with 8 vertices"));
    assert!(with("f 1 2 0").contains("`0` in line 27"));
    assert!(with("f 1 2 -9").contains("`-9` in line 27"));
    assert!(with("f 1 2 x").contains("`x` in line 27"));
    assert!(with("f 1 2").contains("a face of 2 corners in line 27"));
    assert!(with("v 1 2").contains("`v 1 2` in line 27"));
    assert!(with("v 1 2 z").contains("`v 1 2 z` in line 27"));
    assert!(with("v 1 2 3 0").contains("`v 1 2 3 0` in line 27"));
    assert!(with("f 99999999999999999999 1 2").contains("in line 27"));
    assert!(refused("# nothing\nf 1 2 3\n", "a.obj").contains("vertex 3 named in line 2"));
    assert!(refused("vn 0 0 1\n", "a.obj").contains("no line that begins with `v`"));
    assert!(refused("\u{1F9B7}", "a.txt").contains("4 bytes of another format"));
    // Too few corners only in elements that are no surface, and meaningless texture numbers.
    assert_eq!(
        parse(format!("{good}l 1\nf 1/77/88 2/9 3//\n"), "a.obj")
            .expect("OBJ")
            .triangles
            .len(),
        13
    );
}

#[test]
fn broken_ply_is_refused_with_what_was_found() {
    let mesh = cuboid(Vec3::repeat(0.01));
    let good = String::from_utf8(ply(&mesh, Order::Ascii)).expect("text");
    let with = |from: &str, to: &str| refused(good.replacen(from, to, 1), "a.ply");
    assert!(with("end_header", "end").contains("no line `end_header`"));
    assert!(with("format ascii", "format osci").contains("wrong in line 2"));
    assert!(with("property double y", "property double yy").contains("no number `y`"));
    assert!(with("property double z", "property long z").contains("wrong in line 7"));
    assert!(
        with(
            "list uchar int vertex_indices",
            "list uchar float vertex_indices"
        )
        .contains("no list of whole numbers")
    );
    assert!(with("element face", "element strip").contains("[vertex, strip, camera]"));
    assert!(with("3 0 2 3", "3 0 2 8").contains("vertex 8 of 8 in `face` 0, line 23"));
    assert!(with("3 0 2 3", "3 0 2 -1").contains("vertex -1 of 8"));
    assert!(with("3 0 2 3", "2 0 2 3").contains("2 corners in `face` 0"));
    assert!(with("3 0 2 3", "3 0 2 x").contains("`face` 0, line 23"));
    assert!(with("3 0 2 3", "9 0 2 3").contains("`face` 0, line 23"));
    for order in [Order::Ascii, Order::Little, Order::Big] {
        let mut short = ply(&mesh, order);
        short.truncate(short.len() - 30);
        refused(short, "a.ply");
    }
}

#[test]
fn a_header_that_announces_more_than_the_file_holds_is_refused_before_memory_is_taken() {
    for count in ["1000000000", "18446744073709551615"] {
        for (format, element) in [
            ("ascii", "element vertex"),
            ("binary_little_endian", "element vertex"),
            ("binary_big_endian", "element face"),
        ] {
            let text = String::from_utf8(ply(&TriMesh::default(), Order::Ascii)).expect("text");
            let text = text
                .replace("format ascii", &format!("format {format}"))
                .replace(&format!("{element} 0"), &format!("{element} {count}"));
            let said = refused(text, "small.ply");
            assert!(
                said.contains(&format!("announces {count} of element")),
                "{said}"
            );
        }
    }
    // Elements without properties take no bytes in a binary file, however many.
    let text = "ply\nformat binary_little_endian 1.0\nelement nothing 18446744073709551615\nelement vertex 0\nproperty float x\nproperty float y\nproperty float z\nelement face 0\nproperty list uchar int vertex_indices\nend_header\n";
    assert_eq!(parse(text, "a.ply").expect("PLY"), TriMesh::default());
    // A list that announces four thousand million entries.
    let text = "ply\nformat binary_little_endian 1.0\nelement vertex 0\nproperty float x\nproperty float y\nproperty float z\nelement face 1\nproperty list uint int vertex_indices\nend_header\n";
    let mut bytes = text.as_bytes().to_vec();
    bytes.extend([255; 8]);
    assert!(refused(bytes, "a.ply").contains("`face` 0"));
    // A binary STL file cannot announce more than it has either.
    let mut stl = vec![0; 84];
    stl[80..].copy_from_slice(&u32::MAX.to_le_bytes());
    assert!(refused(stl, "a.stl").contains("announces 214748364834"));
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 96, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn random_bytes_never_panic(
        bytes in proptest::collection::vec(any::<u8>(), 0..600),
        head in 0_usize..7,
        name in 0_usize..4,
    ) {
        let heads: [&[u8]; 7] = [
            b"", b"solid x\nfacet normal", b"ply\nformat ascii 1.0\n", b"v 1 2 3\n",
            b"ply\nformat binary_big_endian 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\nelement face 9\nproperty list uchar int vertex_index\nend_header\n",
            b"ply\nformat binary_little_endian 1.0\nelement face 3\nproperty list int int vertex_index\nelement vertex 1\nproperty char x\nproperty char y\nproperty char z\nend_header\n",
            b"v 1 2 3\nv 2 3 4\nv 3 4 9\nf 1 2 3\n",
        ];
        let names = ["a.stl", "a.obj", "a.ply", "a"];
        let bytes = [heads[head], &bytes[..]].concat();
        if let Ok(mesh) = parse(bytes, names[name]) {
            repair(mesh);
        }
    }

    #[test]
    fn random_words_never_panic(
        words in proptest::collection::vec(0_usize..28, 0..120),
        name in 0_usize..4,
    ) {
        let known = [
            "v", "f", "\n", "\n", "\n", " ", " ", "1", "2", "3", "-1", "0", "1e308", "nan", "1/1/1", "\\",
            "solid", "endsolid", "facet normal 0 0 0", "outer loop", "vertex", "endloop", "endfacet",
            "ply", "element vertex", "property list uchar int", "end_header", "9223372036854775807",
        ];
        let text: String = words.iter().flat_map(|&w| [known[w], " "]).collect();
        let names = ["a.stl", "a.obj", "a.ply", "a"];
        if let Ok(mesh) = parse(text, names[name]) {
            repair(mesh);
        }
    }

    #[test]
    fn damaged_and_cut_files_never_panic(
        which in 0_usize..6,
        damage in proptest::collection::vec((any::<prop::sample::Index>(), any::<u8>()), 0..12),
        kept in 0.0_f64..1.3,
    ) {
        let (name, mut bytes) = files(&icosphere(0.004, 1)).swap_remove(which);
        for (at, byte) in damage {
            let at = at.index(bytes.len());
            bytes[at] = byte;
        }
        bytes.truncate((bytes.len() as f64 * kept) as usize);
        match parse(bytes, name) {
            Ok(mesh) => {
                repair(mesh);
            }
            Err(error) => {
                let said = error.to_string();
                prop_assert!(said.starts_with(name) && !said.contains('\n'), "{}", said);
            }
        }
    }
}

//! PLY files of real programs: CR alone, strips of triangles, repeated names.

use std::path::Path;

use proptest::prelude::*;
use sulcus_core::Vec3;
use sulcus_scene::mesh::TriMesh;
use sulcus_scene::mesh::load::{Loaded, Unit, load_mesh, parse_mesh};
use sulcus_scene::mesh::repair::repair;
use sulcus_scene::mesh::shapes::{cuboid, icosphere};

use crate::ngons::input;

fn parse(bytes: impl Into<Vec<u8>>) -> Result<Loaded, String> {
    parse_mesh(bytes.into(), Path::new("a.ply"), Unit::Millimetre)
        .map_err(|error| error.to_string())
}

#[test]
fn every_input_gives_the_mesh_of_the_good_one() {
    let good = load_mesh(&input("ply/good_le.ply"), Unit::Millimetre).expect("good");
    assert_eq!(
        (good.mesh.vertices.len(), good.mesh.triangles.len()),
        (478, 952)
    );
    for name in [
        "cr_header_ascii",
        "cr_header_binary",
        "dup_props",
        "dup_props_ascii",
        "tristrips",
    ] {
        let file = input("ply").join(name).with_extension("ply");
        let found = load_mesh(&file, Unit::Millimetre).expect(name);
        assert!(found.notes.is_empty(), "{name}: {:?}", found.notes);
        assert_eq!(found.mesh.vertices.len(), 478, "{name}");
        for (a, b) in found.mesh.vertices.iter().zip(&good.mesh.vertices) {
            assert!((a - b).norm() < 1e-8, "{name}: {a} is not {b}");
        }
        if name == "tristrips" {
            let (strips, repairs) = repair(found.mesh);
            assert!(repairs.is_empty(), "{repairs}");
            assert_eq!(strips.triangles.len(), 952);
            assert!((strips.signed_volume() / good.mesh.signed_volume() - 1.0).abs() < 1e-9);
        } else {
            assert_eq!(found.mesh.triangles, good.mesh.triangles, "{name}");
        }
    }
}

/// The bytes of a number in a file of this order.
fn number(order: char, little: &[u8]) -> Vec<u8> {
    match order {
        'b' => little.iter().rev().copied().collect(),
        _ => little.to_vec(),
    }
}

/// Returns the PLY of a mesh in mm, with more properties of a vertex before and behind the place, as uchar. Lines end
/// in `end`.
fn ply(
    mesh: &TriMesh,
    order: char,
    end: &str,
    before: &[&str],
    behind: &[&str],
    lists: usize,
) -> Vec<u8> {
    let format = match order {
        'a' => "ascii",
        'l' => "binary_little_endian",
        _ => "binary_big_endian",
    };
    let mut header = format!(
        "ply\nformat {format} 1.0\ncomment the end_header follows\n\nelement vertex {}\n",
        mesh.vertices.len()
    );
    let extra = |header: &mut String, names: &[&str]| {
        for name in names {
            header.push_str(&format!("property uchar {name}\n"));
        }
    };
    extra(&mut header, before);
    header.push_str("property double x\nproperty double y\nproperty double z\n");
    extra(&mut header, behind);
    header.push_str(&format!(
        "element face {}\nproperty list uchar int vertex_indices\n",
        mesh.triangles.len()
    ));
    header.push_str(&"property list uchar float texcoord\n".repeat(lists));
    header.push_str("end_header\n");
    let mut bytes = header.replace('\n', end).into_bytes();
    for v in &mesh.vertices {
        if order == 'a' {
            let odd = |names: &[&str]| "7 ".repeat(names.len());
            let v = v * 1e3;
            bytes.extend(
                format!(
                    "{}{} {} {} {}{end}",
                    odd(before),
                    v.x,
                    v.y,
                    v.z,
                    odd(behind)
                )
                .bytes(),
            );
            continue;
        }
        bytes.extend(before.iter().map(|_| 7));
        for x in v.iter() {
            bytes.extend(number(order, &(x * 1e3).to_le_bytes()));
        }
        bytes.extend(behind.iter().map(|_| 7));
    }
    for t in &mesh.triangles {
        if order == 'a' {
            let texture = " 2 0.5 0.25".repeat(lists);
            bytes.extend(format!("3 {} {} {}{texture}{end}", t[0], t[1], t[2]).bytes());
            continue;
        }
        bytes.push(3);
        for v in t {
            bytes.extend(number(order, &v.to_le_bytes()));
        }
        for _ in 0..lists {
            bytes.push(2);
            bytes.extend(number(order, &0.5_f32.to_le_bytes()).repeat(2));
        }
    }
    bytes
}

#[test]
fn names_that_are_there_twice_shift_no_column_in_any_order_and_with_any_end_of_a_line() {
    let mesh = icosphere(0.004, 1);
    let names: [(&[&str], &[&str], usize); 4] = [
        (&[], &["red", "green", "blue", "red", "green", "blue"], 0),
        (&["q", "q"], &["q", "q_2"], 1),
        (&["alpha"], &["alpha", "alpha", "alpha_2"], 2),
        (&[], &[], 3),
    ];
    for (before, behind, lists) in names {
        for order in ['a', 'l', 'b'] {
            for end in ["\n", "\r\n", "\r"] {
                let said = format!("{before:?} {behind:?} {order} {end:?}");
                let found = parse(ply(&mesh, order, end, before, behind, lists)).expect(&said);
                assert_eq!(found.mesh.triangles, mesh.triangles, "{said}");
                for (a, b) in found.mesh.vertices.iter().zip(&mesh.vertices) {
                    assert!((a - b).norm() < 1e-12, "{said}: {a} is not {b}");
                }
                assert!(found.notes.is_empty(), "{said}");
            }
        }
    }
}

#[test]
fn a_first_byte_of_data_that_is_lf_is_not_taken_for_the_end_of_a_line() {
    // 10 vertices would begin with the byte 10 if the first column were a number of them.
    let end = "\r";
    for first in [10_u8, 13, 0] {
        let header = "ply\nformat binary_little_endian 1.0\nelement vertex 3\nproperty uchar tag\nproperty float x\nproperty float y\nproperty float z\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n";
        let mut bytes = header.replace('\n', end).into_bytes();
        for k in 0..3_u8 {
            bytes.push(first);
            for axis in 0..3 {
                bytes.extend(f32::from(u8::from(axis == k)).to_le_bytes());
            }
        }
        bytes.extend([3, 0, 0, 0, 0, 1, 0, 0, 0, 2, 0, 0, 0]);
        let found = parse(bytes).expect("read");
        assert_eq!(
            found.mesh.vertices,
            [Vec3::x() * 1e-3, Vec3::y() * 1e-3, Vec3::z() * 1e-3],
            "{first}"
        );
    }
}

#[test]
fn a_second_coordinate_list_of_corners_or_surface_is_refused_by_line() {
    let good =
        String::from_utf8(ply(&cuboid(Vec3::repeat(0.002)), 'a', "\n", &[], &[], 0)).expect("text");
    let with = |from: &str, to: &str| parse(good.replacen(from, to, 1)).expect_err("refused");
    let said = with("property double z", "property double z\nproperty double x");
    assert!(
        said.contains("`property double x` a second time in line 9"),
        "{said}"
    );
    let said = with(
        "vertex_indices\n",
        "vertex_indices\nproperty list uchar int vertex_indices\n",
    );
    assert!(said.contains("a second time in line 11"), "{said}");
    let said = with(
        "vertex_indices\n",
        "vertex_indices\nproperty list uchar int vertex_index\n",
    );
    assert!(
        said.contains("both `vertex_indices` and `vertex_index` in element `face`"),
        "{said}"
    );
    let said = with(
        "\nend_header",
        "\nelement face 3\nproperty list uchar int vertex_indices\nend_header",
    );
    assert!(said.contains("`element face 3` a second time"), "{said}");
    // The same text in two elements, or two equal elements of no surface, is no fault.
    let twice = good.replacen(
        "\nend_header",
        "\nelement edge 0\nproperty int x\nelement edge 0\nproperty int x\nend_header",
        1,
    );
    assert_eq!(parse(twice).expect("read").mesh.triangles.len(), 12);
    let cut = "ply\rformat ascii 1.0\relement vertex 0\r";
    assert!(
        parse(cut)
            .expect_err("cut")
            .contains("no line `end_header`")
    );
}

#[test]
fn bytes_behind_the_last_element_are_noted() {
    let mesh = cuboid(Vec3::repeat(0.002));
    for order in ['a', 'l', 'b'] {
        let mut bytes = ply(&mesh, order, "\n", &[], &[], 0);
        bytes.extend(b"\n\n");
        assert!(parse(bytes.clone()).expect("read").notes.is_empty());
        bytes.extend(b"<xmp/>\n");
        let notes = parse(bytes).expect("read").notes;
        assert!(
            notes.len() == 1 && notes[0].contains("bytes behind the last element were not read"),
            "{notes:?}"
        );
    }
}

/// A file of strips.
fn strips(order: char, kind: &str, lists: &[&[i64]]) -> Vec<u8> {
    let format = match order {
        'a' => "ascii",
        'l' => "binary_little_endian",
        _ => "binary_big_endian",
    };
    let mut bytes = format!(
        "ply\nformat {format} 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\nelement tristrips {}\nproperty list int {kind} vertex_indices\nend_header\n",
        lists.len()
    )
    .into_bytes();
    for v in [
        [0_f32, 0.0, 0.0],
        [4.0, 0.0, 0.0],
        [0.0, 4.0, 0.0],
        [0.0, 0.0, 4.0],
    ] {
        match order {
            'a' => bytes.extend(format!("{} {} {}\n", v[0], v[1], v[2]).bytes()),
            _ => bytes.extend(v.iter().flat_map(|x| number(order, &x.to_le_bytes()))),
        }
    }
    for list in lists {
        if order == 'a' {
            bytes.extend(list.len().to_string().bytes());
            bytes.extend(list.iter().flat_map(|v| format!(" {v}").into_bytes()));
            bytes.push(b'\n');
            continue;
        }
        bytes.extend(number(order, &(list.len() as i32).to_le_bytes()));
        for v in *list {
            bytes.extend(number(order, &(*v as i32).to_le_bytes()));
        }
    }
    bytes
}

#[test]
fn strips_alternate_and_begin_anew_behind_minus_one_and_in_every_list() {
    // A tetrahedron: two triangles by alternation, one led to by a repeated corner, one of its own.
    let walks: [&[&[i64]]; 4] = [
        // 1 0 2, then 2 0 3 (turned), then 2 3 1, and 0 1 3 behind the gap.
        &[&[1, 0, 2, 3, 1, -1, 0, 1, 3]],
        &[&[1, 0, 2, 3, 1], &[0, 1, 3]],
        &[&[-1, 1, 0, 2, 3, 1, -1, -1, 0, 1, 3, -1]],
        &[&[1, 0, 2, 3, 1, 1, 0, 1, 3], &[], &[0, 1]],
    ];
    for (k, lists) in walks.into_iter().enumerate() {
        for order in ['a', 'l', 'b'] {
            let found = parse(strips(order, "int", lists)).expect("strips").mesh;
            let (mesh, repairs) = repair(found);
            assert!(repairs.is_empty(), "{k} {order}: {repairs}");
            let volume = mesh.signed_volume() * 1e9;
            assert!(
                (volume - 64.0 / 6.0).abs() < 1e-9,
                "{k} {order}: {volume} mm3"
            );
        }
    }
    // Without a sign -1 is the largest number.
    let found = parse(strips('l', "uint", walks[0])).expect("strips").mesh;
    assert_eq!(found.triangles.len(), 4);
    for (list, told) in [
        ([0, 1, 4], "vertex 4 of 4 in `tristrips` 0"),
        ([0, 1, -2], "vertex -2 of 4"),
    ] {
        let said = parse(strips('b', "int", &[&list])).expect_err("refused");
        assert!(said.contains(told), "{said}");
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 128, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn random_headers_and_strips_never_panic(
        lines in proptest::collection::vec(0_usize..16, 0..24),
        ends in proptest::collection::vec(0_usize..3, 24),
        data in proptest::collection::vec(any::<u8>(), 0..400),
        order in 0_usize..3,
    ) {
        let known = [
            "element vertex 3", "property float x", "property float y", "property float z", "property uchar x",
            "element face 2", "property list uchar int vertex_indices", "element tristrips 1", "property list int int vertex_indices",
            "end_header", "", "comment end_header", "property", "element", "element vertex", "property list uchar uint vertex_index",
        ];
        let format = ["ascii", "binary_little_endian", "binary_big_endian"][order];
        let mut text = format!("ply\nformat {format} 1.0");
        for (line, end) in lines.iter().zip(&ends) {
            text.push_str(["\n", "\r", "\r\n"][*end]);
            text.push_str(known[*line]);
        }
        text.push_str("\nend_header\r");
        let bytes = [text.into_bytes(), data].concat();
        if let Ok(found) = parse(bytes) {
            repair(found.mesh);
        }
    }
}

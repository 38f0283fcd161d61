//! Meshes of Gmsh. The files in `data` were written by Gmsh 4.15: a box of 10 x 8 x 6 mm ("soft tissue") against one of 5 x 8 x
//! 6 mm ("rest"), with the face at x = 0 named "fixed"; `plain_lin_22` without groups, `twice_22` one box in two groups.

mod common;

use std::path::PathBuf;

use common::SOFT;
use proptest::prelude::*;
use sulcus_core::Vec3;
use sulcus_fem::msh::{Unit, read_msh};
use sulcus_fem::{Factored, TetMesh};

fn data(name: &str) -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR"))
        .join("tests/data")
        .join(name)
}

fn read(name: &str, volume: Option<&str>) -> TetMesh {
    read_msh(&data(name), Unit::Millimetre, volume).expect("a mesh")
}

/// Writes a text and reads it as a mesh.
fn try_text(name: &str, text: impl AsRef<[u8]>, volume: Option<&str>) -> Result<TetMesh, String> {
    let path = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join(name);
    std::fs::write(&path, text).expect("a file");
    read_msh(&path, Unit::Metre, volume).map_err(|error| error.to_string())
}

/// That midside nodes are where this crate expects them.
fn check_middles(mesh: &TetMesh) {
    let edges = [[0, 1], [1, 2], [0, 2], [0, 3], [1, 3], [2, 3]];
    for tet in &mesh.tets {
        for (edge, ends) in edges.iter().enumerate() {
            let [a, b] = ends.map(|a| mesh.nodes[tet[a] as usize]);
            let middle = mesh.nodes[tet[4 + edge] as usize];
            assert!((middle - (a + b) * 0.5).norm() < 1e-12, "edge {edge}");
        }
    }
}

fn check_held(mesh: &TetMesh) {
    for (x, held) in mesh.nodes.iter().zip(&mesh.held) {
        assert_eq!(*held, [x.x.abs() < 1e-12; 3], "{x}");
    }
    assert!(mesh.held.iter().filter(|held| held[0]).count() >= 13);
}

#[test]
fn both_formats_and_both_orders_give_the_box() {
    let box_of = |name: &str, volume: Option<&str>, size: [f64; 3]| {
        let mesh = read(name, volume);
        let exact: f64 = size.iter().product::<f64>() * 1e-9;
        assert!((mesh.volume() / exact - 1.0).abs() < 1e-12, "{name}");
        check_middles(&mesh);
        mesh
    };
    let new = box_of("block_41.msh", None, [15.0, 8.0, 6.0]);
    check_held(&new);
    assert_eq!(new.nodes.len(), 155);
    let old = box_of("block_22.msh", None, [15.0, 8.0, 6.0]);
    assert_eq!((&new.nodes, &new.held), (&old.nodes, &old.held));
    assert_eq!(new.tets, old.tets);
    assert_eq!(new, box_of("block_41_param.msh", None, [15.0, 8.0, 6.0]));
    let linear = box_of("block_lin_41.msh", None, [15.0, 8.0, 6.0]);
    check_held(&linear);
    let one = box_of("block_41.msh", Some("soft tissue"), [10.0, 8.0, 6.0]);
    check_held(&one);
    assert!(
        one.nodes.len() < new.nodes.len(),
        "nodes of the other are dropped"
    );
    assert_eq!(
        one,
        box_of("block_22.msh", Some("soft tissue"), [10.0, 8.0, 6.0])
    );
    let plain = box_of("plain_lin_22.msh", None, [15.0, 8.0, 6.0]);
    assert!(plain.held.iter().all(|held| *held == [false; 3]));
    // In two groups, which lists each tetrahedron twice.
    let twice = box_of("twice_22.msh", None, [10.0, 8.0, 6.0]);
    assert_eq!(
        twice,
        box_of("twice_22.msh", Some("rest"), [10.0, 8.0, 6.0])
    );
    assert_eq!(
        twice.held.iter().filter(|held| held[0]).count(),
        1,
        "a point is held"
    );
    let metres = read_msh(&data("block_41.msh"), Unit::Metre, None);
    assert!(
        metres
            .expect_err("15 m")
            .to_string()
            .contains("within 10 m")
    );
}

#[test]
fn what_is_read_can_be_solved() {
    let mesh = read("block_41.msh", None);
    let factored = Factored::new(&mesh, &SOFT).expect("held");
    let mut load = vec![Vec3::zeros(); mesh.nodes.len()];
    let far = mesh
        .nodes
        .iter()
        .position(|x| x.x > 14.9e-3)
        .expect("an end");
    load[far] = Vec3::x() * 0.1;
    let moved = factored.solve(&[load]).expect("finite");
    assert!(moved[0][far].x > 1e-5);
}

#[test]
fn a_group_that_holds_nothing_of_the_volume_is_refused() {
    let said = read_msh(&data("block_41.msh"), Unit::Millimetre, Some("rest"));
    let said = said.expect_err("not touched").to_string();
    assert!(
        said.contains("block_41.msh: no node of the volume in group \"fixed\""),
        "{said}"
    );
    let said = read_msh(&data("block_41.msh"), Unit::Millimetre, Some("bone"));
    let said = said.expect_err("no such").to_string();
    assert!(
        said.contains("no volume \"bone\", expected \"soft tissue\" or \"rest\""),
        "{said}"
    );
    let said = read_msh(&data("plain_lin_22.msh"), Unit::Millimetre, Some("bone"));
    let said = said.expect_err("no names").to_string();
    assert!(said.contains("the file has no named volumes"), "{said}");
    let said = read_msh(&data("none.msh"), Unit::Millimetre, None);
    assert!(said.expect_err("absent").to_string().contains("none.msh"));
}

/// One tetrahedron of four nodes with tags far apart, one node that it has not, a triangle that is held, line ends of another
/// system, a section that nobody knows.
const ONE: &str =
    "$MeshFormat\r\n2.2 0 8\r\n$EndMeshFormat\r\n$Comments\nanything $Nodes\n$EndComments
$PhysicalNames\n2\n2 5 \"fixed\"\n3 6 \"one\"\n$EndPhysicalNames
$Nodes\n5\n7 0 0 0\n4000000000000 1 0 0\n3 9 9 9\n12 0 1e0 0\n5 0.0 0 1\n$EndNodes
$Elements\n2\n1 2 2 5 1 7 12 4000000000000\n9 4 2 6 1 7 4000000000000 12 5\n$EndElements\n";

#[test]
fn tags_may_be_far_apart_and_orphans_are_dropped() {
    let mesh = try_text("one.msh", ONE, Some("one")).expect("a mesh");
    assert_eq!(mesh.nodes.len(), 10);
    assert_eq!(mesh.tets, [[0, 1, 2, 3, 4, 5, 6, 7, 8, 9]]);
    assert!((mesh.volume() - 1.0 / 6.0).abs() < 1e-15);
    check_middles(&mesh);
    for (x, held) in mesh.nodes.iter().zip(&mesh.held) {
        assert_eq!(
            *held,
            [x.z == 0.0; 3],
            "corners and middles of the triangle: {x}"
        );
    }
}

#[test]
fn an_edge_between_held_nodes_is_held_only_where_a_held_element_has_it() {
    // Points alone name corners.
    let text = ONE.replace("2 5 \"fixed\"", "0 5 \"fixed\"").replace(
        "$Elements\n2\n1 2 2 5 1 7 12 4000000000000",
        "$Elements\n3\n1 15 2 5 1 7\n2 15 2 5 1 12",
    );
    let mesh = try_text("points.msh", text, None).expect("a mesh");
    let held: Vec<usize> = (0..10).filter(|&k| mesh.held[k][0]).collect();
    assert_eq!(held, [0, 2]);
}

#[test]
fn what_is_wrong_is_said_with_its_line() {
    let cases = [
        (
            "2.2 0 8",
            "4 0 8",
            "line 2: version 4, expected version 2.2 or 4.1",
        ),
        (
            "2.2 0 8",
            "2.2 1 8",
            "line 2: file type 1, expected 0: text, not binary",
        ),
        (
            "$MeshFormat",
            "$Mesh",
            "line 1: $Mesh, expected $MeshFormat",
        ),
        (
            "3 6 \"one\"",
            "7 6 \"one\"",
            "line 10: dimension 7, expected 0 to 3",
        ),
        (
            "3 6 \"one\"",
            "3 6 one",
            "line 10: 3 6 one, expected dimension, tag and \"name\"",
        ),
        (
            "$Nodes\n5",
            "$Nodes\n6",
            "line 19: $EndNodes, expected tag, x, y, z",
        ),
        (
            "$Nodes\n5",
            "$Nodes\n4",
            "line 18: 5 0.0 0 1, expected $EndNodes",
        ),
        (
            "$Nodes\n5",
            "$Nodes\n99999999999999999999",
            "line 13: 99999999999999999999, expected number of nodes",
        ),
        (
            "12 0 1e0 0",
            "12 0 one 0",
            "line 17: one, expected tag, x, y, z",
        ),
        (
            "12 0 1e0 0",
            "12 0 nan 0",
            "line 17: 12 0 nan 0, expected three finite numbers",
        ),
        (
            "12 0 1e0 0",
            "12 0 1",
            "line 17: the end of the line, expected tag, x, y, z",
        ),
        (
            "12 0 1e0 0",
            "12 0 11 0",
            "line 17: a node at 0, 11, 0 m, expected within 10 m",
        ),
        (
            "12 0 1e0 0",
            "7 0 1 0",
            "line 17: node 7 again, expected another tag than on line 14",
        ),
        (
            "$Elements\n2",
            "$Elements\n18446744073709551615",
            "line 24: $EndElements, expected tag, kind, number of tags",
        ),
        (
            "9 4 2 6 1",
            "9 77 2 6 1",
            "line 23: element of kind 77, expected a kind of element up to second order",
        ),
        (
            "9 4 2 6 1",
            "9 4 99999999999 6 1",
            "line 23: the end of the line, expected tag, kind",
        ),
        (
            "9 4 2 6 1 7 4000000000000 12 5",
            "9 7 2 6 1 7 4000000000000 12 5 3",
            "line 23: element of kind 7, expected 4 or 11",
        ),
        (
            "12 5\n$EndE",
            "12 6\n$EndE",
            "line 23: node 6, expected a node of the file",
        ),
        (
            "6 1 7 4000000000000 12 5",
            "6 1 4000000000000 7 12 5",
            "line 23: a tetrahedron flat or inside out",
        ),
        (
            "$Elements\n2\n1 2 2 5 1 7 12 4000000000000\n9 4",
            "$Elements\n2\n1 2 2 5 1 7 12 4000000000000\n9 2",
            "no tetrahedra, expected at least 1",
        ),
        (
            "$EndElements\n",
            "",
            "line 24: the end of the file, expected $EndElements",
        ),
        (
            "$EndElements\n",
            "$EndElements\n$Elements\n0\n",
            "line 25: $Elements, expected this section once",
        ),
        (
            "$EndElements\n",
            "$EndElements\nhello\n",
            "line 25: hello, expected a section",
        ),
        (
            "$EndElements\n",
            "$EndElements\n$PartitionedEntities\n",
            "line 25: $PartitionedEntities, expected a mesh that is not",
        ),
    ];
    for (from, to, said) in cases {
        assert!(ONE.contains(from), "{from}");
        let error = try_text("wrong.msh", ONE.replacen(from, to, 1), None).expect_err(said);
        assert!(
            error.contains(said) && error.contains("wrong.msh"),
            "{error}\n{said}"
        );
    }
    let nothing = try_text("wrong.msh", "", None).expect_err("empty");
    assert!(
        nothing.contains("line 1: the end of the file, expected $MeshFormat"),
        "{nothing}"
    );
    let binary =
        try_text("wrong.msh", b"$MeshFormat\n4.1 1 8\n\xff\xfe", None).expect_err("binary");
    assert!(
        binary.contains("line 3: bytes that are no text"),
        "{binary}"
    );
    // What the reader of format 4.1 alone can say.
    let text = std::fs::read_to_string(data("block_41.msh")).expect("a file");
    for (from, to, said) in [
        (
            "\n45 155 1 155\n",
            "\n45 156 1 155\n",
            "line 59: 155 in its blocks, expected 156",
        ),
        (
            "\n3 1 11 42\n",
            "\n3 1 4 42\n",
            "line 467: a tetrahedron of 10 nodes, expected 4 nodes, as on line 424",
        ),
        (
            "\n3 1 11 42\n",
            "\n2 1 11 42\n",
            "kind 11 in dimension 2, expected dimension 3",
        ),
        (
            "12 20 11 2\n",
            "12 20 11 99999999999\n",
            "line 57: $EndEntities, expected tag, box",
        ),
    ] {
        assert!(text.contains(from), "{from}");
        let error = try_text("wrong.msh", text.replacen(from, to, 1), None).expect_err(said);
        assert!(error.contains(said), "{error}\n{said}");
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 1500, failure_persistence: None, ..ProptestConfig::default() })]

    /// A good file cut short or with bytes replaced, inserted and left out, some of them digits that make counts and tags
    /// great: an error or a mesh that can be checked, never a panic.
    #[test]
    fn damaged_files_never_panic(
        which in 0..4_usize,
        changes in prop::collection::vec((any::<prop::sample::Index>(), 0..12_usize, prop_oneof![
            prop::collection::vec(any::<u8>(), 0..8),
            prop::collection::vec(prop::sample::select(b"0123456789-. \n$e".to_vec()), 0..20),
        ]), 0..4),
        cut in prop::option::of(any::<prop::sample::Index>()),
    ) {
        let name = ["block_41.msh", "block_22.msh", "twice_22.msh", ""][which];
        let mut bytes = if name.is_empty() { ONE.as_bytes().to_vec() } else { std::fs::read(data(name)).expect("a file") };
        for (at, out, put) in changes {
            let at = at.index(bytes.len());
            let end = (at + out).min(bytes.len());
            bytes.splice(at..end, put);
            if bytes.is_empty() { bytes.push(b'$'); }
        }
        if let Some(cut) = cut {
            bytes.truncate(cut.index(bytes.len()));
        }
        if let Ok(mesh) = try_text("damaged.msh", &bytes, None) {
            prop_assert!(mesh.validate().is_ok());
            prop_assert!(mesh.tets.len() <= bytes.len() && mesh.nodes.len() <= 10 * bytes.len());
        }
    }
}

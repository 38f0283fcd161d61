//! Files that are no valid meshes of Gmsh.

use crate::common::{ONE, data, try_text};
use proptest::prelude::*;

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
            "line 23: element of kind 7, expected kind 4 or 11",
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
            "line 25: $Elements, expected each section once",
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
        binary.contains("line 3: bytes that are not text"),
        "{binary}"
    );
    // Errors of the reader of format 4.1 only.
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

    /// A good file cut short, or with bytes replaced, inserted and left out. Some are digits that make counts and
    /// tags large.
    ///
    /// The reader returns an error or a mesh that can be checked; it never panics.
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

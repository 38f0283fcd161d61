//! Meshes of Gmsh. Gmsh 4.15 wrote the files in `data`: a box of 10 x 8 x 6 mm ("soft tissue") beside a box of 5 x 8
//! x 6 mm ("rest").
//!
//! The face at x = 0 is named "fixed". `plain_lin_22` has no groups; `twice_22` has one box in two groups.

use crate::common::{ONE, SOFT, data, try_text};
use sulcus_core::Vec3;
use sulcus_fem::msh::{Unit, read_msh};
use sulcus_fem::{Factored, TetMesh};

fn read(name: &str, volume: Option<&str>) -> TetMesh {
    read_msh(&data(name), Unit::Millimetre, volume).expect("a mesh")
}

/// Checks that midside nodes are in the order of this crate.
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
    // A box in two groups, which lists each tetrahedron twice.
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
    // Groups of points name corners only.
    let text = ONE.replace("2 5 \"fixed\"", "0 5 \"fixed\"").replace(
        "$Elements\n2\n1 2 2 5 1 7 12 4000000000000",
        "$Elements\n3\n1 15 2 5 1 7\n2 15 2 5 1 12",
    );
    let mesh = try_text("points.msh", text, None).expect("a mesh");
    let held: Vec<usize> = (0..10).filter(|&k| mesh.held[k][0]).collect();
    assert_eq!(held, [0, 2]);
}

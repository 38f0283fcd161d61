//! Comparison of large displacements with the reference solutions of a tongue, which were checked against CalculiX.

use crate::common::{TONGUE, load, off, reference};
use sulcus_fem::files::read_mesh;
use sulcus_fem::{NewtonOptions, solve_neo_hookean};
use sulcus_support::long;

#[test]
fn neo_hookean_cases_are_those_of_the_reference_at_every_vertex() {
    if !long::selected("neo-hookean-reference") {
        return;
    }
    let Some(folder) = reference() else { return };
    let mesh = read_mesh(&folder).expect("a mesh");
    let n = mesh.nodes.len();
    // Each tangent takes three seconds.
    let options = NewtonOptions {
        steps: 2,
        tolerance: 1e-6,
        ..NewtonOptions::default()
    };
    let cases = [("lateral", "2.5"), ("tip_vertical", "1.5")];
    for (name, newtons) in cases {
        let load = load(&folder, name, newtons, n);
        let mut tangents = 0;
        let moved = solve_neo_hookean(&mesh, &TONGUE, &load, &options, &mut |p| {
            tangents = p.tangents;
        })
        .expect("equilibrium");
        println!("{tangents} tangents");
        let off = off(&folder, &format!("{name}_nl_{newtons}N.csv"), &moved);
        assert!(off <= 1e-4, "{name}: {off:e}");
    }
}

//! Large displacements against the reference solutions of a tongue (checked there against CalculiX).

mod common;

use common::{TONGUE, reference};
use sulcus_fem::files::{ForceColumns, read_displacements, read_forces, read_mesh};
use sulcus_fem::{NewtonOptions, solve_neo_hookean};

#[test]
fn neo_hookean_cases_are_those_of_the_reference_at_every_vertex() {
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
        let unit = read_forces(
            &folder.join(format!("{name}_forces_unit.csv")),
            n,
            ForceColumns::Quadratic,
        )
        .expect("forces");
        let by: f64 = newtons.parse().expect("a number");
        let load: Vec<_> = unit.iter().map(|f| f * by).collect();
        let mut tangents = 0;
        let moved = solve_neo_hookean(&mesh, &TONGUE, &load, &options, &mut |p| {
            tangents = p.tangents;
        })
        .expect("equilibrium");
        let file = folder.join(format!("{name}_nl_{newtons}N.csv"));
        let known = read_displacements(&file, n).expect("displacements");
        let most = known.iter().map(|(_, u)| u.norm()).fold(0.0, f64::max);
        let off = known
            .iter()
            .map(|(k, u)| (moved[*k] - u).norm())
            .fold(0.0, f64::max);
        println!(
            "{name}, {newtons} N: {} vertices, largest {:.3} mm, off by at most {:.5} mm, {:.4} %, {tangents} tangents",
            known.len(),
            most * 1e3,
            off * 1e3,
            100.0 * off / most
        );
        assert!(off <= 1e-4 * most, "{name}: {off:e} of {most:e} m");
        assert!(known.len() > 2000);
    }
}

//! Large displacements against the reference solutions of a tongue (checked there against CalculiX).

use std::path::PathBuf;

use sulcus_fem::files::{read_displacements, read_forces, read_mesh};
use sulcus_fem::{Elastic, NewtonOptions, solve_neo_hookean};

#[test]
fn neo_hookean_cases_are_those_of_the_reference_at_every_vertex() {
    let folder = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../../../shared/data/fem");
    if !folder.join("nodes.csv").is_file() {
        eprintln!("SKIPPED: no reference at {}", folder.display());
        return;
    }
    let mesh = read_mesh(&folder).expect("a mesh");
    let n = mesh.nodes.len();
    let tongue = Elastic {
        young: 1e5,
        poisson: 0.49,
    };
    let cases = [("lateral", "2.5"), ("tip_vertical", "1.5")];
    for (name, newtons) in cases {
        let unit = read_forces(&folder.join(format!("{name}_forces_unit.csv")), n).expect("forces");
        let by: f64 = newtons.parse().expect("a number");
        let load: Vec<_> = unit.iter().map(|f| f * by).collect();
        let options = NewtonOptions { steps: std::env::var("STEPS").ok().map_or(4, |s| s.parse().unwrap()), ..Default::default() };
        let start = std::time::Instant::now();
        let moved = solve_neo_hookean(&mesh, &tongue, &load, &options, &mut |p| println!("{:?} {p:?}", start.elapsed()))
            .expect("equilibrium");
        let file = folder.join(format!("{name}_nl_{newtons}N.csv"));
        let reference = read_displacements(&file, n).expect("displacements");
        let most = reference.iter().map(|(_, u)| u.norm()).fold(0.0, f64::max);
        let off = reference
            .iter()
            .map(|(k, u)| (moved[*k] - u).norm())
            .fold(0.0, f64::max);
        println!(
            "{name}, {newtons} N: {} vertices, largest {:.3} mm, off by at most {:.5} mm, {:.4} %",
            reference.len(),
            most * 1e3,
            off * 1e3,
            100.0 * off / most
        );
        assert!(off <= 5e-3 * most, "{name}: {off:e} of {most:e} m");
        assert!(reference.len() > 2000);
    }
}

//! Sphere trees of real meshes and of the parametric parts: time to build, error level by level.
//!
//! `cargo bench -p sulcus-scene [-- LEVELS [NAME...]]`: by default 4 levels and all meshes.
//!
//! Meshes of the data folder beside the project are skipped with a message if the folder is absent.

// A bench uses a clock and prints.
#![allow(clippy::disallowed_methods)]

#[path = "../tests/it/meshes/mod.rs"]
mod meshes;

use std::time::Instant;

use sulcus_scene::error::{Sampling, measure};
use sulcus_scene::mesh::distance::MeshDistance;

fn main() {
    let words: Vec<String> = std::env::args().skip(1).collect();
    if words.iter().any(|word| word == "--test") {
        return;
    }
    let words: Vec<&str> = words
        .iter()
        .map(String::as_str)
        .filter(|word| !word.starts_with("--"))
        .collect();
    let levels = words.iter().find_map(|word| word.parse().ok()).unwrap_or(4);
    let names: Vec<&&str> = words.iter().filter(|w| w.parse::<u8>().is_err()).collect();
    println!("distances in mm: mean, 95 %, largest; seconds of wall time\n");
    for part in meshes::all() {
        if !names.is_empty() && !names.iter().any(|name| part.name.contains(**name)) {
            continue;
        }
        let Some(mesh) = part.mesh() else { continue };
        let started = Instant::now();
        let tree = part.tree(&mesh, levels);
        let seconds = started.elapsed().as_secs_f64();
        let sampling = Sampling::default();
        let report = measure(
            &tree,
            &MeshDistance::new(mesh),
            part.zones(),
            &sampling,
            &|_| (),
        );
        println!("{} in {seconds:.1} s", part.name);
        let zones = report.zones.iter();
        for (name, levels) in std::iter::once(("", &report.levels))
            .chain(zones.map(|zone| (zone.name.as_str(), &zone.levels)))
        {
            for e in levels {
                let (m, s) = (&e.mesh_to_spheres_mm, &e.spheres_to_mesh_mm);
                println!(
                    "  L{} {:5}  mesh to spheres {:.4} {:.4} {:.4}  spheres to mesh {:.4} {:.4} {:.4}  {name}",
                    e.level, e.spheres, m.mean, m.p95, m.max, s.mean, s.p95, s.max
                );
            }
        }
    }
}

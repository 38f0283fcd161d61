use std::time::Instant;
use sulcus_core::Vec3;
use sulcus_scene::build::{TreeOptions, build_tree};
use sulcus_scene::filled::filled;
use sulcus_scene::load::Unit;
use sulcus_scene::mesh::TriMesh;
use sulcus_scene::parametric::*;
use sulcus_scene::shapes::{cuboid, ellipsoid, icosphere};
use sulcus_scene::solid::{Reading, read_solid};

fn main() {
    let deepest: u8 = std::env::args().nth(1).map_or(3, |x| x.parse().unwrap());
    let mut meshes: Vec<(String, TriMesh)> = Vec::new();
    for file in std::env::args().skip(2) {
        let reading = Reading {
            size: sulcus_scene::size::Size::Any,
            ..Unit::Millimetre.into()
        };
        match read_solid(file.as_ref(), reading) {
            Ok(s) => meshes.push((file, s.mesh)),
            Err(e) => println!("{e}"),
        }
    }
    if meshes.is_empty() {
        meshes.push(("probe".into(), Probe::default().touching_mesh()));
        meshes.push(("mirror".into(), Mirror::default().touching_mesh()));
        meshes.push(("molar".into(), Molar::default().mesh()));
        meshes.push(("tongue".into(), Tongue::default().mesh()));
        for fdi in [31, 33, 36] {
            meshes.push((
                format!("tooth {fdi}"),
                Tooth::lower(fdi).unwrap().mesh_of_side(),
            ));
        }
        meshes.push(("ball".into(), icosphere(0.005, 3)));
        meshes.push(("egg".into(), ellipsoid(Vec3::new(0.04, 0.025, 0.015), 4)));
        meshes.push(("cube".into(), cuboid(Vec3::repeat(0.005))));
        meshes.push(("plate".into(), cuboid(Vec3::new(0.01, 0.01, 0.0005))));
        meshes.push(("thin plate".into(), cuboid(Vec3::new(0.02, 0.02, 0.0001))));
        meshes.push(("rod".into(), cuboid(Vec3::new(0.04, 0.0005, 0.0005))));
        meshes.push(("needle".into(), cuboid(Vec3::new(0.05, 1e-5, 1e-5))));
    }
    for (name, mesh) in &meshes {
        let v = mesh.signed_volume();
        let short = name.rsplit('/').next().unwrap();
        for levels in 1..=deepest {
            let mut line = format!("{short:36} L{levels}");
            for (volumetric, blended) in [(false, false), (false, true), (true, false)] {
                if volumetric && levels < 2 {
                    continue;
                }
                let options = TreeOptions {
                    levels,
                    volumetric,
                    blended,
                    ..TreeOptions::default()
                };
                let t0 = Instant::now();
                match build_tree(mesh, &options, &|_, _| ()) {
                    Ok(tree) => {
                        let b = t0.elapsed().as_secs_f64();
                        let t1 = Instant::now();
                        let f = filled(&tree);
                        line += &format!(
                            "  | {:8.2} % ({b:.1} s, {:.1} ms)",
                            100.0 * (f / v - 1.0),
                            1e3 * t1.elapsed().as_secs_f64()
                        );
                    }
                    Err(e) => line += &format!(" | {e}"),
                }
            }
            println!("{line}");
        }
    }
}

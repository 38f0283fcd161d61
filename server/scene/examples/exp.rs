use std::path::Path;
use std::time::Instant;
use sulcus_scene::build::{TreeOptions, build_tree};
use sulcus_scene::distance::MeshDistance;
use sulcus_scene::error::level_error;
use sulcus_scene::{load::Unit, solid::read_solid};
fn main() {
    let args: Vec<String> = std::env::args().collect();
    let levels: u8 = args[1].parse().unwrap();
    for name in &args[2..] {
        let (name, kind) = match name.split_once(':') {
            Some((n, k)) => (n.to_string(), k.to_string()),
            None => (name.clone(), String::new()),
        };
        let file = Path::new("/work/shared/data/meshes").join(format!("{name}.stl"));
        let mesh = read_solid(&file, Unit::Millimetre).unwrap().mesh;
        let t = Instant::now();
        let tooth = MeshDistance::new(
            read_solid(
                Path::new("/work/shared/data/meshes/tooth_36_first_molar.stl"),
                Unit::Millimetre,
            )
            .unwrap()
            .mesh,
        );
        let weight: f64 = std::env::var("FOCUS")
            .ok()
            .and_then(|v| v.parse().ok())
            .unwrap_or(20.0);
        let z = [sulcus_scene::zone::Zone {
            name: "pocket".into(),
            regions: vec![
                sulcus_scene::zone::Region::Near {
                    mesh: std::sync::Arc::new(tooth),
                    within: 0.45e-3,
                },
                sulcus_scene::zone::Region::Box {
                    low: sulcus_core::Vec3::new(-1.0, -1.0, 1.2e-3),
                    high: sulcus_core::Vec3::repeat(1.0),
                },
            ],
        }];
        let zone = |p: &sulcus_core::Vec3| z[0].contains(p);
        let per: usize = std::env::var("PER")
            .ok()
            .and_then(|v| v.parse().ok())
            .unwrap_or(60);
        let options = TreeOptions {
            levels,
            volumetric: kind == "v",
            ..TreeOptions::default()
        };
        let tree = sulcus_scene::build::build_weighted(
            &mesh,
            &options,
            &|p| {
                if kind == "p" {
                    sulcus_scene::zone::importance(&z, weight, p)
                } else {
                    1.0
                }
            },
            &|_, _| (),
        )
        .unwrap();
        let s = t.elapsed().as_secs_f64();
        println!("{name} {s:.1} s");
        let d = MeshDistance::new(mesh);
        if std::env::var("WORST").is_ok() {
            let spheres: Vec<_> = tree.shape_at(levels).map(|(_, n)| n.sphere()).collect();
            let mut worst: Vec<(f64, _)> = sulcus_scene::sample::surface(&d, 1_000_000, 0.5)
                .into_iter()
                .map(|s| {
                    let (g, k) = spheres
                        .iter()
                        .enumerate()
                        .map(|(k, x)| ((s.point - x.centre).norm() - x.radius, k))
                        .min_by(|a, b| a.0.total_cmp(&b.0))
                        .unwrap();
                    (g, (s.point * 1e3, s.normal, spheres[k].radius * 1e3))
                })
                .collect();
            worst.sort_by(|a, b| b.0.abs().total_cmp(&a.0.abs()));
            for w in worst.iter().take(200).step_by(14) {
                println!(
                    "    {:.3} at {:.2?} n {:.2?} r {:.3}",
                    w.0 * 1e3,
                    w.1.0.as_slice(),
                    w.1.1.as_slice(),
                    w.1.2
                );
            }
        }
        if kind == "p" {
            for l in 1..=levels {
                let spheres: Vec<_> = tree.shape_at(l).map(|(_, n)| n.sphere()).collect();
                let w: Vec<f64> = sulcus_scene::sample::surface(&d, 200000, 0.5)
                    .into_iter()
                    .filter(|s| zone(&s.point))
                    .map(|s| {
                        1e3 * spheres
                            .iter()
                            .map(|x| (s.point - x.centre).norm() - x.radius)
                            .fold(f64::INFINITY, f64::min)
                            .abs()
                    })
                    .collect();
                let mut owners = std::collections::BTreeMap::new();
                let mut worst = Vec::new();
                for s in sulcus_scene::sample::surface(&d, 200000, 0.5)
                    .into_iter()
                    .filter(|s| zone(&s.point))
                {
                    let (g, k) = spheres
                        .iter()
                        .enumerate()
                        .map(|(k, x)| ((s.point - x.centre).norm() - x.radius, k))
                        .min_by(|a, b| a.0.total_cmp(&b.0))
                        .unwrap();
                    *owners.entry(k).or_insert(0) += 1;
                    worst.push((g * 1e3, s.point * 1e3, s.normal, spheres[k].radius * 1e3));
                }
                worst.sort_by(|a, b| b.0.abs().total_cmp(&a.0.abs()));
                println!(
                    "  zone owners {} area {:.0} mm2 of {:.0}",
                    owners.len(),
                    d.mesh().area() * 1e6 * worst.len() as f64 / 200000.0,
                    d.mesh().area() * 1e6
                );
                if l == 3 {
                    for w in worst.iter().take(120).step_by(10) {
                        println!(
                            "   {:.3} {:.2?} n {:.2?} r {:.2}",
                            w.0,
                            w.1.as_slice(),
                            w.2.as_slice(),
                            w.3
                        );
                    }
                }
                println!(
                    "  zone L{l} {} mean {:.4} max {:.4}",
                    w.len(),
                    w.iter().sum::<f64>() / w.len() as f64,
                    w.iter().fold(0.0f64, |a, b| a.max(*b))
                );
            }
        }
        for l in 1..=levels {
            let e = level_error(&tree, l, &d);
            println!(
                "  L{l} {:5} m2s {:.4} {:.4} {:.4}   s2m {:.4} {:.4} {:.4}",
                e.spheres,
                e.mesh_to_spheres_mm.mean,
                e.mesh_to_spheres_mm.p95,
                e.mesh_to_spheres_mm.max,
                e.spheres_to_mesh_mm.mean,
                e.spheres_to_mesh_mm.p95,
                e.spheres_to_mesh_mm.max
            );
        }
    }
}

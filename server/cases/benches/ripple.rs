//! Ripple: level by tool by depth by shape by method, with the thread's CPU time per tick of the same
//! run. Times of one run compare with each other; the machine decides the rest.
//!
//! `cargo bench -p sulcus-cases --bench ripple [-- WORD...]`: only lines that contain every word.

#[path = "../tests/it/shapes/mod.rs"]
mod shapes;

use sulcus_cases::record;
use sulcus_cases::ripple::{Shape, slide};
use sulcus_cases::scenes;
use sulcus_cases::statistics::percentiles_us;
use sulcus_cases::timing::{cpu_ns, time};
use sulcus_core::{NoProbe, Vec3};
use sulcus_operator::HandParams;
use sulcus_operator::crown::{Crown, CrownParams};
use sulcus_scene::mesh::TriMesh;
use sulcus_scene::mesh::distance::MeshDistance;
use sulcus_scene::tree::blend::{BlendOptions, blend_error, calibrate};
use sulcus_scene::{BuildOptions, compile_default};

fn cpu_us() -> f64 {
    cpu_ns() as f64 * 1e-3
}

/// Thread CPU microseconds of each tick of the crown exercise on the built-in molar, hard and blended, on
/// the same hand: median, 99th percentile, mean, and mean rows.
fn crown() {
    let plain = compile_default(&BuildOptions::cached(), &|_, _| ())
        .expect("the built-in scene")
        .scene;
    let object = &plain.objects[0];
    let vertex = |v: &[f32; 3]| Vec3::new(v[0].into(), v[1].into(), v[2].into());
    let distance = MeshDistance::new(TriMesh {
        vertices: object.mesh.vertices.iter().map(vertex).collect(),
        triangles: object.mesh.triangles.clone(),
    });
    for level in 2..=4 {
        let mut scene = plain.clone();
        let options = BlendOptions {
            coarsest: level,
            finest: level,
            ..BlendOptions::default()
        };
        let object = &mut scene.objects[0];
        println!(
            "hard    {:?}",
            blend_error(&object.tree, level, &distance, 2.5e-4)
        );
        object.tree = calibrate(&object.tree, &distance, &options).expect("numbers");
        println!(
            "blended {:?}",
            blend_error(&object.tree, level, &distance, 2.5e-4)
        );
        object.level = level;
        scene.tools[0].level = level;
        let script = Crown::new(
            &scene,
            None,
            CrownParams {
                duration: 6.0,
                ..CrownParams::default()
            },
        );
        let hand = (HandParams::default(), 1);
        let script = Box::new(script.expect("a tooth"));
        let inputs = record(&scene, script, hand, 6000, |_, _| {});
        for blend in [false, true] {
            scene.params.blend = blend;
            let (mut rows, mut steps) = (0.0, 0.0);
            let run = time(&scene, &inputs, |_, out| {
                rows += f64::from(out.tools[0].rows);
                steps += f64::from(out.tools[0].substeps);
            });
            let n = run.cpu.len() as f64;
            let mean = run.cpu.iter().sum::<u64>() as f64 * 1e-3 / n;
            let at = percentiles_us(run.cpu);
            println!(
                "crown L{level} {} p50 {:.2} p99 {:.2} mean {mean:.2} us, rows {:.2}, passes {:.2}",
                if blend { "blended" } else { "hard   " },
                at.p50,
                at.p99,
                rows / n,
                steps / n,
            );
        }
    }
}

fn main() {
    let words: Vec<String> = std::env::args().skip(1).collect();
    if words.iter().any(|word| word == "--test") {
        return;
    }
    if words.is_empty() || words.iter().any(|word| word == "crown") {
        crown();
    }
    let words: Vec<_> = words.iter().filter(|w| !w.starts_with("--")).collect();
    let all = [
        ("ellipsoid", Shape::ELLIPSOID, 5),
        ("slab", Shape::Slab(Vec3::new(0.015, 0.008, 0.003)), 4),
        (
            "cylinder",
            Shape::Cylinder {
                radius: 0.008,
                half_length: 0.02,
            },
            4,
        ),
    ];
    println!(
        "{:10} {:8} {:>2} {:>5} {:8} {:>7} {:>7} {:>7} {:>6} {:>6} {:>8} {:>6} {:>5} {:>4} {:>7}",
        "shape",
        "tool",
        "L",
        "mm",
        "method",
        "rms %",
        "pk-pk",
        "bias %",
        "p50",
        "p95",
        "buzz N",
        "rows",
        "steps",
        "unc",
        "us/tick"
    );
    for (name, shape, deepest) in all {
        let mut tree = None;
        for tool in ["tip", "mirror"] {
            for level in 2..=deepest {
                for depth in [1e-3, 3e-3] {
                    for method in ["hard", "k4", "k6", "k8"] {
                        let label = format!("{name} {tool} L{level} {}mm {method}", depth * 1e3);
                        if !words.iter().all(|word| label.contains(word.as_str())) {
                            continue;
                        }
                        let tree = tree.get_or_insert_with(|| {
                            shapes::tree(name, &shapes::mesh(&shape), deepest)
                        });
                        let tree = match method[1..].parse::<f64>() {
                            Ok(blend_per_error) => {
                                let distance = MeshDistance::new(shapes::mesh(&shape));
                                let options = BlendOptions {
                                    blend_per_error,
                                    coarsest: level,
                                    finest: level,
                                    ..BlendOptions::default()
                                };
                                let started = cpu_us();
                                let tree = calibrate(tree, &distance, &options).expect("numbers");
                                println!(
                                    "{:.1} s {:?}",
                                    (cpu_us() - started) * 1e-6,
                                    blend_error(&tree, level, &distance, 2.5e-4)
                                );
                                tree
                            }
                            Err(_) => tree.clone(),
                        };
                        let mut scene =
                            scenes::scene(name, vec![shapes::object(name, tree.clone(), level)]);
                        scene.tools[0] = if tool == "tip" {
                            shapes::tip()
                        } else {
                            shapes::mirror(level.min(4))
                        };
                        let before = cpu_us();
                        let r = slide(&scene, &shape, depth, &mut NoProbe);
                        let us = (cpu_us() - before) / f64::from(r.ticks + 400);
                        println!(
                            "{name:10} {tool:8} {level:>2} {:5.1} {method:8} {:7.3} {:7.3} {:7.3} {:6.2} {:6.2} {:8.5} {:6.1} {:5.2} {:4} {us:7.1}",
                            depth * 1e3,
                            r.rms_percent,
                            r.peak_to_peak_percent,
                            r.bias_percent,
                            r.direction_p50_deg,
                            r.direction_p95_deg,
                            r.buzz,
                            r.rows,
                            r.substeps,
                            r.unconverged,
                        );
                    }
                }
            }
        }
    }
}

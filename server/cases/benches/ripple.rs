//! Ripple: level by tool by depth by shape by method, with the thread's CPU time per tick of the same
//! run. Times of one run compare with each other; the machine decides the rest.
//!
//! `cargo bench -p sulcus-cases --bench ripple [-- WORD...]`: only lines that contain every word.

#[path = "../tests/shapes/mod.rs"]
mod shapes;

use rustix::time::{ClockId, clock_gettime};
use sulcus_cases::ripple::{Shape, slide};
use sulcus_cases::scenes;
use sulcus_core::{NoProbe, Vec3};
use sulcus_scene::blend::{BlendOptions, blend_error, calibrate};
use sulcus_scene::distance::MeshDistance;

fn cpu_us() -> f64 {
    let now = clock_gettime(ClockId::ThreadCPUTime);
    now.tv_sec as f64 * 1e6 + now.tv_nsec as f64 * 1e-3
}

fn main() {
    let words: Vec<String> = std::env::args().skip(1).collect();
    if words.iter().any(|word| word == "--test") {
        return;
    }
    let words: Vec<_> = words.iter().filter(|w| !w.starts_with("--")).collect();
    let all = [
        ("ellipsoid", Shape::ELLIPSOID, 4),
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
                    for method in ["hard", "k4", "k5", "k6", "k8"] {
                        let label = format!("{name} {tool} L{level} {}mm {method}", depth * 1e3);
                        if !words.iter().all(|word| label.contains(word.as_str())) {
                            continue;
                        }
                        let tree = tree.get_or_insert_with(|| {
                            shapes::tree(name, &shapes::mesh(&shape), deepest, 0.4)
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

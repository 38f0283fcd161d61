use std::path::Path;
use std::time::Instant;
use sulcus_scene::build::{TreeOptions, build_tree};
use sulcus_scene::distance::MeshDistance;
use sulcus_scene::error::level_error;
use sulcus_scene::load::{Unit, load_stl};
fn main() {
    let args: Vec<String> = std::env::args().collect();
    let levels: u8 = args[1].parse().unwrap();
    for name in &args[2..] {
        let (name, alpha) = match name.split_once(':') { Some((n,a)) => (n.to_string(), a.parse().unwrap()), None => (name.clone(), 0.4) };
        let file = Path::new("/work/shared/data/meshes").join(format!("{name}.stl"));
        let mesh = load_stl(&file, Unit::Millimetre).unwrap();
        let t = Instant::now();
        let tree = build_tree(&mesh, &TreeOptions { levels, alpha, samples: (10*8usize.pow(levels as u32)).max(60_000), ..TreeOptions::default() }, &|_, _| ()).unwrap();
        let s = t.elapsed().as_secs_f64();
        println!("{name} {s:.1} s");
        let d = MeshDistance::new(mesh);
        for l in 1..=levels {
            let e = level_error(&tree, l, &d);
            println!("  L{l} {:5} m2s {:.4} {:.4} {:.4}   s2m {:.4} {:.4} {:.4}", e.spheres, e.mesh_to_spheres_mm.mean, e.mesh_to_spheres_mm.p95, e.mesh_to_spheres_mm.max, e.spheres_to_mesh_mm.mean, e.spheres_to_mesh_mm.p95, e.spheres_to_mesh_mm.max);
        }
    }
}

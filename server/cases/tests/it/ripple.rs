//! What a hand feels of the spheres, on the ellipsoid whose answer is known.

use sulcus_cases::ripple::{Shape, slide};
use sulcus_cases::scenes;
use sulcus_core::NoProbe;
use sulcus_scene::mesh::distance::MeshDistance;
use sulcus_scene::tree::blend::{BlendOptions, blend_error, calibrate};

/// Largest rms (per cent) and median error of direction (degrees), 1 mm deep, and largest mean error of
/// the blended surface (millimetres), level by level.
const BOUNDS: [(u8, f64, f64, f64); 2] = [(3, 2.0, 2.0, 0.02), (4, 0.4, 0.5, 0.004)];

#[test]
fn the_tip_slides_smoothly_over_the_blended_ellipsoid() {
    let shape = Shape::ELLIPSOID;
    let mesh = crate::shapes::mesh(&shape);
    let hard = crate::shapes::tree("ellipsoid", &mesh, 4);
    let distance = MeshDistance::new(mesh);
    let options = BlendOptions {
        coarsest: 3,
        ..BlendOptions::default()
    };
    let tree = calibrate(&hard, &distance, &options).expect("a tree stays a tree");
    for (level, rms, direction, error) in BOUNDS {
        let of = |tree, depth| {
            let mut scene =
                scenes::scene("ripple", vec![crate::shapes::object("shape", tree, level)]);
            scene.tools[0] = crate::shapes::tip();
            slide(&scene, &shape, depth, &mut NoProbe)
        };
        let (before, now) = (of(hard.clone(), 1e-3), of(tree.clone(), 1e-3));
        println!("level {level}: hard {before:?}\nblended {now:?}");
        assert!(now.rms_percent <= rms, "level {level}: {now:?}");
        assert!(now.direction_p50_deg <= direction, "level {level}: {now:?}");
        assert!(now.rms_percent < 0.5 * before.rms_percent);
        assert_eq!(now.unconverged, 0);
        // Ripple is an error of the surface over the depth.
        let deep = of(tree.clone(), 3e-3);
        assert!(deep.rms_percent < 0.6 * now.rms_percent, "{deep:?}");
        // The same with spheres that were not calibrated for.
        for radius in [0.0, 2.5e-4, 1e-3] {
            let found = blend_error(&tree, level, &distance, radius);
            println!("{found:?}");
            assert!(
                found.mean <= error && found.bias.abs() <= 0.5 * error,
                "{found:?}"
            );
        }
    }
}

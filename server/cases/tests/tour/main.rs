//! The simulated operator probes whole teeth: well, and badly in named ways.

mod charted;

use charted::{perform, print};
use sulcus_core::Scene;
use sulcus_core::tissue::gingiva::Site;
use sulcus_operator::tour::Tour;
use sulcus_operator::tour_params::{TourParams, Visit};
use sulcus_scene::{BuildOptions, compile_text};

/// Three molars in a row that touch, each with its gingiva. (The middle one is probed; what is beside it is a molar too,
/// whatever its number.)
fn row() -> Scene {
    let mut text = String::from(
        r#"
name = "row"
[[tool]]
name = "probe"
kind = "periodontal_probe"
level = 3
levels = 4
park_mm = [0.0, 0.0, 130.0]
"#,
    );
    for (fdi, x) in [(35, 10.95), (36, 0.0), (37, -10.95)] {
        text += &format!(
            r#"
[[object]]
name = "tooth {fdi}"
fdi = {fdi}
kind = "molar"
translate_mm = [{x}, 0.0, 0.0]
level = 3
levels = 4
[[object]]
name = "gingiva {fdi}"
kind = "gingiva"
tooth = "tooth {fdi}"
level = 3
levels = 3
tissue = "gingiva"
[object.pocket]
width_mm = 0.4
depths_mm = [5.0, 2.5, 4.0, 4.0, 2.0, 5.0]
margin_mm = 1.0
papilla_mm = 2.0
crest_mm = 0.5
wall_mm = 0.7
[object.gingiva]
wall_stiffness_n_per_mm = 0.5
floor_stiffness_n_per_mm = 0.5
"#
        );
    }
    compile_text(&text, "row.toml".as_ref(), &BuildOptions::cached(), &|_, _| {})
        .expect("compiles")
        .scene
}

#[test]
fn a_whole_tooth_is_charted() {
    let scene = if std::env::var("LONE").is_ok() {
        sulcus_cases::tissue_scenes::changed(sulcus_scene::BuiltIn::Pocket, &[("depths_mm", "[5.0, 2.5, 4.0, 4.0, 2.0, 5.0]")])
    } else { row() };
    let begin = std::time::Instant::now();
    let tour = Tour::new(&scene, &[Visit::whole(36)], TourParams::default()).expect("a tooth");
    println!("planned in {:?}", begin.elapsed());
    for path in tour.paths() {
        for degrees in (-180..=180).step_by(8) {
            let around = f64::from(degrees).to_radians();
            let tilts: Vec<String> = [-2e-3, 0.0, 2e-3, 4e-3, 6e-3]
                .iter()
                .map(|depth| {
                    let place = path.place(around, *depth, 0.0);
                    let frame = path.tooth();
                    format!(
                        "{:.0}/{:.0}",
                        libm::atan2(place.up.dot(&frame.mesial), place.up.dot(&frame.axis)).to_degrees(),
                        libm::atan2(place.up.dot(&frame.buccal), place.up.dot(&frame.axis)).to_degrees()
                    )
                })
                .collect();
            println!("{degrees:4} ceiling {:?} tilts {tilts:?}", path.ceiling(around).map(|c| c * 1e3));
        }
    }
    let charted = perform(&scene, Box::new(tour), 0, 7);
    print(&charted);
    assert!(charted.done);
    assert_eq!(charted.calls.len(), 6);
    for site in Site::ALL {
        let read = charted.of(36, site);
        assert!((read.reached - read.prescribed).abs() <= 0.3e-3, "{read:?}");
    }
}

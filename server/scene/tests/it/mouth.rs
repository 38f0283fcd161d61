//! The whole mouth: gingivae match a patient's chart for any seed, and are made in a short time.

use std::f64::consts::PI;

use sulcus_core::tissue::TissueModel;
use sulcus_core::tissue::gingiva::{Gingiva, Site, ToothFrame};
use sulcus_core::{Object, Scene, Vec3};
use sulcus_scene::anatomy::patient::{Condition, LOWER, Patient, generate};
use sulcus_scene::{BuildOptions, BuiltIn, Compiled, compile_built_in};

fn mouth(seed: u64) -> Compiled {
    let options = BuildOptions {
        seed: Some(seed),
        ..BuildOptions::cached()
    };
    compile_built_in(BuiltIn::Mouth, &options, &|_, _| ()).expect("a mouth")
}

fn gingivae(scene: &Scene) -> impl Iterator<Item = (&Object, &Gingiva)> {
    scene
        .objects
        .iter()
        .filter_map(|object| match &object.tissue {
            TissueModel::Gingiva(model) => Some((object, &**model)),
            _ => None,
        })
}

/// Returns the height over the tooth's origin at which a tip of 0.5 mm in the pocket meets the floor at rest, metres.
///
/// The value is the height of the lowest point of the tip.
fn sounded(object: &Object, model: &Gingiva, around: f64) -> f64 {
    const TIP: f64 = 0.25e-3;
    let frame = &model.tooth;
    let radial = frame.mesial * libm::cos(around) + frame.buccal * libm::sin(around);
    let floor = |id: u32| model.places[id as usize].floor;
    let balls: Vec<_> = object
        .tree
        .shape_at(model.level)
        .filter(|(id, _)| floor(*id))
        .map(|(_, node)| node.sphere())
        .collect();
    // The middle of the pocket there is over the floor's own spheres.
    let beside = |ball: &&sulcus_core::Sphere| {
        let off = ball.centre - frame.origin;
        let across = off - frame.axis * off.dot(&frame.axis);
        let turn = libm::atan2(across.dot(&frame.buccal), across.dot(&frame.mesial)) - around;
        (turn - 2.0 * PI * libm::floor(turn / (2.0 * PI) + 0.5)).abs() < 0.35
            && (ball.radius - 0.45e-3).abs() < 1e-9
    };
    let near: Vec<f64> = balls
        .iter()
        .filter(beside)
        .map(|ball| (ball.centre - frame.origin).dot(&radial))
        .collect();
    let middle = near.iter().sum::<f64>() / near.len() as f64;
    let highest = balls.iter().filter_map(|ball| {
        let off = ball.centre - frame.origin;
        let height = off.dot(&frame.axis);
        let across = (off - frame.axis * height - radial * middle).norm();
        let reach = ball.radius + TIP;
        (across < reach).then(|| height + (reach * reach - across * across).sqrt() - TIP)
    });
    highest.fold(f64::NEG_INFINITY, f64::max)
}

#[test]
fn fourteen_teeth_stand_in_their_gingivae_and_the_chart_is_in_the_scene() {
    let compiled = mouth(3);
    let patient = generate(3, Condition::Periodontitis);
    assert_eq!(compiled.patient.as_deref(), Some(&*patient.to_toml()));
    let there: Vec<u8> = LOWER
        .into_iter()
        .filter(|fdi| !patient.missing.contains(fdi))
        .collect();
    let teeth = compiled
        .scene
        .objects
        .iter()
        .filter(|o| o.fdi != 0 && o.tissue.is_rigid());
    assert_eq!(teeth.map(|tooth| tooth.fdi).collect::<Vec<_>>(), there);
    let fdis: Vec<u8> = gingivae(&compiled.scene)
        .map(|(object, _)| object.fdi)
        .collect();
    assert_eq!(fdis, there);
    for (object, model) in gingivae(&compiled.scene) {
        let chart = patient.tooth(object.fdi).expect("charted");
        for site in Site::ALL {
            let says = model.prescribed(site);
            assert!((says.depth * 1e3 - chart.depth_mm.of(site)).abs() < 1e-12);
            assert_eq!(says.bleeds, chart.bleeding.of(site));
        }
    }
}

#[test]
fn the_floor_is_as_deep_as_prescribed_deepest_under_the_contact_and_nowhere_deeper() {
    // In the last seed, places 3 mm deeper than their neighbours were once filled from the side.
    for seed in [1, 2, 6] {
        let compiled = mouth(seed);
        for (object, model) in gingivae(&compiled.scene) {
            let sink = model.params.sink() / model.params.firmness();
            let mut deepest = [(0.0, 0.0); 6];
            for k in 0..360 {
                let around = (f64::from(k) - 179.5).to_radians();
                let depth = model.margin_at(around) - sounded(object, model, around) + sink;
                let zone = &mut deepest[model.site_at(around) as usize];
                if depth > zone.0 {
                    *zone = (depth, around);
                }
            }
            for site in Site::ALL {
                let (depth, around) = deepest[site as usize];
                let off = depth - model.prescribed(site).depth;
                assert!(
                    off.abs() < 0.3e-3,
                    "{}, {}: {:.2} mm off at {:.0} deg",
                    object.name,
                    site.name(),
                    off * 1e3,
                    around.to_degrees()
                );
            }
        }
    }
}

#[test]
fn upright_at_the_line_angle_there_is_less_than_under_the_contact() {
    let compiled = mouth(2);
    let mut compared = 0;
    for (object, model) in gingivae(&compiled.scene) {
        for (site, middle) in [
            (Site::MesioBuccal, Site::Buccal),
            (Site::DistoLingual, Site::Lingual),
        ] {
            let (deep, shallow) = (model.prescribed(site).depth, model.prescribed(middle).depth);
            if deep - shallow < 0.9e-3 {
                continue;
            }
            let side = if site.is_buccal() { 1.0 } else { -1.0 };
            let line = model.proximal - 0.1;
            let around = side
                * if site.is_mesial() == Some(true) {
                    line
                } else {
                    PI - line
                };
            let sink = model.params.sink() / model.params.firmness();
            let there = model.margin_at(around) - sounded(object, model, around) + sink;
            // The margin is also lower there.
            assert!(
                there < deep - 0.5e-3,
                "{} {}: {there}",
                object.name,
                site.name()
            );
            compared += 1;
        }
    }
    assert!(compared > 8, "{compared}");
}

#[test]
fn a_new_patient_needs_no_tree_to_be_built() {
    let empty = tempfile::tempdir().expect("temporary directory");
    // Seeds of patients with all teeth: others would need a healed ridge.
    let whole = |seed: &u64| generate(*seed, Condition::Periodontitis).missing.is_empty();
    let options = BuildOptions {
        cache: Some(empty.path().to_owned()),
        seed: (4711..).find(whole),
        ..BuildOptions::default()
    };
    for scene in BuiltIn::ALL {
        compile_built_in(scene, &options, &|_, _| ()).expect("a scene");
    }
    let built: Vec<_> = std::fs::read_dir(empty.path())
        .expect("the directory")
        .filter_map(|entry| Some(entry.ok()?.file_name().to_string_lossy().into_owned()))
        .filter(|name| name.starts_with("tree-"))
        .collect();
    assert!(
        built.is_empty(),
        "these trees are not in scenes/family.bin ({built:?}): run `sulcus-server scene family --out server/scenes/family.bin`"
    );
}

#[test]
fn a_missing_tooth_leaves_a_healed_ridge_and_no_neighbour() {
    let folder = tempfile::tempdir().expect("temporary directory");
    let mut patient = Patient::healthy("without a first molar");
    patient.missing.push(36);
    std::fs::write(folder.path().join("p.toml"), patient.to_toml()).expect("written");
    let text = BuiltIn::Mouth.text().replace(
        "condition = \"periodontitis\"",
        "patient = \"p.toml\"\nteeth = [35, 37]",
    );
    let file = folder.path().join("mouth.toml");
    let scene = sulcus_scene::compile_text(&text, &file, &BuildOptions::cached(), &|_, _| ());
    let scene = scene.expect("a scene").scene;
    let names: Vec<&str> = scene.objects.iter().map(|o| o.name.as_str()).collect();
    assert!(
        names.contains(&"healed ridge 36") && !names.contains(&"tooth 36"),
        "{names:?}"
    );
    assert!(names.contains(&"gingiva 37") && !names.contains(&"tooth 34"));
}

#[test]
fn a_margin_without_room_for_a_papilla_is_refused_with_tooth_and_site() {
    let folder = tempfile::tempdir().expect("temporary directory");
    let text = "name = \"a\"\n[[tooth]]\nfdi = 36\nrecession_mm.buccal = [-4, -2, -2]\nrecession_mm.lingual = [-2, -2, -2]\n";
    std::fs::write(folder.path().join("p.toml"), text).expect("written");
    let scene = BuiltIn::Mouth
        .text()
        .replace("condition = \"periodontitis\"", "patient = \"p.toml\"");
    let file = folder.path().join("mouth.toml");
    let error = sulcus_scene::compile_text(&scene, &file, &BuildOptions::cached(), &|_, _| ());
    let error = error.expect_err("no room").to_string();
    assert!(
        error.contains("`recession_mm` of tooth 36, mesiobuccal is -4, expected at least -"),
        "{error}"
    );
    let patient = Patient::read(&folder.path().join("p.toml")).expect("in range");
    let checked = sulcus_scene::anatomy::mouth::check(&patient.0).expect_err("no room");
    assert!(error.ends_with(&checked.to_string()), "{error} / {checked}");
}

#[test]
fn a_sulcus_shallower_than_a_reading_sinks_is_refused_with_tooth_and_site() {
    let mut patient = Patient::healthy("shallow");
    let mut chart = sulcus_scene::anatomy::patient::ToothChart::healthy(33);
    chart.depth_mm.lingual[1] = 0.5;
    patient.teeth = vec![chart];
    // Tissue as firm as a healthy one has a wall of 0.05 mm, inflamed tissue none.
    assert_eq!(sulcus_scene::anatomy::mouth::check(&patient), Ok(()));
    patient.teeth[0].inflammation = 1.0;
    let error = sulcus_scene::anatomy::mouth::check(&patient).expect_err("no wall");
    let told = error.to_string();
    assert!(
        told.contains("`depth_mm` of tooth 33, lingual is 0.5, expected at least 0.95"),
        "{told}"
    );
}

/// The two right-handed halves of the mouth are each other's mirror image.
#[test]
fn the_right_side_is_the_left_one_in_a_mirror_but_for_slight_disorder_in_front() {
    let folder = tempfile::tempdir().expect("temporary directory");
    std::fs::write(
        folder.path().join("p.toml"),
        Patient::healthy("even").to_toml(),
    )
    .expect("written");
    let text = BuiltIn::Mouth
        .text()
        .replace("condition = \"periodontitis\"", "patient = \"p.toml\"");
    let file = folder.path().join("mouth.toml");
    let scene = sulcus_scene::compile_text(&text, &file, &BuildOptions::cached(), &|_, _| ());
    let scene = scene.expect("a scene").scene;
    let of = |name: &str| {
        scene
            .objects
            .iter()
            .find(|o| o.name == name)
            .expect("there")
    };
    for k in 1..=7 {
        let (left, right) = (of(&format!("tooth 3{k}")), of(&format!("tooth 4{k}")));
        let frame = |fdi: u8| match &of(&format!("gingiva {fdi}")).tissue {
            TissueModel::Gingiva(model) => model.tooth,
            _ => panic!("a gingiva"),
        };
        // Place in the tooth's own frame, whose axes are mirrored with the tooth.
        let inside = |at: &Vec3, frame: &ToothFrame| {
            let off = at - frame.origin;
            [frame.mesial, frame.buccal, frame.axis].map(|axis| off.dot(&axis))
        };
        let frames = [30 + k, 40 + k].map(frame);
        for (l, r) in left.tree.nodes().iter().zip(right.tree.nodes()) {
            let [a, b] = [inside(&l.centre, &frames[0]), inside(&r.centre, &frames[1])];
            assert!(a.iter().zip(b).all(|(a, b)| (a - b).abs() < 1e-12));
            assert_eq!(l.contact_radius, r.contact_radius);
            // The teeth in front are in slight disorder: their frames are no mirror images.
            let mirrored = Vec3::new(r.centre.x, -r.centre.y, r.centre.z);
            assert!(k <= 3 || (l.centre - mirrored).norm() < 1e-12);
        }
    }
}

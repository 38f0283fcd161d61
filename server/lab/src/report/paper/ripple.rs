//! Section 8.4: what a hand feels of the spheres, on an ellipsoid whose answer is known.

use sulcus_cases::ripple::{Shape, forced, slide};
use sulcus_cases::scenes;
use sulcus_core::tissue::TissueModel;
use sulcus_core::{DisplayMesh, NoProbe, Object, SphereTree};
use sulcus_scene::mesh::distance::MeshDistance;
use sulcus_scene::mesh::shapes;
use sulcus_scene::tree::blend::{BlendOptions, calibrate};
use sulcus_scene::tree::build::{TreeOptions, build_tree};

use super::answers::Answers;

/// Semi-axes 40, 25 and 15 mm: the ellipsoid of all ripple here.
const SHAPE: Shape = Shape::ELLIPSOID;
/// How deep the hand is, metres.
const DEPTH: f64 = 1e-3;
/// Level and id of what is printed for it.
const LEVELS: [(u8, &str); 2] = [(2, "ripple-level2-percent"), (3, "ripple-level3-percent")];

/// Ripple of a tree at a level.
fn rippled(tree: &SphereTree, level: u8) -> sulcus_cases::ripple::Ripple {
    let object = Object {
        name: "ellipsoid".into(),
        fdi: 0,
        tree: tree.clone(),
        level,
        tissue: TissueModel::Rigid,
        mesh: DisplayMesh::default(),
        carriers: Vec::new(),
    };
    let mut scene = scenes::scene("ripple", vec![object]);
    scene.tools[0] = forced(scenes::rod());
    slide(&scene, &SHAPE, DEPTH, &mut NoProbe)
}

/// Answers for the force error on a curved surface.
pub(super) fn answer(quick: bool, answers: &mut Answers) {
    let Shape::Ellipsoid(axes) = SHAPE else {
        unreachable!("an ellipsoid");
    };
    // Its facets stand off by some micrometres, tenths of a per cent here; four times that in a quick report.
    let mesh = shapes::ellipsoid(axes, if quick { 4 } else { 5 });
    let options = TreeOptions {
        levels: 3,
        ..TreeOptions::default()
    };
    let hard = build_tree(&mesh, &options, &|_, _| ()).expect("a closed mesh");
    let options = BlendOptions {
        coarsest: 2,
        finest: 3,
        samples_per_sphere: if quick { 10 } else { 30 },
        ..BlendOptions::default()
    };
    let facets = if quick { 5120 } else { 20_480 };
    let smooth = calibrate(&hard, &MeshDistance::new(mesh), &options).expect("a tree stays a tree");
    let mut buzz = Vec::new();
    for (level, id) in LEVELS {
        let (before, after) = (rippled(&hard, level), rippled(&smooth, level));
        answers.measured(
            id,
            format!(
                "{:.1} % with plain spheres, {:.1} % with blended ones (the default)",
                before.rms_percent, after.rms_percent
            ),
            &[
                ("plain_rms_percent", before.rms_percent),
                ("blended_rms_percent", after.rms_percent),
                ("plain_peak_to_peak_percent", before.peak_to_peak_percent),
                ("blended_peak_to_peak_percent", after.peak_to_peak_percent),
                ("plain_direction_p50_deg", before.direction_p50_deg),
                ("blended_direction_p50_deg", after.direction_p50_deg),
            ],
            format!("a probe's tip led {} mm deep over an ellipsoid with semi-axes 40, 25, 15 mm at 8 mm/s; rms of |F| over the exact |F| less one, without detrending; the tree is of a mesh of {facets} triangles; the error is bump height over depth, so it depends on the depth, which the paper does not say", DEPTH * 1e3),
        );
        buzz.push((before.buzz * 1e3, after.buzz * 1e3));
    }
    let (plain, blended) = buzz[1];
    answers.measured(
        "bumps-when-slow",
        format!("second difference of force per tick {plain:.2} mN with plain spheres, {blended:.2} mN with blended ones"),
        &[("plain_buzz_mn", plain), ("blended_buzz_mn", blended)],
        "not felt by anybody here: the same slide at level 3, 8 mm/s over the ellipsoid, rigid",
    );
}

//! Sections 2, 3.1, 5 to 7: spheres, springs, levels, stiffness; what the shipped scenes are made of.

use sulcus_cases::comparison::as_printed;
use sulcus_cases::tissue_scenes::{pocket, tongue};
use sulcus_core::math::norm;
use sulcus_core::optimise::UNKNOWNS;
use sulcus_core::tissue::TissueModel;
use sulcus_core::{MAX_TOOLS, Object, Scene, SphereTree};

use super::answers::Answers;
use super::springs;

/// Spheres of a tree that are the shape at a level.
fn spheres(tree: &SphereTree, level: u8) -> usize {
    tree.shape_at(level).count()
}

/// The first object of that kind.
fn object(scene: &Scene, is: fn(&TissueModel) -> bool) -> &Object {
    let found = scene.objects.iter().find(|object| is(&object.tissue));
    found.expect("the shipped scenes have a tongue, a gingiva and a tooth")
}

/// Answers for what scenes are made of.
pub(super) fn answer(answers: &mut Answers) {
    let (tongue, pocket) = (tongue(0.5), pocket("0.4"));
    springs::answer(
        object(&tongue, |tissue| matches!(tissue, TissueModel::Skeleton(_))),
        answers,
    );
    levels(&tongue, &pocket, answers);
    gingiva(&pocket, answers);
    let (mirror, probe) = (&tongue.tools[0], &pocket.tools[0]);
    let per_tool = UNKNOWNS / MAX_TOOLS;
    answers.measured(
        "tool-unknowns",
        format!("{per_tool}"),
        &[("unknowns", per_tool as f64)],
        "per tool; twelve where both hands work on one tissue",
    );
    answers.measured(
        "metric-translation",
        format!("{} N/mm", probe.stiffness_n_per_m * 1e-3),
        &[("n_per_mm", probe.stiffness_n_per_m * 1e-3)],
        "shipped scenes; at the tool's working point",
    );
    answers.measured(
        "metric-rotation",
        format!(
            "{} (probe), {} (mirror) N mm/rad",
            probe.stiffness_nm_per_rad * 1e3,
            mirror.stiffness_nm_per_rad * 1e3
        ),
        &[
            ("probe", probe.stiffness_nm_per_rad * 1e3),
            ("mirror", mirror.stiffness_nm_per_rad * 1e3),
        ],
        "shipped scenes; at the tool's working point",
    );
    let params = &tongue.params;
    let (least, most) = (params.predict_min * 1e3, params.predict_max * 1e3);
    answers.measured(
        "ccp-growth-mm",
        format!("{least} to {most} mm"),
        &[("least_mm", least), ("most_mm", most)],
        "adapts to the hand's motion of the tick; the paper's 0.5 mm/ms would be the upper end",
    );
    let speed = params.max_hand_speed;
    answers.measured(
        "ccp-tool-speed",
        format!("measured from the hand's motion, up to {speed} mm/ms"),
        &[("most_mm_per_ms", speed)],
        "not assumed: contact prediction takes each tick's own motion; faster input is clamped and counted",
    );
}

fn levels(tongue: &Scene, pocket: &Scene, answers: &mut Answers) {
    let organ = object(tongue, |tissue| matches!(tissue, TissueModel::Skeleton(_)));
    let gum = object(pocket, |tissue| matches!(tissue, TissueModel::Gingiva(_)));
    let tooth = object(pocket, TissueModel::is_rigid);
    let (mirror, probe) = (&tongue.tools[0], &pocket.tools[0]);
    let most = |tree: &SphereTree| {
        tree.nodes()
            .iter()
            .map(|node| node.children)
            .max()
            .unwrap_or(0)
    };
    let children = [
        &organ.tree,
        &gum.tree,
        &tooth.tree,
        &mirror.tree,
        &probe.tree,
    ]
    .map(most);
    let children = f64::from(children.into_iter().max().unwrap_or(0));
    answers.measured(
        "tree-children",
        format!("{children} at most"),
        &[("most", children)],
        "all trees of the shipped scenes",
    );
    let counts = [&mirror.tree, &probe.tree, &gum.tree, &tooth.tree].map(|tree| spheres(tree, 3));
    answers.measured(
        "tree-level3-spheres",
        format!(
            "{} mirror, {} probe, {} gingiva, {} tooth",
            counts[0], counts[1], counts[2], counts[3]
        ),
        &[
            ("mirror", counts[0] as f64),
            ("probe", counts[1] as f64),
            ("gingiva", counts[2] as f64),
            ("tooth", counts[3] as f64),
        ],
        "spheres that are the shape at level 3, shipped scenes",
    );
    for (id, level, of) in [
        (
            "tree-tool-level",
            probe.level,
            "probe and mirror in contact",
        ),
        (
            "tree-gingiva-level",
            gum.level,
            "gingiva in contact and in deformation",
        ),
        (
            "tree-tooth-level",
            tooth.level,
            "tooth in contact; the tree goes deeper",
        ),
        (
            "tree-tongue-level",
            organ.level,
            "tongue in contact; its skeleton is at level 2",
        ),
        (
            "gingiva-tree-levels",
            gum.tree.depth(),
            "levels of the gingiva's tree below its root",
        ),
    ] {
        let level = f64::from(level);
        answers.measured(
            id,
            format!("{level}"),
            &[("level", level)],
            format!("{of}, shipped scenes"),
        );
    }
    let shown = |scene: &Scene| -> usize {
        scene
            .objects
            .iter()
            .map(|object| object.mesh.triangles.len())
            .sum()
    };
    let shown = [shown(tongue), shown(pocket)];
    answers.measured(
        "tree-triangles",
        format!("{} (tongue), {} (tooth and gingiva)", shown[0], shown[1]),
        &[("tongue", shown[0] as f64), ("pocket", shown[1] as f64)],
        "triangles displayed, shipped scenes; the whole mouth's stand at Table 3",
    );
}

fn gingiva(pocket: &Scene, answers: &mut Answers) {
    let gum = object(pocket, |tissue| matches!(tissue, TissueModel::Gingiva(_)));
    let TissueModel::Gingiva(model) = &gum.tissue else {
        return;
    };
    let p = &model.params;
    let fall = (-1e-3 / p.reach).exp();
    answers.measured(
        "fig9-attenuation",
        format!("{fall:.2} per millimetre"),
        &[("per_mm", fall)],
        "the default model's compliance falls so with the distance from what is pressed, without a cut",
    );
    let wall = p.wall_stiffness * 1e-3;
    answers.measured(
        "gingiva-stiffness",
        format!("{wall} N/mm"),
        &[("n_per_mm", wall)],
        "default of the wall, shipped pocket",
    );
    let mut printed = pocket.clone();
    as_printed(&mut printed);
    if let TissueModel::PrintedGingiva(model) = &object(&printed, |tissue| {
        matches!(tissue, TissueModel::PrintedGingiva(_))
    })
    .tissue
    {
        let how = "chosen here for the method as printed on the shipped pocket; the default model has no such number";
        let penalty = model.penalty_n_per_m * 1e-3;
        answers.measured(
            "gingiva-penalty",
            format!("{penalty} N/mm"),
            &[("n_per_mm", penalty)],
            how,
        );
        let radius = 0.5e3 * model.tip_diameter_m;
        answers.measured(
            "eq15-radius",
            format!("{radius} mm"),
            &[("mm", radius)],
            format!("{how}; the radius of the probe's tip"),
        );
    }
    let grams = p.damage / 9.80665 * 1e3;
    answers.measured(
        "pocket-threshold-g",
        format!("{grams:.0} g ({} N)", p.damage),
        &[("g", grams), ("n", p.damage)],
        "force on the floor along the tooth's axis that counts as damage, a default of the scene",
    );
    answers.measured(
        "fig16-clearance-mm",
        "0.4 mm at rest",
        &[("mm", 0.4)],
        format!(
            "the shipped pocket, narrower than the probe's tip of {:.1} mm: the wall gives way",
            2e3 * tip_radius(pocket)
        ),
    );
}

/// Radius of the probe's lowest sphere, metres.
fn tip_radius(scene: &Scene) -> f64 {
    let tool = &scene.tools[0];
    let nearest = tool
        .tree
        .shape_at(tool.level)
        .map(|(_, node)| node)
        .min_by(|a, b| norm(&(a.centre - tool.tip)).total_cmp(&norm(&(b.centre - tool.tip))));
    nearest.map_or(0.0, |node| node.contact_radius)
}

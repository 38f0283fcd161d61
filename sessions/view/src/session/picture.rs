//! Constant part of a session's review: mouth, tools, texts at places, eyes.

use crate::review::{
    Eye, Label, MeshPicture, PartKind, PartPicture, ReviewPicture, Slider, ToolPicture,
};
use sulcus_core::math::norm;
use sulcus_core::tissue::TissueModel;
use sulcus_core::tissue::gingiva::{Gingiva, Site};
use sulcus_core::{DisplayMesh, Object, Scene, Vec3};

use super::units::millimetres;
use sulcus_sessions::exercise::{Exercise, Kind};
use sulcus_sessions::record::read::Recording;

/// Length of an arrow for one newton, mm.
pub(crate) const ARROW_MM_PER_N: f32 = 20.0;
/// Distance of the eye on the tongue from its target, mm.
const RETRACTION_MM: f64 = 75.0;
/// Eye of the close-up and its target, mm: x outward from the tooth, z up.
pub(crate) const CLOSE_UP: Eye = Eye {
    at: [15.0, 0.0, 6.0],
    on: [0.0, 0.0, 1.5],
};

/// Height of a site's text above the margin, metres: outside of the pocket.
const LABEL_UP: f64 = 4.5e-3;
/// Least elevation of the eye on the tongue, as a tangent, so that it looks over the teeth of the other side.
const RETRACTION_UP: f64 = 1.0;

pub(super) fn of(recording: &Recording, scene: &Scene, exercise: &Exercise) -> ReviewPicture {
    let probe = probe_of(scene);
    let gingiva = scene.objects.iter().find_map(gingiva_of);
    // An exercise of the tongue alone has no pocket to show.
    let probes = exercise.kind != Kind::Retraction;
    let gingiva = gingiva.filter(|_| probes);
    ReviewPicture {
        name: recording.header().exercise_name.clone(),
        about: about(recording, scene, exercise),
        tools: scene
            .tools
            .iter()
            .map(|tool| ToolPicture {
                name: tool.name.clone(),
                mesh: mesh(&tool.mesh),
                tip: millimetres(&tool.tip),
            })
            .collect(),
        probe,
        parts: scene.objects.iter().map(part).collect(),
        teeth: teeth(scene),
        span_ns: [0, 0],
        reading_band_n: gingiva.map(|_| exercise.probing.force_n),
        trauma_n: gingiva.map(|gingiva| gingiva.params.trauma),
        overview: overview(scene),
        retraction: retraction(scene, exercise),
        close_up: probes.then_some(CLOSE_UP),
        arrow_mm_per_n: ARROW_MM_PER_N,
        work: vec![
            "collide-and-solve passes".to_owned(),
            "contact rows".to_owned(),
            "longest tick of 16 ms, us".to_owned(),
        ],
        slider: Slider::Start,
    }
}

/// Index of the probing tool: the first with bands, else the first.
pub(super) fn probe_of(scene: &Scene) -> usize {
    let banded = scene.tools.iter().position(|tool| !tool.bands.is_empty());
    banded.unwrap_or(0)
}

/// Kind of an object.
pub(super) fn kind_of(object: &Object) -> PartKind {
    match object.tissue {
        TissueModel::Gingiva(_) | TissueModel::PrintedGingiva(_) => PartKind::Gingiva,
        TissueModel::Skeleton(_) | TissueModel::Surface(_) | TissueModel::PrintedSkeleton(_) => {
            PartKind::Tongue
        }
        _ if object.fdi != 0 => PartKind::Tooth,
        _ => PartKind::Other,
    }
}

/// Horizontal direction from the middle of the scene to `point`; forward for the middle itself.
pub(super) fn outward(scene: &Scene, point: &Vec3) -> Vec3 {
    let (low, high) = bounds(scene);
    let mut away = point - (low + high) / 2.0;
    away.z = 0.0;
    if norm(&away) > 1e-3 { away } else { Vec3::x() }
}

fn part(object: &Object) -> PartPicture {
    PartPicture {
        kind: kind_of(object),
        name: object.name.clone(),
        mesh: mesh(&object.mesh),
        yields: !object.tissue.is_rigid(),
    }
}

fn mesh(mesh: &DisplayMesh) -> MeshPicture {
    let opaque = |[r, g, b, _]: [u8; 4]| [r, g, b];
    MeshPicture {
        vertices: mesh.vertices.iter().map(|v| v.map(|x| x * 1e3)).collect(),
        triangles: mesh.triangles.clone(),
        colour: opaque(mesh.colour),
        vertex_colours: mesh.vertex_colours.iter().map(|c| opaque(*c)).collect(),
    }
}

/// Gingiva of an object; `None` for another tissue.
fn gingiva_of(object: &Object) -> Option<&Gingiva> {
    match &object.tissue {
        TissueModel::Gingiva(gingiva) => Some(gingiva),
        _ => None,
    }
}

/// Texts with the numbers above the teeth.
fn teeth(scene: &Scene) -> Vec<Label> {
    let teeth = scene.objects.iter();
    let teeth = teeth.filter(|object| kind_of(object) == PartKind::Tooth);
    teeth
        .map(|tooth| {
            let (low, high) = bounds_of(tooth);
            let middle = (low + high) / 2.0;
            Label {
                at: millimetres(&Vec3::new(middle.x, middle.y, high.z + 2e-3)),
                text: tooth.fdi.to_string(),
            }
        })
        .collect()
}

/// Texts on the crown above the sites of one side, for the tooth in the gingiva `object`.
pub(super) fn sites(scene: &Scene, object: u16, buccal: bool) -> Vec<Label> {
    let object = scene.objects.get(usize::from(object));
    let Some((object, gingiva)) = object.and_then(|object| Some((object, gingiva_of(object)?)))
    else {
        return Vec::new();
    };
    let label = |site: Site| {
        let around = middle_of(site, gingiva.proximal);
        let out =
            gingiva.tooth.mesial * libm::cos(around) + gingiva.tooth.buccal * libm::sin(around);
        let height = gingiva.margin_at(around);
        // Outermost vertex near the margin at the site.
        let vertices = object.mesh.vertices.iter();
        let reach = vertices.filter_map(|v| {
            let point = Vec3::from(v.map(f64::from));
            let (angle, high) = gingiva.tooth.cylindrical(&point);
            let near = libm::cos(angle - around) > 0.95 && (high - height).abs() < 1.5e-3;
            near.then(|| (point - gingiva.tooth.origin).dot(&out))
        });
        let reach = reach.fold(3e-3, |a, b| if b > a { b } else { a });
        let place = gingiva.tooth.origin + out * reach + gingiva.tooth.axis * (height + LABEL_UP);
        Label {
            at: millimetres(&place),
            text: format!("{} {}", object.fdi, short(site)),
        }
    };
    let side = Site::ALL.into_iter();
    side.filter(|site| site.is_buccal() == buccal)
        .map(label)
        .collect()
}

/// Angle of the middle of a site's zone, radians from mesial over buccal.
fn middle_of(site: Site, proximal: f64) -> f64 {
    let half = proximal / 2.0;
    let (quarter, turn) = (std::f64::consts::FRAC_PI_2, std::f64::consts::PI);
    match site {
        Site::MesioBuccal => half,
        Site::Buccal => quarter,
        Site::DistoBuccal => turn - half,
        Site::DistoLingual => half - turn,
        Site::Lingual => -quarter,
        Site::MesioLingual => -half,
    }
}

/// Abbreviation of a site on a chart.
fn short(site: Site) -> &'static str {
    match site {
        Site::MesioBuccal => "MB",
        Site::Buccal => "B",
        Site::DistoBuccal => "DB",
        Site::DistoLingual => "DL",
        Site::Lingual => "L",
        Site::MesioLingual => "ML",
    }
}

/// Eye from the front and above, a little from the right, so far away that the whole mouth is visible.
fn overview(scene: &Scene) -> Eye {
    let (low, high) = bounds(scene);
    let middle = (low + high) / 2.0;
    let size = norm(&(high - low));
    Eye {
        at: millimetres(&(middle + Vec3::new(0.46, -0.18, 0.60) * size)),
        on: millimetres(&middle),
    }
}

/// Eye from the operator's side, nearer and higher, over the teeth of the other side.
fn retraction(scene: &Scene, exercise: &Exercise) -> Option<Eye> {
    let objects = scene.objects.iter();
    let tongue = objects
        .clone()
        .find(|object| kind_of(object) == PartKind::Tongue)?;
    let target = exercise.target.as_ref();
    let (on, from) = match target.and_then(|target| {
        let tooth = |o: &&Object| o.fdi == target.tooth && kind_of(o) == PartKind::Tooth;
        Some((scene.objects.iter().find(tooth)?, target))
    }) {
        Some((tooth, target)) => {
            let (low, high) = bounds_of(tooth);
            let crown = Vec3::new((low.x + high.x) / 2.0, (low.y + high.y) / 2.0, high.z);
            (crown, Vec3::from(target.eye_mm) * 1e-3 - crown)
        }
        None => {
            let (low, high) = bounds_of(tongue);
            ((low + high) / 2.0, Vec3::new(0.8, -0.4, 0.6))
        }
    };
    let flat = Vec3::new(from.x, from.y, 0.0);
    let up = norm(&flat) * RETRACTION_UP;
    let from = Vec3::new(from.x, from.y, if from.z < up { up } else { from.z });
    Some(Eye {
        at: millimetres(&(on + from / norm(&from).max(1e-9) * (RETRACTION_MM * 1e-3))),
        on: millimetres(&on),
    })
}

fn bounds_of(object: &Object) -> (Vec3, Vec3) {
    let inf = Vec3::from([f64::INFINITY; 3]);
    let vertices = object.mesh.vertices.iter();
    let (low, high) = vertices.fold((inf, -inf), |(low, high), v| {
        let v = Vec3::from(v.map(f64::from));
        (low.inf(&v), high.sup(&v))
    });
    if low.x <= high.x {
        return (low, high);
    }
    // Without a mesh the box is that of the spheres.
    let root = &object.tree.nodes()[0];
    let reach = Vec3::from([root.bound_radius; 3]);
    (root.centre - reach, root.centre + reach)
}

/// Box of all objects; without objects, a box of a mouth's size.
fn bounds(scene: &Scene) -> (Vec3, Vec3) {
    let boxes = scene.objects.iter().map(bounds_of);
    let all = boxes.reduce(|a, b| (a.0.inf(&b.0), a.1.sup(&b.1)));
    let room = Vec3::from([0.03; 3]);
    all.unwrap_or((-room, room))
}

/// Text about the session, and explanation of the picture.
fn about(recording: &Recording, scene: &Scene, exercise: &Exercise) -> String {
    let header = recording.header();
    let or = |text: &str| {
        let plain: String = text.chars().filter(|c| !c.is_control()).collect();
        if plain.is_empty() {
            "-".to_owned()
        } else {
            plain
        }
    };
    let (from, to) = recording.facts().ticks.unwrap_or_default();
    let seconds = (to - from) as f64 * scene.tick_s();
    let [low, high] = exercise.probing.force_n;
    let migrated = recording.migration().map_or(String::new(), |migration| {
        format!("Of a former version, shown as this program replays it ({migration}).\n\n")
    });
    format!(
        "### {}\n\n{}\n\n{migrated}| | |\n|---|---|\n| learner | {} |\n| station | {} |\n| scene | {} |\n| length | {seconds:.1} s |\n| program | {} |\n\n\
         ### How to read this\n\
         - **Arrows** push on the instrument: {ARROW_MM_PER_N} mm for 1 N. Yellow: all together, with newtons; red: gingiva, orange: tongue, blue: teeth.\n\
         - **Pale blue instrument**: where the hand is, when tissue or tooth keeps the instrument from being there; the line joins the tips. Force grows with it.\n\
         - **Pocket**: follows the probe's tip, from outside the tooth; the gingiva is seen through, tongue and mirror are left out.\n\
         - **Site labels**: M mesial, D distal, B buccal, L lingual.\n\
         - **Green lines**: force at which a depth is read, {low} to {high} N. Red line: healthy tissue bleeds.\n\
         - **Depth**: of the tip below the gingival margin along the tooth's axis; grey: what the patient's chart prescribes at that site; diamonds: what was called.\n\
         - **Work**: how much there was to do in a tick, and the longest tick of every 16 ms, CPU time of the thread as it was while the session ran (nothing in recordings without channels for viewers).\n",
        or(&header.exercise_name),
        or(&exercise.task),
        or(&header.learner_id),
        or(&header.station),
        or(&scene.name),
        or(&header.program_version),
    )
}

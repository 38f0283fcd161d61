//! Constant part of a live view, from the scene of a display.

use sulcus_proto::display::{DisplayMesh, DisplayObject, DisplayScene, Kind};

use crate::review::{
    Eye, Label, MeshPicture, PartKind, PartPicture, ReviewPicture, Slider, ToolPicture,
};
use crate::session::picture::{ARROW_MM_PER_N, CLOSE_UP};

pub(super) fn of(scene: &DisplayScene) -> ReviewPicture {
    let (low, high) = bounds(scene);
    ReviewPicture {
        name: "live".into(),
        about: String::new(),
        tools: scene
            .tools
            .iter()
            .map(|tool| ToolPicture {
                name: tool.name.clone(),
                mesh: mesh(&tool.mesh),
                tip: tool.tip.map(|x| x * 1e3),
            })
            .collect(),
        probe: probe_of(scene),
        parts: scene.objects.iter().enumerate().map(part).collect(),
        teeth: scene.objects.iter().filter_map(label).collect(),
        span_ns: [0, 0],
        reading_band_n: None,
        trauma_n: None,
        overview: overview(low, high),
        retraction: None,
        close_up: Some(CLOSE_UP),
        arrow_mm_per_n: ARROW_MM_PER_N,
        work: Vec::new(),
        slider: Slider::End,
    }
}

/// Index of the probing tool: the first with bands, else the first.
pub(super) fn probe_of(scene: &DisplayScene) -> usize {
    let banded = scene.tools.iter().position(|tool| !tool.bands.is_empty());
    banded.unwrap_or(0)
}

fn part((k, object): (usize, &DisplayObject)) -> PartPicture {
    let (kind, name) = match object.kind {
        Kind::Tooth => (PartKind::Tooth, "tooth"),
        Kind::Gingiva => (PartKind::Gingiva, "gingiva"),
        Kind::Tongue => (PartKind::Tongue, "tongue"),
        Kind::Mucosa => (PartKind::Other, "mucosa"),
        Kind::Other => (PartKind::Other, "part"),
    };
    PartPicture {
        kind,
        // The number makes names of several parts differ.
        name: match object.fdi {
            0 => format!("{name} {k}"),
            fdi => format!("{name} {fdi} {k}"),
        },
        mesh: mesh(&object.mesh),
        yields: false,
    }
}

fn mesh(mesh: &DisplayMesh) -> MeshPicture {
    let opaque = |[r, g, b, _]: [u8; 4]| [r, g, b];
    MeshPicture {
        vertices: mesh.vertices().map(|v| v.map(|x| x * 1e3)).collect(),
        triangles: mesh.triangles().collect(),
        colour: opaque(mesh.colour),
        vertex_colours: mesh.vertex_colours.iter().map(|c| opaque(*c)).collect(),
    }
}

/// Text with the number above a tooth.
fn label(object: &DisplayObject) -> Option<Label> {
    let ([x, y, _], [to_x, to_y, top]) =
        bounds_of(object).filter(|_| object.kind == Kind::Tooth)?;
    Some(Label {
        at: [(x + to_x) / 2.0, (y + to_y) / 2.0, top + 2e-3].map(|x| x * 1e3),
        text: object.fdi.to_string(),
    })
}

type Box3 = ([f32; 3], [f32; 3]);

/// Box of an object, metres; `None` without a vertex.
pub(super) fn bounds_of(object: &DisplayObject) -> Option<Box3> {
    let each = object.mesh.vertices().map(|v| (v, v));
    each.reduce(joined)
}

/// Box of all objects, metres; without objects, a box of a mouth's size.
pub(super) fn bounds(scene: &DisplayScene) -> Box3 {
    let all = scene.objects.iter().filter_map(bounds_of).reduce(joined);
    all.unwrap_or(([-0.03; 3], [0.03; 3]))
}

fn joined(a: Box3, b: Box3) -> Box3 {
    let each =
        |of: fn(f32, f32) -> f32, a: [f32; 3], b: [f32; 3]| std::array::from_fn(|k| of(a[k], b[k]));
    (each(f32::min, a.0, b.0), each(f32::max, a.1, b.1))
}

/// Eye from the front and above, a little from the right, so far away that the whole mouth is visible.
fn overview(low: [f32; 3], high: [f32; 3]) -> Eye {
    let middle: [f32; 3] = std::array::from_fn(|k| (low[k] + high[k]) / 2.0);
    let size = (0..3)
        .map(|k| (high[k] - low[k]).powi(2))
        .sum::<f32>()
        .sqrt();
    let from = [0.46, -0.18, 0.60];
    Eye {
        at: std::array::from_fn(|k| (middle[k] + from[k] * size) * 1e3),
        on: middle.map(|x| x * 1e3),
    }
}

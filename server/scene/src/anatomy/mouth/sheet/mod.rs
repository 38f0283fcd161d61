//! The soft tissues of a mouth as a student sees them: one sheet from the margins to lip, cheek and floor of the mouth.
//!
//! Margin, recession and inflammation are visible. Depth, bleeding, furcation and mobility are hidden, and no such
//! value reaches the sheet: two patients with the same visible values have the same sheet, bit for bit.
//!
//! # Margin
//! The drawn margin touches the tooth at the height of the simulated one. Both have the shape of a pocket of a usual
//! depth, so that no margin tells a depth. Beside a contact the sheet rises above the simulated margin, up to the
//! contact, where a healthy papilla ends.
//!
//! # Surface
//! Columns run down both sides of each tooth, from its margin. Between neighbours a saddle joins the columns of both
//! sides. Where no tooth stands, the columns of both sides begin at the crest of the ridge.
//!
//! The number of columns and rows is the same for every patient, so that a ridge has a tooth's columns.
//!
//! # Pieces
//! The sheet is cut at the planes between neighbours, and in a row below the mucogingival line. Vertices on a cut have
//! the same bits in both pieces.

mod cell;
mod face;
mod floor;
mod gap;
mod levels;
mod line;
mod path;
mod relax;
mod ridge;
mod sizes;
mod strip;
#[cfg(test)]
mod tests;
mod vestibule;
mod weave;

use sulcus_core::tissue::TissueModel;
use sulcus_core::tissue::gingiva::{Gingiva, ToothFrame};
use sulcus_core::{Object, Scene, Vec3};

use super::standing;
use crate::mesh::TriMesh;
use crate::parallel;
use cell::Cell;
use face::Faces;
use gap::Gap;
use levels::Levels;
use line::Line;
use ridge::Ridge;
use weave::{Woven, weave};

/// Number of angles of a margin.
const ANGLES: usize = 144;
/// Largest difference between a tooth's frame and its place on the arch, metres and dimensionless.
const SAME: f64 = 1e-9;

/// Part of the soft tissues.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Part {
    /// Free and attached gingiva, from the margin or the crest of a ridge to the mucogingival line.
    Gingiva,
    /// Alveolar mucosa and the bottom of the vestibule.
    Mucosa,
    /// Inner side of lip and cheek, and their rim.
    Lip,
    /// Floor of the mouth.
    Floor,
}

/// Place of a vertex in the anatomy.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Mark {
    /// Part of the tissue.
    pub part: Part,
    /// Whether the vertex lies on the tongue's side.
    pub lingual: bool,
    /// Height of the margin or the crest over the vertex, mm.
    pub below: f64,
    /// Share of the way through the part: of a gingiva from the margin (0) to the mucogingival line (1); of the mucosa
    /// to the vestibule (1) and round its bottom (2); of a lip to the end (1); of the floor to the middle (1).
    pub share: f64,
    /// Nearness to a papilla, 0 in the middle of a tooth to 1 between neighbours.
    pub papilla: f64,
    /// Inflammation, 0 to 1.
    pub inflammation: f64,
    /// Whether the vertex lies under the crest of a ridge or of a retromolar pad.
    pub is_ridge: bool,
    /// Place along the arch from the midline, mm; positive on the patient's left.
    pub s: f64,
    /// Share of darkness towards the ends of the sheet, 0 to 1.
    pub dark: f64,
}

/// Piece of the sheet.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Piece {
    /// Mesh, world axes, metres.
    pub mesh: TriMesh,
    /// Places of the vertices in the anatomy.
    pub marks: Vec<Mark>,
}

/// Gingiva of a tooth.
#[derive(Clone, Debug, PartialEq)]
pub struct DrawnGingiva {
    /// The tooth's part of the sheet.
    pub piece: Piece,
    /// Heights of the drawn margin over the tooth's origin at equal angles from mesial over buccal, metres.
    pub margin: Vec<f64>,
    /// Places of the six sites at the margin, in the order of `Site::ALL`, world axes, metres.
    pub sites: [Vec3; 6],
}

/// Soft tissues of a mouth, by objects of the scene.
#[derive(Clone, Debug, PartialEq)]
pub struct Sheet {
    /// Gingivae by object.
    pub gingivae: Vec<Option<DrawnGingiva>>,
    /// Healed ridges by object.
    pub ridges: Vec<Option<Piece>>,
    /// The rest: mucosa, vestibule, lip and cheek, floor, retromolar pads, and ridges that are no object.
    pub rest: Piece,
}

/// All that columns are made from.
struct Mouth<'a> {
    line: Line,
    cells: Vec<Cell<'a>>,
    faces: Faces,
    ridge: Ridge,
    gaps: Vec<Gap>,
    levels: Levels,
}

/// Returns the soft tissues of a compiled scene. `None`: the scene has no gingiva of a `[mouth]`.
///
/// Sizes of the collar that a scene file sets are not in the compiled scene. The sheet has the default sizes.
pub fn sheet(scene: &Scene) -> Option<Sheet> {
    // A scene without a mouth needs no shapes of teeth, which take seconds.
    let is_of_mouth = |object: &Object| object.name == format!("gingiva {}", object.fdi);
    if !scene.objects.iter().any(is_of_mouth) {
        return None;
    }
    let all = standing();
    let gingiva = |fdi: u8, frame: &ToothFrame| -> Option<(usize, &Gingiva)> {
        scene
            .objects
            .iter()
            .enumerate()
            .find_map(|(k, object)| match &object.tissue {
                TissueModel::Gingiva(model) if object.fdi == fdi && same(&model.tooth, frame) => {
                    Some((k, &**model))
                }
                _ => None,
            })
    };
    let found: Vec<Option<(usize, &Gingiva)>> = all
        .iter()
        .map(|tooth| gingiva(tooth.fdi, &tooth.frame))
        .collect();
    if found.iter().all(Option::is_none) {
        return None;
    }
    let ridge = |fdi: u8| {
        let name = format!("healed ridge {fdi}");
        scene.objects.iter().position(|object| object.name == name)
    };
    let ridges: Vec<Option<usize>> = all.iter().map(|tooth| ridge(tooth.fdi)).collect();
    let seen = |model: &Gingiva| {
        let recession = model.sites.map(|site| site.recession * 1e3);
        (recession, model.params.inflammation)
    };
    let cells = all.iter().zip(&found).map(|(tooth, found)| {
        let seen = found.map(|(_, model)| seen(model));
        Cell::new(tooth, seen)
    });
    let mouth = Mouth::new(cells.collect());
    let own: Vec<bool> = (0..all.len())
        .map(|k| found[k].is_some() || ridges[k].is_some())
        .collect();
    let (pieces, rest) = weave(&mouth, &woven(&mouth), &own);
    let mut sheet = Sheet {
        gingivae: scene.objects.iter().map(|_| None).collect(),
        ridges: scene.objects.iter().map(|_| None).collect(),
        rest,
    };
    for (k, piece) in pieces.into_iter().enumerate() {
        match (found[k], ridges[k]) {
            (Some((object, _)), _) => sheet.gingivae[object] = Some(drawn(&mouth.cells[k], piece)),
            (None, Some(object)) => sheet.ridges[object] = Some(piece),
            (None, None) => {}
        }
    }
    Some(sheet)
}

impl<'a> Mouth<'a> {
    fn new(mut cells: Vec<Cell<'a>>) -> Self {
        let line = Line::new(standing());
        gap::raise(&mut cells);
        let faces = Faces::new(&line, &cells);
        let ridge = Ridge::new(&line, &cells, &faces);
        let gaps = (0..=cells.len())
            .map(|k| Gap::new(&line, &cells, (&ridge, &faces), k))
            .collect();
        let levels = Levels::new(&line, &cells);
        Self {
            line,
            cells,
            faces,
            ridge,
            gaps,
            levels,
        }
    }
}

/// Columns of both sides with their points.
fn woven(mouth: &Mouth<'_>) -> [Woven; 2] {
    [0, 1].map(|side| {
        let strip = strip::strip(mouth, side);
        let columns = &strip.columns;
        let mut points = parallel::map(columns.len(), |c| path::path(mouth, &columns[c], side));
        relax::relax(mouth, &strip, &mut points);
        if side == 1 {
            // Both halves of the floor end in the same places of the middle line.
            let last = points.len() - 1;
            for c in 0..points.len() / 2 {
                let end = points[c].len() - 1;
                points[last - c][end].0 = points[c][end].0;
            }
        }
        Woven { strip, points }
    })
}

fn same(a: &ToothFrame, b: &ToothFrame) -> bool {
    let of = |f: &ToothFrame| [f.origin, f.axis, f.mesial, f.buccal];
    let mut pairs = of(a).into_iter().zip(of(b));
    pairs.all(|(a, b)| (a - b).norm() <= SAME)
}

fn drawn(cell: &Cell<'_>, piece: Piece) -> DrawnGingiva {
    let angle = |k: usize| std::f64::consts::TAU * k as f64 / ANGLES as f64;
    let sites = cell.visible.as_ref().map(|seen| seen.sulcus.sites());
    DrawnGingiva {
        piece,
        margin: (0..ANGLES).map(|k| cell.margin(angle(k)) * 1e-3).collect(),
        sites: sites.unwrap_or_default().map(|around| {
            let z = cell.margin(around);
            cell.world(around, cell.surface(around, z), z) * 1e-3
        }),
    }
}

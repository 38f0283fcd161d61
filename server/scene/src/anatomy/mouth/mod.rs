//! The teeth and gingivae of a patient, placed on the lower arch.
//!
//! A tooth's tree comes from a family of seven shapes (the file `family.bin`): placed, and mirrored on the right side. A gingiva is
//! laid out anew for each patient ([`crate::anatomy::collar`]), round its tooth and up to the planes between neighbours.

mod faces;
mod gingiva;

use std::f64::consts::FRAC_PI_2;
use std::path::{Path, PathBuf};
use std::sync::LazyLock;

use serde::{Deserialize, Serialize};
use sulcus_core::Vec3;
use sulcus_core::tissue::gingiva::{GingivaParams, Site, ToothFrame};

use crate::anatomy::arch;
use crate::anatomy::arch::Footprint;
use crate::anatomy::collar::{Collar, CollarSizes, Entrance, Sulcus, outer_face};
use crate::anatomy::patient::{Condition, LOWER, Patient, ToothChart};
use crate::anatomy::sections::Sections;
use crate::anatomy::tooth::{Furcation, Tooth};
use crate::file::GingivaEntry;
use crate::mesh::TriMesh;

pub(crate) use gingiva::{placed_gingiva, placed_mesh};

/// `[mouth]`: a patient's teeth with their gingivae.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct MouthEntry {
    /// Patient file, relative to the scene file. Without one a patient is generated.
    pub patient: Option<PathBuf>,
    /// What a generated patient has.
    pub condition: Condition,
    /// Seed of a generated patient.
    pub seed: u64,
    /// FDI numbers of the teeth that are modelled; all that the patient has when left out.
    pub teeth: Option<Vec<u8>>,
    /// Level of the teeth in contact.
    pub tooth_level: u8,
    /// Finest level of the teeth that is kept.
    pub tooth_levels: u8,
    /// Width of the pockets at rest, mm. A real one is about 0.4, and a probe's tip 0.5.
    pub width_mm: f64,
    /// Thickness of the free margin, mm.
    pub crest_mm: f64,
    /// Thickness of the gingiva farther down, mm.
    pub wall_mm: f64,
    /// Parameters of all gingivae that differ from the defaults; how inflamed each is, the patient says.
    pub gingiva: GingivaEntry,
}

impl Default for MouthEntry {
    fn default() -> Self {
        Self {
            patient: None,
            condition: Condition::default(),
            seed: 1,
            teeth: None,
            tooth_level: 3,
            tooth_levels: 4,
            width_mm: 0.4,
            crest_mm: 0.7,
            wall_mm: 1.3,
            gingiva: GingivaEntry::default(),
        }
    }
}

/// Height in the world at which the jaw begins, mm: below the deepest floor of any tooth.
pub const JAW_TOP: f64 = -13.5;
/// Room that a papilla needs under the contact point, mm.
const UNDER_CONTACT: f64 = 0.8;

/// A tooth that stands in the mouth.
#[derive(Clone)]
pub(crate) struct Standing {
    /// FDI number.
    pub fdi: u8,
    /// Surface, metres, the tooth's frame (of a left tooth).
    pub mesh: TriMesh,
    /// Frame in the world, metres.
    pub frame: ToothFrame,
    shape: Tooth,
    /// Mesial and distal contact point, mm, the tooth's frame.
    contacts: [Vec3; 2],
    sections: Sections,
}

impl Standing {
    /// How far the gingiva's outer faces are from the axis where the jaw begins, buccally and lingually, mm.
    pub(crate) fn faces(&self, wall: f64) -> [f64; 2] {
        let z = JAW_TOP - self.frame.origin.z * 1e3;
        [1.0, -1.0].map(|side| outer_face(&self.sections, wall, FRAC_PI_2 * side, z))
    }

    /// How far the contact points are from the axis, mesially and distally, mm.
    pub(crate) fn ends(&self) -> [f64; 2] {
        let [mesial, distal] = self.contacts;
        [mesial.x, -distal.x]
    }
}

/// All lower teeth in the order of [`LOWER`], made once per process.
pub(crate) fn standing() -> &'static [Standing] {
    static STANDING: LazyLock<Vec<Standing>> = LazyLock::new(stand);
    &STANDING
}

/// Makes all lower teeth. The right side's shapes are the left side's.
fn stand() -> Vec<Standing> {
    let teeth: Vec<Tooth> = (31..=37).filter_map(Tooth::lower).collect();
    let shapes: Vec<(Tooth, TriMesh, Sections, [Vec3; 2])> =
        crate::parallel::map(teeth.len(), |k| {
            let shape = teeth[k].clone();
            let mesh = shape.mesh();
            let low = JAW_TOP - arch::OCCLUSAL + shape.crown_height_mm() - 1.0;
            let sections = Sections::of(&mesh, low, shape.crown_height_mm() + 0.5);
            let contacts = shape.contacts();
            (shape, mesh, sections, contacts)
        });
    let footprints = |side: u8| -> Vec<Footprint> {
        let all = shapes.iter().zip(1..);
        all.map(|((shape, _, _, contacts), k)| Footprint {
            fdi: 10 * side + k,
            contacts: *contacts,
            crown_height: shape.crown_height_mm(),
        })
        .collect()
    };
    let frames = [3, 4].map(|side| arch::quadrant(&footprints(side)));
    LOWER
        .into_iter()
        .map(|fdi| {
            let k = usize::from(fdi % 10 - 1);
            let (shape, mesh, sections, contacts) = &shapes[k];
            let mut frame = frames[usize::from(fdi / 10 - 3)][k];
            frame.origin *= 1e-3;
            Standing {
                fdi,
                mesh: mesh.clone(),
                frame,
                shape: shape.clone(),
                contacts: *contacts,
                sections: sections.clone(),
            }
        })
        .collect()
}

/// Why a patient's gingiva cannot be laid out.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("`{key}` of tooth {fdi}, {site} is {found}, expected at least {least:.2}: {why}")]
pub struct NoRoom {
    /// Key in the patient file.
    pub key: &'static str,
    /// The tooth.
    pub fdi: u8,
    /// The site.
    pub site: &'static str,
    /// Value found, mm.
    pub found: f64,
    /// Least value for which there is room, mm.
    pub least: f64,
    /// What there is no room for.
    pub why: &'static str,
}

/// Least height of a pocket's wall at rest, mm.
const LEAST_WALL: f64 = 0.05;

/// Whether all of a patient's gingivae can be laid out in a mouth of the default sizes and tissue.
///
/// # Errors
/// The first site for which there is no room.
pub fn check(patient: &Patient) -> Result<(), NoRoom> {
    let entry = MouthEntry::default();
    let mut all = standing().to_vec();
    all.retain(|tooth| patient.tooth(tooth.fdi).is_some());
    for (k, tooth) in all.iter().enumerate() {
        if let Some(chart) = patient.tooth(tooth.fdi) {
            let params = GingivaParams {
                inflammation: chart.inflammation,
                ..GingivaParams::default()
            };
            collar(&all, k, &chart, &entry, &params)?;
        }
    }
    Ok(())
}

/// The collar of the tooth at `k` among those that stand (in the order of [`LOWER`]).
pub(crate) fn collar(
    all: &[Standing],
    k: usize,
    chart: &ToothChart,
    entry: &MouthEntry,
    params: &GingivaParams,
) -> Result<Collar, NoRoom> {
    let tooth = &all[k];
    let depths = chart.depth_mm.round();
    // (The junction is nearly level there, at the height of the origin.)
    let nearly = chart.recession_mm.round().map(|recession| -recession);
    let angles = Sulcus::new(&tooth.sections, depths, nearly).sites();
    // Depths are prescribed as read, whatever the tissue's firmness: the floor lies higher at rest.
    let sink = params.sink() / params.firmness() * 1e3;
    let mut margins = [0.0; 6];
    for site in Site::ALL {
        let i = site as usize;
        let (cej, found) = (tooth.shape.cej(angles[i]), chart.recession_mm.of(site));
        if depths[i] < sink + LEAST_WALL {
            return Err(NoRoom {
                key: "depth_mm",
                fdi: tooth.fdi,
                site: site.name(),
                found: depths[i],
                least: sink + LEAST_WALL,
                why: "the tissue is so soft that a reading's force sinks as far into the floor",
            });
        }
        margins[i] = cej - found;
        if let Some(mesial) = site.is_mesial() {
            let highest = tooth.contacts[usize::from(!mesial)].z - UNDER_CONTACT;
            if margins[i] > highest {
                return Err(NoRoom {
                    key: "recession_mm",
                    fdi: tooth.fdi,
                    site: site.name(),
                    found,
                    least: cej - highest,
                    why: "higher up there is no room for a papilla under the contact point",
                });
            }
        }
    }
    let sizes = CollarSizes {
        width: entry.width_mm,
        crest: entry.crest_mm,
        wall: entry.wall_mm,
        base: JAW_TOP - tooth.frame.origin.z * 1e3,
        sink,
    };
    Ok(Collar {
        tooth: tooth.shape.clone(),
        sections: tooth.sections.clone(),
        entrances: entrances(tooth, chart)?,
        sulcus: Sulcus::new(&tooth.sections, depths, margins),
        neighbours: faces::neighbours(all, k, entry.wall_mm),
        sizes,
    })
}

/// The entrances between a tooth's roots with their degrees.
fn entrances(tooth: &Standing, chart: &ToothChart) -> Result<Vec<Entrance>, NoRoom> {
    let entrance = |furcation: Furcation| {
        let (site, degree) = if furcation.around > 0.0 {
            (Site::Buccal, chart.furcation.buccal)
        } else {
            (Site::Lingual, chart.furcation.lingual)
        };
        let lost = chart.depth_mm.of(site) + chart.recession_mm.of(site);
        let least = tooth.shape.cej(furcation.around) - furcation.height_mm;
        if degree > 0 && lost < least {
            return Err(NoRoom {
                key: "depth_mm` plus `recession_mm",
                fdi: tooth.fdi,
                site: site.name(),
                found: lost,
                least,
                why: "its `furcation` is not 0, and higher up the roots have not divided",
            });
        }
        Ok(Entrance { furcation, degree })
    };
    tooth.shape.furcations().into_iter().map(entrance).collect()
}

/// Tells each collar how deep its neighbours' floors are where they meet. (All axes are upright.)
pub(crate) fn meet(collars: &mut [Collar], all: &[Standing]) {
    let floors: Vec<(u8, [[f64; 2]; 2])> = collars
        .iter()
        .zip(all)
        .map(|(collar, tooth)| {
            let up = tooth.frame.origin.z * 1e3;
            let in_world = |end| collar.floors_at(end).map(|z| z + up);
            (tooth.fdi, [0, 1].map(in_world))
        })
        .collect();
    for (collar, tooth) in collars.iter_mut().zip(all) {
        for neighbour in collar.neighbours.iter_mut().flatten() {
            let (fdi, end) = neighbour.end;
            if let Some((_, theirs)) = floors.iter().find(|(other, _)| *other == fdi) {
                let up = tooth.frame.origin.z * 1e3;
                neighbour.floors = theirs[end].map(|z| z - up);
            }
        }
    }
}

/// The patient of `file`, else the one that `seed` generates, with its file's text.
pub(crate) fn patient(
    file: Option<&Path>,
    condition: Condition,
    seed: u64,
) -> Result<(Patient, String), crate::file::FileError> {
    match file {
        Some(file) => Patient::read(file),
        None => {
            let patient = crate::anatomy::patient::generate(seed, condition);
            let text = patient.to_toml();
            Ok((patient, text))
        }
    }
}

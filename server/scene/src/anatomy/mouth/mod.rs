//! The teeth and gingivae of a patient, placed on the lower arch.
//!
//! The tree of a tooth comes from a family of seven shapes, the file `family.bin`. It is placed, and mirrored on the
//! right side.
//!
//! A gingiva is laid out anew for each patient ([`crate::anatomy::collar`]), round its tooth and up to the planes
//! between neighbours.

mod drawn_teeth;
mod faces;
mod packed_tissue;
mod sheet;
mod standing;

use std::path::Path;

use sulcus_core::Vec3;
use sulcus_core::tissue::gingiva::{GingivaParams, Site};

use crate::anatomy::arch::{from_world, to_world};
use crate::anatomy::collar::{Collar, CollarSizes, Entrance, SulcusProfile, USUAL_MM};
use crate::anatomy::patient::{Patient, PatientFault, ToothChart, generate};
use crate::anatomy::tooth::Furcation;
use crate::file::{Condition, MouthEntry};
use crate::hand_written::FileError;

pub use drawn_teeth::{DrawnTooth, drawn_teeth};
pub(crate) use packed_tissue::{placed_gingiva, placed_mesh};
pub use sheet::{DrawnGingiva, Mark, Part, Piece, Sheet, sheet};
pub use standing::JAW_TOP;
pub(crate) use standing::{Standing, standing};

/// Least room for a papilla under the contact point, mm.
const UNDER_CONTACT: f64 = 0.8;

/// Reason why a patient's gingiva cannot be laid out.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("`{key}` of tooth {fdi}, {site} is {found}, expected at least {least:.2}: {why}")]
pub struct NoRoom {
    /// Key in the patient file.
    pub key: &'static str,
    /// FDI number of the tooth.
    pub fdi: u8,
    /// The site.
    pub site: &'static str,
    /// Value found, mm.
    pub found: f64,
    /// Least value with room, mm.
    pub least: f64,
    /// Tissue that has no room.
    pub why: &'static str,
}

/// Least height of a pocket's wall at rest, mm.
const LEAST_WALL: f64 = 0.05;

/// Checks that all gingivae of a patient can be laid out in a mouth of the default sizes and tissue.
///
/// # Errors
/// [`NoRoom`] with the first site without room.
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

/// Returns all faults of a patient: values out of range, and sites without room at teeth whose values are in range.
pub fn faults(patient: &Patient) -> Vec<PatientFault> {
    let mut found = patient.faults();
    let mut all = standing().to_vec();
    all.retain(|tooth| patient.tooth(tooth.fdi).is_some());
    for tooth in &all {
        let is_refused = |fault: &PatientFault| fault.fdi == Some(tooth.fdi);
        let Some(chart) = patient.tooth(tooth.fdi) else {
            continue;
        };
        if found.iter().any(is_refused) {
            continue;
        }
        let params = GingivaParams {
            inflammation: chart.inflammation,
            ..GingivaParams::default()
        };
        let (_, mut without) = margins(tooth, &chart, sink_mm(&params));
        let furcations = tooth.shape.furcations().into_iter();
        without.extend(furcations.filter_map(|at| entrance(tooth, &chart, at).err()));
        found.extend(without.iter().map(NoRoom::fault));
    }
    found
}

impl NoRoom {
    /// The same fault with its place as data.
    fn fault(&self) -> PatientFault {
        let is_sum = self.key.contains("plus");
        PatientFault {
            fdi: Some(self.fdi),
            site: Site::ALL.into_iter().find(|site| site.name() == self.site),
            key: if is_sum { "loss" } else { self.key },
            field: format!("`{}` of tooth {}, {}", self.key, self.fdi, self.site),
            found: self.found.to_string(),
            expected: format!("at least {:.2}: {}", self.least, self.why),
        }
    }
}

/// Returns how far the force of a reading sinks into the floor, mm.
fn sink_mm(params: &GingivaParams) -> f64 {
    params.sink() / params.firmness() * 1e3
}

/// Returns the collar of tooth `k` of `all`, which is in the order of [`crate::file::LOWER`].
pub(crate) fn collar(
    all: &[Standing],
    k: usize,
    chart: &ToothChart,
    entry: &MouthEntry,
    params: &GingivaParams,
) -> Result<Collar, NoRoom> {
    let tooth = &all[k];
    let depths = chart.depth_mm.round();
    // Depths are prescribed as read, whatever the firmness of the tissue. The floor at rest lies higher.
    let sink = sink_mm(params);
    let (margins, without) = margins(tooth, chart, sink);
    if let Some(first) = without.into_iter().next() {
        return Err(first);
    }
    let sizes = CollarSizes {
        width: entry.width_mm,
        crest: entry.crest_mm,
        wall: entry.wall_mm,
        base: tooth.base(),
        sink,
    };
    Ok(Collar {
        tooth: tooth.shape.clone(),
        sections: tooth.sections.clone(),
        entrances: entrances(tooth, chart)?,
        sulcus: SulcusProfile::new(&tooth.sections, depths, margins),
        neighbours: faces::neighbours(all, k, entry.wall_mm),
        sizes,
    })
}

/// Returns the heights of the margins at the six sites, mm, and the sites without room.
fn margins(tooth: &Standing, chart: &ToothChart, sink: f64) -> ([f64; 6], Vec<NoRoom>) {
    let depths = chart.depth_mm.round();
    // The junction is nearly level there, at the height of the origin. Its height is taken beside a pocket of the usual
    // depth, so that a margin does not tell the depths.
    let nearly = chart.recession_mm.round().map(|recession| -recession);
    let angles = SulcusProfile::new(&tooth.sections, [USUAL_MM; 6], nearly).sites();
    let mut without = Vec::new();
    let mut margins = [0.0; 6];
    for site in Site::ALL {
        let i = site as usize;
        let (cej, found) = (tooth.shape.cej(angles[i]), chart.recession_mm.of(site));
        if depths[i] < sink + LEAST_WALL {
            without.push(NoRoom {
                key: "depth_mm",
                fdi: tooth.fdi,
                site: site.name(),
                found: depths[i],
                least: sink + LEAST_WALL,
                why: "the force of a reading sinks as far into the soft floor",
            });
        }
        margins[i] = cej - found;
        if let Some(mesial) = site.is_mesial() {
            let highest = tooth.contacts[usize::from(!mesial)].z - UNDER_CONTACT;
            if margins[i] > highest {
                without.push(NoRoom {
                    key: "recession_mm",
                    fdi: tooth.fdi,
                    site: site.name(),
                    found,
                    least: cej - highest,
                    why: "a higher papilla has no room under the contact point",
                });
            }
        }
    }
    (margins, without)
}

/// Returns the entrances between a tooth's roots with their degrees.
fn entrances(tooth: &Standing, chart: &ToothChart) -> Result<Vec<Entrance>, NoRoom> {
    let furcations = tooth.shape.furcations().into_iter();
    furcations.map(|at| entrance(tooth, chart, at)).collect()
}

fn entrance(
    tooth: &Standing,
    chart: &ToothChart,
    furcation: Furcation,
) -> Result<Entrance, NoRoom> {
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
            why: "its `furcation` is not 0, and the roots divide further down",
        });
    }
    Ok(Entrance { furcation, degree })
}

/// Sets the depth of the neighbours' floors in each collar, where two collars meet.
pub(crate) fn meet(collars: &mut [Collar], all: &[Standing]) {
    let floors: Vec<(u8, [[Vec3; 2]; 2])> = collars
        .iter()
        .zip(all)
        .map(|(collar, tooth)| {
            let frame = tooth.frame_mm();
            let in_world = |end| collar.floors_at(end).map(|p| to_world(&frame, &p));
            (tooth.fdi, [0, 1].map(in_world))
        })
        .collect();
    for (collar, tooth) in collars.iter_mut().zip(all) {
        let frame = tooth.frame_mm();
        for neighbour in collar.neighbours.iter_mut().flatten() {
            let (fdi, end) = neighbour.end;
            if let Some((_, theirs)) = floors.iter().find(|(other, _)| *other == fdi) {
                neighbour.floors = theirs[end].map(|p| from_world(&frame, &p).z);
            }
        }
    }
}

/// Returns the patient of `file` with the file's text. Without a file, the patient is generated from `seed`.
pub(crate) fn patient(
    file: Option<&Path>,
    condition: Condition,
    seed: u64,
) -> Result<(Patient, String), FileError> {
    match file {
        Some(file) => Patient::read(file),
        None => {
            let patient = generate(seed, condition);
            let text = patient.to_toml();
            Ok((patient, text))
        }
    }
}

//! What a probe read, site by site: the chart of one session, against what the scene prescribes.

use sulcus_core::output::{ForceZone, PocketReading};
use sulcus_core::tissue::TissueModel;
use sulcus_core::{Scene, TickOutput};

/// Force on the floor from which a reading counts, as a share of the force that the scene reads its
/// depths at. The upper end is the threshold of the zone "too heavy".
const CORRECT_FROM: f64 = 0.8;

/// The six zones that are charted, in the order of the bearing.
pub const SITES: [&str; 6] = [
    "distolingual",
    "lingual",
    "mesiolingual",
    "mesiobuccal",
    "buccal",
    "distobuccal",
];
/// Half the width of the middle zone of a side, degrees.
const MIDDLE: f64 = 22.5;

/// One zone of one tooth's circumference.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Site {
    /// FDI number of the tooth, 0 where the scene has none.
    pub tooth: u8,
    /// Index in [`SITES`].
    pub site: usize,
    /// Deepest reading of the zone at correct force, metres; none where the force was never correct.
    pub measured: Option<f64>,
    /// What is prescribed where that reading was taken (or where the tip was deepest), metres.
    pub truth: f64,
    /// Deepest that the tip was, whatever the force, metres.
    pub deepest: f64,
    /// Largest force on the floor, newtons.
    pub max_force: f64,
    /// Ticks at correct force.
    pub ticks: u64,
}

/// Chart of a session.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Chart {
    sites: Vec<(u16, Site)>,
    /// Entries into each zone of force, by [`ForceZone::ALL`].
    pub zones: [u64; ForceZone::ALL.len()],
}

impl Chart {
    /// Takes one tick in.
    pub fn observe(&mut self, scene: &Scene, output: &TickOutput) {
        for reading in output.tools.iter().filter_map(|tool| tool.pocket.as_ref()) {
            if reading.entered_zone {
                self.zones[reading.zone as usize] += 1;
            }
            self.read(scene, reading);
        }
    }

    fn read(&mut self, scene: &Scene, reading: &PocketReading) {
        let Some(pocket) = Pocket::of(scene, reading.object) else {
            return;
        };
        let site = site_at(reading.around);
        let found = self
            .sites
            .iter()
            .position(|(object, s)| (*object, s.site) == (reading.object, site));
        let at = found.unwrap_or_else(|| {
            let new = Site {
                tooth: pocket.fdi,
                site,
                measured: None,
                truth: 0.0,
                deepest: 0.0,
                max_force: 0.0,
                ticks: 0,
            };
            self.sites.push((reading.object, new));
            self.sites.len() - 1
        });
        let site = &mut self.sites[at].1;
        site.max_force = site.max_force.max(reading.floor_force);
        let correct = pocket.correct.contains(&reading.floor_force);
        site.ticks += u64::from(correct);
        if correct && site.measured.is_none_or(|before| reading.depth > before) {
            site.measured = Some(reading.depth);
            site.truth = pocket.prescribed(reading.around);
        }
        if reading.depth > site.deepest {
            site.deepest = reading.depth;
            if site.measured.is_none() {
                site.truth = pocket.prescribed(reading.around);
            }
        }
    }

    /// The sites that were reached, tooth by tooth in the order of [`SITES`].
    pub fn sites(&self) -> Vec<Site> {
        let mut sites = self.sites.clone();
        sites.sort_by_key(|(object, site)| (*object, site.site));
        sites.into_iter().map(|(_, site)| site).collect()
    }
}

/// Index in [`SITES`] of a bearing, radians from mesial over buccal, -pi to pi.
fn site_at(around: f64) -> usize {
    let degrees = around.to_degrees();
    let side = if degrees < 0.0 {
        degrees + 180.0
    } else {
        degrees
    };
    // Along each side of the tooth 90 degrees is its middle; mesial comes first on the buccal side.
    let along = if side < 90.0 - MIDDLE {
        0
    } else if side <= 90.0 + MIDDLE {
        1
    } else {
        2
    };
    if degrees < 0.0 { along } else { 3 + along }
}

/// What a scene says of a pocket.
struct Pocket<'a> {
    gingiva: &'a sulcus_core::tissue::gingiva::Gingiva,
    object: &'a sulcus_core::Object,
    fdi: u8,
    /// Forces at which a depth is read correctly.
    correct: std::ops::RangeInclusive<f64>,
}

impl<'a> Pocket<'a> {
    fn of(scene: &'a Scene, object: u16) -> Option<Self> {
        let object = scene.objects.get(usize::from(object))?;
        let TissueModel::Gingiva(gingiva) = &object.tissue else {
            return None;
        };
        let axis = &gingiva.tooth.origin;
        let tooth = scene
            .objects
            .iter()
            .filter(|object| object.fdi != 0)
            .min_by(|a, b| {
                let from = |o: &sulcus_core::Object| (o.tree.nodes()[0].centre - axis).norm();
                from(a).total_cmp(&from(b))
            });
        let params = &gingiva.params;
        Some(Self {
            gingiva,
            object,
            fdi: tooth.map_or(0, |tooth| tooth.fdi),
            correct: CORRECT_FROM * params.reading_force..=params.too_heavy,
        })
    }

    /// Depth that is read at the reading force at a bearing, metres: the margin's height over the floor at rest,
    /// and how far that force presses the floor of healthy tissue.
    fn prescribed(&self, around: f64) -> f64 {
        let gingiva = self.gingiva;
        let mut nearest = (f64::INFINITY, 0.0);
        for (id, node) in self.object.tree.shape_at(gingiva.level) {
            let place = &gingiva.places[id as usize];
            let (angle, height) = gingiva.tooth.cylindrical(&node.centre);
            let apart = libm::cos(angle - around);
            if place.floor && -apart < nearest.0 {
                nearest = (-apart, height - place.height);
            }
        }
        let params = &gingiva.params;
        gingiva.margin_at(around) - nearest.1 + params.sink()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bearings_fall_into_six_zones() {
        let names = [-170.0, -90.0, -10.0, 10.0, 90.0, 170.0]
            .map(|degrees: f64| SITES[site_at(degrees.to_radians())]);
        // From mesial over buccal: -90 is the middle of the lingual side.
        assert_eq!(
            names,
            [
                "distolingual",
                "lingual",
                "mesiolingual",
                "mesiobuccal",
                "buccal",
                "distobuccal"
            ]
        );
        assert_eq!(SITES[site_at(67.0_f64.to_radians())], "mesiobuccal");
        assert_eq!(SITES[site_at(68.0_f64.to_radians())], "buccal");
        assert_eq!(SITES[site_at(113.0_f64.to_radians())], "distobuccal");
    }
}

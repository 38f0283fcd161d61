//! What a probe read, site by site: the chart of one session, against what the scene prescribes.

use sulcus_core::output::{ForceZone, PocketReading};
use sulcus_core::tissue::TissueModel;
use sulcus_core::tissue::gingiva::{Gingiva, Site};
use sulcus_core::{Scene, TickOutput};

/// Force on the floor from which a reading counts, as a share of the force that the scene reads its
/// depths at. The upper end is the threshold of the zone "too heavy".
const CORRECT_FROM: f64 = 0.8;

/// One zone of one tooth's circumference.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Charted {
    /// FDI number of the tooth, 0 where the scene has none.
    pub tooth: u8,
    /// The zone.
    pub site: Site,
    /// Deepest reading of the zone at correct force, metres; none where the force was never correct.
    pub measured: Option<f64>,
    /// What is prescribed there, metres.
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
    sites: Vec<(u16, Charted)>,
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
        let site = pocket.gingiva.site_at(reading.around);
        let found = self
            .sites
            .iter()
            .position(|(object, s)| (*object, s.site) == (reading.object, site));
        let at = found.unwrap_or_else(|| {
            let new = Charted {
                tooth: pocket.fdi,
                site,
                measured: None,
                truth: pocket.gingiva.prescribed(site).depth,
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
        }
        if reading.depth > site.deepest {
            site.deepest = reading.depth;
        }
    }

    /// The sites that were reached, tooth by tooth in the order of [`Site::ALL`].
    pub fn sites(&self) -> Vec<Charted> {
        let mut sites = self.sites.clone();
        sites.sort_by_key(|(object, site)| (*object, site.site));
        sites.into_iter().map(|(_, site)| site).collect()
    }
}

/// What a scene says of a pocket.
struct Pocket<'a> {
    gingiva: &'a Gingiva,
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
            fdi: if object.fdi != 0 {
                object.fdi
            } else {
                tooth.map_or(0, |tooth| tooth.fdi)
            },
            correct: CORRECT_FROM * params.reading_force..=params.too_heavy,
        })
    }
}

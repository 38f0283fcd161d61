//! Chart of a session: readings of a probe for each site, with the prescribed depths of the scene.

use sulcus_core::output::{ForceZone, PocketReading};
use sulcus_core::tissue::TissueModel;
use sulcus_core::tissue::gingiva::{Gingiva, Site};
use sulcus_core::{Scene, TickOutput};

/// Smallest force on the floor of a valid reading, as a share of the scene's reading force. The largest force is the
/// threshold of the zone "too heavy".
const CORRECT_FROM: f64 = 0.8;

/// Readings of one zone of one tooth.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Charted {
    /// FDI number of the tooth; 0 in a scene without numbers.
    pub tooth: u8,
    /// Site of the zone.
    pub site: Site,
    /// Deepest reading at a correct force, metres; `None`: the force was never correct.
    pub measured: Option<f64>,
    /// Prescribed depth, metres.
    pub truth: f64,
    /// Largest depth of the tip at any force, metres.
    pub deepest: f64,
    /// Largest force on the floor, newtons.
    pub max_force: f64,
    /// Number of ticks at a correct force.
    pub ticks: u64,
}

/// Chart of a session.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Chart {
    sites: Vec<(u16, Charted)>,
    /// Number of entries into each zone of force, in the order of [`ForceZone::ALL`].
    pub zones: [u64; ForceZone::ALL.len()],
}

impl Chart {
    /// Takes the readings of one tick.
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

    /// Sites that the tip reached, by gingiva in the order of the scene, then in the order of [`Site::ALL`].
    pub fn sites(&self) -> Vec<Charted> {
        let mut sites = self.sites.clone();
        sites.sort_by_key(|(object, site)| (*object, site.site));
        sites.into_iter().map(|(_, site)| site).collect()
    }
}

/// Pocket of a scene.
struct Pocket<'a> {
    gingiva: &'a Gingiva,
    fdi: u8,
    /// Correct forces on the floor, newtons.
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

//! Bleeding that shows.

use sulcus_core::tissue::gingiva::Site;
use sulcus_proto::display::{DisplayScene, Kind, Spot};
use sulcus_sessions::Occurrence;
use sulcus_sessions::exercise::events::BLEEDING;

/// Sites that bleed so far. The cause, inflammation or trauma, is not told.
#[derive(Clone, Debug, Default)]
pub struct Spots {
    /// FDI number and object of each gingiva.
    gingivae: Vec<(u8, u16)>,
    all: Vec<Spot>,
}

impl Spots {
    /// No bleeding.
    pub fn new(scene: &DisplayScene) -> Self {
        let objects = (0..).zip(&scene.objects);
        let gingivae = objects.filter(|(_, object)| object.kind == Kind::Gingiva);
        Self {
            gingivae: gingivae.map(|(k, object)| (object.fdi, k)).collect(),
            all: Vec::new(),
        }
    }

    /// Takes an event. Returns `false` for a bleeding at a place that the scene lacks.
    pub fn occurred(&mut self, event: &Occurrence) -> bool {
        if event.kind != BLEEDING {
            return true;
        }
        let tooth = event.data["tooth"].as_u64();
        let site = event.data["site"].as_str().and_then(Site::from_name);
        let gingiva = self
            .gingivae
            .iter()
            .find(|(fdi, _)| Some(u64::from(*fdi)) == tooth);
        let (Some((_, object)), Some(site)) = (gingiva, site) else {
            return false;
        };
        let spot = Spot {
            object: *object,
            site: site as u8,
            since: event.tick,
        };
        let place = |spot: &Spot| (spot.object, spot.site);
        // A second cause at the same place changes nothing that is visible.
        if let Err(at) = self.all.binary_search_by_key(&place(&spot), place) {
            self.all.insert(at, spot);
        }
        true
    }

    /// All spots, in ascending order of object and site.
    pub fn all(&self) -> &[Spot] {
        &self.all
    }
}

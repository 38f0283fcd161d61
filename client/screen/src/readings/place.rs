//! Place of a stop in the mouth, for the highlight of the site to be read.

use sulcus_proto::display::{DisplayScene, Kind};

use super::site::Stop;

/// Place of a stop.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Place {
    /// Number of the gingiva among the objects of the scene.
    pub object: usize,
    /// Point of the gingival margin at rest, world axes, metres.
    pub at: [f32; 3],
}

impl Place {
    /// Place of `stop` in a scene; `None`: the tooth has no gingiva here.
    pub fn of(stop: Stop, scene: &DisplayScene) -> Option<Self> {
        let objects = scene.objects.iter().enumerate();
        let mut gingivae =
            objects.filter(|(_, one)| one.kind == Kind::Gingiva && one.fdi == stop.tooth);
        gingivae.find_map(|(object, gingiva)| {
            let at = *gingiva.sites.get(stop.site.number())?;
            Some(Self { object, at })
        })
    }
}

#[cfg(test)]
mod tests {
    use super::super::site::Site;
    use super::*;
    use sulcus_proto::display::{DisplayMesh, DisplayObject};

    #[test]
    fn a_stop_is_at_the_margin_of_its_own_tooth() {
        let object = |kind, fdi, x: f32| DisplayObject {
            kind,
            fdi,
            mesh: DisplayMesh::new(&[[0.0; 3]], &[], [255; 4], &[]).expect("a mesh"),
            skin: None,
            sites: if kind == Kind::Gingiva {
                (0..6u8).map(|k| [x, f32::from(k), 0.0]).collect()
            } else {
                vec![]
            },
        };
        let scene = DisplayScene {
            tick_ns: 1_000_000,
            tools: vec![],
            objects: vec![
                object(Kind::Tooth, 36, 0.0),
                object(Kind::Gingiva, 37, 1.0),
                object(Kind::Gingiva, 36, 2.0),
            ],
        };
        let place = |tooth, site| Place::of(Stop { tooth, site }, &scene);
        let lingual = Place {
            object: 2,
            at: [2.0, 4.0, 0.0],
        };
        assert_eq!(place(36, Site::Lingual), Some(lingual));
        assert_eq!(
            place(37, Site::MesioBuccal).map(|place| place.object),
            Some(1)
        );
        assert_eq!(place(35, Site::Buccal), None);
    }
}

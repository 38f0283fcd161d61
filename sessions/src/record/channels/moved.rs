//! Places of a tissue's spheres, computed once for each copy of the shapes, for all outlets.

use std::ops::Range;

use sulcus_core::tissue::{Tissue, TissueModel};
use sulcus_core::{Object, Scene, Vec3};

use super::clouds::shown_level;
use super::shapes::Shapes;

/// Tissues of a scene after the last copy of their shapes. The channels for viewers and the feed for displays read the
/// same places.
pub struct Moved {
    tick: Option<u64>,
    tissues: Vec<Option<MovedTissue>>,
}

/// Tissue of one object after the last copy of its shape.
pub struct MovedTissue {
    model: Box<dyn Tissue>,
    /// Configuration after the copy; zeros at rest.
    configuration: Vec<f64>,
    ids: Vec<u32>,
    /// Spheres for viewers, and spheres that carry a mesh.
    shown: Range<usize>,
    carrying: Range<usize>,
    rest: Vec<Vec3>,
    centres: Vec<Vec3>,
    awake: bool,
}

impl Moved {
    /// All tissues of `scene` at rest.
    pub fn new(scene: &Scene) -> Self {
        let tick_s = scene.tick_s();
        let tissues = scene.objects.iter();
        Self {
            tick: None,
            tissues: tissues.map(|one| MovedTissue::new(one, tick_s)).collect(),
        }
    }

    /// Takes a copy of the shapes. A second call with the same copy has no effect and costs nothing.
    pub fn follow(&mut self, shapes: &Shapes) {
        if self.tick == Some(shapes.tick) {
            return;
        }
        self.tick = Some(shapes.tick);
        for (k, tissue) in self.tissues.iter_mut().enumerate() {
            let Some(tissue) = tissue else { continue };
            let mut configurations = shapes.configurations();
            let shape = configurations.find(|(of, _)| *of == k);
            // Shapes of another scene have another length and count as rest.
            let own = shape.map(|(_, shape)| shape);
            tissue.follow(own.filter(|shape| shape.len() == tissue.configuration.len()));
        }
    }

    /// Tissue of object `k`; `None` for a rigid object.
    pub fn of(&self, k: usize) -> Option<&MovedTissue> {
        self.tissues.get(k)?.as_ref()
    }

    /// Tick of the last copy; `None` before the first.
    pub fn tick(&self) -> Option<u64> {
        self.tick
    }
}

impl MovedTissue {
    fn new(object: &Object, tick_s: f64) -> Option<Self> {
        let model = object.tissue.ready(&object.tree, object.level, tick_s)?;
        let level = shown_level(&object.tree, object.level);
        let ids_of = |level: u8| object.tree.shape_at(level).map(|(id, _)| id);
        let mut ids: Vec<u32> = ids_of(level).collect();
        let (shown, mut carrying) = (0..ids.len(), 0..ids.len());
        if Self::carrying_level(object) != level {
            ids.extend(ids_of(Self::carrying_level(object)));
            carrying = shown.end..ids.len();
        }
        let configuration = vec![0.0; model.shape_len()];
        let mut rest = vec![Vec3::zeros(); ids.len()];
        model.centres(&configuration, &ids, &mut rest);
        Some(Self {
            model,
            configuration,
            ids,
            shown,
            carrying,
            centres: rest.clone(),
            rest,
            awake: false,
        })
    }

    fn follow(&mut self, shape: Option<&[f64]>) {
        let was_awake = std::mem::replace(&mut self.awake, shape.is_some());
        match shape {
            Some(shape) => self.configuration.clone_from_slice(shape),
            None if was_awake => self.configuration.fill(0.0),
            None => return,
        }
        self.model
            .centres(&self.configuration, &self.ids, &mut self.centres);
    }

    /// Level of an object's tree whose spheres carry a mesh, in the order of [`MovedTissue::carrying`].
    ///
    /// Of a gingiva only the spheres in contact yield. Any other tissue has the level for viewers.
    pub fn carrying_level(object: &Object) -> u8 {
        if matches!(object.tissue, TissueModel::Gingiva(_)) {
            object.level
        } else {
            shown_level(&object.tree, object.level)
        }
    }

    /// Whether the tissue is touched or still moves.
    pub fn is_awake(&self) -> bool {
        self.awake
    }

    /// Configuration of the tissue, in the numbers of its model; zeros at rest.
    pub fn configuration(&self) -> &[f64] {
        &self.configuration
    }

    /// Centres of the spheres that carry a mesh, at rest and now, world axes, metres.
    pub fn carrying(&self) -> (&[Vec3], &[Vec3]) {
        (
            &self.rest[self.carrying.clone()],
            &self.centres[self.carrying.clone()],
        )
    }

    /// Centres of the spheres for viewers, world axes, metres.
    pub(super) fn shown(&self) -> &[Vec3] {
        &self.centres[self.shown.clone()]
    }
}

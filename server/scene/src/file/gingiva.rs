//! Entries of a gingiva: `[object.gingiva]`, `[object.pocket]` and `[object.sulcus]`.

use serde::{Deserialize, Serialize};
use sulcus_core::tissue::gingiva::GingivaParams;

/// `[object.gingiva]`: deviations from the defaults of [`sulcus_core::tissue::gingiva::GingivaParams`], in clinical
/// units.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct GingivaEntry {
    /// Stiffness of the pocket's wall away from the tooth, N/mm.
    pub wall_stiffness_n_per_mm: Option<f64>,
    /// Stiffness of the wall along the tooth, N/mm.
    pub shear_stiffness_n_per_mm: Option<f64>,
    /// Length over which a press has effect, mm.
    pub reach_mm: Option<f64>,
    /// Time constant, ms.
    pub relaxation_ms: Option<f64>,
    /// Stiffness of the floor along the tooth's axis, N/mm.
    pub floor_stiffness_n_per_mm: Option<f64>,
    /// Height over which the wall becomes the floor, mm.
    pub floor_taper_mm: Option<f64>,
    /// Force of the readings that the prescribed depths mean, N.
    pub reading_force_n: Option<f64>,
    /// Diameter of the tip of these readings, mm.
    pub reading_tip_mm: Option<f64>,
    /// Inflammation, 0 to 1.
    pub inflammation: Option<f64>,
    /// Share of the stiffness lost at full inflammation.
    pub softening: Option<f64>,
    /// Threshold of the zone "too heavy", N.
    pub too_heavy_n: Option<f64>,
    /// Threshold of the zone "trauma", N.
    pub trauma_n: Option<f64>,
    /// Threshold of the zone "damage", N.
    pub damage_n: Option<f64>,
    /// Share of a threshold below which its zone ends.
    pub rearm: Option<f64>,
}

impl GingivaEntry {
    /// Returns the parameters of the gingiva.
    pub(crate) fn params(&self) -> GingivaParams {
        let mut params = GingivaParams::default();
        let set = |to: &mut f64, from: Option<f64>, unit: f64| {
            if let Some(x) = from {
                *to = x * unit;
            }
        };
        let (n_per_mm, mm, ms) = (1e3, 1e-3, 1e-3);
        set(
            &mut params.wall_stiffness,
            self.wall_stiffness_n_per_mm,
            n_per_mm,
        );
        set(
            &mut params.shear_stiffness,
            self.shear_stiffness_n_per_mm,
            n_per_mm,
        );
        set(&mut params.reach, self.reach_mm, mm);
        set(&mut params.relaxation, self.relaxation_ms, ms);
        set(
            &mut params.floor_stiffness,
            self.floor_stiffness_n_per_mm,
            n_per_mm,
        );
        set(&mut params.floor_taper, self.floor_taper_mm, mm);
        set(&mut params.reading_force, self.reading_force_n, 1.0);
        set(&mut params.reading_tip, self.reading_tip_mm, mm);
        set(&mut params.inflammation, self.inflammation, 1.0);
        set(&mut params.softening, self.softening, 1.0);
        set(&mut params.too_heavy, self.too_heavy_n, 1.0);
        set(&mut params.trauma, self.trauma_n, 1.0);
        set(&mut params.damage, self.damage_n, 1.0);
        set(&mut params.rearm, self.rearm, 1.0);
        params
    }
}

/// `[object.pocket]`: a pocket, millimetres.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Pocket {
    /// Width between tooth and gingiva at rest, mm. A real width is about 0.4; a probe's tip has 0.5.
    pub width_mm: f64,
    /// Probing depths, mm: mesio-buccal, buccal, disto-buccal, disto-lingual, lingual, mesio-lingual.
    ///
    /// Depths are readings with the force and tip of the model's parameters. At rest the floor lies higher.
    pub depths_mm: [f64; 6],
    /// Height of the margin over the tooth's origin mid-buccally and mid-lingually, mm. The origin is at the buccal
    /// CEJ.
    pub margin_mm: f64,
    /// Height of the papillae, mesially and distally, mm.
    pub papilla_mm: f64,
    /// Thickness of the free margin, mm.
    pub crest_mm: f64,
    /// Thickness of the wall further down, mm.
    pub wall_mm: f64,
    /// Height of attached tissue below the deepest floor, mm.
    pub base_mm: f64,
    /// Edge of the grid of the surface, mm.
    pub grid_mm: f64,
}

impl Default for Pocket {
    fn default() -> Self {
        Self {
            width_mm: 0.4,
            depths_mm: [3.0, 2.0, 3.0, 3.0, 2.0, 3.0],
            margin_mm: 1.2,
            papilla_mm: 2.8,
            crest_mm: 0.8,
            wall_mm: 1.8,
            base_mm: 2.0,
            grid_mm: 0.18,
        }
    }
}

/// `[object.sulcus]`: known values of the sulcus of a gingiva that is a mesh. Omitted ones are found from the meshes.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct SulcusEntry {
    /// Direction along the tooth's axis, towards the chewing surface, world, any length. Default: up for a lower
    /// tooth, down for an upper one.
    pub axis: Option<[f64; 3]>,
    /// Direction towards mesial, world, any length. Default: anterior for molars and premolars, towards the middle
    /// for other teeth.
    pub mesial: Option<[f64; 3]>,
    /// Point of the tooth's axis at the height of the buccal cemento-enamel junction, world, mm. Default: the middle
    /// of the tooth at its margin, 2 mm below the buccal margin.
    pub origin_mm: Option<[f64; 3]>,
    /// Height of a flat floor over that origin along the axis, mm. Default: sounded.
    pub floor_mm: Option<f64>,
    /// Width between tooth and tissue at rest, mm. Default: the median of the sounded widths.
    pub width_mm: Option<f64>,
    /// Least width of an open sulcus, mm.
    pub open_mm: f64,
    /// Reach of the proximal zones from the mesial and distal midlines, degrees.
    pub proximal_deg: f64,
}

impl Default for SulcusEntry {
    fn default() -> Self {
        Self {
            axis: None,
            mesial: None,
            origin_mm: None,
            floor_mm: None,
            width_mm: None,
            open_mm: 0.15,
            proximal_deg: 50.0,
        }
    }
}

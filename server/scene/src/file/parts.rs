//! Dimensions of the parametric objects: `[object.molar]`, `[object.sizes]` and `[object.tongue]`.

use serde::{Deserialize, Serialize};

/// `[object.molar]`: dimensions of the tooth, millimetres.
///
/// Defaults follow averages of textbooks of dental anatomy (Wheeler: crown 7.5 high, 11.0 mesiodistal, 10.5
/// buccolingual; root 14).
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Molar {
    /// Largest mesiodistal width of the crown, mm.
    pub mesiodistal_mm: f64,
    /// Largest buccolingual width of the crown, mm.
    pub buccolingual_mm: f64,
    /// Height of the highest cusp (mesiolingual) above the CEJ, mm.
    pub crown_height_mm: f64,
    /// Length of the longer root (mesial) from the CEJ to its apex, mm.
    pub root_length_mm: f64,
    /// Depth of the central fossa below the plane of the cusp tips, relative to the average.
    pub relief: f64,
    /// Edge of the grid of the surface, mm. A smaller edge makes more triangles.
    pub grid_mm: f64,
}

impl Default for Molar {
    fn default() -> Self {
        Self {
            mesiodistal_mm: 11.0,
            buccolingual_mm: 10.3,
            crown_height_mm: 7.5,
            root_length_mm: 13.5,
            relief: 1.0,
            grid_mm: 0.28,
        }
    }
}

/// `[object.sizes]`: dimensions of a tooth, millimetres. Omitted ones are the averages of that tooth.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct ToothSizes {
    /// Largest mesiodistal width of the crown, mm.
    pub mesiodistal_mm: Option<f64>,
    /// Largest buccolingual width of the crown, mm.
    pub buccolingual_mm: Option<f64>,
    /// Height of the highest cusp or of the incisal edge above the buccal CEJ, mm.
    pub crown_height_mm: Option<f64>,
    /// Length of the root from the buccal CEJ to its apex, mm; of two roots, the longer one.
    pub root_length_mm: Option<f64>,
    /// Depth of the chewing surface's relief relative to the average. It has no effect on incisors.
    pub relief: Option<f64>,
    /// Edge of the grid of the surface, mm. A smaller edge makes more triangles.
    pub grid_mm: Option<f64>,
}

/// `[object.tongue]`: dimensions of the tongue, millimetres.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Tongue {
    /// Length from root to tip, mm.
    pub length_mm: f64,
    /// Largest width, mm.
    pub width_mm: f64,
    /// Height from the underside to the highest place of the back, mm.
    pub height_mm: f64,
    /// Depth of the groove along the middle of the back, mm.
    pub groove_mm: f64,
    /// Edge of the grid of the surface, mm. A smaller edge makes more triangles.
    pub grid_mm: f64,
}

impl Default for Tongue {
    fn default() -> Self {
        Self {
            length_mm: 80.0,
            width_mm: 50.0,
            height_mm: 30.0,
            groove_mm: 1.0,
            grid_mm: 1.0,
        }
    }
}

//! Values of a tooth's six sites. A file has both sides, or one side while the other is healthy.

use serde::{Deserialize, Deserializer, Serialize};
use sulcus_core::tissue::gingiva::Site;

/// Values of the six sites, each side mesio-, mid-, disto-.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Sides<T> {
    /// Buccal or labial side.
    pub buccal: [T; 3],
    /// Lingual side.
    pub lingual: [T; 3],
}

impl<T: Copy> Sides<T> {
    /// Returns the value of one site.
    pub fn of(&self, site: Site) -> T {
        self.round()[site as usize]
    }

    /// Returns all six values in the order of [`Site::ALL`], round the tooth.
    pub fn round(&self) -> [T; 6] {
        let ([mb, b, db], [ml, l, dl]) = (self.buccal, self.lingual);
        [mb, b, db, dl, l, ml]
    }

    /// Returns the sides of six values in the order of [`Site::ALL`].
    pub fn from_round([mb, b, db, dl, l, ml]: [T; 6]) -> Self {
        Self {
            buccal: [mb, b, db],
            lingual: [ml, l, dl],
        }
    }
}

/// Returns the depths of a healthy tooth, mm.
pub fn healthy_depth() -> Sides<f64> {
    let side = [3.0, 2.0, 3.0];
    Sides {
        buccal: side,
        lingual: side,
    }
}

/// Returns the recessions of a healthy tooth, mm: about 2 mm above the CEJ mid-facially, more beside a neighbour
/// (Wang 2022, Appl. Sci. 12:7015).
pub fn healthy_recession() -> Sides<f64> {
    let side = [-2.5, -2.0, -2.5];
    Sides {
        buccal: side,
        lingual: side,
    }
}

/// Sides of a file. An omitted side is healthy.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Written<T> {
    buccal: Option<[T; 3]>,
    lingual: Option<[T; 3]>,
}

fn read<'de, D, T>(from: D, healthy: Sides<T>) -> Result<Sides<T>, D::Error>
where
    D: Deserializer<'de>,
    T: Deserialize<'de>,
{
    let written = Written::deserialize(from)?;
    Ok(Sides {
        buccal: written.buccal.unwrap_or(healthy.buccal),
        lingual: written.lingual.unwrap_or(healthy.lingual),
    })
}

/// Reads probing depths.
pub(super) fn depth<'de, D: Deserializer<'de>>(from: D) -> Result<Sides<f64>, D::Error> {
    read(from, healthy_depth())
}

/// Reads recessions.
pub(super) fn recession<'de, D: Deserializer<'de>>(from: D) -> Result<Sides<f64>, D::Error> {
    read(from, healthy_recession())
}

/// Reads bleeding on probing.
pub(super) fn bleeding<'de, D: Deserializer<'de>>(from: D) -> Result<Sides<bool>, D::Error> {
    read(from, Sides::default())
}

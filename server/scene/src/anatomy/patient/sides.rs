//! Values of a tooth's six sites, and how they are written: both sides, or one with the other healthy.

use serde::{Deserialize, Deserializer, Serialize};
use sulcus_core::tissue::gingiva::Site;

use super::{healthy_depth, healthy_recession};

/// Values of the six sites, each side mesio-, mid-, disto-.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Sides<T> {
    /// On the cheek's (the lip's) side.
    pub buccal: [T; 3],
    /// On the tongue's side.
    pub lingual: [T; 3],
}

impl<T: Copy> Sides<T> {
    /// The value of one site.
    pub fn of(&self, site: Site) -> T {
        self.round()[site as usize]
    }

    /// All six in the order of [`Site::ALL`], round the tooth.
    pub fn round(&self) -> [T; 6] {
        let ([mb, b, db], [ml, l, dl]) = (self.buccal, self.lingual);
        [mb, b, db, dl, l, ml]
    }

    /// From the order of [`Site::ALL`].
    pub fn from_round([mb, b, db, dl, l, ml]: [T; 6]) -> Self {
        Self {
            buccal: [mb, b, db],
            lingual: [ml, l, dl],
        }
    }
}

/// Sides as written. A side that is left out is healthy.
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

/// Probing depths.
pub(super) fn depth<'de, D: Deserializer<'de>>(from: D) -> Result<Sides<f64>, D::Error> {
    read(from, healthy_depth())
}

/// Recessions.
pub(super) fn recession<'de, D: Deserializer<'de>>(from: D) -> Result<Sides<f64>, D::Error> {
    read(from, healthy_recession())
}

/// Bleeding on probing.
pub(super) fn bleeding<'de, D: Deserializer<'de>>(from: D) -> Result<Sides<bool>, D::Error> {
    read(from, Sides::default())
}

//! Plausible sizes. Mesh files name no unit, and a wrong unit is visible in the size only.

use serde::{Deserialize, Serialize};

use crate::mesh::edges::Length;
use crate::mesh::load::Unit;

/// Smallest and largest plausible overall size, metres: longest edge of the bounding box.
pub const PLAUSIBLE_SIZE_M: (f64, f64) = (0.5e-3, 0.5);

/// Kind of object in a mesh. It decides the plausible size.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Size {
    /// A tooth or its crown.
    Tooth,
    /// A tongue or another organ that deforms as a whole.
    Tongue,
    /// A jaw, or a gingiva of several teeth.
    Arch,
    /// An instrument, or its touching part.
    Instrument,
    /// Any object in a mouth.
    #[default]
    Mouth,
    /// Any size with which the computation is possible.
    Any,
}

impl Size {
    /// All kinds, in the order of messages.
    pub const ALL: [Size; 6] = [
        Size::Tooth,
        Size::Tongue,
        Size::Arch,
        Size::Instrument,
        Size::Mouth,
        Size::Any,
    ];

    /// Returns the smallest and largest plausible length of the longest edge of the bounding box, mm.
    ///
    /// A human tooth is 17 to 30 mm long, a scanned crown at least 5 mm. A tongue is 70 mm long, a mandible 100 mm, a
    /// probe 170 mm, and the working end of an instrument a few millimetres.
    pub fn range_mm(self) -> (f64, f64) {
        match self {
            Size::Tooth => (4.0, 45.0),
            Size::Tongue => (20.0, 150.0),
            Size::Arch => (12.0, 200.0),
            Size::Instrument => (4.0, 300.0),
            Size::Mouth => (4.0, 300.0),
            Size::Any => (PLAUSIBLE_SIZE_M.0 * 1e3, PLAUSIBLE_SIZE_M.1 * 1e3),
        }
    }

    /// Returns the kind in scene files and on the command line.
    pub fn name(self) -> &'static str {
        match self {
            Size::Tooth => "tooth",
            Size::Tongue => "tongue",
            Size::Arch => "arch",
            Size::Instrument => "instrument",
            Size::Mouth => "mouth",
            Size::Any => "any",
        }
    }

    /// Returns the kind in a sentence.
    fn described(self) -> &'static str {
        match self {
            Size::Tooth => "a tooth",
            Size::Tongue => "a tongue",
            Size::Arch => "a jaw or gingiva",
            Size::Instrument => "an instrument",
            Size::Mouth => "any object in a mouth",
            Size::Any => "a mesh",
        }
    }

    /// Returns whether this size of a bounding box (mm) is plausible.
    pub fn holds(self, size_mm: f64) -> bool {
        let (low, high) = self.range_mm();
        // The tolerance includes the edge of a box that was scaled to its limit.
        (low * (1.0 - 1e-9)..=high * (1.0 + 1e-9)).contains(&size_mm)
    }
}

impl std::str::FromStr for Size {
    type Err = String;
    fn from_str(text: &str) -> Result<Self, String> {
        Size::ALL
            .into_iter()
            .find(|size| size.name() == text)
            .ok_or_else(|| {
                let names = Size::ALL.map(|size| format!("`{}`", size.name()));
                format!("size is `{text}`, expected one of {}", names.join(", "))
            })
    }
}

/// Returns the expected range, for a message.
pub(crate) fn expected(size: Size) -> String {
    let (low, high) = size.range_mm();
    match size {
        Size::Any => format!("{low} to {high} mm"),
        _ => format!("{low} to {high} mm for {}", size.described()),
    }
}

/// Returns the units that would make a size plausible, for a message. `read_in` is `None` for a mesh from no file.
pub(crate) fn advice(size_mm: f64, size: Size, read_in: Option<Unit>) -> String {
    // The numbers of a mesh from no file may be millimetres used as metres, or the other way round.
    let read = |unit: Unit| {
        read_in.unwrap_or(match unit {
            Unit::Millimetre => Unit::Metre,
            _ => Unit::Millimetre,
        })
    };
    let tries = Unit::ALL.into_iter().filter(|unit| read_in != Some(*unit));
    let fits: Vec<(Unit, f64)> = tries
        .map(|unit| (unit, size_mm * unit.metres() / read(unit).metres()))
        .filter(|(_, mm)| size.holds(*mm))
        .collect();
    let mut said = if fits.is_empty() {
        let names: Vec<&str> = Unit::ALL.iter().map(|unit| unit.plural()).collect();
        let (last, first) = names.split_last().unwrap_or((&"", &[]));
        format!(
            "neither {} nor {last} gives a plausible size{}",
            first.join(", "),
            read_in.map_or(String::new(), |unit| format!(
                " (it was read in {})",
                unit.plural()
            ))
        )
    } else {
        let each = fits.iter().map(|(unit, mm)| {
            let (name, symbol) = (unit.plural(), unit.symbol());
            format!(
                "in {name} it would be {} mm, so write `unit = \"{symbol}\"` in a scene file or `--unit {symbol}` on the command line",
                Length(*mm)
            )
        });
        each.collect::<Vec<_>>().join("; ")
    };
    if size != Size::Any && Size::Any.holds(size_mm) {
        said.push_str(
            "; if the size is right, write `size = \"any\"` in a scene file or `--size any` on the command line",
        );
    }
    said
}

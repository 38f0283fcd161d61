//! The ranges of a parametric tooth's dimensions.

use super::{Checked, number, wrong};
use crate::anatomy::Tooth;
use crate::file::{ObjectEntry, ObjectKind};

/// Dimensions that a tooth may have, relative to its average ones. Within them every tooth is a solid.
const RANGE: (f64, f64) = (0.8, 1.25);

/// Checks number and sizes of an object of kind "tooth".
pub(super) fn tooth(field: &dyn Fn(&str) -> String, entry: &ObjectEntry) -> Checked {
    if entry.kind != Some(ObjectKind::Tooth) {
        return match &entry.sizes {
            Some(_) => wrong(field("sizes"), "given", "nothing without kind = \"tooth\""),
            None => Ok(()),
        };
    }
    let Some(usual) = Tooth::lower(entry.fdi) else {
        return wrong(
            field("fdi"),
            entry.fdi,
            "the FDI number of a lower tooth (31-37, 41-47) with kind = \"tooth\"",
        );
    };
    let Some(sizes) = &entry.sizes else {
        return Ok(());
    };
    let field = |key: &str| field(&format!("sizes.{key}"));
    let lengths = [
        (
            "mesiodistal_mm",
            sizes.mesiodistal_mm,
            usual.mesiodistal_mm(),
        ),
        (
            "buccolingual_mm",
            sizes.buccolingual_mm,
            usual.buccolingual_mm(),
        ),
        (
            "crown_height_mm",
            sizes.crown_height_mm,
            usual.crown_height_mm(),
        ),
        (
            "root_length_mm",
            sizes.root_length_mm,
            usual.root_length_mm(),
        ),
    ];
    for (key, given, usual) in lengths {
        if let Some(x) = given {
            let (low, high) = (RANGE.0 * usual, RANGE.1 * usual);
            let expected = "0.8 to 1.25 times the average of that tooth";
            number(&field, key, x, low, high, expected)?;
        }
    }
    if let Some(x) = sizes.relief {
        number(&field, "relief", x, 0.5, 1.3, "0.5 to 1.3")?;
    }
    if let Some(x) = sizes.grid_mm {
        number(&field, "grid_mm", x, 0.1, 0.5, "0.1 to 0.5 mm")?;
    }
    Ok(())
}

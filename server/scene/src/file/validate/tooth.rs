//! Ranges of a parametric tooth's keys that do not depend on its drawing.
//!
//! Lengths are shares of the average tooth. The compiler checks them against the drawing.

use crate::file::{LOWER, ObjectEntry, ObjectKind};
use crate::hand_written::{Checked, number, wrong};

/// Checks number, relief and grid of an object of kind "tooth".
pub(super) fn tooth(field: &dyn Fn(&str) -> String, entry: &ObjectEntry) -> Checked {
    if entry.kind != Some(ObjectKind::Tooth) {
        return match &entry.sizes {
            Some(_) => wrong(field("sizes"), "given", "nothing without kind = \"tooth\""),
            None => Ok(()),
        };
    }
    if !LOWER.contains(&entry.fdi) {
        return wrong(
            field("fdi"),
            entry.fdi,
            "the FDI number of a lower tooth (31-37, 41-47) with kind = \"tooth\"",
        );
    }
    let Some(sizes) = &entry.sizes else {
        return Ok(());
    };
    let field = |key: &str| field(&format!("sizes.{key}"));
    if let Some(x) = sizes.relief {
        number(&field, "relief", x, 0.5, 1.3, "0.5 to 1.3")?;
    }
    if let Some(x) = sizes.grid_mm {
        number(&field, "grid_mm", x, 0.1, 0.5, "0.1 to 0.5 mm")?;
    }
    Ok(())
}

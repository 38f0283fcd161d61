//! Ranges of `[mouth]`.

use super::ranges::levels;
use crate::file::{LOWER, MouthEntry, ObjectEntry};
use crate::hand_written::{Checked, number, wrong};

pub(super) fn mouth(entry: &MouthEntry, objects: &[ObjectEntry]) -> Checked {
    let field = |key: &str| format!("`{key}` in [mouth]");
    if let Some(teeth) = &entry.teeth {
        if let Some(fdi) = teeth.iter().find(|fdi| !LOWER.contains(fdi)) {
            return wrong(field("teeth"), fdi, "31 to 37 or 41 to 47");
        }
        if teeth.is_empty() {
            return wrong(field("teeth"), "empty", "at least one tooth");
        }
    }
    levels(
        &|key| field(&format!("tooth_{key}")),
        entry.tooth_level,
        entry.tooth_levels,
    )?;
    let sizes = [
        ("width_mm", entry.width_mm, 0.2, 1.0, "0.2 to 1 mm"),
        ("crest_mm", entry.crest_mm, 0.3, 1.5, "0.3 to 1.5 mm"),
        ("wall_mm", entry.wall_mm, 0.8, 3.0, "0.8 to 3 mm"),
    ];
    for (key, found, low, high, expected) in sizes {
        number(&field, key, found, low, high, expected)?;
    }
    if entry.gingiva.inflammation.is_some() {
        return wrong(
            field("gingiva.inflammation"),
            "given",
            "nothing, because the patient file has the inflammation of each gingiva",
        );
    }
    if let Err(error) = entry.gingiva.params().validate() {
        return wrong(
            field(&format!("gingiva.{}", error.field)),
            error.found,
            "a value in the range of that parameter (SI units)",
        );
    }
    if let Some(twice) = objects.iter().find(|object| LOWER.contains(&object.fdi)) {
        return wrong(
            format!("`fdi` of object `{}`", twice.name),
            twice.fdi,
            "a number that no tooth of the mouth has",
        );
    }
    Ok(())
}

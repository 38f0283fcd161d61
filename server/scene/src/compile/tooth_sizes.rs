//! Lengths of parametric teeth, checked against the average of the tooth that the FDI number names.

use crate::anatomy::tooth::Tooth;
use crate::file::{ObjectEntry, ObjectKind, SceneFile};
use crate::hand_written::{Checked, number};

/// Least and largest length, shares of the average. Within them every tooth is a solid.
const RANGE: (f64, f64) = (0.8, 1.25);

/// Checks the lengths of all objects of kind "tooth".
pub(super) fn tooth_sizes(scene: &SceneFile) -> Checked {
    scene.objects.iter().try_for_each(of_object)
}

fn of_object(entry: &ObjectEntry) -> Checked {
    let (Some(ObjectKind::Tooth), Some(sizes)) = (entry.kind, &entry.sizes) else {
        return Ok(());
    };
    // The check of the file refuses other FDI numbers.
    let Some(usual) = Tooth::lower(entry.fdi) else {
        return Ok(());
    };
    let field = |key: &str| format!("`sizes.{key}` of object `{}`", entry.name);
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
    Ok(())
}

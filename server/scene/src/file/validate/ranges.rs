//! Checks that several entries share: a place, levels, the origin of a mesh.

use crate::hand_written::{Checked, number, wrong};

pub(super) fn place(field: &dyn Fn(&str) -> String, key: &str, point: &[f64; 3]) -> Checked {
    point
        .iter()
        .try_for_each(|&x| number(field, key, x, -1000.0, 1000.0, "-1000 to 1000 mm"))
}

pub(super) fn levels(field: &dyn Fn(&str) -> String, level: u8, levels: u8) -> Checked {
    if !(1..=5).contains(&levels) {
        return wrong(field("levels"), levels, "1 to 5");
    }
    if level > levels {
        return wrong(field("level"), level, "0 to `levels`");
    }
    Ok(())
}

pub(super) fn source(
    field: &dyn Fn(&str) -> String,
    kind: bool,
    mesh: bool,
    unit: bool,
) -> Checked {
    match (kind, mesh, unit) {
        (true, true, _) => wrong(
            field("mesh"),
            "given beside `kind`",
            "either `kind` or `mesh`",
        ),
        (false, false, _) => wrong(
            field("mesh"),
            "missing",
            "a path to an STL, OBJ or PLY file, or `kind` instead",
        ),
        (false, true, false) => wrong(
            field("unit"),
            "missing",
            "\"mm\", \"m\" or \"in\", because mesh files do not name their unit",
        ),
        (true, false, true) => wrong(field("unit"), "given", "nothing without `mesh`"),
        _ => Ok(()),
    }
}

/// Refuses keys for reading a mesh file if no mesh file is named.
pub(super) fn reading(
    field: &dyn Fn(&str) -> String,
    mesh: bool,
    given: [(&str, bool); 3],
) -> Checked {
    match given.into_iter().find(|(_, given)| *given && !mesh) {
        Some((key, _)) => wrong(field(key), "given", "nothing without `mesh`"),
        None => Ok(()),
    }
}

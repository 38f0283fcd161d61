//! Pictures of a compiled mouth for its case.

use anyhow::Context;
use sulcus_core::Scene;

use super::Still;
use super::camera::{LEFT_BUCCAL, LEFT_LINGUAL, RIGHT_BUCCAL, RIGHT_LINGUAL, SIDES, Side};

/// Parts of the names of drawn objects. The tongue would hide the lingual sides.
const DRAWN: [&str; 4] = ["tooth", "gingiva", "jaw", "healed ridge"];

/// Sides of the pictures.
const ALL: [Side; 6] = [
    SIDES[2],
    SIDES[0],
    RIGHT_BUCCAL,
    LEFT_BUCCAL,
    RIGHT_LINGUAL,
    LEFT_LINGUAL,
];

/// Names of the sides from which a mouth can be drawn.
pub fn mouth_sides() -> [&'static str; 6] {
    ALL.map(|side| side.name)
}

/// Draws the teeth and gingivae of a scene from a side of [`mouth_sides`], as PNG, the longer edge `pixels` long.
///
/// # Errors
/// The side is unknown, the scene has no such objects, or the picture cannot be encoded.
pub fn mouth_picture(scene: &Scene, side: &str, pixels: usize) -> anyhow::Result<Vec<u8>> {
    let found = ALL.iter().find(|other| other.name == side);
    let found = found.with_context(|| {
        let names = mouth_sides().join(", ");
        format!("side is `{}`, expected one of {names}", side.escape_debug())
    })?;
    let only = DRAWN.map(str::to_owned);
    let still = Still::of(scene, &only);
    let still = still.with_context(|| format!("scene `{}` has no teeth to draw", scene.name))?;
    Ok(still.picture(found, pixels).to_png()?)
}

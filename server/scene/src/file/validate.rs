//! Ranges of the values of a scene file, and dependencies between its keys.

mod mouth;
mod ranges;
mod tissue;
mod tool;
mod tooth;

use sulcus_core::MAX_TOOLS;

use crate::file::{ObjectEntry, ObjectKind, SceneFile, TissueEntry};
use crate::hand_written::{Checked, number, wrong};
use ranges::{levels, place, reading, source};
use tissue::{gingiva, skeleton, surface, tongue_dimensions};
use tool::tool;
use tooth::tooth;

/// Checks all that the types do not check.
pub(crate) fn scene_file(scene: &SceneFile) -> Checked {
    if scene.name.trim().is_empty() {
        return wrong("`name`".into(), "empty", "a name");
    }
    if scene.tools.is_empty() || scene.tools.len() > MAX_TOOLS {
        return wrong(
            "number of [[tool]] entries".into(),
            scene.tools.len(),
            "1 or 2",
        );
    }
    if let Err(error) = scene.params.validate() {
        return wrong(
            format!("`{}` in [params]", error.field),
            error.found,
            error.expected,
        );
    }
    scene.tools.iter().try_for_each(tool)?;
    scene.objects.iter().try_for_each(object)?;
    if let Some(entry) = &scene.mouth {
        mouth::mouth(entry, &scene.objects)?;
    }
    for (k, object) in scene.objects.iter().enumerate() {
        gingiva(object, &scene.objects)?;
        if scene.objects[..k]
            .iter()
            .any(|earlier| earlier.name == object.name)
        {
            return wrong(
                "`name` of an [[object]]".into(),
                format!("`{}` twice", object.name),
                "a different name each",
            );
        }
    }
    Ok(())
}

fn object(entry: &ObjectEntry) -> Checked {
    let field = |key: &str| format!("`{key}` of object `{}`", entry.name);
    source(
        &field,
        entry.kind.is_some(),
        entry.mesh.is_some(),
        entry.unit.is_some(),
    )?;
    reading(
        &field,
        entry.mesh.is_some(),
        [
            ("size", entry.size.is_some()),
            ("keep_largest", entry.keep_largest),
            ("close_base", entry.close_base),
        ],
    )?;
    if entry.molar.is_some() && entry.kind != Some(ObjectKind::Molar) {
        return wrong(field("molar"), "given", "nothing without kind = \"molar\"");
    }
    tooth(&field, entry)?;
    if entry.tongue.is_some() && entry.kind != Some(ObjectKind::Tongue) {
        return wrong(
            field("tongue"),
            "given",
            "nothing without kind = \"tongue\"",
        );
    }
    if entry.skeleton.is_some() && !entry.tissue.is_skeleton() {
        return wrong(
            field("skeleton"),
            "given",
            "nothing without tissue = \"skeleton\" or \"printed_skeleton\"",
        );
    }
    for (key, given, wanted, expected) in [
        (
            "printed_skeleton",
            entry.printed_skeleton.is_some(),
            TissueEntry::PrintedSkeleton,
            "nothing without tissue = \"printed_skeleton\"",
        ),
        (
            "printed_gingiva",
            entry.printed_gingiva.is_some(),
            TissueEntry::PrintedGingiva,
            "nothing without tissue = \"printed_gingiva\"",
        ),
    ] {
        if given && entry.tissue != wanted {
            return wrong(field(key), "given", expected);
        }
    }
    if entry.surface.is_some() && entry.tissue != TissueEntry::SurfaceCompliance {
        return wrong(
            field("surface"),
            "given",
            "nothing without tissue = \"surface_compliance\"",
        );
    }
    if entry.tissue.is_organ() && entry.levels < 2 {
        return wrong(
            field("levels"),
            entry.levels,
            "2 to 5, because an organ is made of the spheres of level 2",
        );
    }
    if let Some(options) = &entry.surface {
        surface(&field, options)?;
    }
    if let Some(tongue) = &entry.tongue {
        tongue_dimensions(&field, tongue)?;
    }
    if let Some(options) = &entry.skeleton {
        skeleton(&field, options)?;
        if options.springs_file.is_some() && entry.tissue != TissueEntry::Skeleton {
            return wrong(
                field("skeleton.springs_file"),
                "given",
                "nothing without tissue = \"skeleton\"",
            );
        }
    }
    let (quadrant, tooth) = (entry.fdi / 10, entry.fdi % 10);
    if entry.fdi != 0 && !((1..=4).contains(&quadrant) && (1..=8).contains(&tooth)) {
        return wrong(
            field("fdi"),
            entry.fdi,
            "0, or an FDI number of a permanent tooth (11-18, 21-28, 31-38, 41-48)",
        );
    }
    levels(&field, entry.level, entry.levels)?;
    place(&field, "translate_mm", &entry.translate_mm)?;
    if let Some(molar) = &entry.molar {
        let range = |key: &str, x: f64, low: f64, high: f64, expected| {
            number(
                &|key: &str| field(&format!("molar.{key}")),
                key,
                x,
                low,
                high,
                expected,
            )
        };
        range(
            "mesiodistal_mm",
            molar.mesiodistal_mm,
            8.0,
            14.0,
            "8 to 14 mm",
        )?;
        range(
            "buccolingual_mm",
            molar.buccolingual_mm,
            8.0,
            13.0,
            "8 to 13 mm",
        )?;
        range(
            "crown_height_mm",
            molar.crown_height_mm,
            5.0,
            10.0,
            "5 to 10 mm",
        )?;
        range(
            "root_length_mm",
            molar.root_length_mm,
            9.0,
            18.0,
            "9 to 18 mm",
        )?;
        range("relief", molar.relief, 0.5, 1.3, "0.5 to 1.3")?;
        range("grid_mm", molar.grid_mm, 0.1, 0.5, "0.1 to 0.5 mm")?;
    }
    Ok(())
}

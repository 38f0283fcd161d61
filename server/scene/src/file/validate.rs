//! The ranges of a scene file's values, and which keys need or exclude which others.

mod mouth;
mod tissue;
mod tooth;

use std::path::Path;

use sulcus_core::MAX_TOOLS;

use crate::file::{
    FileError, ObjectEntry, ObjectKind, SceneFile, TissueEntry, ToolEntry, ToolKind,
};
use crate::instruments::Mirror;
use tissue::{gingiva, skeleton, surface, tongue_dimensions};
use tooth::tooth;

/// A value that cannot stand.
pub(crate) struct Wrong {
    pub field: String,
    pub found: String,
    pub expected: &'static str,
}

impl Wrong {
    /// The same as an error about a file.
    pub fn in_file(self, file: &Path) -> FileError {
        FileError::Field {
            file: file.to_owned(),
            field: self.field,
            found: self.found,
            expected: self.expected,
        }
    }
}

pub(crate) type Checked = Result<(), Wrong>;

pub(crate) fn wrong(field: String, found: impl ToString, expected: &'static str) -> Checked {
    Err(Wrong {
        field,
        found: found.to_string(),
        expected,
    })
}

/// Checks everything that the types do not.
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

fn tool(entry: &ToolEntry) -> Checked {
    let field = |key: &str| format!("`{key}` of tool `{}`", entry.name);
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
    let given = [
        ("working_point_mm", entry.working_point_mm.is_some()),
        ("tip_mm", entry.tip_mm.is_some()),
        ("tip_axis", entry.tip_axis.is_some()),
    ];
    for (key, present) in given {
        if present && entry.mesh.is_none() {
            return wrong(
                field(key),
                "given",
                "nothing, because a parametric tool knows its own",
            );
        }
        if !present && entry.mesh.is_some() {
            return wrong(
                field(key),
                "missing",
                "three numbers, because a mesh does not say where its tip is",
            );
        }
    }
    if entry.probe.is_some() && entry.kind != Some(ToolKind::PeriodontalProbe) {
        return wrong(
            field("probe"),
            "given",
            "nothing without kind = \"periodontal_probe\"",
        );
    }
    if entry.mirror.is_some() && entry.kind != Some(ToolKind::MouthMirror) {
        return wrong(
            field("mirror"),
            "given",
            "nothing without kind = \"mouth_mirror\"",
        );
    }
    levels(&field, entry.level, entry.levels)?;
    number(
        &field,
        "stiffness_n_per_mm",
        entry.stiffness_n_per_mm,
        1e-3,
        100.0,
        "0.001 to 100 N/mm",
    )?;
    number(
        &field,
        "stiffness_nmm_per_rad",
        entry.stiffness_nmm_per_rad,
        0.1,
        1e6,
        "0.1 to 1000000 N mm/rad",
    )?;
    place(&field, "park_mm", &entry.park_mm)?;
    for degrees in entry.park_rotation_deg {
        number(
            &field,
            "park_rotation_deg",
            degrees,
            -360.0,
            360.0,
            "-360 to 360 degrees",
        )?;
    }
    for (key, point) in [
        ("working_point_mm", &entry.working_point_mm),
        ("tip_mm", &entry.tip_mm),
    ] {
        if let Some(point) = point {
            place(&field, key, point)?;
        }
    }
    if let Some(axis) = entry.tip_axis {
        let length = axis.iter().map(|x| x * x).sum::<f64>().sqrt();
        if !(1e-6..1e6).contains(&length) {
            return wrong(
                field("tip_axis"),
                format!("{axis:?}"),
                "a direction that is not zero",
            );
        }
    }
    if let Some(probe) = &entry.probe {
        let range = |key: &str, x: f64, low: f64, high: f64, expected| {
            number(
                &|key: &str| field(&format!("probe.{key}")),
                key,
                x,
                low,
                high,
                expected,
            )
        };
        range(
            "tip_diameter_mm",
            probe.tip_diameter_mm,
            0.2,
            2.0,
            "0.2 to 2 mm",
        )?;
        range(
            "neck_diameter_mm",
            probe.neck_mm(),
            probe.stem_mm(),
            2.4,
            "stem_diameter_mm to 2.4 mm",
        )?;
        range(
            "stem_diameter_mm",
            probe.stem_mm(),
            0.5 * probe.tip_diameter_mm,
            probe.tip_diameter_mm,
            "half of tip_diameter_mm to tip_diameter_mm",
        )?;
        range(
            "working_end_mm",
            probe.working_end_mm,
            15.0,
            25.0,
            "15 to 25 mm",
        )?;
        range(
            "working_end_deg",
            probe.working_end_deg,
            0.0,
            80.0,
            "0 to 80 degrees",
        )?;
        range("shank_deg", probe.shank_deg, 0.0, 60.0, "0 to 60 degrees")?;
        range("reach_mm", probe.reach_mm, 60.0, 150.0, "60 to 150 mm")?;
        range("touching_mm", probe.touching_mm, 10.0, 45.0, "10 to 45 mm")?;
        range("length_mm", probe.length_mm, 150.0, 220.0, "150 to 220 mm")?;
        range(
            "working_point_mm",
            probe.working_point_mm,
            0.0,
            10.0,
            "0 to 10 mm",
        )?;
    }
    match &entry.mirror {
        Some(mirror) => dimensions(&field, mirror),
        None => Ok(()),
    }
}

fn dimensions(field: &dyn Fn(&str) -> String, mirror: &Mirror) -> Checked {
    let range = |key: &str, x: f64, low: f64, high: f64, expected| {
        let field = |key: &str| field(&format!("mirror.{key}"));
        number(&field, key, x, low, high, expected)
    };
    if !matches!(mirror.number, 4 | 5) {
        return wrong(
            field("mirror.number"),
            mirror.number,
            "4 (22 mm) or 5 (24 mm)",
        );
    }
    let (disc, thickness) = (mirror.diameter_mm(), mirror.disc_thickness_mm);
    let end = disc + mirror.neck_mm + 5.0;
    range("disc_diameter_mm", disc, 16.0, 30.0, "16 to 30 mm")?;
    range("disc_thickness_mm", thickness, 1.0, 4.0, "1 to 4 mm")?;
    range(
        "edge_radius_mm",
        mirror.edge_radius_mm,
        0.1,
        0.5 * thickness,
        "0.1 mm to half of disc_thickness_mm",
    )?;
    range("disc_deg", mirror.disc_deg, 0.0, 80.0, "0 to 80 degrees")?;
    range(
        "neck_diameter_mm",
        mirror.neck_diameter_mm,
        0.8,
        thickness,
        "0.8 mm to disc_thickness_mm",
    )?;
    range("neck_mm", mirror.neck_mm, 3.0, 10.0, "3 to 10 mm")?;
    range("reach_mm", mirror.reach_mm, 60.0, 150.0, "60 to 150 mm")?;
    range(
        "touching_mm",
        mirror.touching_mm,
        end,
        55.0,
        "disc_diameter_mm + neck_mm + 5 mm to 55 mm",
    )?;
    range("length_mm", mirror.length_mm, 150.0, 220.0, "150 to 220 mm")
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

fn source(field: &dyn Fn(&str) -> String, kind: bool, mesh: bool, unit: bool) -> Checked {
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

/// The keys that say how a mesh file is read mean nothing without one.
fn reading(field: &dyn Fn(&str) -> String, mesh: bool, given: [(&str, bool); 3]) -> Checked {
    match given.into_iter().find(|(_, given)| *given && !mesh) {
        Some((key, _)) => wrong(field(key), "given", "nothing without `mesh`"),
        None => Ok(()),
    }
}

fn levels(field: &dyn Fn(&str) -> String, level: u8, levels: u8) -> Checked {
    if !(1..=5).contains(&levels) {
        return wrong(field("levels"), levels, "1 to 5");
    }
    if level > levels {
        return wrong(field("level"), level, "0 to `levels`");
    }
    Ok(())
}

fn number(
    field: &dyn Fn(&str) -> String,
    key: &str,
    found: f64,
    low: f64,
    high: f64,
    expected: &'static str,
) -> Checked {
    // Written so that NaN fails.
    if found >= low && found <= high {
        Ok(())
    } else {
        wrong(field(key), found, expected)
    }
}

fn place(field: &dyn Fn(&str) -> String, key: &str, point: &[f64; 3]) -> Checked {
    point
        .iter()
        .try_for_each(|&x| number(field, key, x, -1000.0, 1000.0, "-1000 to 1000 mm"))
}

//! Ranges of `[[tool]]`.

use super::ranges::{levels, place, reading, source};
use crate::file::{ToolEntry, ToolKind};
use crate::hand_written::{Checked, number, wrong};
use crate::instruments::Mirror;

pub(super) fn tool(entry: &ToolEntry) -> Checked {
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
                "nothing, because a parametric tool has its own",
            );
        }
        if !present && entry.mesh.is_some() {
            return wrong(
                field(key),
                "missing",
                "three numbers, because a mesh file has no tip",
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

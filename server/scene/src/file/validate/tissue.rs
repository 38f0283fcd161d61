//! Ranges of the tissues of a scene file.

use crate::file::{ObjectEntry, ObjectKind, Pocket, SulcusEntry, TissueEntry, Tongue};
use crate::hand_written::{Checked, number, wrong};
use crate::organ::SurfaceOptions;
use crate::organ::skeleton::SkeletonOptions;

pub(super) fn tongue_dimensions(field: &dyn Fn(&str) -> String, tongue: &Tongue) -> Checked {
    let range = |key: &str, x: f64, low: f64, high: f64, expected| {
        let field = |key: &str| field(&format!("tongue.{key}"));
        number(&field, key, x, low, high, expected)
    };
    range("length_mm", tongue.length_mm, 40.0, 120.0, "40 to 120 mm")?;
    range("width_mm", tongue.width_mm, 25.0, 80.0, "25 to 80 mm")?;
    range("height_mm", tongue.height_mm, 15.0, 50.0, "15 to 50 mm")?;
    range("groove_mm", tongue.groove_mm, 0.0, 2.0, "0 to 2 mm")?;
    range("grid_mm", tongue.grid_mm, 0.5, 2.0, "0.5 to 2 mm")
}

pub(super) fn surface(field: &dyn Fn(&str) -> String, options: &SurfaceOptions) -> Checked {
    let range = |key: &str, x: f64, low: f64, high: f64, expected| {
        let field = |key: &str| field(&format!("surface.{key}"));
        number(&field, key, x, low, high, expected)
    };
    let (masters, cells) = (options.masters as f64, options.cells as f64);
    range("element_mm", options.element_mm, 0.5, 50.0, "0.5 to 50 mm")?;
    range("masters", masters, 9.0, 256.0, "9 to 256")?;
    range("cells", cells, 0.0, 64.0, "0 to 64")?;
    range(
        "young_kpa",
        options.young_kpa,
        0.1,
        1e5,
        "0.1 to 100000 kPa",
    )?;
    range("poisson", options.poisson, 0.0, 0.499, "0 to 0.499")?;
    range(
        "relaxation_ms",
        options.relaxation_ms,
        2.0,
        1000.0,
        "2 to 1000 ms",
    )?;
    for (key, share) in [
        ("fixed_root", options.fixed_root),
        ("fixed_bottom", options.fixed_bottom),
        ("free_tip", options.free_tip),
    ] {
        range(key, share, 0.0, 1.0, "0 to 1")?;
    }
    Ok(())
}

pub(super) fn skeleton(field: &dyn Fn(&str) -> String, options: &SkeletonOptions) -> Checked {
    let range = |key: &str, x: f64, low: f64, high: f64, expected| {
        let field = |key: &str| field(&format!("skeleton.{key}"));
        number(&field, key, x, low, high, expected)
    };
    for k in options.stiffness_n_per_mm {
        range(
            "stiffness_n_per_mm",
            k,
            1e-4,
            1000.0,
            "0.0001 to 1000 N/mm each",
        )?;
    }
    range("root_factor", options.root_factor, 0.1, 20.0, "0.1 to 20")?;
    range("tip_factor", options.tip_factor, 0.1, 20.0, "0.1 to 20")?;
    range("stretch_limit", options.stretch_limit, 1.0, 20.0, "1 to 20")?;
    range(
        "stretch_half",
        options.stretch_half,
        0.05,
        20.0,
        "0.05 to 20",
    )?;
    range(
        "damping_n_s_per_m",
        options.damping_n_s_per_m,
        0.0,
        100.0,
        "0 to 100 N s/m",
    )?;
    range(
        "density_g_per_cm3",
        options.density_g_per_cm3,
        0.1,
        20.0,
        "0.1 to 20 g/cm3",
    )?;
    range(
        "springs_young_kpa",
        options.springs_young_kpa,
        0.01,
        1e6,
        "0.01 to 1e6 kPa",
    )?;
    range("fixed_root", options.fixed_root, 0.0, 0.9, "0 to 0.9")?;
    range("fixed_bottom", options.fixed_bottom, 0.0, 0.9, "0 to 0.9")?;
    range("free_tip", options.free_tip, 0.0, 1.0, "0 to 1")
}

/// Checks the keys that only a gingiva may have, and those that it must have.
pub(super) fn gingiva(entry: &ObjectEntry, all: &[ObjectEntry]) -> Checked {
    let field = |key: &str| format!("`{key}` of object `{}`", entry.name);
    let drawn = entry.kind == Some(ObjectKind::Gingiva);
    let yields = entry.tissue.is_gingiva();
    if (drawn && !yields) || (yields && !drawn && entry.mesh.is_none()) {
        return wrong(
            field("tissue"),
            if yields {
                "a gingiva's"
            } else {
                "not a gingiva's"
            },
            "\"gingiva\" or \"printed_gingiva\" together with kind = \"gingiva\" or a mesh, or neither",
        );
    }
    let given = [
        ("tooth", entry.tooth.is_some()),
        ("pocket", entry.pocket.is_some()),
        ("sulcus", entry.sulcus.is_some()),
        ("gingiva", entry.gingiva.is_some()),
    ];
    if !yields {
        return match given.iter().find(|(_, given)| *given) {
            Some((key, _)) => wrong(
                field(key),
                "given",
                "nothing without tissue = \"gingiva\" or \"printed_gingiva\"",
            ),
            None => Ok(()),
        };
    }
    if entry.pocket.is_some() && !drawn {
        return wrong(
            field("pocket"),
            "given",
            "nothing without kind = \"gingiva\", because a mesh has its own",
        );
    }
    if entry.sulcus.is_some() && drawn {
        return wrong(field("sulcus"), "given", "nothing without `mesh`");
    }
    let fits = |tooth: &ObjectEntry| {
        tooth.kind == Some(ObjectKind::Molar)
            || (!drawn && tooth.mesh.is_some() && tooth.tissue == TissueEntry::Rigid)
    };
    let expected = if drawn {
        "the name of an object of kind \"molar\""
    } else {
        "the name of an object of kind \"molar\" or of a rigid mesh"
    };
    let Some(name) = &entry.tooth else {
        return wrong(field("tooth"), "missing", expected);
    };
    let tooth = all.iter().find(|other| other.name == *name);
    if !tooth.is_some_and(fits) {
        return wrong(field("tooth"), format!("\"{name}\""), expected);
    }
    if drawn && entry.translate_mm != [0.0; 3] {
        return wrong(
            field("translate_mm"),
            format!("{:?}", entry.translate_mm),
            "nothing, because a gingiva has the place of its tooth",
        );
    }
    if let Some(given) = &entry.sulcus {
        sulcus(&field, given)?;
    }
    if let Some(pocket) = &entry.pocket {
        self::pocket(&field, pocket)?;
    }
    match entry
        .gingiva
        .clone()
        .unwrap_or_default()
        .params()
        .validate()
    {
        Ok(()) => Ok(()),
        Err(error) => wrong(
            field(&format!("gingiva.{}", error.field)),
            error.found,
            "a value in the range of that parameter (SI units)",
        ),
    }
}

fn sulcus(field: &dyn Fn(&str) -> String, sulcus: &SulcusEntry) -> Checked {
    let range = |key: &str, x: f64, low: f64, high: f64, expected| {
        let field = |key: &str| field(&format!("sulcus.{key}"));
        number(&field, key, x, low, high, expected)
    };
    let directions = [("axis", sulcus.axis), ("mesial", sulcus.mesial)];
    for (key, direction) in directions {
        let Some(v) = direction else { continue };
        let length = v.iter().map(|x| x * x).sum::<f64>().sqrt();
        if !(1e-6..1e6).contains(&length) {
            return wrong(
                field(&format!("sulcus.{key}")),
                format!("{v:?}"),
                "a direction that is not zero",
            );
        }
    }
    for x in sulcus.origin_mm.into_iter().flatten() {
        range("origin_mm", x, -1000.0, 1000.0, "-1000 to 1000 mm")?;
    }
    if let Some(floor) = sulcus.floor_mm {
        range("floor_mm", floor, -30.0, 30.0, "-30 to 30 mm")?;
    }
    if let Some(width) = sulcus.width_mm {
        range("width_mm", width, 0.05, 2.0, "0.05 to 2 mm")?;
    }
    range("open_mm", sulcus.open_mm, 0.02, 1.0, "0.02 to 1 mm")?;
    range(
        "proximal_deg",
        sulcus.proximal_deg,
        20.0,
        80.0,
        "20 to 80 degrees",
    )
}

fn pocket(field: &dyn Fn(&str) -> String, pocket: &Pocket) -> Checked {
    let range = |key: &str, x: f64, low: f64, high: f64, expected| {
        let field = |key: &str| field(&format!("pocket.{key}"));
        number(&field, key, x, low, high, expected)
    };
    range("width_mm", pocket.width_mm, 0.2, 1.5, "0.2 to 1.5 mm")?;
    for depth in pocket.depths_mm {
        range("depths_mm", depth, 1.5, 8.0, "1.5 to 8 mm each")?;
    }
    let margin = pocket.margin_mm;
    range("margin_mm", margin, -5.0, 4.0, "-5 to 4 mm")?;
    range(
        "papilla_mm",
        pocket.papilla_mm,
        margin,
        5.0,
        "margin_mm to 5 mm",
    )?;
    range("crest_mm", pocket.crest_mm, 0.4, 1.5, "0.4 to 1.5 mm")?;
    range(
        "wall_mm",
        pocket.wall_mm,
        pocket.crest_mm,
        4.0,
        "crest_mm to 4 mm",
    )?;
    range("base_mm", pocket.base_mm, 1.0, 5.0, "1 to 5 mm")?;
    range("grid_mm", pocket.grid_mm, 0.08, 0.4, "0.08 to 0.4 mm")
}

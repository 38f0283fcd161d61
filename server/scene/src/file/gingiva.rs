//! Parameters of a gingiva from its entry in a scene file.

use sulcus_core::tissue::gingiva::GingivaParams;

use crate::file::GingivaEntry;

/// Parameters of a gingiva as written in a file.
pub(crate) fn gingiva_params(given: &GingivaEntry) -> GingivaParams {
    let mut params = GingivaParams::default();
    let set = |to: &mut f64, from: Option<f64>, unit: f64| {
        if let Some(x) = from {
            *to = x * unit;
        }
    };
    let (n_per_mm, mm, ms) = (1e3, 1e-3, 1e-3);
    set(
        &mut params.wall_stiffness,
        given.wall_stiffness_n_per_mm,
        n_per_mm,
    );
    set(
        &mut params.shear_stiffness,
        given.shear_stiffness_n_per_mm,
        n_per_mm,
    );
    set(&mut params.reach, given.reach_mm, mm);
    set(&mut params.relaxation, given.relaxation_ms, ms);
    set(
        &mut params.floor_stiffness,
        given.floor_stiffness_n_per_mm,
        n_per_mm,
    );
    set(&mut params.floor_taper, given.floor_taper_mm, mm);
    set(&mut params.reading_force, given.reading_force_n, 1.0);
    set(&mut params.reading_tip, given.reading_tip_mm, mm);
    set(&mut params.inflammation, given.inflammation, 1.0);
    set(&mut params.softening, given.softening, 1.0);
    set(&mut params.too_heavy, given.too_heavy_n, 1.0);
    set(&mut params.trauma, given.trauma_n, 1.0);
    set(&mut params.damage, given.damage_n, 1.0);
    set(&mut params.rearm, given.rearm, 1.0);
    params
}

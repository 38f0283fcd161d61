//! Models that are part of the program.

use super::{DeviceModel, ModelError};

/// Files of the models, in the order of their names.
const FILES: [&str; 18] = [
    include_str!("../../models/delta_3.toml"),
    include_str!("../../models/falcon.toml"),
    include_str!("../../models/inverse3.toml"),
    include_str!("../../models/inverse3x.toml"),
    include_str!("../../models/lambda_7.toml"),
    include_str!("../../models/minverse.toml"),
    include_str!("../../models/omega_3.toml"),
    include_str!("../../models/omega_6.toml"),
    include_str!("../../models/omega_7.toml"),
    include_str!("../../models/premium_1_5.toml"),
    include_str!("../../models/premium_1_5_6dof.toml"),
    include_str!("../../models/premium_1_5_hf.toml"),
    include_str!("../../models/premium_3_0_6dof.toml"),
    include_str!("../../models/sigma_7.toml"),
    include_str!("../../models/touch.toml"),
    include_str!("../../models/touch_x.toml"),
    include_str!("../../models/virtuose_6d.toml"),
    include_str!("../../models/virtuose_desktop.toml"),
];

/// Returns all shipped models.
///
/// # Errors
/// A file is invalid. The tests exclude this.
pub fn shipped() -> Result<Vec<DeviceModel>, ModelError> {
    FILES
        .iter()
        .map(|text| DeviceModel::from_toml(text))
        .collect()
}

/// Returns the shipped model of `library` that the library reports as `model`. Capitals do not matter. `None`: no such
/// model.
pub fn shipped_for(library: &str, model: &str) -> Option<DeviceModel> {
    let all = shipped().ok()?;
    all.into_iter()
        .find(|shipped| shipped.is_of(library, model))
}

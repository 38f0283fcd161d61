//! Filters of the templates: numbers and pictures as text.

use askama::Values;

use crate::picture::data_uri;

/// A number with so many decimals.
#[askama::filter_fn]
pub(super) fn fixed(number: &f64, _: &dyn Values, decimals: usize) -> askama::Result<String> {
    Ok(format!("{number:.decimals$}"))
}

/// A number with so many decimals, a dash without a number.
#[askama::filter_fn]
pub(super) fn or_dash(
    number: &Option<f64>,
    _: &dyn Values,
    decimals: usize,
) -> askama::Result<String> {
    Ok(number.map_or("–".to_owned(), |number| format!("{number:.decimals$}")))
}

/// The bytes of a PNG file as an address.
#[askama::filter_fn]
pub(super) fn png(bytes: &[u8], _: &dyn Values) -> askama::Result<String> {
    Ok(data_uri("image/png", bytes))
}

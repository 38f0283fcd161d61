//! Filters of the templates: numbers as text.

use askama::Values;

/// A number with so many decimals.
#[askama::filter_fn]
pub fn fixed(number: &f64, _: &dyn Values, decimals: usize) -> askama::Result<String> {
    Ok(format!("{number:.decimals$}"))
}

/// A number with so many decimals, or a dash without a number.
#[askama::filter_fn]
pub fn or_dash(number: &Option<f64>, _: &dyn Values, decimals: usize) -> askama::Result<String> {
    Ok(number.map_or("–".into(), |number| format!("{number:.decimals$}")))
}

/// A number with its sign and so many decimals.
#[askama::filter_fn]
pub fn signed(number: &f64, _: &dyn Values, decimals: usize) -> askama::Result<String> {
    Ok(format!("{number:+.decimals$}"))
}

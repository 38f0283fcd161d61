//! The pages of the laboratory: HTML from the templates in `templates/`, each a file that needs no other file.
//!
//! A view is a struct whose fields a template shows. The template escapes every text; only [`plot::Svg`] is markup.

mod filters;
mod plot;
pub(crate) mod report;
pub(crate) mod tissue;

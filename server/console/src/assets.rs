//! Style and script of the pages, parts of the program.

use axum::extract::Path;
use axum::http::{StatusCode, header};
use axum::response::{IntoResponse, Response};

const STYLE: (&str, &str) = (
    "text/css; charset=utf-8",
    include_str!("assets/console.css"),
);
const SCRIPT: &str = "text/javascript; charset=utf-8";

/// Content type and content of each file.
fn file(name: &str) -> Option<(&'static str, &'static str)> {
    Some(match name {
        "console.css" => STYLE,
        "replay.js" => (SCRIPT, include_str!("assets/replay.js")),
        "results.css" => (STYLE.0, include_str!("assets/results.css")),
        "view.css" => ("text/css; charset=utf-8", include_str!("assets/view.css")),
        "view.js" => (SCRIPT, include_str!("assets/view.js")),
        "flat.js" => (SCRIPT, include_str!("assets/flat.js")),
        "plots.js" => (SCRIPT, include_str!("assets/plots.js")),
        "chart.js" => (SCRIPT, include_str!("assets/chart.js")),
        "stations.js" => (SCRIPT, include_str!("assets/stations.js")),
        "station.js" => (SCRIPT, include_str!("assets/station.js")),
        "live.js" => (SCRIPT, include_str!("assets/live.js")),
        "tile.js" => (SCRIPT, include_str!("assets/tile.js")),
        "cases.css" => ("text/css; charset=utf-8", include_str!("assets/cases.css")),
        "cases.js" => (SCRIPT, include_str!("assets/cases.js")),
        "case.js" => (SCRIPT, include_str!("assets/case.js")),
        "counts.js" => (SCRIPT, include_str!("assets/counts.js")),
        "patient.js" => (SCRIPT, include_str!("assets/patient.js")),
        "case-chart.js" => (SCRIPT, include_str!("assets/case-chart.js")),
        "ask.js" => (SCRIPT, include_str!("assets/ask.js")),
        "register.css" => (STYLE.0, include_str!("assets/register.css")),
        "register.js" => (SCRIPT, include_str!("assets/register.js")),
        _ => return None,
    })
}

/// `GET /assets/{name}`.
pub async fn asset(Path(name): Path<String>) -> Response {
    match file(&name) {
        Some((content_type, content)) => {
            // Asked for again at each load: an upgraded server must not meet scripts of the old one.
            let headers = [
                (header::CONTENT_TYPE, content_type),
                (header::CACHE_CONTROL, "no-cache"),
            ];
            (headers, content).into_response()
        }
        None => StatusCode::NOT_FOUND.into_response(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Relative luminance of a colour `#rrggbb`, by WCAG 2.2.
    fn luminance(colour: &str) -> f64 {
        let part = |at: usize| {
            let digits = colour.get(at..at + 2).expect("six digits");
            let value = f64::from(u8::from_str_radix(digits, 16).expect("digits")) / 255.0;
            if value <= 0.04045 {
                value / 12.92
            } else {
                ((value + 0.055) / 1.055).powf(2.4)
            }
        };
        0.2126 * part(1) + 0.7152 * part(3) + 0.0722 * part(5)
    }

    /// The orange of a warning had 4.3 to 1 on white, and a warning was seldom on the page while the browser looked.
    #[test]
    fn every_colour_of_text_has_a_contrast_of_at_least_4_5_in_both_schemes() {
        let schemes: Vec<&str> = STYLE.1.split(":root {").skip(1).take(2).collect();
        assert_eq!(schemes.len(), 2, "light and dark");
        for scheme in schemes {
            let scheme = scheme.split('}').next().unwrap_or_default();
            let colour = |name: &str| {
                let (_, rest) = scheme.split_once(&format!("--{name}: ")).expect(name);
                luminance(rest.split(';').next().expect(name))
            };
            for text in [
                "text", "faint", "accent", "grave", "zone0", "zone1", "zone2", "zone3",
            ] {
                for behind in ["ground", "sheet"] {
                    let (a, b) = (colour(text), colour(behind));
                    let contrast = (a.max(b) + 0.05) / (a.min(b) + 0.05);
                    assert!(contrast >= 4.5, "{text} on {behind}: {contrast:.2}");
                }
            }
        }
    }
}

//! Key of a chart: the meaning of its lines and signs. The words are in the template `chart.html`.

use super::super::svg::Svg;
use super::{BLUE, RED};

/// Signs of a chart that need words.
pub struct Key {
    /// Whether prescribed values are drawn.
    pub truth: bool,
    /// Whether there is a furcation, called or prescribed.
    pub furcation: bool,
    /// Whether there is a zone without a call of recession.
    pub no_margin: bool,
    /// Name of the numbering of teeth.
    pub numbering: &'static str,
}

impl Key {
    /// Sample of the line of the margin.
    pub fn margin(&self) -> Svg {
        sample(RED, None)
    }

    /// Sample of the line of the attachment.
    pub fn attachment(&self) -> Svg {
        sample(BLUE, Some("7 2.5"))
    }
}

fn sample(colour: &str, dashes: Option<&str>) -> Svg {
    const STYLE: &str = "display:inline;width:26px;height:9px;vertical-align:middle";
    Svg::drawing(
        |svg| svg.with("style", STYLE).with("viewBox", "0 0 26 9"),
        |svg| {
            svg.element("line")
                .with("x1", 0)
                .with("y1", 4.5)
                .with("x2", 26)
                .with("y2", 4.5)
                .stroke(colour, 2.4)
                .maybe("stroke-dasharray", dashes)
                .end();
        },
    )
}

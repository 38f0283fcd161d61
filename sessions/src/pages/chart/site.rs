//! Numbers and signs of one site of a chart.

use super::super::svg::Svg;
use super::RED;
use super::place::Row;
use crate::grade::sites::SiteGrade;

/// Depth or attachment loss from which a number is bold, mm.
const POCKET: f64 = 4.0;

/// Numbers and dots of a site at `x`, from the teeth outwards.
pub fn numbers(svg: &mut Svg, grade: &SiteGrade, x: f64, row: &Row, truth: bool) {
    let mut text = |k: usize, number: &str, bold: bool| {
        svg.element("text")
            .xy(x, row.line(k))
            .with("font-size", 11.5)
            .with("text-anchor", "middle")
            .maybe("font-weight", bold.then_some(700))
            .text(number);
    };
    let depth = grade.called_mm.map(f64::from);
    match depth {
        Some(mm) => text(0, &format!("{mm:.0}"), mm >= POCKET),
        None => text(0, "–", false),
    }
    let recession = grade.recession_called_mm;
    if let Some(mm) = recession {
        text(1, &signed(mm), false);
    }
    if let (Some(depth), Some(recession)) = (depth, recession) {
        let loss = depth + f64::from(recession);
        text(2, &format!("{loss:.0}").replace('-', "−"), loss >= POCKET);
    }
    if truth && let Some(mm) = grade.truth_mm {
        text(4, &format!("{mm}"), false);
    }
    if let Some(bleeds) = grade.bleeding_called {
        dot(svg, (x, row.line(3) - 4.0), bleeds);
    }
    if truth {
        dot(svg, (x, row.line(5) - 4.0), grade.bled);
    }
}

/// Recession with its sign.
fn signed(mm: i8) -> String {
    match mm {
        0 => "0".into(),
        mm if mm < 0 => format!("−{}", mm.unsigned_abs()),
        mm => format!("+{mm}"),
    }
}

/// Sign of bleeding: a full dot, or a ring without bleeding.
fn dot(svg: &mut Svg, (x, y): (f64, f64), bleeds: bool) {
    let (fill, r, stroke) = match bleeds {
        true => (RED, 3.6, "#5a0012"),
        false => ("#fff", 2.6, "#777"),
    };
    svg.element("circle")
        .at("cx", x)
        .at("cy", y)
        .with("r", r)
        .with("fill", fill)
        .with("stroke", stroke)
        .end();
}

/// Sign of a furcation of grade 1 to 3: an open, half or full circle, dotted if the grade was not called.
pub fn furcation(svg: &mut Svg, grade: u8, called: bool, (x, y): (f64, f64)) {
    if grade == 0 {
        return;
    }
    svg.element("circle")
        .at("cx", x)
        .at("cy", y)
        .with("r", 5)
        .with("fill", if grade == 3 { "#111" } else { "#fff" })
        .stroke("#111", 1.3)
        .maybe("stroke-dasharray", (!called).then_some("1.5 2"))
        .end();
    if grade == 2 {
        svg.element("path")
            .with("d", format_args!("M{x:.1},{:.1}a5,5 0 0 1 0,10Z", y - 5.0))
            .with("fill", "#111")
            .end();
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn grades_of_furcation_have_signs_of_their_own() {
        let sign = |grade| {
            let mut svg = Svg::default();
            furcation(&mut svg, grade, true, (0.0, 0.0));
            svg.markup().0.to_owned()
        };
        assert_eq!(sign(0), "");
        assert!(sign(1).contains("#fff") && !sign(1).contains("path"));
        assert!(sign(2).contains("path"));
        assert!(sign(3).contains("fill=\"#111\"") && !sign(3).contains("path"));
    }
}

//! One row of a chart: scale, teeth, lines and numbers of one side of a jaw.

use super::super::jaw::across;
use super::super::svg::Svg;
use super::super::tooth::{FURCATION_MM, ToothKind};
use super::lines::{self, Spot};
use super::place::Row;
use super::{CROWN_MM, Chart, LEFT, MM, ROOT_MM, site};

impl Row {
    /// Name, scale in millimetres, and names of the lines of numbers.
    fn labels(&self, svg: &mut Svg, lines: usize) {
        // Between two marks of the scale.
        svg.element("text")
            .with("x", 0)
            .at("y", self.y(10.0) + 3.0)
            .with("font-size", 11)
            .with("font-weight", 700)
            .text(self.name);
        for mm in [2, 4, 6, 8, 10, 12] {
            let y = self.y(f64::from(mm));
            self.level(svg, y, ("#ddd", 0.7));
            if mm % 4 == 0 {
                mark(svg, y, &format!("{mm} mm"));
            }
        }
        self.level(svg, self.cej, ("#aaa", 0.9));
        mark(svg, self.cej, "CEJ");
        let names = ["PD", "recession", "CAL", "bleeding", "PD, true", "bled"];
        for (k, name) in names[..lines].iter().enumerate() {
            svg.element("text")
                .xy(LEFT - 3.0, self.line(k))
                .with("font-size", 9.5)
                .with("text-anchor", "end")
                .text(name);
        }
    }

    /// Line across all teeth.
    fn level(&self, svg: &mut Svg, y: f64, (colour, width): (&str, f64)) {
        svg.across(y, LEFT, format_args!("{:.0}", self.width))
            .stroke(colour, width)
            .end();
    }
}

/// Name of a mark of the scale.
fn mark(svg: &mut Svg, y: f64, name: &str) {
    svg.element("text")
        .xy(LEFT - 3.0, y + 3.0)
        .with("font-size", 8)
        .with("fill", "#555")
        .with("text-anchor", "end")
        .text(name);
}

impl Chart<'_> {
    /// Draws a row.
    pub(super) fn row(&self, svg: &mut Svg, teeth: &[u8; 16], row: &Row) {
        row.labels(svg, self.lines());
        let (mut called, mut truth) = (Vec::new(), Vec::new());
        let mut x = LEFT;
        for fdi in teeth {
            let wide = self.width(*fdi);
            self.tooth(svg, *fdi, row, x);
            for (k, place) in across(*fdi, row.buccal).into_iter().enumerate() {
                let x = x + wide * (0.17 + 0.33 * k as f64);
                let grade = self.at(*fdi, place);
                if let Some(grade) = grade {
                    site::numbers(svg, grade, x, row, self.truth);
                }
                called.push(grade.map(|grade| Spot {
                    x,
                    recession: grade.recession_called_mm.map(f64::from),
                    depth: grade.called_mm.map(f64::from),
                }));
                truth.push(grade.map(|grade| Spot {
                    x,
                    recession: grade.recession_truth_mm,
                    depth: grade.truth_mm,
                }));
            }
            x += wide;
        }
        let y = |mm: f64| row.y(mm.clamp(-CROWN_MM, ROOT_MM - 0.4));
        lines::called(svg, &called, y);
        if self.truth {
            lines::prescribed(svg, &truth, y);
        }
    }

    /// Outline of a tooth whose cell begins at `x`, a cross over a missing tooth, and the furcation.
    fn tooth(&self, svg: &mut Svg, fdi: u8, row: &Row, x: f64) {
        let wide = self.width(fdi);
        let middle = x + 0.5 * wide;
        let (stroke, fill) = match (self.teeth.contains(&fdi), self.is_examined(fdi)) {
            (true, true) => ("#444", "#fbf7ec"),
            (true, false) => ("#a5a5a5", "#fbfbfb"),
            (false, _) => ("#d0d0d0", "none"),
        };
        let outline = ToothKind::of(fdi).path((middle, 0.5 * wide), row.cej, row.up, MM);
        svg.element("path")
            .with("d", outline)
            .with("fill", fill)
            .stroke(stroke, 1.0)
            .end();
        if self.patient.missing.contains(&fdi) {
            let (a, b) = (row.y(-7.0), row.y(11.0));
            let (left, right) = (x + 5.0, x + wide - 5.0);
            let cross = format_args!(
                "M{left:.1},{a:.1}L{right:.1},{b:.1}M{right:.1},{a:.1}L{left:.1},{b:.1}"
            );
            svg.element("path")
                .with("d", cross)
                .stroke("#555", 1.2)
                .end();
        }
        let (grade, called) = self.furcation(fdi, row.buccal);
        site::furcation(svg, grade, called, (middle, row.y(FURCATION_MM)));
    }
}

//! Periodontal chart: two rows of teeth to a jaw, with lines, numbers and signs.
//!
//! A red line is the gingival margin, a blue line the attachment; the pocket between them is hatched. Depth, recession
//! and attachment loss stand in threes. Dots are bleeding, circles are furcations.

mod key;
mod lines;
mod place;
mod row;
mod site;

use super::jaw::{Jaw, Numbering, across};
use super::svg::Svg;
use super::tooth::ToothKind;
use crate::grade::patient::PatientChart;
use crate::grade::sites::SiteGrade;
use key::Key;
use place::Row;
use sulcus_core::tissue::gingiva::Site;

/// Length of a millimetre, units of the drawing.
const MM: f64 = 4.4;
/// Height of a row from the cemento-enamel junction towards the root, mm.
const ROOT_MM: f64 = 13.5;
/// Height of a row from the cemento-enamel junction towards the crown, mm.
const CROWN_MM: f64 = 9.0;
/// Height of a line of numbers.
const LINE: f64 = 13.0;
/// Width of the labels on the left.
const LEFT: f64 = 74.0;
/// Height of the teeth's own numbers between the two rows.
const MIDDLE: f64 = 18.0;
/// Most examined teeth that get wider cells than the others.
const FEW: usize = 5;
/// Colour of the gingival margin and of bleeding.
const RED: &str = "#c4122f";
/// Colour of the attachment.
const BLUE: &str = "#123a8c";

/// Content of a chart.
pub struct Chart<'a> {
    /// Zones.
    pub sites: &'a [SiteGrade],
    /// Teeth of the scene, FDI numbers.
    pub teeth: &'a [u8],
    /// Missing teeth and furcations of the patient.
    pub patient: &'a PatientChart,
    /// Numbering of teeth.
    pub numbering: Numbering,
    /// Whether prescribed values are drawn too.
    pub truth: bool,
}

/// Chart as the template `chart.html` takes it.
pub struct ChartView {
    /// Drawings of the jaws, one below the other.
    pub jaws: Vec<Svg>,
    /// Key of lines and signs.
    pub key: Key,
}

impl Chart<'_> {
    /// The jaws that have zones, and the key of their lines and signs.
    pub fn view(&self) -> ChartView {
        let sides = [true, false];
        let furcation = |fdi| sides.iter().any(|side| self.furcation(fdi, *side).0 > 0);
        let unsaid = |site: &SiteGrade| site.recession_called_mm.is_none();
        ChartView {
            jaws: self.jaws().map(|jaw| self.jaw(jaw)).collect(),
            key: Key {
                truth: self.truth,
                furcation: self.jaws().flat_map(Jaw::teeth).any(furcation),
                no_margin: self.sites.iter().any(unsaid),
                numbering: self.numbering.name(),
            },
        }
    }

    fn jaws(&self) -> impl Iterator<Item = Jaw> + '_ {
        let has_zones = |jaw: &Jaw| self.sites.iter().any(|site| Jaw::of(site.tooth) == *jaw);
        [Jaw::Upper, Jaw::Lower].into_iter().filter(has_zones)
    }

    fn at(&self, tooth: u8, site: Site) -> Option<&SiteGrade> {
        self.sites
            .iter()
            .find(|one| (one.tooth, one.site) == (tooth, site))
    }

    fn is_examined(&self, fdi: u8) -> bool {
        self.sites.iter().any(|site| site.tooth == fdi)
    }

    /// Grade of a furcation to be drawn, and whether it was called.
    fn furcation(&self, fdi: u8, buccal: bool) -> (u8, bool) {
        if ToothKind::of(fdi) != ToothKind::Molar {
            return (0, false);
        }
        let middle = self.at(fdi, across(fdi, buccal)[1]);
        let called = middle.and_then(|grade| grade.furcation_called);
        let prescribed = || self.truth.then(|| self.patient.furcation(fdi, buccal));
        (called.or_else(prescribed).unwrap_or(0), called.is_some())
    }

    /// Width of a tooth's cell. If few teeth were examined, their cells are wider, and the other cells are narrower.
    fn width(&self, fdi: u8) -> f64 {
        let plain = ToothKind::of(fdi).width();
        let mut examined: Vec<u8> = self.sites.iter().map(|site| site.tooth).collect();
        examined.sort_unstable();
        examined.dedup();
        match (examined.len() <= FEW, examined.contains(&fdi)) {
            (false, _) => plain,
            (true, true) => 1.6 * plain,
            (true, false) => 0.85 * plain,
        }
    }

    /// Number of the lines of numbers, from the teeth outwards.
    fn lines(&self) -> usize {
        if self.truth { 6 } else { 4 }
    }

    fn jaw(&self, jaw: Jaw) -> Svg {
        let teeth = jaw.teeth();
        let width: f64 = LEFT + teeth.iter().map(|fdi| self.width(*fdi)).sum::<f64>();
        let (block, row) = (self.lines() as f64 * LINE + 3.0, (ROOT_MM + CROWN_MM) * MM);
        let height = 2.0 * (block + row) + MIDDLE + 2.0;
        Svg::drawing(
            |svg| {
                svg.with("viewBox", format_args!("0 0 {width:.0} {height:.0}"))
                    .with("role", "img")
                    .with(
                        "aria-label",
                        format_args!("periodontal chart, {}", jaw.name()),
                    )
            },
            |svg| {
                hatching(svg);
                // Roots away from the middle of the jaw.
                let below = block + row + MIDDLE;
                let [(upper, upper_name), (lower, lower_name)] = jaw.rows();
                let rows = [
                    Row {
                        buccal: upper,
                        name: upper_name,
                        up: -1.0,
                        cej: block + ROOT_MM * MM,
                        inner: block - 4.0,
                        width,
                    },
                    Row {
                        buccal: lower,
                        name: lower_name,
                        up: 1.0,
                        cej: below + CROWN_MM * MM,
                        inner: below + row + LINE,
                        width,
                    },
                ];
                for row in rows {
                    self.row(svg, &teeth, &row);
                }
                self.middle(svg, &teeth, block + row + MIDDLE - 5.0, height);
            },
        )
    }

    /// The teeth's own numbers at the height `y`, and the line between the patient's right and left.
    fn middle(&self, svg: &mut Svg, teeth: &[u8; 16], y: f64, height: f64) {
        let mut x = LEFT;
        for fdi in teeth {
            let wide = self.width(*fdi);
            let (weight, colour) = match self.is_examined(*fdi) {
                true => ("700", "#000"),
                false => ("400", "#777"),
            };
            svg.element("text")
                .xy(x + 0.5 * wide, y)
                .with("font-size", 12)
                .with("font-weight", weight)
                .with("fill", colour)
                .with("text-anchor", "middle")
                .text(self.numbering.of(*fdi));
            x += wide;
        }
        let half = LEFT + teeth[..8].iter().map(|fdi| self.width(*fdi)).sum::<f64>();
        svg.element("line")
            .at("x1", half)
            .with("y1", 0)
            .at("x2", half)
            .at("y2", height)
            .with("stroke", "#999")
            .with("stroke-dasharray", "2 3")
            .end();
        svg.element("text")
            .with("x", 0)
            .at("y", y)
            .with("font-size", 9)
            .text("R ← patient → L");
    }
}

/// Pattern of a pocket.
fn hatching(svg: &mut Svg) {
    svg.element("defs").around(|svg| {
        svg.element("pattern")
            .with("id", "pocket")
            .with("width", 4)
            .with("height", 4)
            .with("patternUnits", "userSpaceOnUse")
            .with("patternTransform", "rotate(45)")
            .around(|svg| {
                svg.element("rect")
                    .with("width", 4)
                    .with("height", 4)
                    .with("fill", "#f6dfe3")
                    .end();
                svg.element("line")
                    .with("x1", 0)
                    .with("y1", 0)
                    .with("x2", 0)
                    .with("y2", 4)
                    .stroke("#8a5560", 1.1)
                    .end();
            });
    });
}

#[cfg(test)]
mod tests;

//! The periodontal chart as dentists draw it: two rows of teeth to a jaw, a red line for the margin, a blue one for the attachment,
//! the pocket hatched between them; depths, recession and attachment loss in threes, dots for bleeding, circles for
//! furcations.

use std::fmt::Write as _;

use super::jaw::{Jaw, Numbering, across};
use super::tooth::{FURCATION_MM, ToothKind};
use crate::grade::patient::PatientChart;
use crate::grade::sites::SiteGrade;

/// A millimetre, and what a row shows of them towards the root and towards the crown.
const MM: f64 = 4.4;
const ROOT_MM: f64 = 13.5;
const CROWN_MM: f64 = 9.0;
/// Height of a line of numbers, and width of what is written beside.
const LINE: f64 = 13.0;
const LEFT: f64 = 74.0;
/// Space for the teeth's own numbers between the two rows.
const MIDDLE: f64 = 18.0;
/// So many teeth are few.
const FEW: usize = 5;
/// Depth from which a pocket is written bold, mm.
const POCKET: f64 = 4.0;

const RED: &str = "#c4122f";
const BLUE: &str = "#123a8c";

/// What is drawn.
pub struct Chart<'a> {
    /// Zones.
    pub sites: &'a [SiteGrade],
    /// Teeth that the scene has.
    pub teeth: &'a [u8],
    /// What the patient's text says.
    pub patient: &'a PatientChart,
    /// How teeth are numbered.
    pub numbering: Numbering,
    /// Whether what is prescribed is drawn too.
    pub truth: bool,
}

/// Where one site is drawn and what is known there, mm.
#[derive(Clone, Copy)]
struct Spot {
    x: f64,
    recession: Option<f64>,
    depth: Option<f64>,
}

impl Chart<'_> {
    /// The jaws that have zones, one below the other, and what lines and signs mean.
    pub fn html(&self) -> String {
        let signs = Signs {
            truth: self.truth,
            furcation: self.jaws().flat_map(Jaw::teeth).any(|fdi| {
                [true, false]
                    .iter()
                    .any(|buccal| self.furcation(fdi, *buccal).0 > 0)
            }),
            no_margin: self
                .sites
                .iter()
                .any(|site| site.recession_called_mm.is_none()),
        };
        self.svg() + &signs.key(self.numbering)
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

    /// The jaws that have zones, one below the other.
    fn svg(&self) -> String {
        self.jaws().map(|jaw| self.jaw(jaw)).collect()
    }

    fn jaws(&self) -> impl Iterator<Item = Jaw> + '_ {
        let has_zones = |jaw: &Jaw| self.sites.iter().any(|site| Jaw::of(site.tooth) == *jaw);
        [Jaw::Upper, Jaw::Lower].into_iter().filter(has_zones)
    }

    fn at(&self, tooth: u8, site: sulcus_core::tissue::gingiva::Site) -> Option<&SiteGrade> {
        self.sites
            .iter()
            .find(|one| (one.tooth, one.site) == (tooth, site))
    }

    /// Width of a tooth's cell: where few were examined they have more room, and the others less.
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

    /// Lines of numbers, from the teeth outwards.
    fn lines(&self) -> usize {
        if self.truth { 6 } else { 4 }
    }

    fn jaw(&self, jaw: Jaw) -> String {
        let teeth = jaw.teeth();
        let width: f64 = LEFT + teeth.iter().map(|fdi| self.width(*fdi)).sum::<f64>();
        let (block, row) = (self.lines() as f64 * LINE + 3.0, (ROOT_MM + CROWN_MM) * MM);
        let height = 2.0 * (block + row) + MIDDLE + 2.0;
        let mut svg = format!(
            "<svg viewBox=\"0 0 {width:.0} {height:.0}\" role=\"img\" aria-label=\"periodontal chart, {}\"><defs><pattern id=\"pocket\" width=\"4\" height=\"4\" patternUnits=\"userSpaceOnUse\" patternTransform=\"rotate(45)\"><rect width=\"4\" height=\"4\" fill=\"#f6dfe3\"/><line x1=\"0\" y1=\"0\" x2=\"0\" y2=\"4\" stroke=\"#8a5560\" stroke-width=\"1.1\"/></pattern></defs>\n",
            jaw.name()
        );
        // Roots away from the middle of the jaw.
        for (k, (buccal, name)) in jaw.rows().into_iter().enumerate() {
            let below = block + row + MIDDLE;
            let (up, cej) = if k == 0 {
                (-1.0, block + ROOT_MM * MM)
            } else {
                (1.0, below + CROWN_MM * MM)
            };
            let inner = if k == 0 {
                block - 4.0
            } else {
                below + row + LINE
            };
            self.row(&mut svg, &teeth, (buccal, name), (up, cej), (width, inner));
        }
        let middle = block + row + MIDDLE - 5.0;
        let mut x = LEFT;
        for fdi in teeth {
            let wide = self.width(fdi);
            let asked = self.sites.iter().any(|site| site.tooth == fdi);
            let weight = if asked { "700" } else { "400" };
            let colour = if asked { "#000" } else { "#777" };
            let _ = writeln!(
                svg,
                "<text x=\"{:.1}\" y=\"{middle:.1}\" font-size=\"12\" font-weight=\"{weight}\" fill=\"{colour}\" text-anchor=\"middle\">{}</text>",
                x + 0.5 * wide,
                self.numbering.of(fdi)
            );
            x += wide;
        }
        let half: f64 = LEFT + teeth[..8].iter().map(|fdi| self.width(*fdi)).sum::<f64>();
        let _ = writeln!(
            svg,
            "<line x1=\"{half:.1}\" y1=\"0\" x2=\"{half:.1}\" y2=\"{height:.1}\" stroke=\"#999\" stroke-dasharray=\"2 3\"/><text x=\"0\" y=\"{middle:.1}\" font-size=\"9\">R &#8592; patient &#8594; L</text>"
        );
        svg + "</svg>\n"
    }

    /// One row: grid, teeth, lines, numbers.
    fn row(
        &self,
        svg: &mut String,
        teeth: &[u8; 16],
        (buccal, name): (bool, &str),
        (up, cej): (f64, f64),
        (width, inner): (f64, f64),
    ) {
        // Between two marks of the scale.
        let label = cej + up * 10.0 * MM + 3.0;
        let _ = writeln!(
            svg,
            "<text x=\"0\" y=\"{label:.1}\" font-size=\"11\" font-weight=\"700\">{name}</text>"
        );
        for mm in [2, 4, 6, 8, 10, 12] {
            let y = cej + up * f64::from(mm) * MM;
            let _ = write!(
                svg,
                "<line x1=\"{LEFT}\" y1=\"{y:.1}\" x2=\"{width:.0}\" y2=\"{y:.1}\" stroke=\"#ddd\" stroke-width=\"0.7\"/>"
            );
            if mm % 4 == 0 {
                let _ = write!(
                    svg,
                    "<text x=\"{:.1}\" y=\"{:.1}\" font-size=\"8\" fill=\"#555\" text-anchor=\"end\">{mm} mm</text>",
                    LEFT - 3.0,
                    y + 3.0
                );
            }
        }
        let _ = writeln!(
            svg,
            "<line x1=\"{LEFT}\" y1=\"{cej:.1}\" x2=\"{width:.0}\" y2=\"{cej:.1}\" stroke=\"#aaa\" stroke-width=\"0.9\"/><text x=\"{:.1}\" y=\"{:.1}\" font-size=\"8\" fill=\"#555\" text-anchor=\"end\">CEJ</text>",
            LEFT - 3.0,
            cej + 3.0
        );
        let names = ["PD", "recession", "CAL", "bleeding", "PD, true", "bled"];
        let line = |k: usize| inner + up * k as f64 * LINE;
        for (k, name) in names[..self.lines()].iter().enumerate() {
            let _ = write!(
                svg,
                "<text x=\"{:.1}\" y=\"{:.1}\" font-size=\"9.5\" text-anchor=\"end\">{name}</text>",
                LEFT - 3.0,
                line(k)
            );
        }
        svg.push('\n');
        let (mut called, mut truth) = (Vec::new(), Vec::new());
        let mut x = LEFT;
        for fdi in teeth {
            let wide = self.width(*fdi);
            self.tooth(svg, *fdi, buccal, (x, cej, up));
            for (k, site) in across(*fdi, buccal).into_iter().enumerate() {
                let at = x + wide * (0.17 + 0.33 * k as f64);
                let Some(grade) = self.at(*fdi, site) else {
                    called.push(None);
                    truth.push(None);
                    continue;
                };
                numbers(svg, grade, at, line, self.truth);
                called.push(Some(Spot {
                    x: at,
                    recession: grade.recession_called_mm.map(f64::from),
                    depth: grade.called_mm.map(f64::from),
                }));
                truth.push(Some(Spot {
                    x: at,
                    recession: grade.recession_truth_mm,
                    depth: grade.truth_mm,
                }));
            }
            x += wide;
        }
        let y = |mm: f64| cej + up * MM * mm.clamp(-CROWN_MM, ROOT_MM - 0.4);
        lines(svg, &called, y, true);
        if self.truth {
            lines(svg, &truth, y, false);
        }
    }

    /// A tooth's outline, and its furcation.
    fn tooth(&self, svg: &mut String, fdi: u8, buccal: bool, (x, cej, up): (f64, f64, f64)) {
        let kind = ToothKind::of(fdi);
        let wide = self.width(fdi);
        let middle = x + 0.5 * wide;
        let missing = self.patient.missing.contains(&fdi);
        let asked = self.sites.iter().any(|site| site.tooth == fdi);
        let (stroke, fill) = match (self.teeth.contains(&fdi), asked) {
            (true, true) => ("#444", "#fbf7ec"),
            (true, false) => ("#a5a5a5", "#fbfbfb"),
            (false, _) => ("#d0d0d0", "none"),
        };
        let _ = write!(
            svg,
            "<path d=\"{}\" fill=\"{fill}\" stroke=\"{stroke}\" stroke-width=\"1\"/>",
            kind.path((middle, 0.5 * wide), cej, up, MM)
        );
        if missing {
            let (a, b) = (cej - up * 7.0 * MM, cej + up * 11.0 * MM);
            let (left, right) = (x + 5.0, x + wide - 5.0);
            let _ = write!(
                svg,
                "<path d=\"M{left:.1},{a:.1}L{right:.1},{b:.1}M{right:.1},{a:.1}L{left:.1},{b:.1}\" stroke=\"#555\" stroke-width=\"1.2\"/>"
            );
        }
        let at = (middle, cej + up * FURCATION_MM * MM);
        furcation(svg, self.furcation(fdi, buccal), at);
    }
}

/// Open, half and full circle for the grades 1 to 3; dotted where nobody `called` it.
fn furcation(svg: &mut String, (grade, called): (u8, bool), (x, y): (f64, f64)) {
    if grade == 0 {
        return;
    }
    let fill = if grade == 3 { "#111" } else { "#fff" };
    let dash = if called {
        ""
    } else {
        " stroke-dasharray=\"1.5 2\""
    };
    let _ = write!(
        svg,
        "<circle cx=\"{x:.1}\" cy=\"{y:.1}\" r=\"5\" fill=\"{fill}\" stroke=\"#111\" stroke-width=\"1.3\"{dash}/>"
    );
    if grade == 2 {
        let _ = write!(
            svg,
            "<path d=\"M{x:.1},{:.1}a5,5 0 0 1 0,10Z\" fill=\"#111\"/>",
            y - 5.0
        );
    }
}

/// The numbers of one site, from the teeth outwards.
fn numbers(svg: &mut String, grade: &SiteGrade, x: f64, line: impl Fn(usize) -> f64, truth: bool) {
    let mut text = |k: usize, what: &str, bold: bool| {
        let weight = if bold { " font-weight=\"700\"" } else { "" };
        let _ = write!(
            svg,
            "<text x=\"{x:.1}\" y=\"{:.1}\" font-size=\"11.5\" text-anchor=\"middle\"{weight}>{what}</text>",
            line(k)
        );
    };
    let depth = grade.called_mm.map(f64::from);
    let recession = grade.recession_called_mm;
    match depth {
        Some(mm) => text(0, &format!("{mm:.0}"), mm >= POCKET),
        None => text(0, "&#8211;", false),
    }
    if let Some(mm) = recession {
        text(1, &signed(mm), false);
    }
    if let (Some(depth), Some(recession)) = (depth, recession) {
        let loss = depth + f64::from(recession);
        text(
            2,
            &format!("{loss:.0}").replace('-', "&#8722;"),
            loss >= POCKET,
        );
    }
    if truth && let Some(mm) = grade.truth_mm {
        text(4, &format!("{mm}"), false);
    }
    let mut dot = |k: usize, bleeds: bool| {
        let (fill, r) = if bleeds { (RED, 3.6) } else { ("#fff", 2.6) };
        let stroke = if bleeds { "#5a0012" } else { "#777" };
        let _ = write!(
            svg,
            "<circle cx=\"{x:.1}\" cy=\"{:.1}\" r=\"{r}\" fill=\"{fill}\" stroke=\"{stroke}\"/>",
            line(k) - 4.0
        );
    };
    if let Some(bleeds) = grade.bleeding_called {
        dot(3, bleeds);
    }
    if truth {
        dot(5, grade.bled);
    }
}

fn signed(mm: i8) -> String {
    match mm {
        0 => "0".into(),
        mm if mm < 0 => format!("&#8722;{}", mm.unsigned_abs()),
        mm => format!("+{mm}"),
    }
}

/// Margin and attachment through neighbouring sites that are known, and the pocket between.
fn lines(svg: &mut String, spots: &[Option<Spot>], y: impl Fn(f64) -> f64, called: bool) {
    let known = |spot: &Option<Spot>| -> Option<(f64, f64, f64)> {
        let spot = (*spot)?;
        // Where recession was not called nobody has said where the margin is, nor the attachment below it.
        let margin = spot.recession?;
        Some((spot.x, y(margin), y(margin + spot.depth?)))
    };
    let all: Vec<Option<(f64, f64, f64)>> = spots.iter().map(known).collect();
    for run in all.split(Option::is_none) {
        let mut run: Vec<(f64, f64, f64)> = run.iter().flatten().copied().collect();
        // A single site has some width too.
        if let [only] = run[..] {
            run = vec![
                (only.0 - 6.0, only.1, only.2),
                (only.0 + 6.0, only.1, only.2),
            ];
        }
        if run.is_empty() {
            continue;
        }
        let through = |which: fn(&(f64, f64, f64)) -> f64| -> Vec<String> {
            run.iter()
                .map(|at| format!("{:.1},{:.1}", at.0, which(at)))
                .collect()
        };
        let (margin, floor) = (through(|at| at.1), through(|at| at.2));
        if called {
            let mut around = margin.clone();
            around.extend(floor.iter().rev().cloned());
            let _ = writeln!(
                svg,
                "<polygon points=\"{}\" fill=\"url(#pocket)\" fill-opacity=\"0.75\"/><polyline points=\"{}\" fill=\"none\" stroke=\"{RED}\" stroke-width=\"2.4\"/><polyline points=\"{}\" fill=\"none\" stroke=\"{BLUE}\" stroke-width=\"2.4\" stroke-dasharray=\"7 2.5\"/>",
                around.join(" "),
                margin.join(" "),
                floor.join(" ")
            );
        } else {
            let _ = writeln!(
                svg,
                "<polyline points=\"{}\" fill=\"none\" stroke=\"{RED}\" stroke-width=\"1.1\" stroke-dasharray=\"1.5 2.5\"/><polyline points=\"{}\" fill=\"none\" stroke=\"#000\" stroke-width=\"1.1\" stroke-dasharray=\"1.5 2.5\"/>",
                margin.join(" "),
                floor.join(" ")
            );
        }
    }
}

/// Which of the signs that need words a chart has.
struct Signs {
    truth: bool,
    /// A furcation, called or prescribed.
    furcation: bool,
    /// A zone of which no recession was called.
    no_margin: bool,
}

impl Signs {
    /// What the lines and signs mean, as HTML.
    fn key(&self, numbering: Numbering) -> String {
        let say = |is: bool, words: &'static str| if is { words } else { "" };
        let truth = say(
            self.truth,
            "; dotted: <b>prescribed</b> margin (red) and attachment (black); bled: in the replay",
        );
        let no_margin = say(
            self.no_margin,
            " No lines where recession was not called: nobody said where the margin is.",
        );
        let furcation = say(
            self.furcation,
            " Circle on a molar: furcation I open, II half, III full",
        );
        let uncalled = say(
            self.furcation && self.truth,
            ", dotted where it was not called",
        );
        let stop = say(self.furcation, ".");
        let line = |colour: &str, dash: &str| {
            format!(
                "<svg style=\"display:inline;width:26px;height:9px;vertical-align:middle\" viewBox=\"0 0 26 9\"><line x1=\"0\" y1=\"4.5\" x2=\"26\" y2=\"4.5\" stroke=\"{colour}\" stroke-width=\"2.4\"{dash}/></svg>"
            )
        };
        format!(
            "<p class=\"small\">{} margin (red, unbroken) {} attachment (blue, broken), pocket hatched between{truth}.{no_margin} PD probing depth as called, mm, bold from 4; recession + below, &#8722; above the cemento-enamel junction (CEJ); CAL = PD + recession. Full dot: bleeding called; ring: none.{furcation}{uncalled}{stop} {}; the patient&#8217;s right is on the left.</p>\n",
            line(RED, ""),
            line(BLUE, " stroke-dasharray=\"7 2.5\""),
            numbering.name()
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::grade::sites::Finding;
    use sulcus_core::tissue::gingiva::Site;

    fn site(tooth: u8, site: Site, called: u8, recession: i8) -> SiteGrade {
        SiteGrade {
            tooth,
            site,
            asked: true,
            probed: true,
            truth_mm: Some(f64::from(called)),
            measured_mm: None,
            called_mm: Some(called),
            deepest_mm: None,
            shown_mm: None,
            max_force_n: None,
            held_s: None,
            pressed_s: None,
            tilt_deg: None,
            into_col_deg: None,
            tilt_right: None,
            recession_truth_mm: Some(f64::from(recession)),
            recession_called_mm: Some(recession),
            bled: true,
            bleeding_called: Some(true),
            furcation_truth: None,
            furcation_called: None,
            finding: Finding::Right,
        }
    }

    #[test]
    fn the_attachment_lies_the_depth_below_the_margin_and_numbers_add_up() {
        // 5 + 3 = 8, 5 - 3 = 2 (the textbook's two examples).
        let sites = [
            site(36, Site::MesioBuccal, 5, 3),
            site(36, Site::Buccal, 5, -3),
        ];
        let chart = Chart {
            sites: &sites,
            teeth: &[36],
            patient: &PatientChart::default(),
            numbering: Numbering::Universal,
            truth: false,
        };
        let svg = chart.svg();
        for number in [
            ">5</text>",
            ">+3</text>",
            ">8</text>",
            ">&#8722;3</text>",
            ">2</text>",
            ">19</text>",
        ] {
            assert!(svg.contains(number), "{number}");
        }
        // The lower jaw's buccal row is the lower one, roots down: margin and attachment in the picture's own units.
        let margin_line = svg
            .split(&format!("stroke=\"{RED}\" stroke-width=\"2.4\""))
            .next()
            .unwrap_or("");
        let points = margin_line.rsplit("points=\"").next().unwrap_or("");
        let y: Vec<f64> = points
            .split(['"', ' '])
            .take(2)
            .filter_map(|point| point.split_once(',')?.1.parse().ok())
            .collect();
        assert!((y[0] - y[1] - 6.0 * MM).abs() < 0.11, "{y:?} {points}");
        assert!(!svg.contains("upper jaw"));
    }

    #[test]
    fn no_line_is_drawn_where_nobody_said_where_the_margin_is() {
        let mut unsaid = site(36, Site::Buccal, 5, 0);
        unsaid.recession_called_mm = None;
        let svg = |sites: &[SiteGrade], truth: bool| {
            let chart = Chart {
                sites,
                teeth: &[36],
                patient: &PatientChart::default(),
                numbering: Numbering::Fdi,
                truth,
            };
            chart.svg()
        };
        let (red, blue) = (
            format!("stroke=\"{RED}\" stroke-width=\"2.4\""),
            format!("stroke=\"{BLUE}\" stroke-width=\"2.4\""),
        );
        let alone = svg(std::slice::from_ref(&unsaid), false);
        assert!(alone.contains(">5</text>"));
        assert!(!alone.contains(&red) && !alone.contains(&blue));
        // Between two that are known it parts them.
        let three = [
            site(36, Site::MesioBuccal, 3, -2),
            unsaid,
            site(36, Site::DistoBuccal, 3, -2),
        ];
        let parted = svg(&three, false);
        assert_eq!(parted.matches(&blue).count(), 2);
        // The blue line is the depth below the red one.
        let y = |svg: &str, colour: &str| -> f64 {
            let line = svg.split(colour).next().unwrap_or("");
            let points = line.rsplit("points=\"").next().unwrap_or("");
            let first = points.split(['"', ' ']).next().unwrap_or("");
            first
                .split_once(',')
                .and_then(|(_, y)| y.parse().ok())
                .unwrap_or(f64::NAN)
        };
        assert!((y(&parted, &blue) - y(&parted, &red) - 3.0 * MM).abs() < 0.11);
        // What is prescribed is drawn all the same, when it is asked for.
        assert!(svg(&three, true).contains("stroke=\"#000\" stroke-width=\"1.1\""));
    }

    #[test]
    fn the_key_says_what_is_drawn_and_no_more() {
        let mut sites = [site(36, Site::Buccal, 5, -2)];
        let patient = PatientChart::read("[[tooth]]\nfdi = 36\nfurcation.buccal = 2\n");
        let says = |sites: &[SiteGrade], truth: bool| {
            let chart = Chart {
                sites,
                teeth: &[35, 36],
                patient: &patient,
                numbering: Numbering::Fdi,
                truth,
            };
            let html = chart.html();
            let words = ["furcation", "dotted where", "prescribed", "nobody said"];
            let found = words.map(|word| html.contains(word));
            // Whatever the key says, the picture shows.
            assert_eq!(html.contains(" r=\"5\""), found[0]);
            found
        };
        assert_eq!(says(&sites, false), [false; 4]);
        assert_eq!(says(&sites, true), [true, true, true, false]);
        sites[0].furcation_called = Some(1);
        sites[0].recession_called_mm = None;
        assert_eq!(says(&sites, false), [true, false, false, true]);
    }

    #[test]
    fn grades_of_furcation_have_signs_of_their_own() {
        let sign = |grade| {
            let mut svg = String::new();
            furcation(&mut svg, (grade, true), (0.0, 0.0));
            svg
        };
        assert_eq!(sign(0), "");
        assert!(sign(1).contains("#fff") && !sign(1).contains("path"));
        assert!(sign(2).contains("path"));
        assert!(sign(3).contains("fill=\"#111\"") && !sign(3).contains("path"));
    }
}

//! Plots as SVG: lines and points over one pair of axes, linear or logarithmic.

use std::fmt;

use askama::filters::HtmlSafe;
use plotters::coord::combinators::{IntoLogRange, LogCoord};
use plotters::coord::ranged1d::{AsRangedCoord, Ranged, ValueFormatter};
use plotters::prelude::*;

/// A plot as SVG. Only [`Plot::svg`] makes one, and `plotters` escapes every text of it: a template inserts it as it is.
pub(crate) struct Svg(String);

impl Svg {
    /// Whether there was nothing to draw.
    pub(crate) fn is_empty(&self) -> bool {
        self.0.is_empty()
    }
}

impl fmt::Display for Svg {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.0)
    }
}

impl HtmlSafe for Svg {}

/// One line.
pub(crate) struct Series {
    pub(crate) name: String,
    pub(crate) points: Vec<(f64, f64)>,
    /// Whether its points are joined.
    pub(crate) joined: bool,
}

impl Series {
    /// A line of points that are joined.
    pub(crate) fn joined(name: impl Into<String>, points: Vec<(f64, f64)>) -> Self {
        Self {
            name: name.into(),
            points,
            joined: true,
        }
    }
}

/// One plot.
pub(crate) struct Plot {
    /// What the axes have, with units.
    pub(crate) x: String,
    pub(crate) y: String,
    pub(crate) log: (bool, bool),
    pub(crate) series: Vec<Series>,
    /// A level that is not to be passed, and what it is.
    pub(crate) limit: Option<(f64, String)>,
}

const SIZE: (u32, u32) = (640, 360);
/// What a line of the legend takes, and where its two columns begin.
const LEGEND: (u32, [i32; 2]) = (20, [66, 356]);
const RED: RGBColor = RGBColor(0xb0, 0x1e, 0x1e);
const COLOURS: [RGBColor; 8] = [
    RGBColor(0x1c, 0x5e, 0xa8),
    RGBColor(0xc7, 0x61, 0x07),
    RGBColor(0x2b, 0x8a, 0x3e),
    RGBColor(0x9b, 0x2f, 0x8f),
    RGBColor(0x5f, 0x6b, 0x77),
    RGBColor(0x8c, 0x6d, 0x1f),
    RGBColor(0x0b, 0x7a, 0x75),
    RGBColor(0xd6, 0x5d, 0x9b),
];

impl Plot {
    /// The plot, or nothing where there is no finite point.
    pub(crate) fn svg(&self) -> Svg {
        let of = |value: fn(&(f64, f64)) -> f64, log: bool| {
            let points = self.series.iter().flat_map(|series| &series.points);
            let usable = points
                .map(value)
                .filter(|v| v.is_finite() && (!log || *v > 0.0));
            usable.fold(None, |range: Option<(f64, f64)>, v| {
                let (low, high) = range.unwrap_or((v, v));
                Some((low.min(v), high.max(v)))
            })
        };
        let (Some(x), Some(mut y)) = (of(|p| p.0, self.log.0), of(|p| p.1, self.log.1)) else {
            return Svg(String::new());
        };
        if let Some((limit, _)) = &self.limit {
            y = (y.0.min(*limit), y.1.max(*limit));
        }
        // Within less than a decade a logarithmic axis has hardly a number on it.
        let wide = |(low, high): (f64, f64), log: bool| log && high > 8.0 * low;
        let log_of = (wide(x, self.log.0), wide(y, self.log.1));
        let (x, y) = (widened(x, log_of.0), widened(y, log_of.1));
        let mut svg = String::new();
        let drawn = match log_of {
            (true, true) => self.draw(&mut svg, log(x), log(y), log_of),
            (true, false) => self.draw(&mut svg, log(x), linear(y), log_of),
            (false, true) => self.draw(&mut svg, linear(x), log(y), log_of),
            (false, false) => self.draw(&mut svg, linear(x), linear(y), log_of),
        };
        // Writing into a string does not fail; a plot that cannot be drawn is left out.
        Svg(drawn.map_or(String::new(), |()| svg))
    }

    /// What the legend has: names, colours, widths of lines. A line alone is named by its axis.
    fn names(&self) -> Vec<(&str, RGBColor, u32)> {
        if self.series.len() < 2 && self.limit.is_none() {
            return Vec::new();
        }
        let lines = self.series.iter().zip(COLOURS.iter().cycle());
        let lines = lines.map(|(series, colour)| (series.name.as_str(), *colour, 3));
        let limit = self.limit.iter().map(|(_, name)| (name.as_str(), RED, 1));
        lines.chain(limit).collect()
    }

    fn draw<X, Y>(
        &self,
        svg: &mut String,
        x: X,
        y: Y,
        log_of: (bool, bool),
    ) -> Result<(), Box<dyn std::error::Error>>
    where
        X: AsRangedCoord<Value = f64>,
        Y: AsRangedCoord<Value = f64>,
        X::CoordDescType: Ranged<ValueType = f64> + ValueFormatter<f64>,
        Y::CoordDescType: Ranged<ValueType = f64> + ValueFormatter<f64>,
    {
        let names = self.names();
        // Below the axes, where no point can be behind it.
        let rows = names.len().div_ceil(LEGEND.1.len()) as u32;
        let size = (SIZE.0, SIZE.1 + LEGEND.0 * rows);
        let root = SVGBackend::with_string(svg, size).into_drawing_area();
        root.fill(&WHITE)?;
        let (root, below) = root.split_vertically(SIZE.1);
        for (k, (name, colour, width)) in names.into_iter().enumerate() {
            let (x, y) = (LEGEND.1[k % LEGEND.1.len()], (k / LEGEND.1.len()) as i32);
            let y = y * LEGEND.0 as i32 + 8;
            let line = vec![(x, y), (x + 18, y)];
            below.draw(&PathElement::new(line, colour.stroke_width(width)))?;
            let text = ("sans-serif", 13).into_font();
            below.draw(&Text::new(name.to_owned(), (x + 24, y - 6), text))?;
        }
        let mut chart = ChartBuilder::on(&root)
            .margin(12)
            .x_label_area_size(44)
            .y_label_area_size(66)
            .build_cartesian_2d(x, y)?;
        chart
            .configure_mesh()
            .x_desc(self.x.as_str())
            .y_desc(self.y.as_str())
            .light_line_style(RGBColor(0xee, 0xf0, 0xf2))
            .bold_line_style(RGBColor(0xd9, 0xdc, 0xe0))
            .label_style(("sans-serif", 13))
            .axis_desc_style(("sans-serif", 14))
            .x_label_formatter(&|v| label(*v, log_of.0))
            .y_label_formatter(&|v| label(*v, log_of.1))
            .draw()?;
        for (k, series) in self.series.iter().enumerate() {
            let colour = COLOURS[k % COLOURS.len()];
            let points = || {
                let finite = |p: &&(f64, f64)| {
                    p.0.is_finite()
                        && p.1.is_finite()
                        && (!self.log.0 || p.0 > 0.0)
                        && (!self.log.1 || p.1 > 0.0)
                };
                series.points.iter().filter(finite).copied()
            };
            if series.joined {
                let path = PathElement::new(points().collect::<Vec<_>>(), colour.stroke_width(2));
                chart.draw_series([path])?;
            }
            // A curve of hundreds of points needs no dots.
            if series.points.len() <= 40 {
                chart.draw_series(points().map(|p| Circle::new(p, 4, colour.filled())))?;
            }
        }
        if let Some((limit, _)) = &self.limit {
            let range = chart.x_range();
            let line = vec![(range.start, *limit), (range.end, *limit)];
            chart.draw_series([PathElement::new(line, RED.stroke_width(1))])?;
        }
        root.present()?;
        Ok(())
    }
}

fn linear((low, high): (f64, f64)) -> std::ops::Range<f64> {
    low..high
}

fn log((low, high): (f64, f64)) -> LogCoord<f64> {
    // (Named, so that both kinds of axis can be told apart by type.)
    let range = (low..high).log_scale();
    range.into()
}

/// A little room at both ends; never empty.
fn widened((low, high): (f64, f64), log: bool) -> (f64, f64) {
    if log {
        return (low / 1.3, high * 1.6);
    }
    // (Round a value that stands alone there is room enough for numbers that differ.)
    let least = if high > low { 1e-9 } else { 0.2 };
    let room = (0.1 * (high - low)).max(least * high.abs()).max(1e-12);
    // What is counted from nothing is shown from nothing.
    let low = if low >= 0.0 && low < 0.5 * high {
        0.0
    } else {
        low - room
    };
    (low, high + room)
}

/// A number beside an axis; on a logarithmic one only those that have room beside each other.
fn label(x: f64, log: bool) -> String {
    let text = plain(x);
    let digit = text.chars().find(|c| ('1'..='9').contains(c));
    match digit {
        Some('4' | '6'..='9') if log => String::new(),
        _ => text,
    }
}

/// A number as people write it on an axis.
fn plain(x: f64) -> String {
    let size = x.abs();
    if size != 0.0 && !(1e-3..1e5).contains(&size) {
        return format!("{x:.0e}");
    }
    let text = format!("{x:.4}");
    let text = text.trim_end_matches('0').trim_end_matches('.');
    text.to_owned()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_logarithmic_axis_has_room_for_its_numbers() {
        let shown = |log| [0.5, 1.0, 300.0, 600.0, 900.0, 1e-4].map(|x| label(x, log));
        assert_eq!(shown(true), ["0.5", "1", "300", "", "", "1e-4"]);
        assert_eq!(shown(false), ["0.5", "1", "300", "600", "900", "1e-4"]);
    }

    #[test]
    fn the_legend_is_below_the_axes_and_takes_no_point() {
        let mut many = plot(vec![(1.0, 2.0), (30.0, 4.0)], (true, true));
        let height = |svg: &str| {
            let at = svg.split("height=\"").nth(1).expect("a size");
            at.split('"').next().expect("an end").parse::<u32>()
        };
        assert_eq!(height(&many.svg().0), Ok(SIZE.1 + LEGEND.0));
        for k in 0..6 {
            many.series
                .push(Series::joined(format!("line {k}"), vec![(2.0, 3.0)]));
        }
        let svg = many.svg().0;
        assert_eq!(height(&svg), Ok(SIZE.1 + 4 * LEGEND.0));
        // Every name is below the lowest label of the axes.
        for name in ["ours", "line 5", "not above"] {
            let at = svg.find(name).expect("named");
            let before = &svg[..at];
            let y = before.rsplit(" y=\"").next().expect("a place");
            let y: u32 = y
                .split('"')
                .next()
                .expect("an end")
                .parse()
                .expect("a number");
            assert!(y >= SIZE.1 - 10, "{name} at {y}");
        }
        many.series.truncate(1);
        many.limit = None;
        assert_eq!(height(&many.svg().0), Ok(SIZE.1));
    }

    fn plot(points: Vec<(f64, f64)>, log: (bool, bool)) -> Plot {
        Plot {
            x: "time, us".into(),
            y: "error, um".into(),
            log,
            series: vec![Series::joined("ours", points)],
            limit: Some((10.0, "not above".into())),
        }
    }

    #[test]
    fn a_plot_has_its_axes_and_its_points() {
        for log in [(false, false), (true, false), (false, true), (true, true)] {
            let svg = plot(vec![(1.0, 2.0), (30.0, 4.0)], log).svg().0;
            assert!(
                svg.starts_with("<svg") && svg.trim_end().ends_with("</svg>"),
                "{svg}"
            );
            for text in ["time, us", "error, um", "ours", "not above"] {
                assert!(svg.contains(text), "{text}");
            }
            assert_eq!(svg.matches("<circle").count(), 2);
        }
    }

    #[test]
    fn numbers_beside_an_axis_differ_when_all_points_have_one_value() {
        let svg = plot(vec![(231.068, 2.0)], (true, true)).svg().0;
        assert!(svg.matches("231.068").count() <= 1, "{svg}");
        assert!(svg.contains("200") && svg.contains("250"), "{svg}");
    }

    #[test]
    fn what_cannot_be_drawn_is_left_out() {
        assert_eq!(plot(vec![], (false, false)).svg().0, "");
        let svg = plot(vec![(0.0, 1.0), (1.0, f64::NAN), (2.0, 3.0)], (true, true))
            .svg()
            .0;
        assert_eq!(svg.matches("<circle").count(), 1);
    }

    #[test]
    fn every_text_of_a_plot_is_escaped() {
        let named = |text: &str| {
            let mut plot = plot(vec![(1.0, 2.0)], (false, false));
            plot.x = text.to_owned();
            plot.y = text.to_owned();
            plot.series[0].name = text.to_owned();
            plot.limit = Some((10.0, text.to_owned()));
            plot.svg().0
        };
        let svg = named("<b> & \"c\"");
        assert!(!svg.contains("<b>") && !svg.contains("& "), "{svg}");
        assert_eq!(svg.matches("&lt;b&gt; &amp; ").count(), 4, "{svg}");
    }
}

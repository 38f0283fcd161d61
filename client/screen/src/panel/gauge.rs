//! Gauge of a force: numbers, rating, bar against the exercise's zone, trace of the last values.

use super::canvas::{Area, Canvas};
use super::colour::{GREEN, GREY, Rgba, SKY_BLUE, TROUGH, VERMILLION, WHITE};
use super::mark::Mark;
use super::state::{Rating, ToolForce};
use super::trace::VALUES;
use super::words;
use crate::strings::Strings;
use crate::text::Weight;

/// Full scale of a gauge, as a multiple of the greatest force of the zone.
const SCALE: f64 = 2.5;
/// Full scale of a gauge without a zone, newtons. Chosen: the forces that a mirror holds a tongue with.
const FREE_SCALE_N: f64 = 2.0;

/// Shape, colour and number of the word of a rating.
fn sign(rating: Rating) -> (Mark, Rgba, usize) {
    match rating {
        Rating::NoContact => (Mark::Hollow, GREY, 0),
        Rating::Light => (Mark::Down, SKY_BLUE, 1),
        Rating::Right => (Mark::Full, GREEN, 2),
        Rating::Heavy => (Mark::Up, VERMILLION, 3),
    }
}

/// Adds the gauge of a tool off the top of `rows`: two rows and a bar, then two rows of trace for a tool with a zone.
/// Parts without room are left out.
pub fn gauge(canvas: &mut Canvas, rows: &mut Area, tool: &ToolForce, strings: &Strings) {
    // A name without its number would say nothing.
    if rows.height() < 2.0 * canvas.metrics.row {
        return;
    }
    canvas.line(rows, &tool.name, Weight::Regular, GREY);
    let rating = tool.rating();
    if let Some(mut row) = rows.cut_top(canvas.metrics.row) {
        if let Some(rating) = rating {
            rated(canvas, &mut row, rating, strings);
        }
        let force = words::force(tool.force_n, strings);
        canvas.text(row, &force, Weight::Bold, WHITE);
    }
    let scale_n = tool.zone_n.map_or(FREE_SCALE_N, |[_, high]| SCALE * high);
    // In this form a NaN counts as an empty gauge.
    let share = |n: f64| {
        if n > 0.0 && scale_n > 0.0 {
            (n / scale_n).min(1.0) as f32
        } else {
            0.0
        }
    };
    let size = canvas.metrics.size;
    if let Some(bar) = rows.cut_top(0.5 * size.height()) {
        let fill = rating.map_or(GREY, |rating| sign(rating).1);
        canvas.rect(bar, TROUGH);
        let x = |n: f64| bar.min[0] + (bar.width() * share(n)).floor();
        let end = [x(tool.force_n), bar.max[1]];
        canvas.rect(Area { max: end, ..bar }, fill);
        // Both ends of the zone as upright lines, above the fill.
        for end in tool.zone_n.into_iter().flatten() {
            let width = (0.12 * size.height()).floor().max(1.0);
            let left = x(end).min(bar.max[0] - width);
            let line = Area {
                min: [left.max(bar.min[0]), bar.min[1]],
                max: [(left + width).min(bar.max[0]), bar.max[1]],
            };
            canvas.rect(line, WHITE);
        }
    }
    let gap = (0.25 * size.height()).floor();
    rows.cut_top(gap);
    let Some(zone) = tool.zone_n else {
        return;
    };
    if let Some(graph) = rows.cut_top(1.5 * canvas.metrics.row) {
        trace(canvas, graph, tool, zone.map(share), share);
        rows.cut_top(gap);
    }
}

/// Adds shape and word of a rating off the right of a row.
fn rated(canvas: &mut Canvas, row: &mut Area, rating: Rating, strings: &Strings) {
    let (mark, colour, word) = sign(rating);
    let (word, size) = (strings.ratings[word], canvas.metrics.size);
    let side = (0.6 * size.height()).floor();
    let width = size.measure(word)[0];
    if let Some(place) = row.cut_right(width) {
        canvas.text(place, word, Weight::Bold, WHITE);
    }
    row.cut_right(0.5 * size.advance());
    if let Some(place) = row.cut_right(side) {
        let above = (0.5 * (place.height() - side)).floor();
        let min = [place.min[0], place.min[1] + above];
        let square = Area {
            min,
            max: [min[0] + side, min[1] + side],
        };
        mark.draw(canvas, square, colour);
    }
    row.cut_right(size.advance());
}

/// Adds the trace: the zone as a band, and a bar of one pixel's height or more for each value, newest at the right.
fn trace(
    canvas: &mut Canvas,
    graph: Area,
    tool: &ToolForce,
    zone: [f32; 2],
    share: impl Fn(f64) -> f32,
) {
    canvas.rect(graph, TROUGH);
    let y = |share: f32| graph.max[1] - graph.height() * share;
    let band = Area {
        min: [graph.min[0], y(zone[1])],
        max: [graph.max[0], y(zone[0])],
    };
    canvas.rect(band, [GREEN[0], GREEN[1], GREEN[2], 120]);
    let step = graph.width() / VALUES as f32;
    let thick = (0.1 * canvas.metrics.size.height()).max(1.0);
    let count = tool.trace.values().len();
    for (k, value) in tool.trace.values().enumerate() {
        let left = graph.max[0] - step * (count - k) as f32;
        let top = y(share(f64::from(value)))
            .min(graph.max[1] - thick)
            .max(graph.min[1]);
        let dot = Area {
            min: [left.max(graph.min[0]), top],
            max: [(left + step).min(graph.max[0]), top + thick],
        };
        canvas.rect(dot, WHITE);
    }
}

#[cfg(test)]
mod tests {
    use super::super::canvas::Metrics;
    use super::super::primitive::Primitive;
    use super::*;
    use crate::strings::ENGLISH;

    fn drawn(force_n: f64) -> Vec<Primitive> {
        let metrics = Metrics::of([1280, 720], 1.0);
        let mut canvas = Canvas {
            list: vec![],
            metrics,
        };
        let zone_n = Some([0.2, 0.25]);
        let mut tool = ToolForce {
            force_n,
            zone_n,
            ..ToolForce::default()
        };
        tool.trace.push(0.1);
        let mut rows = Area {
            min: [0.0, 0.0],
            max: [300.0, 300.0],
        };
        gauge(&mut canvas, &mut rows, &tool, &ENGLISH);
        canvas.list
    }

    /// Right end of the widest rectangle of a colour.
    fn end(list: &[Primitive], colour: Rgba) -> Option<f32> {
        let of = |one: &Primitive| match one {
            Primitive::Rect { min, max, rgba } if *rgba == colour && min[0] == 0.0 => Some(max[0]),
            _ => None,
        };
        list.iter().filter_map(of).reduce(f32::max)
    }

    #[test]
    fn the_bar_grows_with_the_force_and_stops_at_its_end() {
        // Full scale is 0.625 N.
        assert_eq!(end(&drawn(0.125), SKY_BLUE), Some(60.0));
        assert_eq!(end(&drawn(0.25), GREEN), Some(120.0));
        assert_eq!(end(&drawn(0.5), VERMILLION), Some(240.0));
        assert_eq!(end(&drawn(f64::INFINITY), VERMILLION), Some(300.0));
        assert_eq!(end(&drawn(f64::NAN), GREY), None);
    }

    #[test]
    fn a_rating_has_a_word_and_a_shape_of_its_own() {
        let told = |force_n| {
            let list = drawn(force_n);
            let texts = list.iter().filter_map(|one| match one {
                Primitive::Glyphs { text, .. } => Some(text.clone()),
                Primitive::Rect { .. } => None,
            });
            (texts.collect::<Vec<_>>().join("|"), list.len())
        };
        assert_eq!(told(0.1).0, "light|0.10 N 10 g");
        assert_eq!(told(0.22).0, "right|0.22 N 22 g");
        assert_eq!(told(0.3).0, "heavy|0.30 N 31 g");
        assert_eq!(told(0.0).0, "no contact|0.00 N 0 g");
        let marks = [
            Rating::NoContact,
            Rating::Light,
            Rating::Right,
            Rating::Heavy,
        ]
        .map(|rating| sign(rating).0);
        assert_eq!(marks, [Mark::Hollow, Mark::Down, Mark::Full, Mark::Up]);
    }
}

//! Panel of practice: a column at the right of the picture.

use super::canvas::{Area, Canvas, Metrics};
use super::colour::{GREY, GROUND, WHITE, YELLOW};
use super::gauge::gauge;
use super::next::Next;
use super::state::{Clock, Help, PanelState, Tour};
use super::{status, words};
use crate::strings::{Strings, fill};
use crate::text::Weight;

/// Least width of the column, characters.
const COLUMNS: f32 = 30.0;
/// Width of the column in a large window, and largest share of a small one.
const SHARES: [f32; 2] = [0.22, 0.4];
/// Largest number of rows of the next step, and of the task.
const ROWS: [usize; 2] = [4, 6];

/// Cuts the column off the right of an area and fills it. Returns the room for its rows; `None` without room.
pub fn column(canvas: &mut Canvas, area: &mut Area) -> Option<Area> {
    let metrics = canvas.metrics;
    let column = area.cut_right(column_width(&metrics, area.width()))?;
    canvas.rect(column, GROUND);
    Some(column.inset(metrics.pad))
}

/// Width of the column in an area of `width`, pixels.
fn column_width(metrics: &Metrics, width: f32) -> f32 {
    let [share, most] = SHARES.map(|share| share * width);
    let wanted = COLUMNS * metrics.size.advance() + 2.0 * metrics.pad;
    wanted.max(share).min(most)
}

/// Adds the panel of practice, and returns the area that is left for the picture.
pub fn practice(
    canvas: &mut Canvas,
    mut area: Area,
    state: &PanelState,
    strings: &Strings,
) -> Area {
    let items = status::items(&state.status, state.help.detail, strings);
    status::strip(canvas, &mut area, &items, false);
    if let Some(mut rows) = column(canvas, &mut area) {
        head(
            canvas,
            &mut rows,
            &state.clock,
            state.tour.as_ref(),
            &state.help,
            strings,
        );
        // The tool that is to be watched comes first. In a small window the other one has no room.
        let (rated, others): (Vec<_>, Vec<_>) = state
            .help
            .tools
            .iter()
            .partition(|tool| tool.zone_n.is_some());
        for tool in rated {
            gauge(canvas, &mut rows, tool, strings);
        }
        steps(canvas, &mut rows, state, strings);
        for tool in others {
            gauge(canvas, &mut rows, tool, strings);
        }
        foot(canvas, &mut rows, state, strings);
    }
    area
}

/// Adds title, time, site and depth.
fn head(
    canvas: &mut Canvas,
    rows: &mut Area,
    clock: &Clock,
    tour: Option<&Tour>,
    help: &Help,
    strings: &Strings,
) {
    if !help.title.is_empty() {
        canvas.line(rows, &help.title, Weight::Regular, GREY);
    }
    let time = words::clock(clock, strings);
    let progress = tour.filter(|tour| tour.stop.is_some()).map(|tour| {
        let (number, count) = ((tour.number + 1).to_string(), tour.count.to_string());
        fill(strings.progress, &[&number, &count])
    });
    pair(canvas, rows, &time, &progress.unwrap_or_default());
    if let Some(tour) = tour {
        canvas.line(rows, &words::present(tour, strings), Weight::Bold, WHITE);
    }
    let depth = match help.depth_mm {
        Some(mm) => fill(strings.depth, &[&words::decimal(mm, 1, strings)]),
        None => strings.no_depth.into(),
    };
    canvas.line(rows, &depth, Weight::Bold, WHITE);
}

/// Adds two texts in one row, at its left and its right, or in two rows if one is too short for both.
fn pair(canvas: &mut Canvas, rows: &mut Area, left: &str, right: &str) {
    let size = canvas.metrics.size;
    let [left_width, right_width] = [left, right].map(|text| size.measure(text)[0]);
    let fits = left_width + 2.0 * size.advance() + right_width <= rows.width();
    let Some(mut row) = rows.cut_top(canvas.metrics.row) else {
        return;
    };
    if let Some(place) = row.cut_right(right_width).filter(|_| fits) {
        canvas.text(place, right, Weight::Regular, GREY);
        canvas.text(row, left, Weight::Regular, WHITE);
        return;
    }
    row.max[0] = rows.max[0];
    canvas.text(row, left, Weight::Regular, WHITE);
    canvas.line(rows, right, Weight::Regular, GREY);
}

/// Adds next step, findings of the site, and the reason against the last key.
fn steps(canvas: &mut Canvas, rows: &mut Area, state: &PanelState, strings: &Strings) {
    let (tour, [most, _]) = (state.tour.as_ref(), ROWS);
    let next = Next::of(tour, &state.help, &state.status);
    if let Some(next) = next {
        canvas.paragraph(rows, &next.sentence(strings), most, Weight::Bold, WHITE);
    }
    if let Some(tour) = tour {
        canvas.paragraph(
            rows,
            &words::entered(tour, strings),
            2,
            Weight::Regular,
            YELLOW,
        );
        if let Some(wrong) = tour.wrong {
            canvas.paragraph(rows, words::wrong(wrong, strings), 2, Weight::Regular, GREY);
        }
    }
    rows.cut_top(canvas.metrics.pad);
}

/// Adds the task, and the confirmed findings, newest first.
fn foot(canvas: &mut Canvas, rows: &mut Area, state: &PanelState, strings: &Strings) {
    if !state.help.task.is_empty() {
        canvas.paragraph(rows, &state.help.task, ROWS[1], Weight::Regular, GREY);
        rows.cut_top(canvas.metrics.pad);
    }
    let entries = state.tour.iter().flat_map(|tour| tour.entries.iter().rev());
    for entry in entries {
        canvas.paragraph(
            rows,
            &words::entry(entry, strings),
            2,
            Weight::Regular,
            WHITE,
        );
    }
}

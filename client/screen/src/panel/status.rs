//! Parts of the panel that practice and exam share: status at the bottom, banner of a pause, warnings.

use super::canvas::{Area, Canvas};
use super::colour::{BLACK, GREEN, GROUND, ORANGE, Rgba, SKY_BLUE, VERMILLION, WHITE, YELLOW};
use super::mark::Mark;
use super::state::{Detail, Link, Recording, Status, Warning};
use super::words::decimal;
use crate::strings::{Strings, fill};
use crate::text::{Weight, wrap};

/// Largest number of warnings on the screen.
const MOST_WARNINGS: usize = 3;
/// Largest number of rows of an instructor's message.
const MESSAGE_ROWS: usize = 4;

/// Text with a shape before it, in a flow of rows.
#[derive(Clone, Debug, PartialEq)]
pub struct Item {
    /// Shape and its colour.
    pub mark: Option<(Mark, Rgba)>,
    /// Text.
    pub text: String,
    /// Weight of the text.
    pub weight: Weight,
}

impl Item {
    /// Text without a shape.
    pub fn plain(text: String, weight: Weight) -> Self {
        let mark = None;
        Self { mark, text, weight }
    }
}

/// Items of the status: link, recording, pause, limit, and a reduced detail of the picture.
pub fn items(status: &Status, detail: Detail, strings: &Strings) -> Vec<Item> {
    let words = &strings.status;
    let item = |mark, text: String| Item {
        mark: Some(mark),
        text,
        weight: Weight::Regular,
    };
    let link = match status.link {
        Link::Up(Some(ms)) => item((Mark::Full, GREEN), fill(words.link, &[&ms.to_string()])),
        Link::Up(None) => item((Mark::Full, GREEN), words.link_up.into()),
        Link::Returning => item((Mark::Hollow, YELLOW), words.link_returning.into()),
        Link::Lost => item((Mark::Cross, VERMILLION), words.link_lost.into()),
    };
    let recording = match status.recording {
        Recording::On => item((Mark::Full, VERMILLION), words.recording.into()),
        Recording::Off => item((Mark::Hollow, WHITE), words.not_recorded.into()),
        Recording::Failed => item((Mark::Cross, VERMILLION), words.recording_failed.into()),
    };
    let pause = if status.is_paused() {
        item((Mark::Bars, YELLOW), words.paused.into())
    } else {
        item((Mark::Full, SKY_BLUE), words.running.into())
    };
    let limit = match status.force_limit_n {
        Some(newtons) => fill(words.limit, &[&decimal(newtons, 2, strings)]),
        None => words.limit_of_scene.into(),
    };
    let mut items = vec![link, recording, pause, Item::plain(limit, Weight::Regular)];
    items.extend(status.person.map(|person| {
        let hand = words.hands[person.hand as usize];
        let rest = words.rests[person.rest as usize];
        Item::plain(fill(words.person, &[hand, rest]), Weight::Regular)
    }));
    let [plain, low, lowest] = words.detail;
    let detail = match detail {
        Detail::Full => None,
        Detail::Plain => Some(plain),
        Detail::Low => Some(low),
        Detail::Lowest => Some(lowest),
    };
    items.extend(detail.map(|text| Item::plain(text.into(), Weight::Regular)));
    items
}

/// Numbers of the items in each row of `width` pixels.
fn rows(canvas: &Canvas, items: &[Item], width: f32) -> Vec<Vec<usize>> {
    let mut rows: Vec<Vec<usize>> = Vec::new();
    let mut left = 0.0;
    for (k, item) in items.iter().enumerate() {
        let needed = item_width(canvas, item);
        match rows.last_mut() {
            Some(row) if left + needed <= width => row.push(k),
            _ => {
                rows.push(vec![k]);
                left = 0.0;
            }
        }
        left += needed + 2.0 * canvas.metrics.size.advance();
    }
    rows
}

fn item_width(canvas: &Canvas, item: &Item) -> f32 {
    let size = canvas.metrics.size;
    let mark = item
        .mark
        .map_or(0.0, |_| mark_side(canvas) + size.advance());
    mark + size.measure(&item.text)[0]
}

fn mark_side(canvas: &Canvas) -> f32 {
    (0.6 * canvas.metrics.size.height()).floor()
}

/// Adds items in rows over the whole width, off the bottom of `area` or off its top. Rows without room are left out.
pub fn strip(canvas: &mut Canvas, area: &mut Area, items: &[Item], at_top: bool) {
    let pad = canvas.metrics.pad;
    let rows = rows(canvas, items, area.width() - 2.0 * pad);
    let (row_height, margin) = (canvas.metrics.row, (0.5 * pad).floor());
    let room = ((area.height() - 2.0 * margin) / row_height)
        .floor()
        .max(0.0);
    let count = rows.len().min(room as usize);
    let height = row_height * count as f32 + 2.0 * margin;
    let cut = if at_top {
        area.cut_top(height)
    } else {
        area.cut_bottom(height)
    };
    let Some(mut ground) = cut.filter(|_| count > 0) else {
        return;
    };
    canvas.rect(ground, GROUND);
    ground.cut_top(margin);
    for row in rows.iter().take(count) {
        let Some(line) = ground.cut_top(row_height) else {
            return;
        };
        let mut line = Area {
            min: [line.min[0] + pad.min(line.width()), line.min[1]],
            ..line
        };
        for item in row.iter().filter_map(|k| items.get(*k)) {
            add(canvas, &mut line, item);
        }
    }
}

/// Adds an item off the left of a row.
fn add(canvas: &mut Canvas, line: &mut Area, item: &Item) {
    let (size, side) = (canvas.metrics.size, mark_side(canvas));
    if let Some((mark, colour)) = item.mark {
        let Some(place) = line.cut_left(side) else {
            return;
        };
        let above = (0.5 * (place.height() - side)).floor().max(0.0);
        let min = [place.min[0], place.min[1] + above];
        let max = [min[0] + side, (min[1] + side).min(place.max[1])];
        mark.draw(canvas, Area { min, max }, colour);
        line.cut_left(size.advance());
    }
    let width = canvas.text(*line, &item.text, item.weight, WHITE);
    line.cut_left(width);
    line.cut_left(2.0 * size.advance());
}

/// Adds the banner of a pause and the message of an instructor off the top of `area`.
pub fn banner(canvas: &mut Canvas, area: &mut Area, status: &Status, strings: &Strings) {
    let words = &strings.status;
    let pause = match (status.paused_by_student, status.paused_by_station) {
        (false, false) => None,
        (true, false) => Some(words.paused_by_student),
        (false, true) => Some(words.paused_by_station),
        (true, true) => Some(words.paused_by_both),
    };
    if let Some(text) = pause {
        notice(canvas, area, text, (YELLOW, Mark::Bars), Place::Top(2));
    }
    if let Some(text) = &status.message {
        let text = fill(words.message, &[text]);
        let place = Place::Top(MESSAGE_ROWS);
        notice(canvas, area, &text, (SKY_BLUE, Mark::Full), place);
    }
}

/// Adds the first warnings off the bottom of `area`.
pub fn warnings(canvas: &mut Canvas, area: &mut Area, status: &Status, strings: &Strings) {
    let words = &strings.status;
    for warning in status.warnings.iter().take(MOST_WARNINGS) {
        let text = match warning {
            Warning::NoForce(device) => fill(words.no_force, &[device]),
            Warning::SlowPicture => words.slow_picture.into(),
            Warning::Other(text) => text.clone(),
        };
        notice(canvas, area, &text, (ORANGE, Mark::Cross), Place::Bottom(2));
    }
}

/// Edge of a notice, with its largest number of rows.
#[derive(Clone, Copy)]
enum Place {
    Top(usize),
    Bottom(usize),
}

/// Adds a text with a shape on a bright ground.
fn notice(
    canvas: &mut Canvas,
    area: &mut Area,
    text: &str,
    (ground, mark): (Rgba, Mark),
    place: Place,
) {
    let (Place::Top(most) | Place::Bottom(most)) = place;
    let (size, pad, row) = (canvas.metrics.size, canvas.metrics.pad, canvas.metrics.row);
    let side = mark_side(canvas);
    let beside = 2.0 * pad + side + size.advance();
    let lines = wrap(text, size.columns(area.width() - beside), most);
    let widest = lines
        .iter()
        .map(|line| size.measure(line)[0])
        .fold(0.0, f32::max);
    let height = row * lines.len() as f32 + pad;
    let mut rest = *area;
    let cut = match place {
        Place::Top(_) => rest.cut_top(height),
        Place::Bottom(_) => rest.cut_bottom(height),
    };
    let Some(mut block) = cut.filter(|_| !lines.is_empty()) else {
        return;
    };
    *area = rest;
    block.max[0] = block.min[0] + widest + beside;
    canvas.rect(block, ground);
    let mut inner = block.inset((0.5 * pad).floor());
    inner.cut_left((0.5 * pad).floor());
    if let Some(place) = inner.cut_left(side) {
        let top = place.min[1] + (0.5 * (row - side)).floor();
        let square = Area {
            min: [place.min[0], top],
            max: [place.max[0], top + side],
        };
        mark.draw(canvas, square, BLACK);
    }
    inner.cut_left(size.advance());
    for line in lines {
        canvas.line(&mut inner, &line, Weight::Bold, BLACK);
    }
}

//! Panel of an exam: time, site to be read, and the student's own findings, as a clinic has them on paper.
//!
//! No function of this module gets the helps of practice: neither force nor depth can appear.

use super::canvas::{Area, Canvas};
use super::state::{Clock, Detail, Status, Tour};
use super::status::{self, Item};
use super::words;
use crate::strings::Strings;
use crate::text::Weight;

/// Adds the panel of an exam, and returns the area that is left for the picture.
pub fn exam(
    canvas: &mut Canvas,
    mut area: Area,
    clock: &Clock,
    tour: Option<&Tour>,
    status: &Status,
    strings: &Strings,
) -> Area {
    let items = status::items(status, Detail::Full, strings);
    status::strip(canvas, &mut area, &items, false);
    let mut head = vec![Item::plain(words::clock(clock, strings), Weight::Regular)];
    if let Some(tour) = tour {
        head.push(Item::plain(words::present(tour, strings), Weight::Bold));
        let own = tour.stop.map(|_| words::entered(tour, strings));
        head.extend(own.map(|own| Item::plain(own, Weight::Regular)));
        let wrong = tour.wrong.map(|wrong| words::wrong(wrong, strings));
        head.extend(wrong.map(|text| Item::plain(text.into(), Weight::Regular)));
    }
    status::strip(canvas, &mut area, &head, true);
    area
}

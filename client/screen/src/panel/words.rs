//! Numbers and findings in the words of a language.

use super::state::{Clock, Tour};
use crate::readings::{Draft, Entry, Field, Stop, Wrong};
use crate::strings::{Strings, fill};

/// Standard gravity, m/s2, by which a force in grams is defined.
const GRAVITY: f64 = 9.80665;

/// Number with `digits` decimal digits; a dash for a number that is not finite.
pub fn decimal(x: f64, digits: usize, strings: &Strings) -> String {
    if x.is_finite() {
        format!("{x:.digits$}").replace('.', strings.decimal)
    } else {
        "-".into()
    }
}

/// Force in newtons and grams.
pub fn force(newtons: f64, strings: &Strings) -> String {
    let grams = newtons * 1e3 / GRAVITY;
    fill(
        strings.force,
        &[&decimal(newtons, 2, strings), &decimal(grams, 0, strings)],
    )
}

/// Time as minutes and seconds, or hours, minutes and seconds.
pub fn minutes(seconds: f64) -> String {
    // The conversion limits to the range of the integer, and NaN becomes 0.
    let whole = seconds as u64;
    let (h, m, s) = (whole / 3600, whole / 60 % 60, whole % 60);
    if h > 0 {
        format!("{h}:{m:02}:{s:02}")
    } else {
        format!("{m}:{s:02}")
    }
}

/// Time of a session.
pub fn clock(clock: &Clock, strings: &Strings) -> String {
    let now = minutes(clock.elapsed_s);
    match clock.length_s {
        Some(length) => fill(strings.time_of, &[&now, &minutes(length)]),
        None => fill(strings.time, &[&now]),
    }
}

/// Tooth and site.
pub fn stop(stop: Stop, strings: &Strings) -> String {
    let site = strings.sites[stop.site.number()];
    fill(strings.stop, &[&stop.tooth.to_string(), site])
}

/// Site to be read, or the end of the tour.
pub fn present(tour: &Tour, strings: &Strings) -> String {
    tour.stop
        .map_or_else(|| strings.ended.into(), |at| stop(at, strings))
}

/// Findings, separated by commas; empty without any.
pub fn findings(draft: &Draft, strings: &Strings) -> String {
    let words = &strings.findings;
    let mut said: Vec<String> = Vec::new();
    said.extend(
        draft
            .depth_mm
            .map(|mm| fill(words.depth, &[&mm.to_string()])),
    );
    let signed = |mm: i8| fill(words.recession, &[&mm.to_string()]);
    said.extend(draft.recession_mm.map(signed));
    let bleeding = |yes| {
        if yes {
            words.bleeding
        } else {
            words.no_bleeding
        }
    };
    said.extend(draft.bleeding.map(|yes| bleeding(yes).to_owned()));
    said.extend(
        draft
            .furcation
            .map(|grade| fill(words.furcation, &[&grade.to_string()])),
    );
    said.extend(draft.suppuration.then(|| words.suppuration.to_owned()));
    said.join(", ")
}

/// Findings that are being typed, with the prompt of the present field.
pub fn entered(tour: &Tour, strings: &Strings) -> String {
    let words = &strings.findings;
    let mut text = findings(&tour.draft, strings);
    let prompt = match tour.field {
        Field::Recession { above, mm: None } => {
            let sign = if above { " -" } else { "" };
            Some(format!("{}{sign}", words.ask_recession))
        }
        Field::Furcation => Some(words.ask_furcation.to_owned()),
        Field::Depth | Field::Recession { .. } => None,
    };
    if let Some(prompt) = prompt {
        if !text.is_empty() {
            text += ", ";
        }
        text += &prompt;
    }
    if text.is_empty() {
        text = words.nothing.into();
    }
    fill(words.entered, &[&text])
}

/// Confirmed findings of a site, with tooth and initials.
pub fn entry(entry: &Entry, strings: &Strings) -> String {
    let draft = Draft {
        depth_mm: Some(entry.depth_mm),
        recession_mm: entry.recession_mm,
        bleeding: entry.bleeding,
        furcation: entry.furcation,
        suppuration: entry.suppuration == Some(true),
    };
    let initials = strings.initials[entry.stop.site.number()];
    format!(
        "{} {initials} {}",
        entry.stop.tooth,
        findings(&draft, strings)
    )
}

/// Reason why a key changed nothing.
pub fn wrong(wrong: Wrong, strings: &Strings) -> &'static str {
    let words = &strings.refusals;
    match wrong {
        Wrong::Ended => strings.ended,
        Wrong::OutOfRange => words.out_of_range,
        Wrong::SignOutOfPlace => words.sign,
        Wrong::Proximal => words.proximal,
        Wrong::NoDepth => words.no_depth,
        Wrong::NothingToUndo => words.nothing_to_undo,
        Wrong::AtStart => words.at_start,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::readings::{Key, Readings, Site};
    use crate::strings::ENGLISH;

    #[test]
    fn numbers_have_their_units_and_the_sign_of_the_language() {
        assert_eq!(force(0.22, &ENGLISH), "0.22 N 22 g");
        assert_eq!(force(1.96133, &ENGLISH), "1.96 N 200 g");
        assert_eq!(force(f64::NAN, &ENGLISH), "- N - g");
        let german = Strings {
            decimal: ",",
            ..ENGLISH
        };
        assert_eq!(decimal(0.25, 2, &german), "0,25");
        let times = [0.0, 59.9, 60.0, 3725.0, -4.0, f64::NAN].map(minutes);
        assert_eq!(times, ["0:00", "0:59", "1:00", "1:02:05", "0:00", "0:00"]);
    }

    #[test]
    fn findings_read_as_they_were_typed() {
        let stop = Stop {
            tooth: 36,
            site: Site::Buccal,
        };
        let mut readings = Readings::new(vec![stop]);
        let mut after = |keys: &str| {
            for key in keys.chars().filter_map(Key::from_char) {
                readings.press(key);
            }
            entered(&Tour::of(&readings, None), &ENGLISH)
        };
        assert_eq!(after(""), "Entered: nothing yet");
        assert_eq!(after("5b"), "Entered: 5 mm, bleeding");
        assert_eq!(after("r-"), "Entered: 5 mm, bleeding, recession? -");
        assert_eq!(
            after("2f"),
            "Entered: 5 mm, recession -2 mm, bleeding, furcation?"
        );
        assert_eq!(
            after("1s"),
            "Entered: 5 mm, recession -2 mm, bleeding, furcation 1, pus"
        );
        let tour = {
            readings.press(Key::Next);
            Tour::of(&readings, None)
        };
        assert_eq!(present(&tour, &ENGLISH), "All sites visited");
        let line = "36 B 5 mm, recession -2 mm, bleeding, furcation 1, pus";
        assert_eq!(entry(&tour.entries[0], &ENGLISH), line);
    }
}

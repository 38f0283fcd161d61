//! All words that the panel shows, in one place.
//!
//! A language is one table, a constant of the type [`Strings`]. A missing word does not compile. English is shipped.
//! The font covers German and Spanish ([`crate::text`]); Chinese needs another font.
//!
//! A number in braces is replaced by a value: `{0}` by the first, `{1}` by the second.

mod english;

pub use english::ENGLISH;

use crate::hand::keys::{Act, Control};

/// Words of a language.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Strings {
    /// Sign between whole and decimal digits.
    pub decimal: &'static str,
    /// Tooth and site: 0 is the number, 1 the name of the site.
    pub stop: &'static str,
    /// Names of the sites, in the order of [`crate::readings::Site::ALL`].
    pub sites: [&'static str; 6],
    /// Initials of the sites, in the same order.
    pub initials: [&'static str; 6],
    /// Number 0 of 1 stops.
    pub progress: &'static str,
    /// End of the tour.
    pub ended: &'static str,
    /// Time since the start: 0 is minutes and seconds.
    pub time: &'static str,
    /// Time since the start, 0, and length, 1.
    pub time_of: &'static str,
    /// Depth of the tip below the margin: 0 is millimetres.
    pub depth: &'static str,
    /// Depth while the tip is in no pocket.
    pub no_depth: &'static str,
    /// Force: 0 is newtons, 1 grams.
    pub force: &'static str,
    /// Ratings of a force: none, light, right, heavy.
    pub ratings: [&'static str; 4],
    /// Sentences of the next step.
    pub steps: Steps,
    /// Findings of a site.
    pub findings: Findings,
    /// Reasons why a key changed nothing.
    pub refusals: Refusals,
    /// State of link, recording, pause and force.
    pub status: StatusWords,
    /// Band trainer.
    pub lesson: LessonWords,
    /// Page after a session.
    pub end: EndWords,
    /// First lesson.
    pub first: FirstWords,
    /// Hands without a force device.
    pub hands: HandWords,
}

/// First lesson.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct FirstWords {
    /// Title: 0 is the number of the step, 1 the number of all steps.
    pub title: &'static str,
    /// Tasks, in the order of [`crate::first::Step::ALL`].
    pub tasks: [&'static str; 4],
    /// Confirmations of the steps, in the same order.
    pub done: [&'static str; 4],
    /// Hint for a heavy contact.
    pub heavy: &'static str,
    /// Hint to lift the tip after a soft contact.
    pub lift: &'static str,
    /// End of the lesson.
    pub ended: &'static str,
}

/// Page after a session.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct EndWords {
    /// The session has ended.
    pub ended: &'static str,
    /// The grade is being computed.
    pub replaying: &'static str,
    /// The own score of the learner precedes the grade.
    pub own_score: &'static str,
    /// The grade is at the instructor's.
    pub elsewhere: &'static str,
    /// There is no grade.
    pub no_grade: &'static str,
    /// Score: 0 is the number.
    pub score: &'static str,
    /// Verdicts: passed, not passed.
    pub verdicts: [&'static str; 2],
    /// Title of the advice.
    pub practise: &'static str,
    /// Piece of advice: 0 is its number, 1 its sentence.
    pub advice: &'static str,
    /// No piece of advice.
    pub nothing: &'static str,
    /// Title of the replayed finding.
    pub worst: &'static str,
    /// Ways to close the page.
    pub close: &'static str,
}

/// Words of hands without a force device.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct HandWords {
    /// Names of the devices: mouse and keyboard, 3D mouse, gamepad.
    pub devices: [&'static str; 3],
    /// Sentence that says what is missing.
    pub no_feeling: &'static str,
    /// State of the clutch: open, closed.
    pub clutch: [&'static str; 2],
    /// Controls, in the order of [`crate::hand::keys::Control::ALL`].
    pub controls: [&'static str; Control::ALL.len()],
    /// Acts, in the order of [`crate::hand::keys::Act::ALL`].
    pub acts: [&'static str; Act::ALL.len()],
}

/// Words of the band trainer.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct LessonWords {
    /// Number 0 of 1 tasks.
    pub progress: &'static str,
    /// Question of a task.
    pub question: &'static str,
    /// Rules of rounding, in the order of [`crate::trainer::Rule::ALL`].
    pub rules: [&'static str; 3],
    /// The last answer is right: 0 is the number.
    pub right: &'static str,
    /// The last answer is wrong: 0 is the right number, 1 the answer, 2 the length in millimetres.
    pub wrong: &'static str,
    /// End of the lesson.
    pub ended: &'static str,
    /// Grade: 0 and 1 are percent right and within 1 mm, 2 the mean error with its sign, mm.
    pub grade: &'static str,
    /// Side of the wrong answers: too deep, too shallow.
    pub leanings: [&'static str; 2],
}

/// Sentences of the next step, as a teacher speaks them.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Steps {
    /// Tooth and site within a sentence: 0 is the number, 1 the name of the site.
    pub place: &'static str,
    /// Way to a site: 0 is the place.
    pub go_to: &'static str,
    /// The tip is in a pocket: 0 is the place.
    pub slide_down: &'static str,
    /// The force is light: 0 and 1 are least and greatest force.
    pub press_more: &'static str,
    /// The force is right.
    pub read: &'static str,
    /// The force is heavy: 0 is the greatest force.
    pub press_less: &'static str,
    /// A depth was entered: 0 is the next place.
    pub confirm: &'static str,
    /// A depth was entered at the last stop.
    pub confirm_last: &'static str,
    /// The session is paused.
    pub wait: &'static str,
    /// The tour has ended.
    pub ended: &'static str,
}

/// Findings of a site.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Findings {
    /// Prompt of the findings that are being typed: 0 is the findings.
    pub entered: &'static str,
    /// No finding yet.
    pub nothing: &'static str,
    /// Depth: 0 is millimetres.
    pub depth: &'static str,
    /// Recession: 0 is millimetres, with a sign.
    pub recession: &'static str,
    /// Bleeding.
    pub bleeding: &'static str,
    /// No bleeding.
    pub no_bleeding: &'static str,
    /// Furcation: 0 is the grade.
    pub furcation: &'static str,
    /// Suppuration.
    pub suppuration: &'static str,
    /// Prompt for the digits of a recession.
    pub ask_recession: &'static str,
    /// Prompt for the grade of a furcation.
    pub ask_furcation: &'static str,
}

/// Reasons why a key changed nothing.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Refusals {
    /// The number would leave its range.
    pub out_of_range: &'static str,
    /// The sign stands elsewhere than before a recession.
    pub sign: &'static str,
    /// The site has no furcation.
    pub proximal: &'static str,
    /// Findings without a depth.
    pub no_depth: &'static str,
    /// No key to take back.
    pub nothing_to_undo: &'static str,
    /// No site before the first.
    pub at_start: &'static str,
}

/// State of link, recording, pause and force.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct StatusWords {
    /// Link with a delay: 0 is milliseconds.
    pub link: &'static str,
    /// Link without a known delay.
    pub link_up: &'static str,
    /// Link that is being restored.
    pub link_returning: &'static str,
    /// No link.
    pub link_lost: &'static str,
    /// The session is recorded.
    pub recording: &'static str,
    /// The session is not recorded.
    pub not_recorded: &'static str,
    /// The recording has failed.
    pub recording_failed: &'static str,
    /// The session runs.
    pub running: &'static str,
    /// The session is paused.
    pub paused: &'static str,
    /// Message of an instructor: 0 is its text.
    pub message: &'static str,
    /// Pause by the student.
    pub paused_by_student: &'static str,
    /// Pause by the instructor.
    pub paused_by_station: &'static str,
    /// Pause by both.
    pub paused_by_both: &'static str,
    /// Force limit: 0 is newtons.
    pub limit: &'static str,
    /// Force limit of the scene.
    pub limit_of_scene: &'static str,
    /// Picture in less detail: plain, low, lowest.
    pub detail: [&'static str; 3],
    /// Settings of the person: 0 is the hand, 1 the finger rest.
    pub person: &'static str,
    /// Hand of the probe, in the order of [`crate::handed::Handed::ALL`].
    pub hands: [&'static str; 2],
    /// Finger rest, in the order of [`crate::handed::FingerRest::ALL`].
    pub rests: [&'static str; 3],
    /// No force is displayed: 0 is the device.
    pub no_force: &'static str,
    /// The picture is late.
    pub slow_picture: &'static str,
}

/// Text of `template` with `values` in the places of `{0}`, `{1}` and so on.
pub fn fill(template: &str, values: &[&str]) -> String {
    let mut text = String::with_capacity(template.len());
    let mut rest = template;
    while let Some(open) = rest.find('{') {
        let (before, from) = rest.split_at(open);
        text.push_str(before);
        let value = from.find('}').and_then(|close| {
            let number: usize = from[1..close].parse().ok()?;
            Some((close, values.get(number)?))
        });
        match value {
            Some((close, value)) => {
                text.push_str(value);
                rest = &from[close + 1..];
            }
            None => {
                text.push('{');
                rest = &from[1..];
            }
        }
    }
    text.push_str(rest);
    text
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::text::glyph::is_known;

    #[test]
    fn places_are_filled_in_any_order_and_values_stay_as_they_are() {
        assert_eq!(fill("{1} of {0}", &["a", "{1}"]), "{1} of a");
        assert_eq!(fill("{2} {x} {", &["a"]), "{2} {x} {");
        assert_eq!(fill("für {0}", &["36"]), "für 36");
    }

    #[test]
    fn the_font_has_every_letter_of_the_table() {
        let written = format!("{ENGLISH:?}");
        let missing: String = written.chars().filter(|c| !is_known(*c)).collect();
        assert_eq!(missing, "");
    }

    /// Sources of all modules whose texts come from the table.
    #[test]
    fn no_other_module_of_the_panel_holds_words() {
        let folder = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("src/panel");
        let mut files = 0;
        for file in std::fs::read_dir(folder).expect("the panel") {
            let path = file.expect("a file").path();
            if path.ends_with("tests.rs") {
                continue;
            }
            files += 1;
            let source = std::fs::read_to_string(&path).expect("text");
            let code = source.split("#[cfg(test)]").next().unwrap_or_default();
            for line in code
                .lines()
                .filter(|line| !line.trim_start().starts_with("//"))
            {
                // Every second part lies between quotation marks.
                for literal in line.split('"').skip(1).step_by(2) {
                    // Names of values in a format are no words.
                    let parts = literal.split('{').map(|part| part.rsplit('}').next());
                    let shown: String = parts.flatten().collect();
                    let letters = shown.chars().filter(|c| c.is_alphabetic()).count();
                    // The one word of a protocol.
                    let is_shown = literal != "practice";
                    assert!(letters < 2 || !is_shown, "{}: {line}", path.display());
                }
            }
        }
        assert!(files >= 8, "{files} sources");
    }
}

//! Page after a session: score, advice, and the worst finding, which the picture replays.

use super::canvas::{Area, Canvas};
use super::colour::{GREY, WHITE, YELLOW};
use super::words::decimal;
use super::{Panel, practice};
use crate::strings::{Strings, fill};
use crate::text::Weight;

/// Largest number of rows of a sentence.
const ROWS: usize = 6;
/// Largest number of pieces of advice. Chosen: a learner can attend to a few.
const MOST: usize = 3;

/// Content of the page.
#[derive(Clone, Debug, PartialEq)]
pub enum End {
    /// After an exam.
    Silent,
    /// The recording is being replayed.
    Replaying,
    /// In self-assessment: the own score precedes the grade.
    OwnScoreFirst,
    /// The recording and its grade are at the instructor's.
    Elsewhere,
    /// After practice.
    Graded {
        /// Score, 0 to 100; `None` without a grade.
        score: Option<f64>,
        /// Whether the session is passed.
        passed: bool,
        /// Advice, a sentence each, the most urgent first.
        advice: Vec<String>,
        /// Tooth, site and finding that the picture replays.
        finding: Option<String>,
    },
}

/// Page for a window of `window` physical pixels on a display with the scale factor `scale`. The picture has its place
/// in [`Panel::free`].
pub fn end(end: &End, window: [u32; 2], scale: f32, strings: &Strings) -> Panel {
    let (mut canvas, mut free) = Canvas::over(window, scale);
    if let Some(mut rows) = practice::column(&mut canvas, &mut free) {
        let words = &strings.end;
        // The way out has its room before all others.
        if let Some(row) = rows.cut_bottom(canvas.metrics.row) {
            canvas.text(row, words.close, Weight::Regular, GREY);
        }
        canvas.paragraph(&mut rows, words.ended, ROWS, Weight::Bold, WHITE);
        rows.cut_top(canvas.metrics.pad);
        let sentence = match end {
            End::Silent => None,
            End::Replaying => Some(words.replaying),
            End::OwnScoreFirst => Some(words.own_score),
            End::Elsewhere => Some(words.elsewhere),
            End::Graded { score: None, .. } => Some(words.no_grade),
            End::Graded { .. } => None,
        };
        if let Some(sentence) = sentence {
            canvas.paragraph(&mut rows, sentence, ROWS, Weight::Regular, WHITE);
        }
        if let End::Graded {
            score: Some(score),
            passed,
            advice,
            finding,
        } = end
        {
            graded(&mut canvas, &mut rows, (*score, *passed), strings);
            practise(&mut canvas, &mut rows, advice, strings);
            if let Some(finding) = finding {
                rows.cut_top(canvas.metrics.pad);
                canvas.line(&mut rows, words.worst, Weight::Bold, YELLOW);
                canvas.paragraph(&mut rows, finding, ROWS, Weight::Regular, WHITE);
            }
        }
    }
    Panel {
        list: canvas.list,
        free,
    }
}

fn graded(canvas: &mut Canvas, rows: &mut Area, (score, passed): (f64, bool), strings: &Strings) {
    let words = &strings.end;
    let score = fill(words.score, &[&decimal(score, 1, strings)]);
    canvas.line(rows, &score, Weight::Bold, WHITE);
    let [yes, no] = words.verdicts;
    canvas.line(rows, if passed { yes } else { no }, Weight::Regular, WHITE);
    rows.cut_top(canvas.metrics.pad);
}

fn practise(canvas: &mut Canvas, rows: &mut Area, advice: &[String], strings: &Strings) {
    let words = &strings.end;
    canvas.line(rows, words.practise, Weight::Bold, YELLOW);
    if advice.is_empty() {
        canvas.paragraph(rows, words.nothing, ROWS, Weight::Regular, WHITE);
    }
    for (k, sentence) in advice.iter().take(MOST).enumerate() {
        let number = (k + 1).to_string();
        let text = fill(words.advice, &[&number, sentence]);
        canvas.paragraph(rows, &text, ROWS, Weight::Regular, WHITE);
    }
}

#[cfg(test)]
mod tests {
    use super::super::Primitive;
    use super::*;
    use crate::strings::ENGLISH;

    fn texts(page: &End, window: [u32; 2]) -> String {
        let list = end(page, window, 1.0, &ENGLISH).list;
        let text = |one: &Primitive| match one {
            Primitive::Glyphs { text, .. } => Some(text.clone()),
            _ => None,
        };
        let all: Vec<String> = list.iter().filter_map(text).collect();
        all.join(" ")
    }

    fn practised() -> End {
        End::Graded {
            score: Some(71.44),
            passed: true,
            advice: (1..=4).map(|k| format!("Advice number {k}.")).collect(),
            finding: Some("36 distobuccal: the tip stood here.".into()),
        }
    }

    #[test]
    fn practice_shows_score_three_sentences_and_the_worst_finding() {
        let shown = texts(&practised(), [1280, 720]);
        for words in [
            "Score 71.4 of 100",
            "3. Advice number 3.",
            "36 distobuccal:",
            "Esc or F10",
        ] {
            assert!(shown.contains(words), "{words} in {shown}");
        }
        assert!(!shown.contains("number 4"), "{shown}");
    }

    #[test]
    fn an_exam_shows_no_more_than_that_the_session_has_ended() {
        let shown = texts(&End::Silent, [1280, 720]);
        let close = ENGLISH.end.close;
        assert_eq!(shown.replace(close, "").trim(), ENGLISH.end.ended);
        let first = texts(&End::OwnScoreFirst, [1280, 720]);
        assert!(first.contains("Judge yourself first.") && !first.contains("Score"));
    }

    #[test]
    fn all_texts_lie_in_the_window_and_the_way_out_is_always_shown() {
        for window in [[640, 360], [1280, 720], [3840, 2160]] {
            assert!(texts(&practised(), window).contains("Esc or F10"));
            for one in end(&practised(), window, 1.0, &ENGLISH).list {
                let [low, high] = one.bounds();
                let inside = (0..2).all(|k| low[k] >= 0.0 && high[k] <= window[k] as f32);
                assert!(inside, "{one:?}");
            }
        }
    }
}

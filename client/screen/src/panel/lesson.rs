//! Panel of the band trainer: question, typed number, and in practice the right answer.

use super::canvas::{Area, Canvas};
use super::colour::{GREY, WHITE, YELLOW};
use super::state::Mode;
use super::words::decimal;
use super::{Panel, practice};
use crate::strings::{Strings, fill};
use crate::text::Weight;
use crate::trainer::{Leaning, Lesson, LessonGrade, Rule};

/// Largest number of rows of a sentence.
const ROWS: usize = 4;

/// Panel of a lesson for a window of `window` physical pixels on a display with the scale factor `scale`. The picture
/// of the probe has its place in [`Panel::free`].
///
/// An exam shows neither right answers nor the grade.
pub fn lesson(
    lesson: &Lesson,
    mode: Mode,
    window: [u32; 2],
    scale: f32,
    strings: &Strings,
) -> Panel {
    let (mut canvas, mut free) = Canvas::over(window, scale);
    if let Some(mut rows) = practice::column(&mut canvas, &mut free) {
        if lesson.task().is_some() {
            question(&mut canvas, &mut rows, lesson, strings);
        } else {
            canvas.paragraph(&mut rows, strings.lesson.ended, ROWS, Weight::Bold, WHITE);
        }
        if mode == Mode::Practice {
            rows.cut_top(canvas.metrics.pad);
            feedback(&mut canvas, &mut rows, lesson, strings);
        }
    }
    Panel {
        list: canvas.list,
        free,
    }
}

fn question(canvas: &mut Canvas, rows: &mut Area, lesson: &Lesson, strings: &Strings) {
    let words = &strings.lesson;
    let (number, count) = (
        (lesson.answers().len() + 1).to_string(),
        lesson.len().to_string(),
    );
    canvas.line(
        rows,
        &fill(words.progress, &[&number, &count]),
        Weight::Regular,
        GREY,
    );
    canvas.paragraph(rows, words.question, ROWS, Weight::Bold, WHITE);
    let rule = Rule::ALL.iter().position(|rule| *rule == lesson.rule());
    if let Some(sentence) = rule.and_then(|k| words.rules.get(k)) {
        canvas.paragraph(rows, sentence, ROWS, Weight::Regular, GREY);
    }
    let findings = &strings.findings;
    let typed = lesson
        .typed()
        .map(|mm| fill(findings.depth, &[&mm.to_string()]));
    let typed = typed.unwrap_or_else(|| findings.nothing.into());
    canvas.line(
        rows,
        &fill(findings.entered, &[&typed]),
        Weight::Regular,
        YELLOW,
    );
}

/// Adds the right answer to the last task, and at the end the grade.
fn feedback(canvas: &mut Canvas, rows: &mut Area, lesson: &Lesson, strings: &Strings) {
    let words = &strings.lesson;
    let Some(last) = lesson.answers().last() else {
        return;
    };
    let right = last.right_mm.to_string();
    let text = if last.error_mm() == 0 {
        fill(words.right, &[&right])
    } else {
        let shown = decimal(f64::from(last.task.tenths) / 10.0, 1, strings);
        fill(words.wrong, &[&right, &last.said_mm.to_string(), &shown])
    };
    canvas.paragraph(rows, &text, ROWS, Weight::Bold, WHITE);
    if let Some(grade) = lesson.grade().filter(|_| lesson.task().is_none()) {
        rows.cut_top(canvas.metrics.pad);
        for sentence in sentences(&grade, strings) {
            canvas.paragraph(rows, &sentence, ROWS, Weight::Regular, WHITE);
        }
    }
}

/// Sentences of a grade.
fn sentences(grade: &LessonGrade, strings: &Strings) -> Vec<String> {
    let words = &strings.lesson;
    let percent = |share: f64| decimal(100.0 * share, 0, strings);
    let sign = if grade.mean_error_mm > 0.0 { "+" } else { "" };
    let error = format!("{sign}{}", decimal(grade.mean_error_mm, 1, strings));
    let [deep, shallow] = words.leanings;
    let leaning = match grade.leaning() {
        Leaning::Neither => None,
        Leaning::Deep => Some(deep),
        Leaning::Shallow => Some(shallow),
    };
    let numbers = fill(
        words.grade,
        &[&percent(grade.right), &percent(grade.within_1_mm), &error],
    );
    [numbers]
        .into_iter()
        .chain(leaning.map(String::from))
        .collect()
}

//! Lessons on the markings of real probes.

use super::*;

fn bands(ends: &[(f32, bool)]) -> Vec<DisplayBand> {
    let mut from = 0.0;
    let band = |&(end, dark): &(f32, bool)| {
        let to = end * 1e-3;
        let band = DisplayBand { from, to, dark };
        from = to;
        band
    };
    ends.iter().map(band).collect()
}

fn williams() -> Vec<DisplayBand> {
    bands(&[1.0, 2.0, 3.0, 5.0, 7.0, 8.0, 9.0, 10.0].map(|end| (end, false)))
}

fn lesson(seed: u64, count: usize) -> Lesson {
    Lesson::new(&williams(), Rule::default(), seed, count).expect("bands")
}

#[test]
fn a_seed_names_a_series_within_the_marks() {
    let tasks = |seed| lesson(seed, 2000).tasks;
    assert_eq!(tasks(5), tasks(5));
    assert_ne!(tasks(5), tasks(6));
    let drawn = tasks(5);
    assert_eq!(drawn.iter().map(|task| task.tenths).min(), Some(5));
    assert_eq!(drawn.iter().map(|task| task.tenths).max(), Some(100));
    assert!(drawn.windows(2).all(|pair| pair[0] != pair[1]));
    let unc = bands(&[(5.0, true), (10.0, true), (15.0, true)]);
    let deep = Lesson::new(&unc, Rule::default(), 1, 2000)
        .expect("bands")
        .tasks;
    assert_eq!(deep.iter().map(|task| task.tenths).max(), Some(MOST_TENTHS));
}

#[test]
fn a_tool_without_bands_has_no_lesson() {
    for none in [vec![], bands(&[(0.9, true)]), bands(&[(f32::NAN, true)])] {
        let found = Lesson::new(&none, Rule::default(), 1, 3);
        assert_eq!(found.err(), Some(LessonError::NoBands));
    }
}

#[test]
fn the_band_at_the_margin_is_the_one_that_ends_at_the_mark() {
    let (bands, at) = (williams(), |tenths| Task { tenths });
    assert_eq!(at(30).band(&bands), Some(2));
    assert_eq!(at(31).band(&bands), Some(3));
    assert_eq!(at(50).band(&bands), Some(3));
    assert_eq!(at(101).band(&bands), None);
    assert!((at(34).depth_m() - 3.4e-3).abs() < 1e-9);
}

#[test]
fn answers_are_graded_by_share_and_side() {
    let mut lesson = lesson(11, 4);
    assert_eq!(lesson.grade(), None);
    // Right, two too deep, one too deep, one too shallow.
    for off in [0i16, 2, 1, -1] {
        let task = lesson.task().expect("a task");
        let right = Rule::default().whole_mm(task.tenths);
        let said = i16::from(right) + off;
        let answer = lesson
            .answer(u8::try_from(said).expect("a depth"))
            .expect("taken");
        assert_eq!(
            (answer.task, answer.right_mm, answer.error_mm()),
            (task, right, off)
        );
    }
    let grade = lesson.grade().expect("answers");
    assert_eq!((grade.answers, grade.deep, grade.shallow), (4, 2, 1));
    assert_eq!(
        (grade.right, grade.within_1_mm, grade.mean_error_mm),
        (0.25, 0.75, 0.5)
    );
    assert_eq!(grade.leaning(), Leaning::Deep);
    assert_eq!((lesson.task(), lesson.answer(3)), (None, None));
    assert_eq!(lesson.answers().len(), 4);
}

#[test]
fn a_number_out_of_range_is_no_answer() {
    let mut lesson = lesson(11, 2);
    let before = lesson.clone();
    assert_eq!(lesson.answer(MOST_MM + 1), None);
    assert_eq!(lesson, before);
}

#[test]
fn the_rule_decides_who_is_right() {
    let said = |rule| {
        let mut lesson = Lesson::new(&williams(), rule, 3, 500).expect("bands");
        // A student who always rounds half up.
        while let Some(task) = lesson.task() {
            lesson.answer(Rule::NearestHalfUp.whole_mm(task.tenths));
        }
        lesson.grade().expect("answers")
    };
    assert_eq!(said(Rule::NearestHalfUp).right, 1.0);
    assert_eq!(said(Rule::NearestHalfUp).leaning(), Leaning::Neither);
    assert_eq!(
        (said(Rule::Up).leaning(), said(Rule::Up).deep),
        (Leaning::Shallow, 0)
    );
    assert_eq!(
        (said(Rule::Down).leaning(), said(Rule::Down).shallow),
        (Leaning::Deep, 0)
    );
}

#[test]
fn a_lesson_is_answered_with_the_keys_of_readings() {
    let mut lesson = lesson(11, 3);
    let mut answers = Vec::new();
    for key in "7u12b3\r\rx4-\r<n".chars().filter_map(Key::from_char) {
        answers.extend(lesson.press(key).map(|answer| answer.said_mm));
    }
    // Without a number, return is no answer.
    assert_eq!((answers, lesson.typed()), (vec![12, 4], None));
    assert_eq!(lesson.press(Key::Count(21)), None);
    assert_eq!(lesson.typed(), None);
    lesson.press(Key::Count(20));
    assert_eq!(
        lesson.press(Key::Next).map(|answer| answer.said_mm),
        Some(20)
    );
    lesson.press(Key::Digit(3));
    assert_eq!((lesson.task(), lesson.typed()), (None, None));
}

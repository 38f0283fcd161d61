//! Page of a class: learners, losses of points, hard sites, trends. The words are in the template `class.html`.

mod heat;
mod losses;

use askama::Template;

use super::svg::Svg;
use super::{Look, filters, rendered, trend};
use crate::grade::class::Session;
use crate::grade::report::RubricUsed;
use crate::grade::revision::Sidecar;
use losses::Losses;

/// The page of all sessions, sorted by exercise, learner and attempt. `unread`: files that cannot be read, with the
/// reason.
pub fn class_page(sessions: &[Session], unread: &[(String, String)], look: &Look<'_>) -> String {
    let graded = |session: &&Session| session.grade.score.is_some();
    let exercises = sessions.chunk_by(|a, b| a.grade.exercise == b.grade.exercise);
    let page = ClassPage {
        sessions: sessions.len(),
        graded: sessions.iter().filter(graded).count(),
        unread,
        exercises: exercises.map(|all| Exercise::of(all, look)).collect(),
        numbering: look.numbering.name(),
    };
    rendered(&page)
}

#[derive(Template)]
#[template(path = "class.html")]
struct ClassPage<'a> {
    /// Number of sessions.
    sessions: usize,
    /// Number of sessions with a grade.
    graded: usize,
    unread: &'a [(String, String)],
    exercises: Vec<Exercise<'a>>,
    /// Name of the numbering of teeth.
    numbering: &'static str,
}

/// Sessions of one exercise.
struct Exercise<'a> {
    name: &'a str,
    /// Rubrics of the grades, in words.
    rubrics: Vec<String>,
    learners: Vec<Learner<'a>>,
    losses: Losses,
    /// Maps of the sites, one for each jaw. Exams are left out: the map of a single session shows prescribed depths.
    heat: Vec<Svg>,
}

/// One learner's attempts at an exercise.
struct Learner<'a> {
    name: String,
    last: &'a Session,
    /// Last score of an instructor.
    revised: Option<f64>,
    /// Whether the last session is passed, in words.
    passed: &'static str,
    /// Title of the weakest metric; empty in an exam.
    weakest: &'static str,
    exam: bool,
    trend: Svg,
}

impl<'a> Exercise<'a> {
    fn of(all: &'a [Session], look: &Look<'_>) -> Self {
        let mut rubrics: Vec<String> = Vec::new();
        for used in all.iter().filter_map(|one| one.grade.rubric.as_ref()) {
            let words = rubric(used);
            if !rubrics.contains(&words) {
                rubrics.push(words);
            }
        }
        let open: Vec<&Session> = all.iter().filter(|one| !one.is_exam()).collect();
        let attempts = all.chunk_by(|a, b| a.is_of_the_same(b));
        Self {
            name: &all[0].grade.exercise,
            rubrics,
            learners: attempts.filter_map(|all| Learner::of(all, look)).collect(),
            losses: Losses::of(all),
            heat: heat::maps(&open, look.numbering),
        }
    }
}

impl<'a> Learner<'a> {
    fn of(attempts: &'a [Session], look: &Look<'_>) -> Option<Self> {
        let last = attempts.last()?;
        let weakest = last.grade.advice.first().filter(|_| !last.is_exam());
        let mut marks = attempts.iter().rev().filter_map(|one| one.grade.pass_mark);
        Some(Self {
            name: look.learner(&last.grade.learner_id),
            last,
            revised: last
                .sidecar
                .as_ref()
                .and_then(Sidecar::latest)
                .map(|said| said.score),
            passed: match last.counts().1 {
                Some(true) => "yes",
                Some(false) => "no",
                None if last.grade.score.is_some() => "not decided",
                None => "no grade",
            },
            weakest: weakest.map_or("", |advice| advice.title),
            exam: last.is_exam(),
            trend: trend::plot(attempts, marks.next().unwrap_or_default()),
        })
    }
}

/// A rubric in words.
fn rubric(used: &RubricUsed) -> String {
    let (name, version) = (&used.name, used.version);
    format!("{name} version {version} ({})", &used.blake3[..12])
}

//! Page of one session on one sheet: grade, chart, plots, advice. The words are in the template `student.html`.

mod head;
mod metrics;
mod zones;

use askama::Template;

use super::chart::{Chart, ChartView};
use super::filters;
use super::pictured::Shown;
use super::plots::{self, Plot};
use super::{Look, Pictures, rendered};
use crate::grade::Graded;
use crate::grade::class::Session;
use crate::grade::patient::PatientChart;
use crate::grade::report::Grade;
use crate::grade::revision::{Proposal, Sidecar};
use head::Head;
use metrics::{Definitions, Metrics};
use zones::Zones;

/// Most pieces of advice on a sheet.
const MOST_ADVICE: usize = 3;
/// Most characters of an instructor's reason on a sheet.
const MOST_REASON: usize = 200;
/// Most characters of an instructor's id and of a date on a sheet.
const MOST_NAME: usize = 40;

/// The page of one session. `pictures`: none were asked for, or those of its findings. An exam shows none.
pub fn student_page(
    session: &Session,
    graded: &Graded,
    look: &Look<'_>,
    pictures: Option<&Pictures>,
) -> String {
    let grade = &session.grade;
    let page = StudentPage {
        head: Head::of(session, look),
        revised: session
            .sidecar
            .as_ref()
            .and_then(|all| Revised::of(all, grade)),
        no_grade: grade
            .score
            .is_none()
            .then(|| grade.reason.as_deref().unwrap_or("for no reason known")),
        failures: &grade.failures,
        passed: session.counts().1 == Some(true),
        own: session.self_score.zip(grade.score),
        chart: chart(graded, grade, look),
        plot: plots::plot(graded, look.numbering).filter(|_| !session.is_exam()),
        body: (grade.score.is_some()).then(|| Body::of(session, look, pictures)),
    };
    rendered(&page)
}

#[derive(Template)]
#[template(path = "student.html")]
struct StudentPage<'a> {
    head: Head<'a>,
    revised: Option<Revised>,
    /// Reason against a grade.
    no_grade: Option<&'a str>,
    /// Reasons against a pass in the program's proposal.
    failures: &'a [String],
    /// Whether the session is passed in the end.
    passed: bool,
    /// Learner's own score, and the program's.
    own: Option<(f64, f64)>,
    chart: Option<ChartView>,
    plot: Option<Plot>,
    body: Option<Body<'a>>,
}

/// Parts of a page with a grade.
struct Body<'a> {
    metrics: Metrics<'a>,
    /// None in an exam.
    advice: Option<Vec<Advice<'a>>>,
    zones: Option<Zones>,
    /// None in an exam, and if none were asked for.
    pictures: Option<Shown<'a>>,
    definitions: Definitions<'a>,
}

impl<'a> Body<'a> {
    fn of(session: &'a Session, look: &Look<'_>, pictures: Option<&'a Pictures>) -> Self {
        let grade = &session.grade;
        let pictures = pictures.filter(|_| !session.is_exam());
        Self {
            metrics: Metrics::of(grade),
            advice: (!session.is_exam()).then(|| advice(grade, look)),
            zones: Zones::of(session, look),
            pictures: pictures.map(|all| Shown::of(all, look.numbering)),
            definitions: Definitions::of(grade),
        }
    }
}

/// Latest revision by an instructor. Earlier revisions and the whole of a long reason are in the JSON file.
struct Revised {
    score: f64,
    passed: bool,
    by: String,
    at: String,
    reason: String,
    /// Number of revisions.
    count: usize,
    /// First proposal, if it differs from the present one.
    then: Option<String>,
}

impl Revised {
    fn of(sidecar: &Sidecar, grade: &Grade) -> Option<Self> {
        let said = sidecar.latest()?;
        Some(Self {
            score: said.score,
            passed: said.passed,
            by: clipped(&said.by, MOST_NAME),
            at: clipped(&said.at, MOST_NAME),
            reason: clipped(&said.reason, MOST_REASON),
            count: sidecar.revisions.len(),
            then: sidecar.proposal.differs(&Proposal::of(grade)),
        })
    }
}

/// A piece of advice, with the zones that show it.
struct Advice<'a> {
    title: &'a str,
    text: &'a str,
    /// Zones in words; may be empty.
    sites: String,
}

fn advice<'a>(grade: &'a Grade, look: &Look<'_>) -> Vec<Advice<'a>> {
    let all = grade.advice.iter().take(MOST_ADVICE);
    all.map(|advice| {
        let sites = advice.sites.iter();
        let sites = sites.map(|site| format!("{} {}", look.numbering.of(site.tooth), site.says));
        let sites: Vec<String> = sites.collect();
        Advice {
            title: advice.title,
            text: &advice.text,
            sites: sites.join("; "),
        }
    })
    .collect()
}

fn chart(graded: &Graded, grade: &Grade, look: &Look<'_>) -> Option<ChartView> {
    if grade.sites.is_empty() {
        return None;
    }
    let patient = PatientChart::read(&graded.patient);
    let chart = Chart {
        sites: &grade.sites,
        teeth: &graded.teeth,
        patient: &patient,
        numbering: look.numbering,
        truth: look.truth,
    };
    Some(chart.view())
}

/// A text, or its beginning with three dots.
fn clipped(text: &str, most: usize) -> String {
    if text.chars().count() <= most {
        return text.to_owned();
    }
    let beginning: String = text.chars().take(most).collect();
    format!("{}...", beginning.trim_end())
}

#[cfg(test)]
mod tests {
    use super::clipped;

    #[test]
    fn a_long_reason_is_cut_between_characters_and_a_short_one_is_not() {
        assert_eq!(clipped("finger rest slipped", 200), "finger rest slipped");
        assert_eq!(clipped(&"ü".repeat(200), 200), "ü".repeat(200));
        assert_eq!(clipped(&"ü".repeat(201), 200), "ü".repeat(200) + "...");
        assert_eq!(clipped("slipped twice", 8), "slipped...");
    }
}

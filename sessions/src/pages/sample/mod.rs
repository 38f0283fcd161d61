//! Invented sessions for the tests of the pages. All texts of recording, rubric, key table and instructor are one given
//! text.

mod grade;

use std::path::Path;

use crate::grade::Graded;
use crate::grade::class::{Session, Shown};
use crate::grade::names::Names;
use crate::grade::revision::{Proposal, Revision, Sidecar};
use crate::record::mode::Mode;

/// Variant of a session.
#[derive(Clone, Copy, Debug)]
pub struct Kind {
    /// Mode of the recording and of the grade.
    pub mode: Mode,
    /// Whether pockets are probed; without pockets the plot names the leading tool.
    pub probed: bool,
    /// Whether there is a grade.
    pub graded: bool,
}

/// All variants.
pub const KINDS: [Kind; 4] = [
    Kind {
        mode: Mode::Practice,
        probed: true,
        graded: true,
    },
    Kind {
        mode: Mode::SelfAssessment,
        probed: false,
        graded: true,
    },
    Kind {
        mode: Mode::Exam,
        probed: true,
        graded: true,
    },
    Kind {
        mode: Mode::Practice,
        probed: false,
        graded: false,
    },
];

/// A session and its grade with `text` in all texts. `attempt` is a number from 1 that changes numbers and options.
pub fn session(text: &str, kind: Kind, attempt: usize) -> (Session, Graded) {
    let grade = grade::grade(text, kind, attempt);
    let mut proposal = Proposal::of(&grade);
    proposal.score = Some(12.3);
    let revision = |score: f64| Revision {
        score,
        passed: score > 50.0,
        by: text.into(),
        at: text.into(),
        reason: text.repeat(3),
    };
    let sidecar = Sidecar {
        proposal,
        self_score: Some(55.5),
        revisions: (1..=attempt).map(|k| revision(20.0 * k as f64)).collect(),
    };
    let session = Session {
        file: text.into(),
        grade: grade.clone(),
        sidecar: (attempt != 2).then_some(sidecar),
        self_score: (kind.mode == Mode::SelfAssessment).then_some(55.5),
        shown: Shown {
            mode: kind.mode,
            recorded: (attempt != 1).then_some(Mode::Practice),
        },
        attempt,
    };
    let graded = Graded {
        series: grade::series(kind.probed),
        teeth: vec![15, 16, 36, 37, 46],
        patient:
            "missing = [48, 26]\n[[tooth]]\nfdi = 36\nfurcation.buccal = 2\nfurcation.lingual = 3\n"
                .into(),
        leads: text.into(),
        seconds: 120.0,
        trauma_n: (attempt != 2).then_some(0.3),
        grade,
    };
    (session, graded)
}

/// A key table with `text` as the name of the learner `text`. Empty if a table cannot hold the text.
pub fn names(text: &str) -> Names {
    let quoted = text.replace('"', "\"\"");
    let table = format!("learner_id,name\n\"{quoted}\",\"{quoted}\"\n");
    Names::parse(table.as_bytes(), Path::new("names.csv")).unwrap_or_default()
}

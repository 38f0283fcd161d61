//! Class of all recordings of a command: each session once, a page for each session and a page for the class.

use std::collections::BTreeSet;
use std::path::Path;

use anyhow::Context as _;
use sulcus_program::{PathText, tell};

use super::args::{GradeArgs, Numbers};
use super::session::One;
use crate::cli::drawn;
use crate::grade::class::{Session, number_attempts};
use crate::grade::names::Names;
use crate::pages::{Look, Numbering, Pictures, class_page, student_page};

/// Sessions, each once. Of several copies the most complete one is kept.
pub(super) fn sessions(all: &[(String, One)]) -> Vec<Session> {
    let session = |(file, one): &(String, One)| Session {
        file: file.clone(),
        grade: one.graded.grade.clone(),
        sidecar: one.sidecar.clone(),
        self_score: one.self_score,
        shown: one.shown,
        attempt: 0,
    };
    let mut once: Vec<Session> = Vec::new();
    for session in all.iter().map(session) {
        let Some(other) = once.iter_mut().find(|other| other.is(&session)) else {
            once.push(session);
            continue;
        };
        let left = if session.says() > other.says() {
            std::mem::replace(other, session)
        } else {
            session
        };
        let differ = match (&left.sidecar, &other.sidecar) {
            (Some(left), kept) if Some(left) != kept.as_ref() => {
                "; the scores of people beside this copy do not count"
            }
            _ => "",
        };
        tell!(
            "{}: same session as {}, counted once{differ}",
            left.file,
            other.file
        );
    }
    number_attempts(&mut once);
    once
}

/// Warns of learners without a name in the key table.
pub(super) fn warn_of_unnamed(sessions: &[Session], names: &Names) {
    let ids: BTreeSet<&str> = sessions
        .iter()
        .map(|session| session.grade.learner_id.as_str())
        .filter(|id| !id.is_empty() && names.of(id).is_none_or(str::is_empty))
        .collect();
    for id in ids {
        tell!(
            "warning: the key table has no name for `{}`",
            id.escape_debug()
        );
    }
}

/// Name of a page without its ending. If the file's name needs quoting ([`PathText::shown`]), the page's name has its
/// letters and digits, and dashes.
fn page_name(file: &str) -> String {
    let Some(quoted) = file.strip_prefix("$'") else {
        return file.to_owned();
    };
    let plain = |c: char| {
        if c.is_alphanumeric() || c == '.' {
            c
        } else {
            '-'
        }
    };
    let name: String = quoted.trim_end_matches('\'').chars().map(plain).collect();
    name.strip_suffix(".mcap").unwrap_or(&name).to_owned()
}

/// Writes the pages.
///
/// # Errors
/// A page cannot be written.
pub(super) fn pages(
    folder: &Path,
    all: &[(String, One)],
    (sessions, unread): (&[Session], &[(String, String)]),
    names: Option<&Names>,
    args: &GradeArgs,
) -> anyhow::Result<()> {
    std::fs::create_dir_all(folder)
        .with_context(|| format!("cannot make the folder `{}`", folder.shown()))?;
    let look = Look {
        names,
        numbering: match args.numbering {
            Numbers::Fdi => Numbering::Fdi,
            Numbers::Universal => Numbering::Universal,
        },
        truth: args.truth,
    };
    let mut used = BTreeSet::from(["class".to_owned()]);
    let write = |name: &str, page: String| {
        let path = folder.join(format!("{name}.html"));
        std::fs::write(&path, page).with_context(|| format!("cannot write `{}`", path.shown()))
    };
    for session in sessions {
        let own = |(file, one): &&(String, One)| {
            *file == session.file && one.graded.grade == session.grade
        };
        let Some((file, one)) = all.iter().find(own) else {
            continue;
        };
        let stem = page_name(file.strip_suffix(".mcap").unwrap_or(file));
        let mut name = stem.clone();
        let mut k = 2;
        while !used.insert(name.clone()) {
            name = format!("{stem}-{k}");
            k += 1;
        }
        let wanted = args.pictures && !session.is_exam();
        let pictures = wanted.then(|| drawn::findings(&one.path, &one.graded));
        if let Some(Pictures::Missing(why)) = &pictures {
            tell!("warning: {file}: no pictures: {why}");
        }
        write(
            &name,
            student_page(session, &one.graded, &look, pictures.as_ref()),
        )?;
    }
    write("class", class_page(sessions, unread, &look))?;
    tell!("pages in {}", folder.shown());
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_page_is_named_after_its_recording() {
        assert_eq!(page_name("Übung 1"), "Übung 1");
        assert_eq!(page_name(r"$'r\351sum\351.mcap'"), "r-351sum-351");
    }
}

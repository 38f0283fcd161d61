//! `grade`: grades of recorded sessions from their replay.

mod args;
mod class;
mod say;
mod session;
mod sessions;

use std::path::{Path, PathBuf};
use std::process::ExitCode;

use anyhow::{Context as _, bail};
use serde_json::{Value, json};
use sulcus_program::{PathText, say};

use super::inputs::recordings;
use super::print::complain;
use super::written::may_write;
use crate::grade::class::csv;
use crate::grade::names::Names;
use crate::grade::revision::beside;

pub(super) use args::{EXAMPLES, GradeArgs, LONG_ABOUT};

use args::file_name;
use session::{Asked, one};

pub(super) fn run(args: &GradeArgs) -> anyhow::Result<ExitCode> {
    let asked = Asked::of(args)?;
    let names = args.names.as_deref().map(Names::open).transpose()?;
    let files = recordings(&args.files);
    let found = sessions::sessions(&files);
    if args.self_score.is_some() && found.len() > 1 {
        bail!("--self-score takes one recording, found {}", found.len());
    }
    if args.revise.is_some() && found.len() > 1 {
        bail!("--revise takes one recording, found {}", found.len());
    }
    if let Some(table) = &args.csv {
        let others = [&args.names, &args.rubric, &args.signer]
            .into_iter()
            .flatten();
        let beside: Vec<PathBuf> = files.iter().map(|file| beside(file)).collect();
        let mut read: Vec<&Path> = others.map(PathBuf::as_path).collect();
        read.extend(files.iter().chain(&beside).map(PathBuf::as_path));
        may_write("--csv", table, read)?;
    }
    let (mut code, mut objects, mut all) = (0u8, Vec::new(), Vec::new());
    let mut unread: Vec<(String, String)> = Vec::new();
    for session in &found {
        let path = session.last.as_path();
        match one(session, args, &asked) {
            Ok(one) => {
                code = code.max(u8::from(one.graded.grade.score.is_none()));
                if !args.json {
                    say!("{}", say::text(path, &one, args));
                }
                objects.push(say::json(path, &one));
                if let Some(error) = &one.unkept {
                    code = 2;
                    complain(error);
                }
                all.push((file_name(path), one));
            }
            Err(error) => {
                code = 2;
                complain(&error);
                let why = crate::sentence(&error);
                objects.push(json!({ "file": file_name(path), "error": why }));
                unread.push((file_name(path), why));
            }
        }
    }
    let sessions = class::sessions(&all);
    if let Some(names) = &names {
        class::warn_of_unnamed(&sessions, names);
    }
    let table = args.csv.as_deref().map(|path| {
        let table = csv(&sessions, &unread, names.as_ref())?;
        std::fs::write(path, table).with_context(|| format!("cannot write `{}`", path.shown()))
    });
    let html = args.html.as_deref();
    let pages =
        html.map(|folder| class::pages(folder, &all, (&sessions, &unread), names.as_ref(), args));
    // A table or page that cannot be written does not prevent the others.
    for error in [table, pages].into_iter().flatten().filter_map(Result::err) {
        code = 2;
        complain(&error);
    }
    if args.json {
        let object = match <[Value; 1]>::try_from(objects) {
            Ok([only]) => only,
            Err(objects) => json!({ "sessions": objects.len(), "files": objects }),
        };
        say!("{object}");
    }
    Ok(ExitCode::from(code))
}

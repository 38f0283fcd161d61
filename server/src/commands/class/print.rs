//! Output of `sulcus-server class`.

use serde_json::{Value, json};
use sulcus_program::{say, tell};
use sulcus_sessions::export::cells;

use crate::state::classes::archive::kept_words;
use crate::state::classes::change::Made;
use crate::state::classes::{Archived, Book, Class, Task, codes, plain};
use crate::state::date::{minute, now_s};

fn words(task: Option<&Task>) -> String {
    task.map_or("each station's own".into(), |task| task.wanted().words())
}

fn task_json(task: Option<&Task>) -> Value {
    task.map_or(Value::Null, |task| {
        json!({
            "exercise": task.exercise, "case": task.case, "mode": task.mode.name(),
            "time_limit_s": task.time_limit_s, "exam": task.exam,
        })
    })
}

fn archived_json(class: &Archived) -> Value {
    json!({
        "id": class.id, "name": class.name, "learners": class.learners.len(),
        "archived_unix_s": class.archived_unix_s, "keep_recordings_days": class.keep_recordings_days,
    })
}

fn class_json(book: &Book, class: &Class) -> Value {
    json!({
        "id": class.id, "name": class.name, "learners": book.roll.of_class(&class.id).count(),
        "plan": task_json(class.task.as_ref()), "keep_recordings_days": class.keep_recordings_days,
    })
}

/// All classes.
pub(super) fn list(book: &Book, json: bool) {
    if json {
        let all = book
            .roll
            .classes
            .iter()
            .map(|class| class_json(book, class));
        let archived: Vec<Value> = book.roll.archived.iter().map(archived_json).collect();
        say!(
            "{}",
            json!({ "classes": all.collect::<Vec<Value>>(), "archived": archived })
        );
        return;
    }
    if book.roll.classes.is_empty() {
        tell!("no classes; `sulcus-server class import` makes them from a table");
    } else {
        say!("{:6} {:32} {:>8} plan", "id", "name", "learners");
    }
    for class in &book.roll.classes {
        let count = book.roll.of_class(&class.id).count();
        let (name, task) = (plain(&class.name), words(class.task.as_ref()));
        let limit = limit(class.keep_recordings_days);
        say!("{:6} {name:32} {count:8} {task}{limit}", class.id);
    }
    for class in &book.roll.archived {
        let (name, count) = (plain(&class.label()), class.learners.len());
        let limit = limit(class.keep_recordings_days);
        say!("{:6} {name:32} {count:8} archived{limit}", class.id);
    }
}

/// Limit of the recordings as the end of a line; nothing for recordings that are kept forever.
fn limit(days: Option<u32>) -> String {
    days.map_or(String::new(), |_| {
        format!(", recordings kept for {}", kept_words(days))
    })
}

/// A class with its learners.
pub(super) fn class(book: &Book, class: &Class, json: bool) {
    let now = now_s();
    let until = |learner: &crate::state::classes::Learner| {
        let code = learner.code.as_ref().filter(|code| now < code.until_unix_s);
        code.map(|code| code.until_unix_s)
    };
    let station = |id: &str| {
        let seat = book.roll.seats.iter().find(|seat| seat.learner == id);
        seat.map(|seat| seat.station.clone())
    };
    if json {
        let learner = |learner: &crate::state::classes::Learner| {
            json!({
                "id": learner.id, "name": book.names.name_of(&learner.id),
                "plan": task_json(learner.task.as_ref()),
                "code_until_unix_s": until(learner), "station": station(&learner.id),
            })
        };
        let learners: Vec<Value> = book.roll.of_class(&class.id).map(learner).collect();
        let mut object = class_json(book, class);
        object["learners"] = json!(learners);
        say!("{object}");
        return;
    }
    say!(
        "{} {}: plan {}",
        class.id,
        plain(&class.name),
        words(class.task.as_ref())
    );
    for learner in book.roll.of_class(&class.id) {
        let name = book.names.name_of(&learner.id).unwrap_or_default();
        let mut text = format!("  {:12} {}", learner.id, plain(&name));
        if learner.task.is_some() {
            text.push_str(&format!(", own plan {}", words(learner.task.as_ref())));
        }
        if let Some(until) = until(learner) {
            text.push_str(&format!(", code until {}", minute(until)));
        }
        if let Some(station) = station(&learner.id) {
            text.push_str(&format!(", at {station}"));
        }
        say!("{text}");
    }
    if !book.names.is_open {
        tell!("the key table names.json is not in the state folder: ids alone");
    }
}

/// Table of ids and names of a class.
pub(super) fn names(book: &Book, class: &Class) -> String {
    let quoted = |text: &str| format!("\"{}\"", cells::text(text).replace('"', "\"\""));
    let mut table = String::from("learner_id,name\r\n");
    for learner in book.roll.of_class(&class.id) {
        if let Some(name) = book.names.name_of(&learner.id) {
            table.push_str(&format!("{},{}\r\n", quoted(&learner.id), quoted(&name)));
        }
    }
    table
}

/// Codes, shown once.
pub(super) fn cards(book: &Book, made: &[Made], json: bool) {
    if json {
        let card = |made: &Made| json!({ "learner": made.learner, "name": book.names.name_of(&made.learner), "code": made.code });
        say!(
            "{}",
            json!({ "codes": made.iter().map(card).collect::<Vec<Value>>() })
        );
        return;
    }
    tell!("codes, shown once:");
    for made in made {
        let name = book.names.name_of(&made.learner).unwrap_or_default();
        say!(
            "{}  {:12} {}",
            codes::shown(&made.code),
            made.learner,
            plain(&name)
        );
    }
}

/// All exams, newest first.
pub(super) fn exams(book: &Book, now_s: u64, json: bool) {
    if json {
        say!("{}", json!({ "exams": book.roll.exams }));
        return;
    }
    if book.roll.exams.is_empty() {
        tell!(
            "no exams; `sulcus-server class assign CLASS --exercise NAME --mode exam` begins one"
        );
        return;
    }
    for exam in book.roll.exams.iter().rev() {
        let of = book.roll.class_label(&exam.of).unwrap_or(exam.of.clone());
        let end = exam
            .ended_unix_s
            .map_or("goes on".into(), |end| format!("to {}", minute(end)));
        let seal = match (&exam.released, exam.sealed_until_unix_s) {
            (Some(released), _) => format!("released on {}", minute(released.unix_s)),
            (None, None) => "sealed until the release".into(),
            (None, Some(until)) if now_s < until => format!("sealed until {}", minute(until)),
            (None, Some(_)) => "open to instructors, sealed for learners".into(),
        };
        let begun = minute(exam.begun_unix_s);
        say!(
            "{:6} {}: {}, from {begun}, {end}; {seal}",
            exam.id,
            plain(&of),
            exam.title
        );
    }
}

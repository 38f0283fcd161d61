//! Tasks of classes and learners: forms, words.

use axum::Extension;
use axum::extract::{Path, State};
use axum::response::Response;
use serde::Deserialize;

use super::ask::{Sent, change, may_set_exams, to, to_class, values};
use super::classes;
use crate::App;
use crate::guard::Caller;
use crate::house::register::{Change, Denied, Target, Task};

/// Exercise of a case for which none is chosen.
const EXERCISE_OF_A_CASE: &str = "probing";
/// Largest time limit of the form, minutes: a day.
const MOST_MINUTES: u32 = 1440;

/// Form of a task.
#[derive(Deserialize)]
pub(super) struct TaskForm {
    /// `exercise:NAME`, `case:NAME`, or empty for no task.
    #[serde(default)]
    task: String,
    /// Exercise of a case; empty: the usual one.
    #[serde(default)]
    exercise: String,
    /// Purpose; empty: practice.
    #[serde(default)]
    mode: String,
    /// Time limit, minutes; empty: none.
    #[serde(default)]
    minutes: String,
    /// Page to which the browser returns: `list` or the class.
    #[serde(default)]
    from: String,
}

impl TaskForm {
    /// Task of the form; `None`: no task of one's own.
    fn task(&self) -> Result<Option<Task>, Denied> {
        let wrong = |text: String| Err(Denied::Invalid(text));
        let (exercise, case) = match self.task.split_once(':') {
            None if self.task.is_empty() => return Ok(None),
            Some(("exercise", name)) => (name, ""),
            Some(("case", name)) if self.exercise.is_empty() => (EXERCISE_OF_A_CASE, name),
            Some(("case", name)) => (self.exercise.as_str(), name),
            _ => {
                let found: String = self.task.escape_debug().take(80).collect();
                return wrong(format!(
                    "task is `{found}`, expected an exercise or a case of the list"
                ));
            }
        };
        let minutes = self.minutes.trim();
        let time_limit_s = match minutes.parse::<u32>() {
            _ if minutes.is_empty() => None,
            Ok(count) if (1..=MOST_MINUTES).contains(&count) => Some(count * 60),
            _ => {
                let found: String = minutes.escape_debug().take(20).collect();
                return wrong(format!(
                    "the time limit is `{found}`, expected 1 to {MOST_MINUTES} minutes, or nothing"
                ));
            }
        };
        let mode = match self.mode.as_str() {
            "" => "practice",
            mode => mode,
        };
        Ok(Some(Task {
            exercise: exercise.to_owned(),
            case: case.to_owned(),
            mode: mode.to_owned(),
            time_limit_s,
        }))
    }
}

impl Task {
    /// The task for people.
    pub(super) fn words(&self) -> String {
        let mut text = match self.case.as_str() {
            "" => self.exercise.clone(),
            case => format!("case {case} ({})", self.exercise),
        };
        text.push_str(&format!(", {}", self.mode));
        if let Some(limit) = self.time_limit_s {
            let (minutes, seconds) = (limit / 60, limit % 60);
            text.push_str(&match seconds {
                0 => format!(", {minutes} min"),
                _ => format!(", {limit} s"),
            });
        }
        text
    }
}

/// Words of a task for a signed-in person, or empty. The content of an exam is not for persons who may set none.
pub(super) fn words(caller: &Caller, task: Option<&Task>) -> String {
    match task {
        None => String::new(),
        Some(task) if task.mode == "exam" && !may_set_exams(caller) => "exam, sealed".into(),
        Some(task) => task.words(),
    }
}

/// `POST /classes/{class}/plan`: gives a class a task.
pub(super) async fn of_class(
    State(app): State<App>,
    Extension(caller): Extension<Caller>,
    Path(class): Path<String>,
    form: Sent<TaskForm>,
) -> Response {
    give(app, caller, Target::Class(class.clone()), class, form).await
}

/// `POST /classes/{class}/learners/{learner}/plan`: gives one learner a task.
pub(super) async fn of_learner(
    State(app): State<App>,
    Extension(caller): Extension<Caller>,
    Path((class, learner)): Path<(String, String)>,
    form: Sent<TaskForm>,
) -> Response {
    give(app, caller, Target::Learner(learner), class, form).await
}

async fn give(
    app: App,
    caller: Caller,
    target: Target,
    class: String,
    form: Sent<TaskForm>,
) -> Response {
    let form = match values(form) {
        Ok(form) => form,
        Err(page) => return *page,
    };
    let done = match form.task() {
        Ok(task) => change(&app, &caller, Change::Assign { target, task }).await,
        Err(why) => Err(why),
    };
    match done {
        Ok(_) if form.from == "list" => to("/classes"),
        Ok(_) => to_class(&class),
        Err(why) if form.from == "list" => classes::list_with(&app, &caller, Some(why)).await,
        Err(why) => classes::class_with(&app, &caller, class, Some(why)).await,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn form(task: &str, exercise: &str, minutes: &str) -> Result<Option<Task>, Denied> {
        let form = TaskForm {
            task: task.into(),
            exercise: exercise.into(),
            mode: String::new(),
            minutes: minutes.into(),
            from: String::new(),
        };
        form.task()
    }

    #[test]
    fn a_choice_becomes_a_task() {
        let words_of = |task: &str, exercise: &str, minutes: &str| {
            let task = form(task, exercise, minutes).expect(task);
            task.map_or_else(String::new, |task| task.words())
        };
        assert_eq!(words_of("", "", ""), "");
        assert_eq!(words_of("exercise:crown", "probing", ""), "crown, practice");
        assert_eq!(
            words_of("case:3", "", " 30 "),
            "case 3 (probing), practice, 30 min"
        );
        assert_eq!(words_of("case:3", "free", ""), "case 3 (free), practice");
        for (task, minutes) in [
            ("crown", ""),
            ("scene:x", ""),
            ("case:3", "0"),
            ("case:3", "1e3"),
        ] {
            assert!(
                matches!(form(task, "", minutes), Err(Denied::Invalid(_))),
                "{task} {minutes}"
            );
        }
    }
}

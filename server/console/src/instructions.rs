//! `POST /api/stations/{station}/instruct`: instructions of a page or a script, each carried out once.

use std::collections::VecDeque;
use std::sync::{Mutex, PoisonError};

use axum::extract::rejection::JsonRejection;
use axum::extract::{Path, State};
use axum::http::StatusCode;
use axum::response::{IntoResponse, Response};
use axum::{Extension, Json};
use serde::Deserialize;
use serde_json::{Value, json};
use sulcus_proto::ClientMessage;
use sulcus_proto::control::{Answer, Instruct, Instruction};
use sulcus_proto::limits::TEXT_BYTES;
use sulcus_proto::permission::{Kind, kind, may};
use tokio::sync::watch;

use crate::App;
use crate::guard::{Caller, no_station, refused};
use crate::house::Instructed;
use crate::routes::Form;

/// Names of the instructions.
const NAMES: &str = "pause, resume, limit, note, flag, say, show_ghost, hide_ghost, end or plan";
/// Longest key of a click, bytes.
const KEY_BYTES: usize = 64;
/// Number of last answers that are kept.
const KEPT: usize = 512;

/// Body of a request.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Asked {
    /// Key of the click. A second request with the key of a first one gets the answer of the first.
    #[serde(default)]
    key: String,
    /// Instruction: one of [`NAMES`].
    r#do: String,
    /// Force limit, newtons; 0: the limit of the scene.
    newtons: Option<f32>,
    /// Text of a note, a flag, a message or a plan; recording of a ghost, without one the newest norm of the exercise.
    text: Option<String>,
}

impl Asked {
    /// Instruction of the body.
    ///
    /// # Errors
    /// Sentence with the field, the value found and the values expected.
    fn instruction(&self) -> Result<Instruction, String> {
        let (newtons, text) = (self.newtons, self.text.as_deref());
        let takes = match self.r#do.as_str() {
            "pause" | "resume" | "hide_ghost" | "end" => [false, false],
            "limit" => [true, false],
            "note" | "flag" | "say" | "show_ghost" | "plan" => [false, true],
            other => {
                let shown: String = other.escape_debug().take(40).collect();
                return Err(format!("do is `{shown}`, expected {NAMES}"));
            }
        };
        let found = [newtons.is_some(), text.is_some()];
        for (k, name) in ["newtons", "text"].into_iter().enumerate() {
            if found[k] && !takes[k] {
                return Err(format!("{name} is given, `{}` takes none", self.r#do));
            }
        }
        if let Some(text) = text
            && text.len() > TEXT_BYTES
        {
            return Err(format!(
                "text has {} bytes, expected at most {TEXT_BYTES}",
                text.len()
            ));
        }
        let some = || match text.map(str::trim) {
            Some(text) if !text.is_empty() => Ok(text.to_owned()),
            _ => Err(format!("text is missing, `{}` needs it", self.r#do)),
        };
        Ok(match self.r#do.as_str() {
            "pause" => Instruction::Pause,
            "resume" => Instruction::Resume,
            "limit" => match newtons {
                Some(force) if force.is_finite() && force >= 0.0 => Instruction::ForceLimit(force),
                Some(force) => {
                    return Err(format!(
                        "newtons is {force}, expected 0 or a positive force"
                    ));
                }
                None => return Err("newtons is missing, `limit` needs it".into()),
            },
            "note" => Instruction::Note(some()?),
            "flag" => Instruction::Flag(text.unwrap_or_default().trim().to_owned()),
            "say" => Instruction::Say(some()?),
            "plan" => Instruction::Plan(some()?),
            "show_ghost" => Instruction::Ghost(text.unwrap_or_default().trim().to_owned()),
            "hide_ghost" => Instruction::Ghost(String::new()),
            _ => Instruction::End,
        })
    }
}

type Kept = watch::Receiver<Option<Answer>>;

/// Answers to the last instructions, by person and key.
#[derive(Default)]
pub struct Answers(Mutex<VecDeque<([String; 3], Kept)>>);

impl Answers {
    /// Answer to an instruction with a key: that of the first request with the key. `carry_out` is called for the first
    /// one alone, and goes on even if its request ends.
    async fn once(
        &self,
        key: [String; 3],
        carry_out: impl FnOnce() -> crate::house::Answering,
    ) -> Option<Answer> {
        let mut answer = {
            let mut kept = self.0.lock().unwrap_or_else(PoisonError::into_inner);
            let found = kept.iter().find(|(other, _)| *other == key);
            let is_named = key.last().is_some_and(|key| !key.is_empty());
            match found.filter(|_| is_named) {
                Some((_, answer)) => answer.clone(),
                None => {
                    let (send, answer) = watch::channel(None);
                    let answering = carry_out();
                    tokio::spawn(async move {
                        let _ = send.send(Some(answering.await));
                    });
                    if kept.len() == KEPT {
                        kept.pop_front();
                    }
                    kept.push_back((key, answer.clone()));
                    answer
                }
            }
        };
        let found = answer.wait_for(Option::is_some).await;
        found.ok().and_then(|answer| answer.clone())
    }
}

/// Carries out an instruction and answers with the first tick that obeys it.
pub async fn instruct(
    State(app): State<App>,
    Extension(caller): Extension<Caller>,
    Path(station): Path<String>,
    body: Result<Json<Asked>, JsonRejection>,
) -> Response {
    let bad = |why: &str| refused(Form::Data, StatusCode::BAD_REQUEST, why);
    let asked = match body {
        Ok(Json(asked)) => asked,
        Err(why) => return bad(&format!("the body is no instruction: {}", why.body_text())),
    };
    if asked.key.len() > KEY_BYTES {
        return bad(&format!(
            "key has {} bytes, expected at most {KEY_BYTES}",
            asked.key.len()
        ));
    }
    let mut instruction = match asked.instruction() {
        Ok(instruction) => instruction,
        Err(why) => return bad(&why),
    };
    if let Instruction::Ghost(file) = &mut instruction
        && file.is_empty()
        && asked.r#do == "show_ghost"
    {
        if let Some(refusal) = no_station(&app, &caller, &station, Form::Data) {
            return refusal;
        }
        match norm_of(&app, &station) {
            Ok(norm) => *file = norm,
            Err(why) => return refused(Form::Data, StatusCode::CONFLICT, &why),
        }
    }
    carry_out(&app, caller, station, instruction, asked.key).await
}

/// File of the newest norm of the exercise at a station.
fn norm_of(app: &App, station: &str) -> Result<String, String> {
    let stations = app.house.stations();
    let found = stations.iter().find(|one| *one.name == *station);
    let exercise = found.map_or(String::new(), |one| one.status.borrow().exercise.clone());
    let all = app.house.grades().all();
    let norm = all
        .iter()
        .find(|one| one.is_norm && one.exercise == exercise && !one.is_exam());
    norm.map(|norm| format!("{}.mcap", norm.id)).ok_or_else(|| {
        format!("no session of the exercise `{exercise}` is a norm: make an expert's session a norm on its page first")
    })
}

/// Carries out an instruction of a signed-in person, if the person may give it, and answers with the first tick that
/// obeys it. A second request with a key that is not empty gets the answer of the first.
pub(crate) async fn carry_out(
    app: &App,
    caller: Caller,
    station: String,
    instruction: Instruction,
    key: String,
) -> Response {
    if let Some(refusal) = no_station(app, &caller, &station, Form::Data) {
        return refusal;
    }
    let message = ClientMessage::Instruct(Instruct {
        number: 0,
        station: station.clone(),
        instruction: instruction.clone(),
    });
    let role = caller.holder.role;
    if !kind(&message).is_some_and(|kind| may(role, kind, true)) {
        let why = format!("the role {role} may not give this instruction");
        return refused(Form::Data, StatusCode::FORBIDDEN, &why);
    }
    let instructed = Instructed {
        station: station.clone(),
        by: caller.holder.id.clone(),
        instruction,
        exams: may(role, Kind::ExamPlan, true),
    };
    let key = [caller.holder.id, station, key];
    let house = app.house.clone();
    let answer = app
        .answers
        .once(key, move || house.instruct(instructed))
        .await;
    match answer {
        Some(Answer {
            taken, tick, text, ..
        }) => {
            let status = if taken {
                StatusCode::OK
            } else {
                StatusCode::CONFLICT
            };
            let body: Value = json!({ "taken": taken, "tick": tick, "text": text });
            (status, Json(body)).into_response()
        }
        None => refused(
            Form::Data,
            StatusCode::SERVICE_UNAVAILABLE,
            "the station is ending",
        ),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn asked(body: &str) -> Result<Instruction, String> {
        let asked: Asked = serde_json::from_str(body).map_err(|error| error.to_string())?;
        asked.instruction()
    }

    #[test]
    fn each_instruction_is_read_with_what_it_takes_and_nothing_else() {
        assert_eq!(asked(r#"{"do":"pause"}"#), Ok(Instruction::Pause));
        assert_eq!(
            asked(r#"{"do":"limit","newtons":0.5}"#),
            Ok(Instruction::ForceLimit(0.5))
        );
        assert_eq!(
            asked(r#"{"do":"flag"}"#),
            Ok(Instruction::Flag(String::new()))
        );
        assert_eq!(
            asked(r#"{"do":"say","text":" slowly "}"#),
            Ok(Instruction::Say("slowly".into()))
        );
        for (body, named) in [
            (r#"{"do":"stop"}"#, "do is `stop`"),
            (r#"{"do":"pause","text":"x"}"#, "text is given"),
            (r#"{"do":"note","text":"  "}"#, "text is missing"),
            (r#"{"do":"limit"}"#, "newtons is missing"),
            (r#"{"do":"limit","newtons":-1}"#, "newtons is -1"),
            (r#"{"do":"pause","when":3}"#, "unknown field"),
            (r#"{}"#, "missing field `do`"),
        ] {
            let told = asked(body).expect_err(body);
            assert!(told.contains(named), "{body}: {told}");
        }
        let long = format!(r#"{{"do":"note","text":"{}"}}"#, "x".repeat(TEXT_BYTES + 1));
        assert!(asked(&long).expect_err("long").contains("expected at most"));
    }

    #[test]
    fn a_second_click_with_the_same_key_is_not_carried_out_again() {
        let runtime = tokio::runtime::Builder::new_current_thread()
            .build()
            .expect("a runtime");
        runtime.block_on(async {
            let answers = Answers::default();
            let count = std::cell::Cell::new(0);
            let ask = |key: &str| {
                let key = ["t-1".to_owned(), "a".to_owned(), key.to_owned()];
                answers.once(key, || {
                    count.set(count.get() + 1);
                    let tick = count.get();
                    Box::pin(async move {
                        Answer {
                            number: 0,
                            taken: true,
                            tick,
                            text: String::new(),
                        }
                    })
                })
            };
            let ticks = [
                ask("k").await,
                ask("k").await,
                ask("l").await,
                ask("").await,
                ask("").await,
            ];
            let ticks = ticks.map(|answer| answer.expect("answered").tick);
            assert_eq!(ticks, [1, 1, 2, 3, 4]);
        });
    }
}

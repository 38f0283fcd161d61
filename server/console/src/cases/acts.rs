//! Acts on cases: new, check, save, compile, remove, use at a station.

use axum::body::Bytes;
use axum::extract::{Path, State};
use axum::response::{IntoResponse, Response};
use axum::{Extension, Json};
use serde_json::json;
use sulcus_proto::control::Instruction;

use super::parse::{Fields, Problem, json as value_of};
use super::{bad, beside, refusal};
use crate::App;
use crate::guard::Caller;
use crate::house::cases::{Chart, Origin};
use crate::instructions::carry_out;

/// Longest name in a request, bytes.
const NAME: usize = 64;
/// Digits of the largest seed.
const SEED_DIGITS: usize = 20;

/// Body of a new case: `{"name": …}` with `"condition"` and `"seed"`, or with `"copy_of"`.
fn new_case(bytes: &[u8]) -> Result<(String, Origin), Problem> {
    let value = value_of(bytes)?;
    let known = ["name", "condition", "seed", "copy_of"];
    let fields = Fields::of("body", Some(&value), &known)?;
    let name = fields.text("name", NAME)?.to_owned();
    if fields.any("copy_of").is_some() {
        for other in ["condition", "seed"] {
            if fields.any(other).is_some() {
                return Err(Problem::new(other, "given", "none with copy_of"));
            }
        }
        return Ok((name, Origin::Copy(fields.text("copy_of", NAME)?.to_owned())));
    }
    let condition = fields.text("condition", NAME)?.to_owned();
    // A script's numbers are exact up to 2^53; a text has all 64 bits.
    let seed = match fields.any("seed") {
        Some(serde_json::Value::String(_)) => {
            let text = fields.text("seed", SEED_DIGITS)?;
            let is_digits = !text.is_empty() && text.bytes().all(|c| c.is_ascii_digit());
            let seed = text.parse().ok().filter(|_| is_digits);
            seed.ok_or_else(|| {
                let found = format!("`{}`", text.escape_debug());
                Problem::new("seed", &found, "a whole number from 0 to 2^64 - 1")
            })?
        }
        _ => fields.whole("seed", u64::MAX)?,
    };
    Ok((name, Origin::Generated { condition, seed }))
}

/// `POST /api/cases`: a new case.
pub(super) async fn create(
    State(app): State<App>,
    Extension(caller): Extension<Caller>,
    body: Bytes,
) -> Response {
    let (name, origin) = match new_case(&body) {
        Ok(new) => new,
        Err(problem) => return bad(&problem),
    };
    let (case, by) = (name.clone(), caller.holder.id);
    match beside(&app, move |cases| cases.create(&case, &origin, &by)).await {
        Ok(()) => Json(json!({ "name": name })).into_response(),
        Err(why) => refusal(&why),
    }
}

/// `POST /api/cases-check`: faults of a chart.
pub(super) async fn check(State(app): State<App>, body: Bytes) -> Response {
    let chart = match Chart::parse(&body) {
        Ok(chart) => chart,
        Err(problem) => return bad(&problem),
    };
    match beside(&app, move |cases| Ok(cases.check(&chart))).await {
        Ok(faults) => Json(json!({ "faults": faults })).into_response(),
        Err(why) => refusal(&why),
    }
}

/// `POST /api/cases/{case}`: saves `{"version": …, "chart": …}`. Another version means that another person saved.
pub(super) async fn save(
    State(app): State<App>,
    Extension(caller): Extension<Caller>,
    Path(case): Path<String>,
    body: Bytes,
) -> Response {
    let read = || {
        let value = value_of(&body)?;
        let fields = Fields::of("body", Some(&value), &["version", "chart"])?;
        let version = fields.text("version", 128)?.to_owned();
        Ok((version, Chart::of(fields.any("chart"))?))
    };
    let (version, chart) = match read() {
        Ok(asked) => asked,
        Err(problem) => return bad(&problem),
    };
    let by = caller.holder.id;
    match beside(&app, move |cases| cases.save(&case, &version, &chart, &by)).await {
        Ok(loaded) => Json(json!({ "case": loaded })).into_response(),
        Err(why) => refusal(&why),
    }
}

/// `POST /api/cases/{case}/compile`: adds the case to the compilations.
pub(super) async fn compile(
    State(app): State<App>,
    Extension(caller): Extension<Caller>,
    Path(case): Path<String>,
) -> Response {
    let by = caller.holder.id;
    let added = beside(&app, move |cases| {
        cases.compile(&case, &by)?;
        Ok(cases.work())
    });
    match added.await {
        Ok(work) => Json(work).into_response(),
        Err(why) => refusal(&why),
    }
}

/// `POST /api/cases/{case}/cancel`: stops the compilation.
pub(super) async fn cancel(
    State(app): State<App>,
    Extension(caller): Extension<Caller>,
    Path(case): Path<String>,
) -> Response {
    let by = caller.holder.id;
    let stopped = beside(&app, move |cases| {
        cases.cancel(&case, &by);
        Ok(cases.work())
    });
    match stopped.await {
        Ok(work) => Json(work).into_response(),
        Err(why) => refusal(&why),
    }
}

/// `POST /api/cases/{case}/remove`: removes the case, unless a plan uses the case.
pub(super) async fn remove(
    State(app): State<App>,
    Extension(caller): Extension<Caller>,
    Path(case): Path<String>,
) -> Response {
    let (name, by) = (case.clone(), caller.holder.id);
    match beside(&app, move |cases| cases.remove(&name, &by)).await {
        Ok(()) => Json(json!({ "removed": case })).into_response(),
        Err(why) => refusal(&why),
    }
}

/// `POST /api/cases/{case}/use`: sets the plan of a station, `{"station": …, "exercise": …, "key": …}`.
pub(super) async fn plan(
    State(app): State<App>,
    Extension(caller): Extension<Caller>,
    Path(case): Path<String>,
    body: Bytes,
) -> Response {
    let read = || {
        let value = value_of(&body)?;
        let fields = Fields::of("body", Some(&value), &["station", "exercise", "key"])?;
        let text = |key| fields.text(key, NAME).map(str::to_owned);
        let key = match fields.any("key") {
            Some(_) => text("key")?,
            None => String::new(),
        };
        Ok((text("station")?, text("exercise")?, key))
    };
    let (station, exercise, key) = match read() {
        Ok(asked) => asked,
        Err(problem) => return bad(&problem),
    };
    let text = match beside(&app, move |cases| cases.plan(&case, &exercise)).await {
        Ok(text) => text,
        Err(why) => return refusal(&why),
    };
    carry_out(&app, caller, station, Instruction::Plan(text), key).await
}

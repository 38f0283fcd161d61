//! Page of the seats: which learner sits at which station, and sessions of another learner than the recording says.

use askama::Template;
use axum::Extension;
use axum::extract::rejection::QueryRejection;
use axum::extract::{Query, State};
use axum::response::Response;
use serde::Deserialize;
use sulcus_proto::Role;
use sulcus_proto::control::Instruction;
use sulcus_proto::station::Phase;

use super::ask::{Sent, ask, change, may_set_exams, record, to, values};
use super::classes::answer;
use crate::App;
use crate::guard::{Caller, no_station};
use crate::house::Instructed;
use crate::house::register::{Change, Denied, Learner, Reassigned, Seat};
use crate::pages::html;
use crate::routes::Form;

/// Number of former entries on the page.
const SHOWN: usize = 50;

/// A station on the page.
struct Place {
    name: String,
    /// Words for the session that runs; empty: none.
    session: String,
    /// File name of the running recording; empty: none.
    recording: String,
    /// Learner for the next session; `None`: nobody was seated.
    seat: Option<Seat>,
}

/// Learners of a class, for a list to choose from.
struct Group {
    class: String,
    learners: Vec<Learner>,
}

#[derive(Template)]
#[template(path = "seats.html")]
struct SeatsPage<'a> {
    role: &'a str,
    id: &'a str,
    is_admin: bool,
    why: &'a str,
    places: &'a [Place],
    groups: &'a [Group],
    /// Learner that is chosen already; empty: none.
    chosen: &'a str,
    /// Recording that is chosen already; empty: none.
    recording: &'a str,
    reassigned: &'a [Reassigned],
}

/// Choices of a link to the page.
#[derive(Default, Deserialize)]
pub(super) struct Chosen {
    #[serde(default)]
    learner: String,
    #[serde(default)]
    recording: String,
}

/// `GET /seats`.
pub(super) async fn page(
    State(app): State<App>,
    Extension(caller): Extension<Caller>,
    chosen: Result<Query<Chosen>, QueryRejection>,
) -> Response {
    let chosen = chosen.map(|Query(chosen)| chosen).unwrap_or_default();
    shown(&app, &caller, &chosen, None).await
}

async fn shown(app: &App, caller: &Caller, chosen: &Chosen, denied: Option<Denied>) -> Response {
    let found = ask(app, |register| {
        let mut reassigned = register.reassigned()?;
        reassigned.truncate(SHOWN);
        Ok((register.seats()?, register.learners()?, reassigned))
    });
    let (seats, learners, reassigned) = match found.await {
        Ok(found) => found,
        Err(why) => return why.page(),
    };
    if learners.iter().any(|learner| !learner.name.is_empty()) {
        record(app, caller, "read names", "all classes, for seats".into()).await;
    }
    let stations = app.house.stations();
    let own = stations
        .iter()
        .filter(|station| caller.holder.includes(&station.name));
    let place = |station: &crate::house::Station| {
        let status = station.status.borrow().clone();
        let learner = match status.learner.as_str() {
            "" => "an anonymous learner",
            id => id,
        };
        let session = match status.phase {
            Phase::Free => String::new(),
            Phase::Ready => format!("{learner} is about to begin"),
            Phase::Running => format!("{learner}, {} runs", status.exercise),
            Phase::Waiting => format!("{learner} is gone, the session waits"),
            Phase::Ending => format!("{learner}, the session is ending"),
        };
        Place {
            name: status.station.clone(),
            session,
            recording: status.recording,
            seat: seats
                .iter()
                .find(|seat| seat.station == *station.name)
                .cloned(),
        }
    };
    let places: Vec<Place> = own.map(place).collect();
    let mut groups: Vec<Group> = Vec::new();
    for learner in learners {
        match groups
            .last_mut()
            .filter(|group| group.class == learner.class)
        {
            Some(group) => group.learners.push(learner),
            None => groups.push(Group {
                class: learner.class.clone(),
                learners: vec![learner],
            }),
        }
    }
    let (status, why) = answer(denied);
    let page = SeatsPage {
        role: caller.holder.role.name(),
        id: &caller.holder.id,
        is_admin: caller.holder.role == Role::Admin,
        why: &why,
        places: &places,
        groups: &groups,
        chosen: &chosen.learner,
        recording: &chosen.recording,
        reassigned: &reassigned,
    };
    html(status, &page)
}

/// Form of a seat.
#[derive(Deserialize)]
pub(super) struct SeatForm {
    station: String,
    learner: String,
}

/// `POST /seats`: sets the plan of a station for a learner, from its next session on.
pub(super) async fn seat(
    State(app): State<App>,
    Extension(caller): Extension<Caller>,
    form: Sent<SeatForm>,
) -> Response {
    let SeatForm { station, learner } = match values(form) {
        Ok(form) => form,
        Err(page) => return *page,
    };
    if let Some(refusal) = no_station(&app, &caller, &station, Form::Page) {
        return refusal;
    }
    match sit(&app, &caller, station, learner.clone()).await {
        Ok(()) => to("/seats"),
        Err(why) => {
            let chosen = Chosen {
                learner,
                ..Chosen::default()
            };
            shown(&app, &caller, &chosen, Some(why)).await
        }
    }
}

async fn sit(app: &App, caller: &Caller, station: String, learner: String) -> Result<(), Denied> {
    let asked = learner.clone();
    let seating = ask(app, move |register| register.seating(&asked)).await?;
    // An exam that a person with the right has set for the learner needs no right of the person who seats.
    let exams = seating.exams || may_set_exams(caller);
    let answer = app.house.instruct(Instructed {
        station: station.clone(),
        by: caller.holder.id.clone(),
        instruction: Instruction::Plan(seating.text),
        exams,
    });
    let answer = answer.await;
    if !answer.taken {
        let why = format!("station {station} did not take the plan: {}", answer.text);
        return Err(Denied::Changed(why));
    }
    change(app, caller, Change::Seated { station, learner }).await?;
    Ok(())
}

/// Form of a session of another learner.
#[derive(Deserialize)]
pub(super) struct ReassignForm {
    recording: String,
    learner: String,
    why: String,
}

/// `POST /seats/reassign`: the session of a recording was that of another learner.
pub(super) async fn reassign(
    State(app): State<App>,
    Extension(caller): Extension<Caller>,
    form: Sent<ReassignForm>,
) -> Response {
    let form = match values(form) {
        Ok(form) => form,
        Err(page) => return *page,
    };
    let chosen = Chosen {
        learner: form.learner.clone(),
        recording: form.recording.clone(),
    };
    let wanted = Change::Reassign {
        recording: form.recording,
        learner: form.learner,
        why: form.why,
    };
    match change(&app, &caller, wanted).await {
        Ok(_) => to("/seats"),
        Err(why) => shown(&app, &caller, &chosen, Some(why)).await,
    }
}

//! Pages of the classes: list, class, codes.

use askama::Template;
use axum::Extension;
use axum::extract::{Path, State};
use axum::http::StatusCode;
use axum::response::Response;
use serde::Deserialize;
use sulcus_proto::Role;

use super::ask::{Sent, ask, change, may_set_exams, record, to, to_class, values};
use super::tasks::words;
use crate::App;
use crate::guard::Caller;
use crate::house::register::{Card, Change, Choices, Class, ClassRow, Denied, NewLearner, Target};
use crate::pages::html;

/// Class in the list.
struct Row {
    id: String,
    name: String,
    learners: usize,
    task: String,
}

#[derive(Template)]
#[template(path = "classes.html")]
struct ClassesPage<'a> {
    role: &'a str,
    id: &'a str,
    is_admin: bool,
    why: &'a str,
    classes: &'a [Row],
    choices: &'a Choices,
}

/// Learner on the page of a class.
struct Member {
    id: String,
    name: String,
    task: String,
    code_until: String,
    station: String,
}

#[derive(Template)]
#[template(path = "class.html")]
struct ClassPage<'a> {
    role: &'a str,
    id: &'a str,
    is_admin: bool,
    why: &'a str,
    class: &'a ClassRow,
    task: &'a str,
    has_names: bool,
    learners: &'a [Member],
    choices: &'a Choices,
    stations: &'a [String],
    exams: bool,
}

#[derive(Template)]
#[template(path = "codes.html")]
struct CodesPage<'a> {
    role: &'a str,
    id: &'a str,
    is_admin: bool,
    class: &'a ClassRow,
    cards: &'a [Card],
    hours: u32,
}

/// `GET /classes`: all classes.
pub(super) async fn list(State(app): State<App>, Extension(caller): Extension<Caller>) -> Response {
    list_with(&app, &caller, None).await
}

/// The list, with the reason why a change was refused.
pub(super) async fn list_with(app: &App, caller: &Caller, denied: Option<Denied>) -> Response {
    let found = ask(app, |register| {
        Ok((register.classes()?, register.choices()?))
    })
    .await;
    let (classes, choices) = match found {
        Ok(found) => found,
        Err(why) => return why.page(),
    };
    let row = |class: ClassRow| Row {
        task: words(caller, class.task.as_ref()),
        id: class.id,
        name: class.name,
        learners: class.learners,
    };
    let classes: Vec<Row> = classes.into_iter().map(row).collect();
    let (status, why) = answer(denied);
    let page = ClassesPage {
        role: caller.holder.role.name(),
        id: &caller.holder.id,
        is_admin: caller.holder.role == Role::Admin,
        why: &why,
        classes: &classes,
        choices: &choices,
    };
    html(status, &page)
}

/// Status and sentence of a page: that of a refusal, or of none.
pub(super) fn answer(denied: Option<Denied>) -> (StatusCode, String) {
    denied.map_or((StatusCode::OK, String::new()), Denied::answer)
}

/// `GET /classes/{class}`: a class with its learners.
pub(super) async fn class(
    State(app): State<App>,
    Extension(caller): Extension<Caller>,
    Path(class): Path<String>,
) -> Response {
    class_with(&app, &caller, class, None).await
}

/// The page of a class, with the reason why a change was refused.
pub(super) async fn class_with(
    app: &App,
    caller: &Caller,
    class: String,
    denied: Option<Denied>,
) -> Response {
    let found = ask(app, move |register| {
        Ok((register.class(&class)?, register.choices()?))
    });
    let (class, choices) = match found.await {
        Ok(found) => found,
        Err(why) => return why.page(),
    };
    let Class {
        row,
        learners,
        has_names,
    } = class;
    if learners.iter().any(|learner| !learner.name.is_empty()) {
        record(app, caller, "read names", format!("class {}", row.id)).await;
    }
    let member = |learner: crate::house::register::Learner| Member {
        task: words(caller, learner.task.as_ref()),
        id: learner.id,
        name: learner.name,
        code_until: learner.code_until,
        station: learner.station,
    };
    let learners: Vec<Member> = learners.into_iter().map(member).collect();
    let stations = own_stations(app, caller);
    let (status, why) = answer(denied);
    let page = ClassPage {
        role: caller.holder.role.name(),
        id: &caller.holder.id,
        is_admin: caller.holder.role == Role::Admin,
        why: &why,
        task: &words(caller, row.task.as_ref()),
        class: &row,
        has_names,
        learners: &learners,
        choices: &choices,
        stations: &stations,
        exams: may_set_exams(caller),
    };
    html(status, &page)
}

/// Names of the stations of a signed-in person.
pub(super) fn own_stations(app: &App, caller: &Caller) -> Vec<String> {
    let all = app.house.stations();
    let own = all
        .iter()
        .filter(|station| caller.holder.includes(&station.name));
    own.map(|station| station.name.to_string()).collect()
}

/// Form with a name.
#[derive(Deserialize)]
pub(super) struct Name {
    name: String,
}

/// `POST /classes`: makes a class.
pub(super) async fn make(
    State(app): State<App>,
    Extension(caller): Extension<Caller>,
    form: Sent<Name>,
) -> Response {
    let name = match values(form) {
        Ok(form) => form.name,
        Err(page) => return *page,
    };
    match change(&app, &caller, Change::Make { name }).await {
        Ok(id) => to_class(&id),
        Err(why) => list_with(&app, &caller, Some(why)).await,
    }
}

/// `POST /classes/{class}/name`: gives a class another name.
pub(super) async fn rename(
    State(app): State<App>,
    Extension(caller): Extension<Caller>,
    Path(class): Path<String>,
    form: Sent<Name>,
) -> Response {
    let name = match values(form) {
        Ok(form) => form.name,
        Err(page) => return *page,
    };
    let wanted = Change::Rename {
        class: class.clone(),
        name,
    };
    shown(&app, &caller, class, wanted).await
}

/// Carries out a change and shows the class, with the reason of a refusal.
async fn shown(app: &App, caller: &Caller, class: String, wanted: Change) -> Response {
    match change(app, caller, wanted).await {
        Ok(_) => to_class(&class),
        Err(why) => class_with(app, caller, class, Some(why)).await,
    }
}

/// Form of a step that cannot be taken back.
#[derive(Deserialize)]
pub(super) struct Sure {
    #[serde(default)]
    sure: String,
}

impl Sure {
    fn check(&self) -> Result<(), Denied> {
        match self.sure.as_str() {
            "yes" => Ok(()),
            _ => Err(Denied::Invalid(
                "tick the box first: nothing was changed".into(),
            )),
        }
    }
}

/// `POST /classes/{class}/remove`: removes a class.
pub(super) async fn remove(
    State(app): State<App>,
    Extension(caller): Extension<Caller>,
    Path(class): Path<String>,
    form: Sent<Sure>,
) -> Response {
    let sure = match values(form) {
        Ok(form) => form.check(),
        Err(page) => return *page,
    };
    let done = match sure {
        Ok(()) => {
            let class = class.clone();
            change(&app, &caller, Change::Remove { class }).await
        }
        Err(why) => Err(why),
    };
    match done {
        Ok(_) => to("/classes"),
        Err(why) => class_with(&app, &caller, class, Some(why)).await,
    }
}

/// Form of a new learner.
#[derive(Deserialize)]
pub(super) struct Added {
    #[serde(default)]
    given: String,
    #[serde(default)]
    family: String,
    #[serde(default)]
    username: String,
    #[serde(default)]
    learner: String,
}

/// `POST /classes/{class}/learners`: adds a learner.
pub(super) async fn add(
    State(app): State<App>,
    Extension(caller): Extension<Caller>,
    Path(class): Path<String>,
    form: Sent<Added>,
) -> Response {
    let form = match values(form) {
        Ok(form) => form,
        Err(page) => return *page,
    };
    let learner = NewLearner {
        id: form.learner.trim().to_owned(),
        given: form.given.trim().to_owned(),
        family: form.family.trim().to_owned(),
        username: form.username.trim().to_owned(),
    };
    let wanted = Change::Add {
        class: class.clone(),
        learner,
    };
    shown(&app, &caller, class, wanted).await
}

/// `POST /classes/{class}/learners/{learner}/remove`: takes a learner out of the class.
pub(super) async fn drop_learner(
    State(app): State<App>,
    Extension(caller): Extension<Caller>,
    Path((class, learner)): Path<(String, String)>,
    form: Sent<Sure>,
) -> Response {
    let sure = match values(form) {
        Ok(form) => form.check(),
        Err(page) => return *page,
    };
    match sure {
        Ok(()) => {
            let wanted = Change::Drop {
                class: class.clone(),
                learner,
            };
            shown(&app, &caller, class, wanted).await
        }
        Err(why) => class_with(&app, &caller, class, Some(why)).await,
    }
}

/// Form of new codes.
#[derive(Deserialize)]
pub(super) struct Hours {
    hours: u32,
}

/// `POST /classes/{class}/codes`: new codes of all learners, shown once.
pub(super) async fn codes(
    State(app): State<App>,
    Extension(caller): Extension<Caller>,
    Path(class): Path<String>,
    form: Sent<Hours>,
) -> Response {
    let target = Target::Class(class.clone());
    make_codes(&app, &caller, class, target, form).await
}

/// `POST /classes/{class}/learners/{learner}/code`: a new code of one learner, shown once.
pub(super) async fn code(
    State(app): State<App>,
    Extension(caller): Extension<Caller>,
    Path((class, learner)): Path<(String, String)>,
    form: Sent<Hours>,
) -> Response {
    make_codes(&app, &caller, class, Target::Learner(learner), form).await
}

async fn make_codes(
    app: &App,
    caller: &Caller,
    class: String,
    target: Target,
    form: Sent<Hours>,
) -> Response {
    let hours = match values(form) {
        Ok(form) => form.hours,
        Err(page) => return *page,
    };
    let (by, of) = (caller.holder.id.clone(), class.clone());
    let made = ask(app, move |register| {
        let class = register.class(&of)?.row;
        Ok((register.make_codes(&by, &target, hours)?, class))
    });
    match made.await {
        Ok((cards, class)) => {
            if cards.iter().any(|card| !card.name.is_empty()) {
                record(
                    app,
                    caller,
                    "read names",
                    format!("codes of class {}", class.id),
                )
                .await;
            }
            let page = CodesPage {
                role: caller.holder.role.name(),
                id: &caller.holder.id,
                is_admin: caller.holder.role == Role::Admin,
                class: &class,
                cards: &cards,
                hours,
            };
            html(StatusCode::OK, &page)
        }
        Err(why) => class_with(app, caller, class, Some(why)).await,
    }
}

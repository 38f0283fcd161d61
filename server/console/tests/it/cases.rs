//! Cases: pages and data for teachers, values that are refused by name, conflicts, plans.

use std::collections::BTreeMap;
use std::sync::Mutex;

use axum::Router;
use axum::http::{Method, StatusCode, header};
use serde_json::{Value, json};
use sulcus_console::house::Cases;
use sulcus_console::house::cases::{
    Case, Chart, Choice, FieldFault, Loaded, Model, Origin, Refused, Running, Sides, ToothChart,
    Work,
};
use sulcus_proto::control::Instruction;

use crate::house::{Fake, request, router, run, send, sign_in, text};

/// Name of a case that is always there.
pub const CASE: &str = "one";
/// Name of a case that a plan uses.
const USED: &str = "used";

/// Cases of a test, and the acts on them.
#[derive(Default)]
pub struct Shelf {
    charts: Mutex<BTreeMap<String, Chart>>,
    acts: Mutex<Vec<String>>,
}

impl Shelf {
    fn note(&self, act: &str, name: &str, by: &str) {
        self.acts.lock().unwrap().push(format!("{act} {name} {by}"));
    }

    fn chart(&self, name: &str) -> Result<Chart, Refused> {
        let charts = self.charts.lock().unwrap();
        match charts.get(name) {
            Some(chart) => Ok(chart.clone()),
            None if [CASE, USED].contains(&name) => Ok(chart()),
            None => Err(Refused::Unknown(format!("no case {name}"))),
        }
    }
}

fn tooth(fdi: u8) -> ToothChart {
    let side = Sides {
        buccal: [3.0, 2.0, 3.0],
        lingual: [3.0, 2.0, 3.0],
    };
    ToothChart {
        fdi,
        depth_mm: side,
        recession_mm: Sides::default(),
        bleeding: Sides::default(),
        inflammation: 0.0,
        furcation: [0, 0],
        mobility: 0,
    }
}

pub fn chart() -> Chart {
    Chart {
        label: "<b>one</b>".into(),
        missing: vec![46],
        teeth: vec![tooth(36), tooth(37)],
    }
}

/// Version of a chart: that of its missing teeth.
fn version(chart: &Chart) -> String {
    format!("{:?}", chart.missing)
}

fn choice(name: &str) -> Choice {
    Choice {
        name: name.into(),
        about: name.into(),
    }
}

impl Cases for Fake {
    fn model(&self) -> Model {
        Model {
            teeth: vec![36, 37],
            third_molars: vec![38],
            healthy: tooth(36),
            depth_mm: [0.5, 10.0],
            recession_mm: [-4.0, 8.5],
            most_loss_mm: 9.0,
            conditions: vec![choice("healthy")],
            exercises: vec![choice("bimanual")],
            sides: vec![choice("above")],
        }
    }

    fn list(&self) -> Result<Vec<Case>, Refused> {
        Ok(vec![self.load(CASE)?.case])
    }

    fn load(&self, name: &str) -> Result<Loaded, Refused> {
        let chart = self.shelf.chart(name)?;
        Ok(Loaded {
            version: version(&chart),
            case: Case {
                name: name.into(),
                state: "new".into(),
                chart: Some(chart),
                ..Case::default()
            },
            faults: Vec::new(),
        })
    }

    fn check(&self, chart: &Chart) -> Vec<FieldFault> {
        let deep = chart
            .teeth
            .iter()
            .filter(|tooth| tooth.depth_mm.buccal[0] > 10.0);
        let fault = |tooth: &ToothChart| FieldFault {
            fdi: Some(tooth.fdi),
            site: Some(("buccal", 0)),
            key: "depth_mm".into(),
            text: "too deep".into(),
        };
        deep.map(fault).collect()
    }

    fn create(&self, name: &str, origin: &Origin, by: &str) -> Result<(), Refused> {
        if name == "taken" {
            return Err(Refused::Bad("name", "taken".into()));
        }
        self.shelf.note(&format!("create {origin:?}"), name, by);
        Ok(())
    }

    fn save(&self, name: &str, loaded: &str, chart: &Chart, by: &str) -> Result<Loaded, Refused> {
        let present = self.shelf.chart(name)?;
        if version(&present) != loaded {
            return Err(Refused::Conflict("changed by another person".into()));
        }
        let mut charts = self.shelf.charts.lock().unwrap();
        charts.insert(name.into(), chart.clone());
        drop(charts);
        self.shelf.note("save", name, by);
        self.load(name)
    }

    fn remove(&self, name: &str, by: &str) -> Result<(), Refused> {
        self.shelf.chart(name)?;
        if name == USED {
            return Err(Refused::Conflict("in use at a".into()));
        }
        self.shelf.note("remove", name, by);
        Ok(())
    }

    fn compile(&self, name: &str, by: &str) -> Result<(), Refused> {
        self.shelf.chart(name)?;
        self.shelf.note("compile", name, by);
        Ok(())
    }

    fn cancel(&self, name: &str, by: &str) {
        self.shelf.note("cancel", name, by);
    }

    fn work(&self) -> Work {
        Work {
            running: Some(Running {
                name: CASE.into(),
                stage: "tooth 36".into(),
                percent: 42,
            }),
            ..Work::default()
        }
    }

    fn picture(&self, name: &str, side: &str) -> Result<Vec<u8>, Refused> {
        self.shelf.chart(name)?;
        match side {
            "above" => Ok(b"\x89PNG".to_vec()),
            _ => Err(Refused::Unknown("no such side".into())),
        }
    }

    fn mouth(&self, name: &str) -> Result<Vec<u8>, Refused> {
        self.shelf.chart(name)?;
        Ok(format!("mouth of {name}").into())
    }

    fn plan(&self, name: &str, exercise: &str) -> Result<String, Refused> {
        self.shelf.chart(name)?;
        match exercise {
            "bimanual" => Ok(format!("scene = \"/cases/{name}.scene\"")),
            other => Err(Refused::Bad("exercise", format!("exercise is `{other}`"))),
        }
    }
}

async fn post(router: &Router, cookie: &str, path: &str, body: &Value) -> (StatusCode, Value) {
    let asked = request(&Method::POST, path, Some(cookie), &body.to_string());
    let answer = send(router, asked).await;
    let status = answer.status();
    let told = text(answer).await;
    (status, serde_json::from_str(&told).expect(&told))
}

#[test]
fn bad_values_are_answered_with_the_name_of_their_field() {
    run(async {
        let house = Fake::new();
        let router = router(&house);
        let cookie = sign_in(&router, "instructor").await;
        let mut wrong = serde_json::to_value(chart()).unwrap();
        wrong["teeth"][0]["depth_mm"]["buccal"][1] = json!("deep");
        let loaded = json!({ "version": "1", "chart": wrong });
        let cases = [
            (
                "/api/cases",
                json!({ "condition": "healthy", "seed": 1 }),
                "name",
            ),
            (
                "/api/cases",
                json!({ "name": "taken", "condition": "healthy", "seed": 1 }),
                "name",
            ),
            (
                "/api/cases",
                json!({ "name": "a", "condition": "healthy", "seed": "-1" }),
                "seed",
            ),
            (
                "/api/cases",
                json!({ "name": "a", "condition": 3, "seed": 1 }),
                "condition",
            ),
            (
                "/api/cases",
                json!({ "name": "a", "copy_of": "b", "seed": 1 }),
                "seed",
            ),
            ("/api/cases", json!({ "name": "a", "why": 1 }), "why"),
            (
                "/api/cases-check",
                wrong.clone(),
                "depth_mm of tooth 36, buccal",
            ),
            ("/api/cases/one", loaded, "depth_mm of tooth 36, buccal"),
            ("/api/cases/one", json!({ "chart": chart() }), "version"),
            ("/api/cases/one/use", json!({ "station": "a" }), "exercise"),
            (
                "/api/cases/one/use",
                json!({ "station": "a", "exercise": "crown" }),
                "exercise",
            ),
            ("/api/cases/one/use", json!([]), "body"),
        ];
        for (path, body, field) in cases {
            let (status, told) = post(&router, &cookie, path, &body).await;
            assert_eq!(status, StatusCode::BAD_REQUEST, "{path} {body}: {told}");
            assert_eq!(told["field"], field, "{path} {body}: {told}");
        }
        assert!(house.shelf.acts.lock().unwrap().is_empty());
    });
}

#[test]
fn the_mouth_of_a_case_opens_once_and_for_its_sign_in_alone() {
    run(async {
        let house = Fake::new();
        let router = router(&house);
        let cookie = sign_in(&router, "instructor").await;
        let open = format!("/api/cases/{CASE}/mouth");
        let (status, told) = post(&router, &cookie, &open, &json!({})).await;
        assert_eq!(status, StatusCode::OK, "{told}");
        let path = told["path"].as_str().expect("a path");
        let get = async |path: &str| {
            let answer = send(&router, request(&Method::GET, path, None, "")).await;
            (answer.status(), text(answer).await)
        };
        let (status, mouth) = get(path).await;
        assert_eq!(
            (status, mouth),
            (StatusCode::OK, format!("mouth of {CASE}"))
        );
        assert_eq!(get(path).await.0, StatusCode::NOT_FOUND, "a second use");
        let (_, told) = post(&router, &cookie, &open, &json!({})).await;
        house.revoked.lock().unwrap().push("t-instructor".into());
        let path = told["path"].as_str().expect("a path");
        assert_eq!(
            get(path).await.0,
            StatusCode::NOT_FOUND,
            "without its sign-in"
        );
        let none = request(&Method::GET, "/api/cases/none/mouth", None, "");
        assert_ne!(send(&router, none).await.status(), StatusCode::OK);
    });
}

#[test]
fn the_second_of_two_instructors_does_not_overwrite_the_first() {
    run(async {
        let house = Fake::new();
        let router = router(&house);
        let cookie = sign_in(&router, "instructor").await;
        let asked = request(&Method::GET, "/api/cases/one", Some(&cookie), "");
        let loaded: Value = serde_json::from_str(&text(send(&router, asked).await).await).unwrap();
        let version = &loaded["case"]["version"];
        let mut mine = chart();
        mine.missing.push(37);
        mine.teeth.pop();
        let body = json!({ "version": version, "chart": mine });
        let (status, told) = post(&router, &cookie, "/api/cases/one", &body).await;
        assert_eq!(status, StatusCode::OK, "{told}");
        assert_ne!(&told["case"]["version"], version);
        assert_eq!(told["case"]["chart"], serde_json::to_value(&mine).unwrap());
        let body = json!({ "version": version, "chart": chart() });
        let (status, told) = post(&router, &cookie, "/api/cases/one", &body).await;
        assert_eq!(status, StatusCode::CONFLICT, "{told}");
        assert_eq!(house.shelf.chart(CASE).unwrap(), mine);
        assert_eq!(*house.shelf.acts.lock().unwrap(), ["save one t-instructor"]);
    });
}

#[test]
fn a_case_goes_to_a_station_of_the_person_alone_and_by_an_instruction() {
    run(async {
        let house = Fake::new();
        let router = router(&house);
        let cookie = sign_in(&router, "instructor").await;
        let body =
            |station: &str| json!({ "station": station, "exercise": "bimanual", "key": "k" });
        let (status, told) = post(&router, &cookie, "/api/cases/one/use", &body("b")).await;
        assert_eq!(status, StatusCode::NOT_FOUND, "{told}");
        let (status, told) = post(&router, &cookie, "/api/cases/two/use", &body("a")).await;
        assert_eq!(status, StatusCode::NOT_FOUND, "{told}");
        assert!(house.instructed.lock().unwrap().is_empty());
        for _ in 0..2 {
            let (status, told) = post(&router, &cookie, "/api/cases/one/use", &body("a")).await;
            assert_eq!(
                (status, &told["taken"]),
                (StatusCode::OK, &json!(true)),
                "{told}"
            );
        }
        let instructed = house.instructed.lock().unwrap();
        let [one] = &instructed[..] else {
            panic!("a second click with the same key: {instructed:?}");
        };
        let plan = Instruction::Plan("scene = \"/cases/one.scene\"".into());
        assert_eq!((one.station.as_str(), &one.instruction), ("a", &plan));
    });
}

#[test]
fn acts_are_told_with_their_author_and_refusals_with_their_reason() {
    run(async {
        let house = Fake::new();
        let router = router(&house);
        let cookie = sign_in(&router, "examiner").await;
        let none = json!({});
        for (path, expected) in [
            ("/api/cases/one/compile", StatusCode::OK),
            ("/api/cases/one/cancel", StatusCode::OK),
            ("/api/cases/one/remove", StatusCode::OK),
            ("/api/cases/used/remove", StatusCode::CONFLICT),
            ("/api/cases/two/remove", StatusCode::NOT_FOUND),
            ("/api/cases/two/compile", StatusCode::NOT_FOUND),
        ] {
            let (status, told) = post(&router, &cookie, path, &none).await;
            assert_eq!(status, expected, "{path}: {told}");
        }
        let acts = house.shelf.acts.lock().unwrap().clone();
        let expected = ["compile", "cancel", "remove"].map(|act| format!("{act} one t-examiner"));
        assert_eq!(acts, expected);
        let get =
            async |path: &str| send(&router, request(&Method::GET, path, Some(&cookie), "")).await;
        assert_eq!(
            get("/api/cases/one/picture/below").await.status(),
            StatusCode::NOT_FOUND
        );
        let picture = get("/api/cases/one/picture/above").await;
        assert_eq!(picture.headers()[header::CONTENT_TYPE], "image/png");
        assert_eq!(get("/cases/two").await.status(), StatusCode::NOT_FOUND);
        let list = text(get("/api/cases").await).await;
        let list: Value = serde_json::from_str(&list).unwrap();
        assert_eq!(list["cases"][0]["summary"]["teeth"], 2, "{list}");
        assert_eq!(list["work"]["running"]["percent"], 42, "{list}");
        assert_eq!(list["stations"], json!(["a"]), "{list}");
    });
}

#[test]
fn a_check_tells_the_place_of_a_fault() {
    run(async {
        let router = router(&Fake::new());
        let cookie = sign_in(&router, "instructor").await;
        let mut chart = chart();
        chart.teeth[1].depth_mm.buccal[0] = 11.0;
        let body = serde_json::to_value(&chart).unwrap();
        let (status, told) = post(&router, &cookie, "/api/cases-check", &body).await;
        assert_eq!(status, StatusCode::OK);
        let expected =
            json!({ "fdi": 37, "site": ["buccal", 0], "key": "depth_mm", "text": "too deep" });
        assert_eq!(told["faults"], json!([expected]));
    });
}

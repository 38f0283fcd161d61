//! The flat picture of a station, ten times a second, for pages without the viewer.

use std::convert::Infallible;
use std::time::Duration;

use axum::Extension;
use axum::extract::{Path, State};
use axum::http::{HeaderValue, StatusCode};
use axum::response::sse::{Event, KeepAlive, Sse};
use axum::response::{IntoResponse, Response};
use futures_util::stream::unfold;
use serde_json::{Value, json};
use sulcus_proto::datagram::WirePose;
use sulcus_proto::live::{Hand, Hands};
use tokio::time::{Interval, MissedTickBehavior};

use crate::App;
use crate::guard::{Caller, is_signed_in, no_station, refused};
use crate::house::{Glance, Outlines, ToolOutline};
use crate::live::Slot;
use crate::routes::Form::Data;

/// Interval between two pictures.
const EVERY: Duration = Duration::from_millis(100);
/// Pictures between two looks at the sign-in of an open stream.
const LOOK: u32 = 10;
/// Interval between two signs of life of a stream.
const ALIVE: Duration = Duration::from_secs(10);

struct Stream {
    app: App,
    caller: Caller,
    station: String,
    every: Interval,
    looks: u32,
    outlines: Option<Outlines>,
    tick: Option<u64>,
    _slot: Slot,
}

/// `GET /api/stations/{station}/flat`: server-sent events. `mouth` has the shapes of a session, in millimetres; `frame`
/// has an instant; `none` says that there is no session; `signed-out` is the last event of a sign-in that has ended.
pub(super) async fn flat(
    State(app): State<App>,
    Extension(caller): Extension<Caller>,
    Path(station): Path<String>,
) -> Response {
    if let Some(refusal) = no_station(&app, &caller, &station, Data) {
        return refusal;
    }
    let Some(slot) = Slot::take() else {
        let why = "too many open pages";
        return refused(Data, StatusCode::SERVICE_UNAVAILABLE, why);
    };
    let mut every = tokio::time::interval(EVERY);
    // A page that was slow gets the newest picture, never a backlog.
    every.set_missed_tick_behavior(MissedTickBehavior::Delay);
    let stream = Stream {
        app,
        caller,
        station,
        every,
        looks: 0,
        outlines: None,
        tick: None,
        _slot: slot,
    };
    let stream = unfold(Some(stream), |stream| async {
        let (event, stream) = stream?.next().await;
        Some((Ok::<_, Infallible>(event), stream))
    });
    let alive = KeepAlive::new().interval(ALIVE);
    let mut response = Sse::new(stream).keep_alive(alive).into_response();
    // A proxy must not hold the events back.
    let no = HeaderValue::from_static("no");
    response.headers_mut().insert("x-accel-buffering", no);
    response
}

impl Stream {
    /// Next event, and the stream unless this was its last one.
    async fn next(mut self) -> (Event, Option<Self>) {
        let event = |kind: &str, data: &Value| Event::default().event(kind).data(data.to_string());
        loop {
            self.every.tick().await;
            self.looks += 1;
            if self.looks >= LOOK {
                self.looks = 0;
                if !is_signed_in(&self.app, &self.caller) {
                    return (event("signed-out", &json!({})), None);
                }
            }
            let glance = self.app.house.feeds().glance(&self.station);
            let Glance { begun, hands } = glance.unwrap_or_default();
            let shown = self.outlines.as_ref().map(|outlines| outlines.begun);
            if shown != Some(begun) {
                let (house, station) = (self.app.house.clone(), self.station.clone());
                let outlines = move || house.feeds().outlines(&station);
                let found = tokio::task::spawn_blocking(outlines).await.ok().flatten();
                let data = match &found {
                    Some(outlines) => event("mouth", &mouth(outlines)),
                    None => event("none", &json!({})),
                };
                let none = Outlines {
                    begun,
                    ..Outlines::default()
                };
                self.outlines = Some(found.unwrap_or(none));
                self.tick = None;
                return (data, Some(self));
            }
            let newer = hands.filter(|hands| self.tick != Some(hands.tick));
            if let (Some(hands), Some(outlines)) = (newer, &self.outlines) {
                self.tick = Some(hands.tick);
                return (event("frame", &frame(outlines, &hands)), Some(self));
            }
        }
    }
}

/// Shapes of a session, millimetres.
fn mouth(outlines: &Outlines) -> Value {
    let places = |list: &[[f32; 3]]| list.iter().map(|at| place(*at)).collect::<Vec<_>>();
    let teeth = outlines.teeth.iter();
    let teeth = teeth.map(|tooth| {
        json!({ "fdi": tooth.fdi, "points": places(&tooth.points), "margin": places(&tooth.margin) })
    });
    let tools = outlines.tools.iter().map(|tool| &tool.name);
    json!({ "teeth": teeth.collect::<Vec<_>>(), "tools": tools.collect::<Vec<_>>() })
}

/// An instant: tools by slot, each with its line and rim, the hand's tip, the force, the pocket.
fn frame(outlines: &Outlines, hands: &Hands) -> Value {
    let tools = outlines.tools.iter().zip(&hands.tools);
    let tools: Vec<Value> = tools.map(|(shape, hand)| tool(shape, hand)).collect();
    let seconds = hands.tick as f64 * outlines.tick_s;
    json!({ "tick": hands.tick, "s": round(seconds, 1e2), "paused": hands.paused, "tools": tools })
}

fn tool(shape: &ToolOutline, hand: &Hand) -> Value {
    let all = |pose: &WirePose, list: &[[f32; 3]]| {
        let moved = list.iter().map(|at| place(moved(pose, *at)));
        moved.collect::<Vec<_>>()
    };
    let tip = shape.line.last().copied().unwrap_or_default();
    let pocket = hand.pocket.map(|pocket| {
        json!({
            "tooth": pocket.tooth,
            "site": pocket.site,
            "depth_mm": round(f64::from(pocket.depth_mm), 1e2),
            "true_depth_mm": round(f64::from(pocket.true_depth_mm), 1e2),
            "floor_n": round(f64::from(pocket.floor_n), 1e3),
            "zone": pocket.zone,
        })
    });
    json!({
        "held": hand.held,
        "line": all(&hand.graphic, &shape.line),
        "rim": all(&hand.graphic, &shape.rim),
        "hand": place(moved(&hand.haptic, tip)),
        "force_n": hand.force_n.map(|x| round(f64::from(x), 1e3)),
        "pocket": pocket,
    })
}

/// Point of a tool in world axes.
fn moved(pose: &WirePose, at: [f32; 3]) -> [f32; 3] {
    let [w, x, y, z] = pose.orientation;
    // v + 2 q x (q x v + w v)
    let q = [x, y, z];
    let cross = |a: [f32; 3], b: [f32; 3]| -> [f32; 3] {
        std::array::from_fn(|k| {
            let (i, j) = ((k + 1) % 3, (k + 2) % 3);
            a[i] * b[j] - a[j] * b[i]
        })
    };
    let inner = cross(q, at);
    let inner = std::array::from_fn(|k| inner[k] + w * at[k]);
    let turned = cross(q, inner);
    std::array::from_fn(|k| pose.position[k] + at[k] + 2.0 * turned[k])
}

/// Millimetres with two decimals.
fn place(at: [f32; 3]) -> [f64; 3] {
    at.map(|x| round(f64::from(x) * 1e3, 1e2))
}

fn round(x: f64, steps: f64) -> f64 {
    (x * steps).round() / steps
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_point_of_a_tool_turns_and_moves_with_its_pose() {
        let half = std::f32::consts::FRAC_1_SQRT_2;
        // A quarter turn about z, then along x.
        let pose = WirePose {
            position: [0.01, 0.0, 0.0],
            orientation: [half, 0.0, 0.0, half],
        };
        let found = place(moved(&pose, [0.002, 0.0, 0.003]));
        assert_eq!(found, [10.0, 2.0, 3.0]);
    }

    #[test]
    fn a_frame_has_the_tip_in_millimetres_the_force_and_the_pocket() {
        let shape = ToolOutline {
            name: "probe".into(),
            line: vec![[0.0; 3], [0.0, 0.0, -0.09]],
            rim: vec![],
        };
        let outlines = Outlines {
            begun: 1,
            tick_s: 0.001,
            tools: vec![shape],
            teeth: vec![],
        };
        let mut hands = Hands {
            tick: 1234,
            ..Hands::default()
        };
        hands.tools[0].held = true;
        hands.tools[0].graphic.position = [0.05, 0.0, 0.1];
        hands.tools[0].force_n = [0.0, 0.12345, 0.0];
        let found = frame(&outlines, &hands);
        assert_eq!(found["s"], 1.23);
        let tool = &found["tools"][0];
        assert_eq!(tool["line"][1], json!([50.0, 0.0, 10.0]));
        assert_eq!(tool["force_n"], json!([0.0, 0.123, 0.0]));
        assert_eq!(
            (&tool["pocket"], &tool["held"]),
            (&Value::Null, &json!(true))
        );
        assert_eq!(found["tools"].as_array().map(Vec::len), Some(1));
    }
}

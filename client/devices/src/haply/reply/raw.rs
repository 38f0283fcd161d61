//! Fields of a reply as JSON, and their reading.

use serde::Deserialize;
use sulcus_core::math::norm;
use sulcus_core::{Quat, Vec3};

use super::{Arm, ArmStatus, Array, Grip, Reply};
use crate::haply::axes::{to_base, turn_to_base};
use crate::haply::loose::{Fields, Loose};

/// Largest distance of a position from the origin of the service, metres. The reach of every arm is shorter.
pub(super) const REACH_M: f64 = 1.0;

/// Reads a reply. `None` for a text that is no object of JSON.
pub(super) fn parse(text: &str) -> Option<Reply> {
    let Fields(raw) = serde_json::from_str::<Loose<Fields<RawReply>>>(text)
        .ok()?
        .0?;
    let arms = raw.inverse3.0.map(|all| {
        let arms = all.into_iter().filter_map(|Fields(arm)| arm.read());
        arms.collect()
    });
    let arrays = [
        (Array::Wireless, raw.wireless_verse_grip),
        (Array::Wired, raw.verse_grip),
        (Array::Custom, raw.custom_verse_grip),
    ];
    let grips = arrays.into_iter().filter_map(|(array, Loose(grips))| {
        let grips = grips?.into_iter().filter_map(|Fields(grip)| grip.read());
        Some((array, grips.collect()))
    });
    Some(Reply {
        arms,
        grips: grips.collect(),
    })
}

#[derive(Deserialize)]
struct RawReply {
    #[serde(default)]
    inverse3: Loose<Vec<Fields<RawArm>>>,
    #[serde(default)]
    wireless_verse_grip: Loose<Vec<Fields<RawGrip>>>,
    #[serde(default)]
    verse_grip: Loose<Vec<Fields<RawGrip>>>,
    #[serde(default)]
    custom_verse_grip: Loose<Vec<Fields<RawGrip>>>,
}

#[derive(Deserialize)]
struct RawArm {
    #[serde(default)]
    device_id: Loose<String>,
    #[serde(default)]
    state: Loose<Fields<RawArmState>>,
    #[serde(default)]
    status: Loose<Fields<RawStatus>>,
}

#[derive(Deserialize)]
struct RawArmState {
    #[serde(default)]
    cursor_position: Loose<Fields<RawVector>>,
    #[serde(default)]
    current_cursor_force: Loose<Fields<RawVector>>,
}

#[derive(Deserialize)]
struct RawGrip {
    #[serde(default)]
    device_id: Loose<String>,
    #[serde(default)]
    state: Loose<Fields<RawGripState>>,
    #[serde(default)]
    status: Loose<Fields<RawStatus>>,
}

#[derive(Deserialize)]
struct RawGripState {
    #[serde(default)]
    orientation: Loose<Fields<RawVector>>,
    #[serde(default)]
    button: Loose<bool>,
    #[serde(default)]
    buttons: Loose<Fields<RawButtons>>,
}

#[derive(Deserialize)]
struct RawButtons {
    #[serde(default)]
    a: Loose<bool>,
    #[serde(default)]
    b: Loose<bool>,
    #[serde(default)]
    c: Loose<bool>,
}

/// Status of an arm or of a grip.
#[derive(Default, Deserialize)]
struct RawStatus {
    #[serde(default)]
    calibrated: Loose<bool>,
    #[serde(default)]
    in_use: Loose<bool>,
    #[serde(default)]
    power_supply: Loose<bool>,
    #[serde(default)]
    ready: Loose<bool>,
    #[serde(default)]
    started: Loose<bool>,
    #[serde(default)]
    connected: Loose<bool>,
    #[serde(default)]
    awake: Loose<bool>,
}

/// Vector, or quaternion with `w`.
#[derive(Deserialize)]
struct RawVector {
    #[serde(default)]
    w: Loose<f64>,
    #[serde(default)]
    x: Loose<f64>,
    #[serde(default)]
    y: Loose<f64>,
    #[serde(default)]
    z: Loose<f64>,
}

impl RawVector {
    fn vector(&self) -> Option<Vec3> {
        let v = to_base([self.x.0?, self.y.0?, self.z.0?]);
        norm(&v).is_finite().then_some(v)
    }

    fn turn(&self) -> Option<Quat> {
        let q = [self.w.0?, self.x.0?, self.y.0?, self.z.0?];
        let length = q.iter().map(|x| x * x).sum::<f64>().sqrt();
        (0.5..2.0).contains(&length).then(|| turn_to_base(q))
    }
}

impl RawArm {
    fn read(self) -> Option<Arm> {
        let state = self.state.0.map(|Fields(state)| state);
        let state = state.as_ref();
        let position = state.and_then(|state| state.cursor_position.0.as_ref()?.0.vector());
        let status = self
            .status
            .0
            .map(|Fields(status)| status)
            .unwrap_or_default();
        Some(Arm {
            id: self.device_id.0?,
            position: position.filter(|at| norm(at) <= REACH_M),
            force: state.and_then(|state| state.current_cursor_force.0.as_ref()?.0.vector()),
            status: ArmStatus {
                calibrated: status.calibrated.0,
                in_use: status.in_use.0,
                power: status.power_supply.0,
                ready: status.ready.0,
                started: status.started.0,
            },
        })
    }
}

impl RawGrip {
    fn read(self) -> Option<Grip> {
        let state = self.state.0.map(|Fields(state)| state);
        let state = state.as_ref();
        let status = self
            .status
            .0
            .map(|Fields(status)| status)
            .unwrap_or_default();
        let three = state.and_then(|state| {
            let Fields(RawButtons { a, b, c }) = state.buttons.0.as_ref()?;
            let bit = |flag: &Loose<bool>, bit: u16| u16::from(flag.0 == Some(true)) << bit;
            Some(bit(a, 0) | bit(b, 1) | bit(c, 2))
        });
        let one = state.and_then(|state| state.button.0.map(u16::from));
        Some(Grip {
            id: self.device_id.0?,
            orientation: state.and_then(|state| state.orientation.0.as_ref()?.0.turn()),
            buttons: three.or(one),
            connected: status.connected.0,
            awake: status.awake.0,
        })
    }
}

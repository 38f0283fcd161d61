//! Alerts of a station for an instructor, made from its successive statuses.
//!
//! An alert is a kind with a sentence. A fault of the hand stays an alert for some time after its end, because an
//! instructor looks at many stations. A fault of the system is an alert for as long as it lasts.

use serde::Serialize;

use crate::station::{Phase, StationStatus, ToolStatus};

/// Urgency of an alert.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Urgency {
    /// Nothing is wrong.
    #[default]
    None,
    /// Worth a look.
    Notice,
    /// Needs a look soon.
    Warning,
    /// Needs a hand now.
    Alarm,
}

/// Kind of an alert, most urgent first.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum AlertKind {
    /// Force on a pocket's floor in the zone of damage.
    Damage,
    /// Force on a pocket's floor in the zone of trauma.
    Trauma,
    /// The recording has lost rows.
    RecordingLoses,
    /// The disk of recordings is nearly full.
    DiskFull,
    /// The student's connection is lost.
    Away,
    /// A held tool has had no new pose for a time: the force is zero.
    NoPoses,
    /// A haptic device is not connected.
    DeviceAbsent,
    /// The motors of a haptic device are warm: the force is limited, or its driver has taken the force off.
    DeviceWarm,
    /// Many ticks are late.
    LateTicks,
    /// The recording is far behind ticks at the hand.
    Behind,
    /// The disk of recordings has little room.
    DiskLow,
    /// Force on a pocket's floor above that of probing.
    TooHeavy,
    /// A haptic device displays no force until a button is pressed.
    ForceOff,
    /// The student has paused.
    PausedByStudent,
    /// The network loses poses.
    PosesLost,
}

/// Number of kinds.
const KINDS: usize = AlertKind::ALL.len();
/// Time for which an alert of trauma or damage stays after its end, milliseconds.
const HURT_MS: u64 = 30_000;
/// Time for which an alert of too much force stays after its end, milliseconds.
const HEAVY_MS: u64 = 5_000;
/// Time for which an alert of late ticks or lost poses stays after its end, milliseconds.
const LATE_MS: u64 = 10_000;
/// Age of a pose from which on its tool counts as silent, milliseconds. The server's watchdog acts far earlier.
const SILENT_MS: u16 = 250;
/// Lag of a recording behind ticks at the hand from which on it is an alert, milliseconds: more than any path causes.
const BEHIND_MS: u32 = 1_000;
/// Share of the ticks since the previous status from which on many are late, and of the poses that are lost.
const MANY: f64 = 0.02;
/// Free space of the two alerts of the disk, mebibytes: some ten minutes, and two hours, of a station with two hands.
const DISK_FULL_MIB: u64 = 256;
const DISK_LOW_MIB: u64 = 2_560;

impl AlertKind {
    /// All kinds, most urgent first.
    pub const ALL: [Self; 15] = [
        Self::Damage,
        Self::Trauma,
        Self::RecordingLoses,
        Self::DiskFull,
        Self::Away,
        Self::NoPoses,
        Self::DeviceAbsent,
        Self::DeviceWarm,
        Self::LateTicks,
        Self::Behind,
        Self::DiskLow,
        Self::TooHeavy,
        Self::ForceOff,
        Self::PausedByStudent,
        Self::PosesLost,
    ];

    /// Urgency of the kind.
    pub fn urgency(self) -> Urgency {
        match self {
            Self::Damage | Self::Trauma | Self::RecordingLoses | Self::DiskFull => Urgency::Alarm,
            Self::Away
            | Self::NoPoses
            | Self::DeviceAbsent
            | Self::DeviceWarm
            | Self::LateTicks
            | Self::Behind
            | Self::DiskLow => Urgency::Warning,
            Self::TooHeavy | Self::ForceOff | Self::PausedByStudent | Self::PosesLost => {
                Urgency::Notice
            }
        }
    }

    /// Time for which the alert stays after its end, milliseconds.
    fn stays_ms(self) -> u64 {
        match self {
            Self::Damage | Self::Trauma => HURT_MS,
            Self::TooHeavy => HEAVY_MS,
            Self::LateTicks | Self::PosesLost | Self::DeviceWarm => LATE_MS,
            _ => 0,
        }
    }
}

/// Alert of a station.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Alert {
    /// Kind.
    pub kind: AlertKind,
    /// Urgency of the kind.
    pub urgency: Urgency,
    /// Time since the alert began, milliseconds.
    pub for_ms: u64,
    /// Sentence for an instructor.
    pub text: String,
}

/// Alert that is present, or was lately.
#[derive(Clone, Debug)]
struct Present {
    began_ms: u64,
    last_ms: u64,
    text: String,
}

/// Alerts of one station over time.
#[derive(Clone, Debug, Default)]
pub struct Alerts {
    present: [Option<Present>; KINDS],
    before: Option<StationStatus>,
}

impl Alerts {
    /// Takes the newest status. `now_ms` is the time of any one clock that never goes back. Returns the present alerts,
    /// most urgent first.
    pub fn take(&mut self, status: &StationStatus, now_ms: u64) -> Vec<Alert> {
        let before = self.before.replace(status.clone());
        // Alerts are those of one session.
        let before = before.filter(|before| before.recording == status.recording);
        if before.is_none() {
            self.present = Default::default();
        }
        for (kind, present) in AlertKind::ALL.into_iter().zip(&mut self.present) {
            match (said(kind, status, before.as_ref()), &mut *present) {
                (Some(text), Some(present)) => {
                    (present.last_ms, present.text) = (now_ms, text);
                }
                (Some(text), none) => {
                    *none = Some(Present {
                        began_ms: now_ms,
                        last_ms: now_ms,
                        text,
                    });
                }
                (None, Some(over)) => {
                    if now_ms.saturating_sub(over.last_ms) >= kind.stays_ms() {
                        *present = None;
                    }
                }
                (None, None) => {}
            }
        }
        AlertKind::ALL
            .into_iter()
            .zip(&self.present)
            .filter_map(|(kind, present)| {
                present.as_ref().map(|present| Alert {
                    kind,
                    urgency: kind.urgency(),
                    for_ms: now_ms.saturating_sub(present.began_ms),
                    text: present.text.clone(),
                })
            })
            .collect()
    }
}

/// Urgency of the most urgent alert.
pub fn urgency(alerts: &[Alert]) -> Urgency {
    alerts
        .iter()
        .map(|alert| alert.urgency)
        .max()
        .unwrap_or_default()
}

/// Sentence of a kind, if the status has it.
fn said(kind: AlertKind, status: &StationStatus, before: Option<&StationStatus>) -> Option<String> {
    let runs = matches!(status.phase, Phase::Running | Phase::Waiting);
    match kind {
        AlertKind::Damage => {
            zone(status, 3).map(|at| format!("tissue damaged by too much force{at}"))
        }
        AlertKind::Trauma => zone(status, 2).map(|at| format!("trauma by too much force{at}")),
        AlertKind::TooHeavy => zone(status, 1).map(|at| format!("force too heavy{at}")),
        AlertKind::RecordingLoses => (runs && status.rows_dropped > 0)
            .then(|| format!("the recording lacks {} ticks", status.rows_dropped)),
        AlertKind::DiskFull => (runs && status.disk_free_mib < DISK_FULL_MIB)
            .then(|| format!("recordings have {} MiB left", status.disk_free_mib)),
        AlertKind::DiskLow => (runs
            && (DISK_FULL_MIB..DISK_LOW_MIB).contains(&status.disk_free_mib))
        .then(|| format!("recordings have {} MiB left", status.disk_free_mib)),
        AlertKind::Away => (status.phase == Phase::Waiting).then(|| {
            format!(
                "connection lost for {:.0} s",
                f64::from(status.gap_ms) / 1e3
            )
        }),
        AlertKind::NoPoses => {
            let held = status.tools.iter().filter(|tool| tool.present);
            let oldest = held.map(|tool| tool.pose_age_ms).max()?;
            (status.phase == Phase::Running && oldest >= SILENT_MS)
                .then(|| format!("the device has been silent for {oldest} ms"))
        }
        AlertKind::LateTicks => {
            let (late, ticks) = grown(status, before?, |status| status.deadline_misses);
            (ticks > 0 && late as f64 > MANY * ticks as f64)
                .then(|| format!("{late} of the last {ticks} ticks were late"))
        }
        AlertKind::Behind => {
            let behind_ms = status.behind_ms.filter(|ms| *ms >= BEHIND_MS)?;
            (status.phase == Phase::Running).then(|| {
                let seconds = f64::from(behind_ms) / 1e3;
                format!("the recording is {seconds:.0} s behind the hand")
            })
        }
        AlertKind::PosesLost => {
            let (lost, ticks) = grown(status, before?, |status| status.poses_lost);
            (ticks > 0 && lost as f64 > MANY * ticks as f64)
                .then(|| format!("the network lost {lost} poses in {ticks} ticks"))
        }
        AlertKind::DeviceAbsent => device(status, &|tool| tool.device_stage == "absent")
            .map(|tool| format!("the device of tool {tool} is not connected")),
        AlertKind::DeviceWarm => warm(status, before),
        AlertKind::ForceOff => {
            let is_off = |tool: &ToolStatus| {
                tool.device_stage.starts_with("tripped_") && tool.device_stage != DRIVER
            };
            device(status, &is_off)
                .map(|tool| format!("no force at tool {tool} until the student presses a button"))
        }
        AlertKind::PausedByStudent => {
            (runs && status.paused_by_student).then(|| "the student has paused".to_owned())
        }
    }
}

/// Stage of a device whose driver has taken the force off, as recordings name it.
const DRIVER: &str = "tripped_driver";

/// Number of the first tool, from 1 on, whose device is as asked while the session runs.
fn device(status: &StationStatus, is: &dyn Fn(&ToolStatus) -> bool) -> Option<usize> {
    let runs = status.phase == Phase::Running;
    let found = status.tools.iter().position(is);
    found.filter(|_| runs).map(|tool| tool + 1)
}

/// Sentence about warm motors.
fn warm(status: &StationStatus, before: Option<&StationStatus>) -> Option<String> {
    if let Some(tool) = device(status, &|tool| tool.device_stage == DRIVER) {
        return Some(format!(
            "the driver of tool {tool} has taken the force off: warm motors, or the device's own switch"
        ));
    }
    let tools = status.tools.iter().zip(&before?.tools);
    let grown = |(now, then): (&ToolStatus, &ToolStatus)| now.device_limited > then.device_limited;
    let tool = tools.map(grown).position(|grown| grown)?;
    Some(format!(
        "the motors of tool {} are warm: their force is limited",
        tool + 1
    ))
}

/// Growth of a count and of the ticks since an earlier status.
fn grown(
    status: &StationStatus,
    before: &StationStatus,
    count: fn(&StationStatus) -> u64,
) -> (u64, u64) {
    let grown = count(status).saturating_sub(count(before));
    (grown, status.tick.saturating_sub(before.tick))
}

/// Place of the tool whose heaviest zone since the previous status is `zone`, for the end of a sentence.
fn zone(status: &StationStatus, zone: u8) -> Option<String> {
    let heaviest = status.tools.iter().map(|tool| tool.peak_zone).max()?;
    let tool = status.tools.iter().find(|tool| tool.peak_zone == zone)?;
    if heaviest != zone || status.phase == Phase::Free {
        return None;
    }
    Some(match tool.tooth {
        0 => String::new(),
        tooth => format!(" at {tooth} {}", tool.site),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn running() -> StationStatus {
        StationStatus {
            phase: Phase::Running,
            recording: "a.mcap".into(),
            disk_free_mib: 100_000,
            ..StationStatus::default()
        }
    }

    fn kinds(alerts: &[Alert]) -> Vec<AlertKind> {
        alerts.iter().map(|alert| alert.kind).collect()
    }

    #[test]
    fn a_trauma_between_two_statuses_is_an_alarm_for_half_a_minute() {
        let (mut alerts, mut status) = (Alerts::default(), running());
        assert_eq!(alerts.take(&status, 0), []);
        (status.tools[0].peak_zone, status.tools[0].tooth) = (2, 36);
        status.tools[0].site = "distobuccal".into();
        let found = alerts.take(&status, 200);
        assert_eq!(kinds(&found), [AlertKind::Trauma]);
        assert!(
            found[0].text.ends_with("at 36 distobuccal"),
            "{}",
            found[0].text
        );
        assert_eq!(urgency(&found), Urgency::Alarm);
        status.tools[0].peak_zone = 0;
        let found = alerts.take(&status, 30_000);
        assert_eq!((found.len(), found[0].for_ms), (1, 29_800));
        assert_eq!(alerts.take(&status, 30_200), []);
    }

    #[test]
    fn alerts_of_one_session_are_not_those_of_the_next() {
        let (mut alerts, mut status) = (Alerts::default(), running());
        status.tools[1].peak_zone = 3;
        assert_eq!(kinds(&alerts.take(&status, 0)), [AlertKind::Damage]);
        status.tools[1].peak_zone = 0;
        status.recording = "b.mcap".into();
        assert_eq!(alerts.take(&status, 100), []);
    }

    #[test]
    fn faults_of_the_system_are_alerts_while_they_last() {
        let (mut alerts, mut status) = (Alerts::default(), running());
        status.phase = Phase::Waiting;
        status.gap_ms = 4_200;
        status.disk_free_mib = 100;
        status.rows_dropped = 7;
        status.paused_by_student = true;
        let found = alerts.take(&status, 0);
        let expected = [
            AlertKind::RecordingLoses,
            AlertKind::DiskFull,
            AlertKind::Away,
            AlertKind::PausedByStudent,
        ];
        assert_eq!(kinds(&found), expected);
        assert!(
            found
                .iter()
                .any(|alert| alert.text == "connection lost for 4 s")
        );
        let mut well = running();
        well.tools[0].present = true;
        well.tools[0].pose_age_ms = 400;
        assert_eq!(kinds(&alerts.take(&well, 200)), [AlertKind::NoPoses]);
        well.tools[0].pose_age_ms = 3;
        assert_eq!(alerts.take(&well, 400), []);
    }

    #[test]
    fn a_warm_an_absent_and_a_tripped_device_are_alerts() {
        let (mut alerts, mut status) = (Alerts::default(), running());
        status.tools[1].device_stage = "live".into();
        status.tools[1].device_limited = 40;
        assert_eq!(
            alerts.take(&status, 0),
            [],
            "a count from before this instructor's first status"
        );
        status.tools[1].device_limited = 41;
        let found = alerts.take(&status, 200);
        assert_eq!(kinds(&found), [AlertKind::DeviceWarm]);
        assert!(found[0].text.contains("tool 2"), "{}", found[0].text);
        assert_eq!(
            kinds(&alerts.take(&status, 10_100)),
            [AlertKind::DeviceWarm]
        );
        assert_eq!(alerts.take(&status, 10_200), []);
        for (stage, kind) in [
            ("tripped_driver", AlertKind::DeviceWarm),
            ("absent", AlertKind::DeviceAbsent),
            ("tripped_speed", AlertKind::ForceOff),
        ] {
            let (mut alerts, mut status) = (Alerts::default(), running());
            status.tools[0].device_stage = stage.into();
            assert_eq!(kinds(&alerts.take(&status, 0)), [kind], "{stage}");
            status.tools[0].device_stage = "live".into();
            let after = alerts.take(&status, 60_000);
            assert_eq!(after, [], "{stage}");
        }
    }

    #[test]
    fn a_recording_far_behind_the_hand_is_an_alert_and_the_delay_of_a_path_is_none() {
        for (behind_ms, said) in [
            (None, None),
            (Some(300), None),
            (Some(4_200), Some("the recording is 4 s behind the hand")),
        ] {
            let status = StationStatus {
                phase: Phase::Running,
                behind_ms,
                disk_free_mib: 100_000,
                ..StationStatus::default()
            };
            let found = super::said(AlertKind::Behind, &status, None);
            assert_eq!(found.as_deref(), said);
        }
    }

    #[test]
    fn late_ticks_and_lost_poses_count_since_the_previous_status() {
        let (mut alerts, mut status) = (Alerts::default(), running());
        (status.tick, status.deadline_misses, status.poses_lost) = (60_000, 5_000, 5_000);
        assert_eq!(
            alerts.take(&status, 0),
            [],
            "counts from before this instructor's first status"
        );
        (status.tick, status.deadline_misses) = (60_200, 5_004);
        assert_eq!(alerts.take(&status, 200), [], "four of two hundred");
        (status.tick, status.deadline_misses, status.poses_lost) = (60_400, 5_009, 5_100);
        let found = kinds(&alerts.take(&status, 400));
        assert_eq!(found, [AlertKind::LateTicks, AlertKind::PosesLost]);
    }

    #[test]
    fn the_order_of_kinds_is_that_of_urgency() {
        let urgencies = AlertKind::ALL.map(AlertKind::urgency);
        assert!(urgencies.is_sorted_by(|a, b| a >= b), "{urgencies:?}");
        assert!(AlertKind::ALL.is_sorted());
    }

    #[test]
    fn a_station_without_a_session_has_no_alert() {
        let free = StationStatus::default();
        assert_eq!(Alerts::default().take(&free, 0), []);
    }
}

//! Header of a recording: all data that are known before the first tick.

use std::collections::BTreeMap;

use serde::Serialize;
use serde::de::DeserializeOwned;
use sulcus_core::Coupling;

use crate::record::coupling;
use crate::record::device::{DeviceFacts, Limits};
use crate::record::key::PublicKey;
use crate::record::mode::Mode;
use crate::record::plan::PlanFacts;
use crate::record::policy::ViewersPolicy;
use crate::record::predecessor::Predecessor;

/// Version of the recording's layout and of the meaning of its numbers ([`crate::record::format`]). Another version is
/// migrated or refused.
pub const FORMAT_VERSION: &str = "7";
/// Name of the metadata record.
pub(crate) const METADATA: &str = "sulcus";
/// Key of the hash of the tick's sources; absent in recordings from before 24 November 2026.
const TICK_SOURCE: &str = "tick_source";
/// Key of the mode; absent in recordings from before 24 November 2026.
const MODE: &str = "mode";
/// Keys of the fields since format 6, each absent without a value. The values are JSON.
const DEVICES: &str = "devices";
const LIMITS: &str = "limits";
const PLAN: &str = "plan";
const ATTACH_EPOCH: &str = "attach_epoch";
const PREDECESSOR: &str = "predecessor";
/// Key of the couplings, since format 7; absent without a value.
const COUPLINGS: &str = "couplings";
/// Key of the policy about the channels for viewers; absent for the policy `recorded`. Programs before 28 November 2026
/// ignore the key.
const VIEWERS: &str = "viewers";
/// Name of the compiled scene's attachment.
pub(crate) const SCENE: &str = "scene.bin";
/// Attachments besides the scene: all text.
pub(crate) const TEXTS: [&str; 3] = ["exercise", "patient", "rubric"];

/// Constant data of a session.
#[derive(Clone, Debug, PartialEq)]
pub struct SessionHeader {
    /// Compiled scene, bytes of [`sulcus_core::Scene::to_bytes`].
    pub scene: Vec<u8>,
    /// Name of the exercise.
    pub exercise_name: String,
    /// The exercise's TOML or JSON text.
    pub exercise: String,
    /// The patient's text; may be empty.
    pub patient: String,
    /// The rubric's text; may be empty.
    pub rubric: String,
    /// Seed of the simulated hand; 0 for a person.
    pub seed: u64,
    /// Name of the station.
    pub station: String,
    /// Opaque id of the learner, never a name.
    pub learner_id: String,
    /// Mode; `None` in recordings from before 24 November 2026.
    pub mode: Option<Mode>,
    /// Version of the recording program.
    pub program_version: String,
    /// `debug` or `release`.
    pub build: String,
    /// First hexadecimal digits of a hash over the sources of the tick; empty in recordings from before 24 November
    /// 2026.
    pub tick_source: String,
    /// Processor and system, such as `x86_64-linux`.
    pub target: String,
    /// Start of the session, nanoseconds since the Unix epoch.
    pub started_unix_ns: u64,
    /// Devices, by slot; empty if no client described one, and before format 6.
    pub devices: Vec<DeviceFacts>,
    /// Limits of the wrench that the station sends; `None` before format 6.
    pub limits: Option<Limits>,
    /// Facts of the station's plan; `None` without a plan, and before format 6.
    pub plan: Option<PlanFacts>,
    /// Session epoch of the client's first attachment; `None` for a session without a connection, and before format 6.
    pub attach_epoch: Option<u32>,
    /// Recording that this one continues; `None` for the beginning of a session.
    pub predecessor: Option<Predecessor>,
    /// Couplings in force, in the order of the tools. Empty for the scene's own couplings, and before format 7.
    pub couplings: Vec<Coupling>,
    /// Policy about the channels for viewers. The metadata have no key for the policy `recorded`.
    pub viewers: ViewersPolicy,
}

impl SessionHeader {
    /// Header for `scene` in practice mode, with version, build and target of this program. All other fields are empty.
    pub fn new(scene: Vec<u8>) -> Self {
        Self {
            scene,
            exercise_name: String::new(),
            exercise: String::new(),
            patient: String::new(),
            rubric: String::new(),
            seed: 0,
            station: String::new(),
            learner_id: String::new(),
            mode: Some(Mode::default()),
            program_version: env!("CARGO_PKG_VERSION").to_owned(),
            build: if cfg!(debug_assertions) {
                "debug"
            } else {
                "release"
            }
            .to_owned(),
            tick_source: env!("SULCUS_TICK_SOURCE").to_owned(),
            target: format!("{}-{}", std::env::consts::ARCH, std::env::consts::OS),
            started_unix_ns: 0,
            devices: Vec::new(),
            limits: None,
            plan: None,
            attach_epoch: None,
            predecessor: None,
            couplings: Vec::new(),
            viewers: ViewersPolicy::default(),
        }
    }

    /// Checks the values of the fields since formats 6 and 7: field, value found, value expected.
    pub(crate) fn check(&self) -> Result<(), String> {
        self.devices.iter().try_for_each(DeviceFacts::check)?;
        let twice = |k: usize| {
            let tool = self.devices[k].tool;
            self.devices[..k].iter().any(|other| other.tool == tool)
        };
        if let Some(k) = (0..self.devices.len()).find(|k| twice(*k)) {
            let tool = self.devices[k].tool;
            return Err(format!("device tool {tool} occurs twice, expected once"));
        }
        self.limits.as_ref().map_or(Ok(()), Limits::check)?;
        self.plan.as_ref().map_or(Ok(()), PlanFacts::check)?;
        self.predecessor
            .as_ref()
            .map_or(Ok(()), Predecessor::check)?;
        coupling::check(&self.couplings)
    }

    /// Name and bytes of each attachment.
    pub(crate) fn attachments(&self) -> [(&'static str, &[u8]); 4] {
        [
            (SCENE, &self.scene),
            (TEXTS[0], self.exercise.as_bytes()),
            (TEXTS[1], self.patient.as_bytes()),
            (TEXTS[2], self.rubric.as_bytes()),
        ]
    }

    /// blake3 of the compiled scene.
    pub fn scene_hash(&self) -> [u8; 32] {
        *blake3::hash(&self.scene).as_bytes()
    }

    /// blake3 of the exercise's text.
    pub fn exercise_hash(&self) -> [u8; 32] {
        *blake3::hash(self.exercise.as_bytes()).as_bytes()
    }

    /// Pairs of the metadata record.
    pub(crate) fn to_metadata(&self, signer: &PublicKey) -> BTreeMap<String, String> {
        let mut pairs: BTreeMap<String, String> = self
            .attachments()
            .into_iter()
            .map(|(name, bytes)| (hash_key(name), blake3::hash(bytes).to_hex().to_string()))
            .collect();
        for (key, value) in [
            ("format_version", FORMAT_VERSION.to_owned()),
            ("program_version", self.program_version.clone()),
            ("build", self.build.clone()),
            (TICK_SOURCE, self.tick_source.clone()),
            ("target", self.target.clone()),
            ("station", self.station.clone()),
            ("learner_id", self.learner_id.clone()),
            ("exercise_name", self.exercise_name.clone()),
            ("seed", self.seed.to_string()),
            ("started_unix_ns", self.started_unix_ns.to_string()),
            ("signer_public_key", signer.fingerprint()),
        ] {
            pairs.insert(key.to_owned(), value);
        }
        pairs.extend(
            self.mode
                .map(|mode| (MODE.to_owned(), mode.name().to_owned())),
        );
        let devices = (!self.devices.is_empty()).then_some(&self.devices);
        for (key, value) in [
            (DEVICES, written(devices)),
            (LIMITS, written(self.limits.as_ref())),
            (PLAN, written(self.plan.as_ref())),
            (ATTACH_EPOCH, written(self.attach_epoch.as_ref())),
            (PREDECESSOR, written(self.predecessor.as_ref())),
            (COUPLINGS, coupling::written(&self.couplings)),
        ] {
            pairs.extend(value.map(|value| (key.to_owned(), value)));
        }
        if self.viewers != ViewersPolicy::default() {
            pairs.insert(VIEWERS.to_owned(), self.viewers.name().to_owned());
        }
        pairs
    }

    /// Inverse of [`SessionHeader::to_metadata`], with the attachments.
    ///
    /// # Errors
    /// A key is missing or invalid: name of the first such key.
    pub(crate) fn from_metadata(
        pairs: &BTreeMap<String, String>,
        attachments: &BTreeMap<String, Vec<u8>>,
    ) -> Result<(Self, PublicKey), String> {
        let text = |key: &str| pairs.get(key).cloned().ok_or_else(|| key.to_owned());
        let number = |key: &str| text(key)?.parse::<u64>().map_err(|_| key.to_owned());
        let attached = |key: &str| {
            String::from_utf8(attachments.get(key).cloned().unwrap_or_default())
                .map_err(|_| key.to_owned())
        };
        let signer = PublicKey::from_hex(&text("signer_public_key")?).ok_or("signer_public_key")?;
        let header = Self {
            scene: attachments.get(SCENE).cloned().unwrap_or_default(),
            exercise_name: text("exercise_name")?,
            exercise: attached(TEXTS[0])?,
            patient: attached(TEXTS[1])?,
            rubric: attached(TEXTS[2])?,
            seed: number("seed")?,
            station: text("station")?,
            learner_id: text("learner_id")?,
            mode: match pairs.get(MODE) {
                Some(name) => Some(Mode::from_name(name).ok_or(MODE)?),
                None => None,
            },
            program_version: text("program_version")?,
            build: text("build")?,
            tick_source: pairs.get(TICK_SOURCE).cloned().unwrap_or_default(),
            target: text("target")?,
            started_unix_ns: number("started_unix_ns")?,
            devices: read(pairs, DEVICES)?.unwrap_or_default(),
            limits: read(pairs, LIMITS)?,
            plan: read(pairs, PLAN)?,
            attach_epoch: read(pairs, ATTACH_EPOCH)?,
            predecessor: read(pairs, PREDECESSOR)?,
            couplings: match pairs.get(COUPLINGS) {
                Some(text) => coupling::read(text).ok_or(COUPLINGS)?,
                None => Vec::new(),
            },
            viewers: match pairs.get(VIEWERS) {
                Some(name) => ViewersPolicy::from_name(name).ok_or(VIEWERS)?,
                None => ViewersPolicy::default(),
            },
        };
        header.check()?;
        Ok((header, signer))
    }
}

/// Value of a key as JSON; `None` without a value.
fn written<T: Serialize + ?Sized>(value: Option<&T>) -> Option<String> {
    // Checked numbers and texts always serialise.
    value.and_then(|value| serde_json::to_string(value).ok())
}

/// Value of a key; `None` without the key.
///
/// # Errors
/// The value is invalid: the key.
fn read<T: DeserializeOwned>(
    pairs: &BTreeMap<String, String>,
    key: &str,
) -> Result<Option<T>, String> {
    let value = pairs.get(key).map(|text| serde_json::from_str(text));
    value.transpose().map_err(|_| key.to_owned())
}

/// Metadata key of an attachment's blake3.
pub(crate) fn hash_key(attachment: &str) -> String {
    format!("blake3 {attachment}")
}

/// Digest of the metadata. It is the first head of the chain and part of every signature, so learner, scene and signer
/// cannot be exchanged.
pub(crate) fn digest(pairs: &BTreeMap<String, String>) -> [u8; 32] {
    let mut hasher = blake3::Hasher::new();
    for text in pairs.iter().flat_map(|(key, value)| [key, value]) {
        hasher
            .update(&(text.len() as u64).to_le_bytes())
            .update(text.as_bytes());
    }
    *hasher.finalize().as_bytes()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::record::key::StationKey;
    use crate::record::plan::PlanChange;

    /// Header with every field since formats 6 and 7.
    fn full() -> SessionHeader {
        let device = |tool| DeviceFacts {
            tool,
            name: "stylus".into(),
            period_ns: 1_000_000,
            workspace_scale: 0.5,
            max_force_n: 3.3,
            max_torque_nm: 0.0,
            force_dof: 3,
            library: "openhaptics".into(),
            coupling: Some(Coupling {
                n_per_m: 400.0,
                nm_per_rad: 0.0,
            }),
            ..DeviceFacts::default()
        };
        SessionHeader {
            devices: vec![device(0), device(1)],
            limits: Some(Limits {
                max_force_n: 3.0,
                max_torque_nm: 0.1,
                max_force_step_n: 0.3,
                max_torque_step_nm: 0.01,
            }),
            plan: Some(PlanFacts {
                name: "exam A".into(),
                revision: "3".into(),
                resume_within_s: 30.0,
                clock_runs_in_gaps: false,
                changed: Some(PlanChange {
                    unix_ns: 7,
                    by: "t04".into(),
                }),
            }),
            attach_epoch: Some(4),
            predecessor: Some(Predecessor {
                file: "first.mcap".into(),
                blake3: [9; 32],
            }),
            couplings: vec![
                Coupling {
                    n_per_m: 400.0,
                    nm_per_rad: 0.1,
                };
                2
            ],
            viewers: ViewersPolicy::OnDemand,
            ..SessionHeader::new(vec![1, 2, 3])
        }
    }

    #[test]
    fn the_fields_survive_the_metadata_and_a_bad_value_is_named() {
        let signer = StationKey::from_seed([1; 32]).public();
        let header = full();
        let pairs = header.to_metadata(&signer);
        let files = header.attachments();
        let files = files.map(|(name, bytes)| (name.to_owned(), bytes.to_vec()));
        let files = BTreeMap::from(files);
        let read = |pairs: &BTreeMap<String, String>| SessionHeader::from_metadata(pairs, &files);
        assert_eq!(read(&pairs), Ok((header, signer)));
        for (key, value) in [
            (DEVICES, "[{}]"),
            (LIMITS, r#"{"max_force_n":1}"#),
            (PLAN, "7"),
            (ATTACH_EPOCH, "-1"),
            (PREDECESSOR, r#"{"file":"x","blake3":"00"}"#),
            (COUPLINGS, r#"[{"n_per_m":"soft","nm_per_rad":"1"}]"#),
            (VIEWERS, "none"),
        ] {
            let mut bad = pairs.clone();
            bad.insert(key.to_owned(), value.to_owned());
            assert_eq!(read(&bad), Err(key.to_owned()));
        }
        let refused = |change: fn(&mut SessionHeader)| {
            let mut header = full();
            change(&mut header);
            header.check().expect_err("a bad value")
        };
        let said = refused(|header| header.devices[1].tool = 0);
        assert_eq!(said, "device tool 0 occurs twice, expected once");
        let said = refused(|header| header.devices[0].workspace_scale = f64::NAN);
        assert!(said.contains("workspace_scale is NaN"), "{said}");
        let said = refused(|header| header.devices[0].force_dof = 7);
        assert!(said.contains("force_dof is 7"), "{said}");
        let said = refused(|header| header.devices[0].friction_n = -1.0);
        assert!(said.contains("friction_n is -1"), "{said}");
        let said = refused(|header| header.devices[1].torque_axes = 4);
        assert!(said.contains("torque_axes is 4"), "{said}");
        let said = refused(|header| header.couplings[1].n_per_m = 0.0);
        assert!(said.contains("tool 1: stiffness_n_per_m is 0"), "{said}");
        let said = refused(|header| {
            header.limits.as_mut().expect("limits").max_force_n = f64::INFINITY;
        });
        assert!(said.contains("max_force_n is inf"), "{said}");
        let said = refused(|header| {
            header.plan.as_mut().expect("a plan").resume_within_s = -1.0;
        });
        assert!(said.contains("resume_within_s is -1"), "{said}");
    }

    #[test]
    fn the_digest_covers_every_field() {
        let signer = StationKey::from_seed([1; 32]).public();
        let plain = full();
        let mut changed = vec![plain.clone(); 23];
        changed[0].scene.push(4);
        for (header, field) in changed[1..].iter_mut().zip(0..) {
            match field {
                0 => header.exercise_name.push('x'),
                1 => header.exercise.push('x'),
                2 => header.patient.push('x'),
                3 => header.rubric.push('x'),
                4 => header.seed += 1,
                5 => header.station.push('x'),
                6 => header.learner_id.push('x'),
                7 => header.program_version.push('x'),
                8 => header.build.push('x'),
                9 => header.target.push('x'),
                10 => header.tick_source.push('x'),
                11 => header.mode = Some(Mode::Exam),
                12 => header.mode = None,
                13 => header.devices[0].period_ns += 1,
                14 => header.limits = None,
                15 => header.plan = None,
                16 => header.attach_epoch = Some(5),
                17 => header.predecessor = None,
                18 => header.couplings[1].nm_per_rad = 0.2,
                19 => header.couplings.clear(),
                20 => header.viewers = ViewersPolicy::Recorded,
                _ => header.started_unix_ns += 1,
            }
        }
        let mut digests: Vec<_> = changed
            .iter()
            .map(|header| digest(&header.to_metadata(&signer)))
            .collect();
        digests.push(digest(&plain.to_metadata(&signer)));
        digests.push(digest(
            &plain.to_metadata(&StationKey::from_seed([2; 32]).public()),
        ));
        digests.sort_unstable();
        digests.dedup();
        assert_eq!(digests.len(), 25);
    }
}

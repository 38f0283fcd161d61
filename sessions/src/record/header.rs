//! Header of a recording: all data that are known before the first tick.

use std::collections::BTreeMap;

use crate::record::key::PublicKey;
use crate::record::mode::Mode;

/// Version of the recording's layout and of the meaning of its numbers ([`crate::record::format`]). Another version is
/// migrated or refused.
pub const FORMAT_VERSION: &str = "5";
/// Name of the metadata record.
pub(crate) const METADATA: &str = "sulcus";
/// Key of the hash of the tick's sources; absent in recordings from before 24 November 2026.
const TICK_SOURCE: &str = "tick_source";
/// Key of the mode; absent in recordings from before 24 November 2026.
const MODE: &str = "mode";
/// Name of the compiled scene's attachment.
pub(crate) const SCENE: &str = "scene.bin";
/// Attachments besides the scene: all text.
pub(crate) const TEXTS: [&str; 3] = ["exercise", "patient", "rubric"];

/// Constant data of a session.
#[derive(Clone, Debug, PartialEq, Eq)]
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
        }
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
        };
        Ok((header, signer))
    }
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

    #[test]
    fn the_digest_covers_every_field() {
        let signer = StationKey::from_seed([1; 32]).public();
        let plain = SessionHeader::new(vec![1, 2, 3]);
        let mut changed = vec![plain.clone(); 15];
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
        assert_eq!(digests.len(), 17);
    }
}

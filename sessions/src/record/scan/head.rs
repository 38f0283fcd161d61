//! Header of a recording, its attachments and its metadata, at any place of the file.

use std::collections::{BTreeMap, BTreeSet};

use mcap::records::op;

use crate::record::bytes::Cut;
use crate::record::format;
use crate::record::format::Migration;
use crate::record::gap::Gap;
use crate::record::header;
use crate::record::header::{METADATA, SCENE, SessionHeader, TEXTS};
use crate::record::key::PublicKey;
use crate::record::note;
use crate::record::note::Note;
use crate::record::read::ReadError;
use crate::record::walk;
use crate::record::walk::{Stop, Walk};

type Pairs = BTreeMap<String, String>;

/// Parts of the header, from a walk over the records that opens no chunk.
#[derive(Default)]
pub(super) struct Head {
    pairs: Pairs,
    files: BTreeMap<String, Vec<u8>>,
    /// First bytes of the header's records.
    pub placed: BTreeSet<usize>,
    /// Note of a recovery.
    note: Option<Note>,
    /// Reason for the end of the walk before the end of the data, as text.
    stopped: Option<String>,
}

/// Valid header.
pub(super) struct Checked {
    pub header: SessionHeader,
    pub signer: PublicKey,
    pub digest: [u8; 32],
    pub migration: Option<Migration>,
    /// Version of the format.
    pub format: u32,
}

impl Head {
    /// Walks from the first record to the end of the data, or to the first damage.
    pub fn read(mut walk: Walk<'_>) -> Result<Self, ReadError> {
        let mut head = Self::default();
        // The flags: this program wrote the file; metadata `sulcus` was found; data have begun.
        let (mut ours, mut said, mut data) = (false, false, false);
        loop {
            let record = match walk.peek() {
                Ok(record) => record,
                Err(stop) => {
                    if !said {
                        return Err(head.without(&stop, ours, data, walk.at));
                    }
                    head.stopped = Some(match stop {
                        Stop::Torn(why) => why.to_owned(),
                        Stop::Damaged(why) => why,
                    });
                    return Ok(head);
                }
            };
            let bad = |what: String| Err(ReadError::Header { what });
            match record.opcode {
                op::HEADER => {
                    let mut cut = Cut(record.body);
                    let _profile = cut.string();
                    ours = cut.string().is_some_and(|by| by.starts_with("sulcus"));
                }
                op::ATTACHMENT => match walk::attachment(record.body) {
                    None if said || data => {}
                    None => return bad("an attachment is incomplete".to_owned()),
                    Some((name, bytes)) => {
                        let known = name == SCENE || TEXTS.contains(&name);
                        let there = head.files.contains_key(name);
                        if known && !there {
                            head.files.insert(name.to_owned(), bytes.to_vec());
                            head.placed.insert(walk.at);
                        } else if !(said || data) {
                            // Another attachment would not be signed, but other tools would show it.
                            return bad(if there {
                                format!("there are two attachments `{name}`")
                            } else {
                                format!(
                                    "there is an attachment `{}`, expected `{SCENE}`, `{}` alone",
                                    name.escape_debug(),
                                    TEXTS.join("`, `")
                                )
                            });
                        }
                    }
                },
                op::METADATA => match walk::metadata(record.body) {
                    None if said || data => {}
                    None => return bad("metadata are incomplete".to_owned()),
                    Some((METADATA, pairs)) if !said => {
                        head.pairs = pairs;
                        head.placed.insert(walk.at);
                        said = true;
                    }
                    Some((note::METADATA, pairs)) => {
                        head.note.get_or_insert(Note(pairs));
                    }
                    Some((name, _)) if !(said || data) => {
                        return bad(format!(
                            "there is metadata `{}`, expected `{METADATA}` alone",
                            name.escape_debug()
                        ));
                    }
                    Some(_) => {}
                },
                op::DATA_END if said => return Ok(head),
                op::DATA_END => return Err(ReadError::NotSulcus),
                op::CHUNK | op::MESSAGE | op::SCHEMA | op::CHANNEL | op::MESSAGE_INDEX => {
                    data = true;
                }
                opcode if opcode >= 0x80 => {}
                _ if said => return Ok(head),
                _ => return Err(ReadError::NotSulcus),
            }
            walk.pass(&record);
        }
    }

    /// Error for a file that ends before its metadata.
    fn without(&self, stop: &Stop, ours: bool, data: bool, at: usize) -> ReadError {
        match stop {
            Stop::Torn(_) if !data && (ours || at == mcap::MAGIC.len()) => {
                ReadError::HeaderCut { at: at as u64 }
            }
            Stop::Damaged(what) if !data && ours => ReadError::Header { what: what.clone() },
            stop if data && (ours || !self.files.is_empty()) => {
                let why = match stop {
                    Stop::Torn(why) => why,
                    Stop::Damaged(why) => why.as_str(),
                };
                ReadError::Header {
                    what: format!(
                        "there is no metadata `{METADATA}` before byte {at}, where {why}"
                    ),
                }
            }
            _ => ReadError::NotSulcus,
        }
    }

    /// Gaps in the recovery's note; none for an invalid list, which the pass reports.
    pub fn gaps(&self) -> Vec<Gap> {
        self.note.as_ref().and_then(Note::gaps).unwrap_or_default()
    }

    /// Checks version, hashes and fields.
    pub fn check(&self) -> Result<Checked, ReadError> {
        let pairs = &self.pairs;
        let found = pairs.get("format_version").cloned().unwrap_or_default();
        let migration = format::reads(&found).map_err(|advice| ReadError::Version {
            advice,
            found: found.escape_debug().to_string(),
            expected: format::readable(),
        })?;
        for name in [SCENE].into_iter().chain(TEXTS) {
            let data = self.files.get(name);
            let hash = blake3::hash(data.map_or(&[][..], Vec::as_slice)).to_hex();
            if pairs.get(&header::hash_key(name)).map(String::as_str) == Some(hash.as_str()) {
                continue;
            }
            let what = match (data, &self.stopped) {
                (None, None) => format!("there is no attachment `{name}`"),
                (None, Some(why)) => {
                    format!("there is no attachment `{name}` in the readable part: {why}")
                }
                _ => {
                    format!("attachment `{name}` does not match the hash that the header gives")
                }
            };
            return Err(ReadError::Header { what });
        }
        let (header, signer) =
            SessionHeader::from_metadata(pairs, &self.files).map_err(|key| ReadError::Header {
                what: format!("field `{key}` is missing or invalid"),
            })?;
        Ok(Checked {
            digest: header::digest(pairs),
            header,
            signer,
            migration,
            // A version that is read is a number.
            format: found.parse().unwrap_or_default(),
        })
    }
}

//! Codes with which learners sign in at a station: six digits, valid for a few hours, stored as hashes.
//!
//! A code opens nothing by itself: the station has its own ticket. The code says which learner sits there. The hash
//! keeps a code from a glance at the file, and its million values from nobody who copies the file.

use sulcus_proto::hex::{from_hex32, hex};

use super::record::{Code, Roll};
use crate::state::error::{StateError, random};

/// Number of digits.
pub const DIGITS: usize = 6;
/// Longest time for which a code is valid, hours.
pub const MOST_HOURS: u32 = 24 * 366;

/// Code of a text that a person typed: blanks and hyphens do not count. `None`: no code.
pub fn typed(text: &str) -> Option<String> {
    if text.len() > 64 {
        return None;
    }
    let digits = text.chars().filter(|c| !c.is_whitespace() && *c != '-');
    let code: String = digits.collect();
    let is_code = code.len() == DIGITS && code.bytes().all(|c| c.is_ascii_digit());
    is_code.then_some(code)
}

/// Code in two groups, for reading aloud and for paper.
pub fn shown(code: &str) -> String {
    let (first, second) = code.split_at_checked(DIGITS / 2).unwrap_or((code, ""));
    format!("{first} {second}")
}

/// Gives each of the learners a new code and returns the codes, in the same order. Former codes end.
///
/// # Errors
/// The system has no random numbers.
pub(super) fn give(
    roll: &mut Roll,
    learners: &[String],
    until_unix_s: u64,
    now_s: u64,
) -> Result<Vec<String>, StateError> {
    let key = match from_hex32(&roll.key) {
        Some(key) => key,
        None => {
            let mut key = [0; 32];
            random(&mut key)?;
            roll.key = hex(&key);
            // Codes under a lost key can no longer be told apart.
            roll.learners.iter_mut().for_each(|one| one.code = None);
            key
        }
    };
    for learner in &mut roll.learners {
        let is_old = |code: &Code| code.until_unix_s <= now_s;
        if learners.contains(&learner.id) || learner.code.as_ref().is_some_and(is_old) {
            learner.code = None;
        }
    }
    let mut made = Vec::with_capacity(learners.len());
    for id in learners {
        let (code, hash) = loop {
            let code = draw()?;
            let hash = hash(&key, &code);
            let is_taken = |code: &Code| code.hash == hash;
            if !roll
                .learners
                .iter()
                .any(|one| one.code.as_ref().is_some_and(is_taken))
            {
                break (code, hash);
            }
        };
        if let Some(learner) = roll.learners.iter_mut().find(|one| one.id == *id) {
            learner.code = Some(Code { hash, until_unix_s });
        }
        made.push(code);
    }
    Ok(made)
}

/// Learner with a code that is valid at a time.
pub(super) fn find<'a>(roll: &'a Roll, code: &str, now_s: u64) -> Option<&'a str> {
    let key = from_hex32(&roll.key)?;
    let wanted = blake3::Hash::from_bytes(from_hex32(&hash(&key, &typed(code)?))?);
    let mut found = None;
    for learner in &roll.learners {
        let Some(code) = &learner.code else { continue };
        // Hashes compare in constant time, and every learner is looked at.
        let is_it =
            from_hex32(&code.hash).is_some_and(|own| blake3::Hash::from_bytes(own) == wanted);
        if is_it && now_s < code.until_unix_s {
            found = Some(learner.id.as_str());
        }
    }
    found
}

fn hash(key: &[u8; 32], code: &str) -> String {
    hex(blake3::keyed_hash(key, code.as_bytes()).as_bytes())
}

/// Six random digits, each combination with the same chance.
fn draw() -> Result<String, StateError> {
    const COUNT: u32 = 1_000_000;
    loop {
        let mut bytes = [0; 4];
        random(&mut bytes)?;
        let number = u32::from_le_bytes(bytes);
        // Numbers above the last whole multiple would favour small codes.
        if number < u32::MAX / COUNT * COUNT {
            return Ok(format!("{:06}", number % COUNT));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::record::Learner;
    use super::*;

    fn roll(count: usize) -> Roll {
        let learner = |k: usize| Learner {
            id: format!("s-{k}"),
            class: "c-1".into(),
            task: None,
            code: None,
        };
        Roll {
            learners: (0..count).map(learner).collect(),
            ..Roll::default()
        }
    }

    #[test]
    fn a_code_names_its_learner_until_its_end_and_no_other() {
        let mut roll = roll(40);
        let ids: Vec<String> = roll.learners.iter().map(|one| one.id.clone()).collect();
        let codes = give(&mut roll, &ids, 100, 0).expect("random numbers");
        for (id, code) in ids.iter().zip(&codes) {
            assert_eq!(find(&roll, code, 99), Some(id.as_str()));
            assert_eq!(find(&roll, &shown(code), 99), Some(id.as_str()));
            assert_eq!(find(&roll, code, 100), None);
            assert!(!format!("{roll:?}").contains(&format!("\"{code}\"")));
        }
        let distinct: std::collections::BTreeSet<&String> = codes.iter().collect();
        assert_eq!(distinct.len(), codes.len());
        let again = give(&mut roll, &ids[..1], 100, 0).expect("random numbers");
        if again[0] != codes[0] {
            assert_eq!(find(&roll, &codes[0], 1), None);
        }
        assert_eq!(find(&roll, &again[0], 1), Some("s-0"));
        assert_eq!(find(&roll, &codes[1], 1), Some("s-1"));
    }

    #[test]
    fn typed_codes_may_have_blanks_and_nothing_else() {
        for text in ["123456", "123 456", " 123-456\n"] {
            assert_eq!(typed(text).as_deref(), Some("123456"), "{text}");
        }
        for text in ["", "12345", "1234567", "12345a", "１２３４５６", "+12345"] {
            assert_eq!(typed(text), None, "{text}");
        }
        assert_eq!(find(&Roll::default(), "123456", 0), None);
    }
}

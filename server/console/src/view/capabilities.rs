//! Paths that open one stream once.
//!
//! The viewer's request for a stream has no cookie. A signed-in page therefore asks for a path with 128 random bits,
//! which is the right to one stream. The right is for one stream and one use, ends after [`LONGEST`], and ends with
//! the sign-in that asked for it.

use std::collections::BTreeMap;
use std::sync::{Mutex, PoisonError};
use std::time::{Duration, Instant};

use sulcus_proto::hex::hex;

use crate::guard::Caller;

/// Time in which a path must be used.
pub const LONGEST: Duration = Duration::from_secs(60);
/// Largest number of unused paths. The oldest one ends for a further one.
const MOST: usize = 256;

/// Stream of a right.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Shows {
    /// Live stream of the station with this name.
    Live(String),
    /// Replay of a recorded session about a moment.
    Replay {
        /// Id of the session.
        session: String,
        /// Time of the moment in the session, milliseconds.
        at_ms: u64,
    },
    /// Mouth of the case with this name, at rest.
    Case(String),
}

/// Right to a stream.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Right {
    /// Stream.
    pub shows: Shows,
    /// Sign-in that asked for the path.
    pub caller: Caller,
}

/// All unused paths, by the hash of their random part: the memory of the server holds none that opens a stream.
#[derive(Default)]
pub struct Capabilities(Mutex<BTreeMap<[u8; 32], (Instant, Right)>>);

impl Capabilities {
    /// Makes a path for a right. Returns its random part as text.
    ///
    /// # Errors
    /// The system gives no random numbers.
    pub fn make(&self, right: Right, now: Instant) -> Result<String, getrandom::Error> {
        let mut bytes = [0; 16];
        getrandom::fill(&mut bytes)?;
        let secret = hex(&bytes);
        let mut map = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        map.retain(|_, (made, _)| is_valid(*made, now));
        if map.len() >= MOST
            && let Some(oldest) = map
                .iter()
                .min_by_key(|(_, (made, _))| *made)
                .map(|(key, _)| *key)
        {
            map.remove(&oldest);
        }
        map.insert(key(&secret), (now, right));
        Ok(secret)
    }

    /// Takes the right of a path. A second call with the same path finds none.
    pub fn take(&self, secret: &str, now: Instant) -> Option<Right> {
        let mut map = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        let (made, right) = map.remove(&key(secret))?;
        is_valid(made, now).then_some(right)
    }
}

fn is_valid(made: Instant, now: Instant) -> bool {
    now.saturating_duration_since(made) < LONGEST
}

fn key(secret: &str) -> [u8; 32] {
    *blake3::hash(secret.as_bytes()).as_bytes()
}

#[cfg(test)]
mod tests {
    use sulcus_proto::Role;

    use super::*;
    use crate::house::Holder;

    fn right(station: &str) -> Right {
        let holder = Holder {
            id: "t-1".into(),
            role: Role::Instructor,
            station: None,
        };
        Right {
            shows: Shows::Live(station.into()),
            caller: Caller {
                holder,
                session: Some("s".into()),
            },
        }
    }

    #[test]
    fn a_path_opens_its_own_station_once_within_a_minute() {
        let (all, begin) = (Capabilities::default(), Instant::now());
        let [a, b, late] = ["a", "b", "a"].map(|name| all.make(right(name), begin).expect("made"));
        assert_eq!(a.len(), 32);
        let soon = begin + LONGEST - Duration::from_millis(1);
        assert_eq!(all.take(&a, soon), Some(right("a")));
        assert_eq!(all.take(&a, soon), None, "used twice");
        assert_eq!(all.take(&b, soon), Some(right("b")));
        assert_eq!(all.take(&late, begin + LONGEST), None, "too late");
        assert_eq!(all.take(&late, begin), None, "a late use ends it");
        assert_eq!(all.take("", begin), None);
    }

    #[test]
    fn the_number_of_unused_paths_is_bounded_and_the_oldest_goes() {
        let (all, begin) = (Capabilities::default(), Instant::now());
        let made: Vec<String> = (0..=MOST as u64)
            .map(|k| all.make(right("a"), begin + Duration::from_millis(k)))
            .map(|made| made.expect("made"))
            .collect();
        let now = begin + Duration::from_secs(1);
        assert_eq!(all.take(&made[0], now), None);
        assert!(all.take(&made[1], now).is_some());
    }
}

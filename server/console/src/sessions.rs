//! Signed-in browsers: random ids with an idle and an absolute end.

use std::collections::BTreeMap;
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};

use sulcus_proto::hex::hex;

use crate::house::Holder;

/// Name of the cookie. The prefix `__Host-` makes browsers accept it from this origin alone, over TLS, for all paths.
pub const COOKIE: &str = "__Host-sulcus";
/// Time without a request after which a session ends.
pub const IDLE: Duration = Duration::from_secs(60 * 60);
/// Time after the sign-in at which a session ends.
pub const LONGEST: Duration = Duration::from_secs(12 * 60 * 60);
/// Largest number of sessions. The session that was idle longest ends for a further one.
pub const MOST: usize = 512;

struct Session {
    holder: Holder,
    began: Instant,
    last: Instant,
}

/// All sessions, by the hash of their id: the memory of the server holds no id that opens one.
#[derive(Default)]
pub struct Sessions(Mutex<BTreeMap<[u8; 32], Session>>);

impl Sessions {
    fn map(&self) -> MutexGuard<'_, BTreeMap<[u8; 32], Session>> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Begins a session. Returns its id, 128 random bits as text.
    ///
    /// # Errors
    /// The system gives no random numbers.
    pub fn begin(&self, holder: Holder, now: Instant) -> Result<String, getrandom::Error> {
        let mut bytes = [0; 16];
        getrandom::fill(&mut bytes)?;
        let id = hex(&bytes);
        let mut map = self.map();
        map.retain(|_, session| session.goes_on(now));
        if map.len() >= MOST
            && let Some(idle) = map
                .iter()
                .min_by_key(|(_, session)| session.last)
                .map(|(key, _)| *key)
        {
            map.remove(&idle);
        }
        let session = Session {
            holder,
            began: now,
            last: now,
        };
        map.insert(key(&id), session);
        Ok(id)
    }

    /// Holder of the session `id`. A request with it delays the idle end, unless `is_background`: a page that nobody
    /// looks at must not keep a session for ever.
    pub fn holder(&self, id: &str, now: Instant, is_background: bool) -> Option<Holder> {
        let mut map = self.map();
        let session = map.get_mut(&key(id))?;
        if !session.goes_on(now) {
            map.remove(&key(id));
            return None;
        }
        if !is_background {
            session.last = now;
        }
        Some(session.holder.clone())
    }

    /// Ends a session.
    pub fn end(&self, id: &str) {
        self.map().remove(&key(id));
    }

    /// Ends all sessions of a token.
    pub fn end_of(&self, token: &str) {
        self.map().retain(|_, session| session.holder.id != token);
    }

    /// Number of sessions.
    pub fn count(&self) -> usize {
        self.map().len()
    }
}

impl Session {
    fn goes_on(&self, now: Instant) -> bool {
        now.saturating_duration_since(self.last) < IDLE
            && now.saturating_duration_since(self.began) < LONGEST
    }
}

fn key(id: &str) -> [u8; 32] {
    *blake3::hash(id.as_bytes()).as_bytes()
}

#[cfg(test)]
mod tests {
    use sulcus_proto::Role;

    use super::*;

    fn holder(id: &str) -> Holder {
        Holder {
            id: id.into(),
            role: Role::Instructor,
            station: None,
        }
    }

    #[test]
    fn a_session_ends_when_idle_and_at_its_longest_and_a_stream_keeps_none() {
        let (sessions, begin) = (Sessions::default(), Instant::now());
        let id = sessions.begin(holder("t-1"), begin).expect("an id");
        assert_eq!(id.len(), 32);
        let half = IDLE / 2;
        assert!(sessions.holder(&id, begin + half, true).is_some());
        assert!(
            sessions.holder(&id, begin + IDLE, true).is_none(),
            "a stream kept it"
        );
        let id = sessions.begin(holder("t-1"), begin).expect("an id");
        let mut now = begin;
        while now + half < begin + LONGEST {
            now += half;
            assert!(sessions.holder(&id, now, false).is_some());
        }
        assert!(sessions.holder(&id, begin + LONGEST, false).is_none());
        assert_eq!(sessions.count(), 0);
    }

    #[test]
    fn a_session_ends_by_itself_or_with_its_token_and_others_go_on() {
        let (sessions, now) = (Sessions::default(), Instant::now());
        let ids = ["a", "a", "b"].map(|token| sessions.begin(holder(token), now).expect("an id"));
        sessions.end(&ids[0]);
        assert!(sessions.holder(&ids[0], now, false).is_none());
        assert!(sessions.holder(&ids[1], now, false).is_some());
        sessions.end_of("a");
        assert!(sessions.holder(&ids[1], now, false).is_none());
        assert_eq!(sessions.holder(&ids[2], now, false), Some(holder("b")));
        assert!(sessions.holder("", now, false).is_none());
    }

    #[test]
    fn the_number_of_sessions_is_bounded_and_the_longest_idle_one_goes() {
        let (sessions, begin) = (Sessions::default(), Instant::now());
        let ids: Vec<String> = (0..=MOST as u64)
            .map(|k| {
                let now = begin + Duration::from_millis(k);
                sessions.begin(holder("t"), now).expect("an id")
            })
            .collect();
        assert_eq!(sessions.count(), MOST);
        let now = begin + Duration::from_secs(1);
        assert!(sessions.holder(&ids[0], now, false).is_none());
        assert!(sessions.holder(&ids[1], now, false).is_some());
    }
}

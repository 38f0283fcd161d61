//! Place of a session's ticks: at the server, or at the hand if the client wishes it and nothing is against it.

use sulcus_proto::control::{ClientHello, capability};

use crate::station::config::SessionPlan;

/// Wish of a client about the place of its ticks.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Wish {
    /// The server ticks.
    Server,
    /// The client ticks, with a compiled scene of this hash.
    Hand {
        /// BLAKE3 hash of the client's compiled scene.
        scene_hash: [u8; 32],
        /// Whether the client can tick at all, with the same bits as the server.
        same_bits: bool,
    },
}

impl Wish {
    /// Wish in a client's hello to a server whose self-test has the hash `self_test`.
    pub fn of(hello: &ClientHello, self_test: u64) -> Self {
        if !hello.tick_at_hand {
            return Self::Server;
        }
        let able = hello.capabilities & capability::TICK_AT_HAND != 0;
        Self::Hand {
            scene_hash: hello.scene_hash,
            same_bits: able && hello.self_test == self_test,
        }
    }

    /// Whether the ticks run at the hand in a new session.
    ///
    /// # Errors
    /// The reason against the wish, one sentence.
    pub fn granted(self, plan: &SessionPlan) -> Result<bool, &'static str> {
        let Self::Hand {
            scene_hash,
            same_bits,
        } = self
        else {
            return Ok(false);
        };
        if !plan.tick_at_hand {
            return Err("the plan keeps the ticks at the server");
        }
        if plan.detail.fixed().is_none() {
            return Err("the plan chooses the detail of tissue by the server's time");
        }
        if scene_hash != *blake3::hash(&plan.scene_bytes).as_bytes() {
            return Err("the client has another compiled scene than the server");
        }
        if !same_bits {
            return Err(
                "the tick of this client gives other bits than that of the server: install the same release, on the \
                 same kind of processor",
            );
        }
        Ok(true)
    }
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use super::*;
    use crate::session::detail::{Budget, Detail};
    use crate::session::simulation::tests::scene;

    #[test]
    fn each_reason_against_ticks_at_the_hand_is_said() {
        let scene = scene();
        let bytes = scene.to_bytes().expect("bytes");
        let scene_hash = *blake3::hash(&bytes).as_bytes();
        let plan = SessionPlan::new(Arc::new(scene), Arc::new(bytes));
        let wish = |scene_hash, same_bits| Wish::Hand {
            scene_hash,
            same_bits,
        };
        let good = wish(scene_hash, true);
        assert_eq!(Wish::Server.granted(&plan), Ok(false));
        assert_eq!(good.granted(&plan), Ok(true));
        let kept = SessionPlan {
            tick_at_hand: false,
            ..plan.clone()
        };
        let by_time = SessionPlan {
            detail: Detail::ByTime(Budget::default()),
            ..plan.clone()
        };
        for (wish, plan, said) in [
            (good, &kept, "the plan keeps the ticks"),
            (good, &by_time, "detail"),
            (wish([1; 32], true), &plan, "another compiled scene"),
            (wish(scene_hash, false), &plan, "other bits"),
        ] {
            let error = wish.granted(plan).expect_err(said);
            assert!(error.contains(said), "{error}");
        }
    }
}

//! kill -9 of the server at random moments: the recording recovers and replays.
//!
//! The bound of 200 ms on the loss is claimed by the times of the record: `sessions/tests/it/kill.rs`.

use std::path::Path;
use std::time::Duration;

use sulcus_sessions::{Ending, Recording, Signature};
use sulcus_tests::{Ended, Place, Program};

/// A number between 0 and 1 that looks like chance: SplitMix64 of `seed`.
fn chance(seed: u64) -> f64 {
    let mut z = seed.wrapping_mul(0x9e37_79b9_7f4a_7c15);
    z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    ((z ^ (z >> 31)) >> 11) as f64 / (1u64 << 53) as f64
}

/// Twenty kills are among the long proofs.
#[test]
fn after_each_kill_the_recording_recovers_and_replays() {
    kill(0..3);
}

/// Kills a server once for each number, and asserts that the recording recovers and replays.
pub fn kill(numbers: std::ops::Range<u64>) {
    let place = Place::new();
    for k in numbers {
        let recordings = format!("recordings/{k}");
        // The client would try for 30 s to return to a server that is gone.
        let server = ["--resume-within", "1", "--recordings", &recordings];
        let mut server = place.serve(&server);
        let session = place.join(&server);
        let file = place.begun(&recordings);
        // Anywhere within and between two flushes, one to twenty of them into the session.
        std::thread::sleep(Duration::from_secs_f64(2.0 * chance(k)));
        server.process.kill().expect("SIGKILL");
        server.process.wait().expect("it is gone");
        let ended = Ended::new(
            session
                .wait_with_output()
                .expect("the client ends by itself"),
        );
        let heard = ended.json()["device"]["last_tick"].as_u64();
        let heard = heard.unwrap_or_else(|| panic!("no last tick: {ended:#?}"));

        let text = |path: &Path| path.to_str().expect("plain").to_owned();
        let whole = place.path(&format!("whole-{k}.mcap"));
        let recovered = place
            .run(
                Program::Sessions,
                &["info", &text(&file), "--recover", &text(&whole), "--json"],
            )
            .ok()
            .json();
        let last = recovered["last_tick"].as_u64().expect("a tick");
        println!("kill {k}: recorded to tick {last}, heard of {heard}");
        assert!(last > 0 && heard > 0, "kill {k}: {last}, {heard}");
        assert!(
            Recording::open(&file).is_ok_and(|torn| matches!(torn.ending(), Ending::CutOff { .. }))
        );
        let opened = Recording::open(&whole).expect("what was recovered opens");
        assert!(
            matches!(opened.ending(), Ending::Recovered { .. }),
            "kill {k}: {}",
            opened.ending()
        );
        let verdict = sulcus_sessions::verify(&opened, None).expect("reads");
        assert!(
            verdict.chain_ok && matches!(verdict.signature, Signature::Unsigned { .. }),
            "{verdict:?}"
        );
        let replay = place.run(Program::Sessions, &["replay", &text(&whole), "--json"]);
        assert_eq!(
            replay.code, 1,
            "identical as far as it goes, and not the whole session: {replay:#?}"
        );
        let replay = replay.json();
        assert_eq!(
            (&replay["identical"], &replay["gradable"]),
            (&true.into(), &false.into()),
            "{replay}"
        );
        assert_eq!(replay["ticks"], recovered["ticks"]);
    }
}

//! kill -9 of the server at random moments: the recording recovers, and replays up to 200 ms before the kill.

use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use sulcus_sessions::{Ending, Recording, Signature};
use sulcus_tests::{Ended, Place, Program, files_with};

/// Ticks that may be missing before the kill.
const MOST_LOST: u64 = 200;

/// A number between 0 and 1 that looks like chance: SplitMix64 of `seed`.
fn chance(seed: u64) -> f64 {
    let mut z = seed.wrapping_mul(0x9e37_79b9_7f4a_7c15);
    z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    ((z ^ (z >> 31)) >> 11) as f64 / (1u64 << 53) as f64
}

/// Waits for the one recording under `folder` to hold its first rows.
fn begun(folder: &Path) -> PathBuf {
    let began = Instant::now();
    loop {
        if let [file] = files_with(folder, "mcap").as_slice()
            && Recording::open(file).is_ok()
        {
            return file.clone();
        }
        assert!(
            began.elapsed() < Duration::from_secs(60),
            "no session began"
        );
        std::thread::sleep(Duration::from_millis(5));
    }
}

/// Twenty kills are among the long proofs.
#[test]
fn kills_lose_at_most_a_fifth_of_a_second_each() {
    kill(0..3);
}

/// Kills a server once for each number, and asserts that the recording recovers and replays.
pub fn kill(numbers: std::ops::Range<u64>) {
    let place = Place::new();
    for k in numbers {
        let recordings = format!("recordings/{k}");
        let mut server = place.serve(&["--recordings", &recordings]);
        let session = place.join(&server);
        let file = begun(&place.path(&recordings));
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
        assert!(
            last + MOST_LOST >= heard,
            "kill {k}: recorded to tick {last}, heard of {heard}"
        );
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

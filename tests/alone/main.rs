//! Hands of a recording as a device, in a process of its own: sessions of other tests would take poses on two cores.

use sulcus_sessions::{Recording, Row};
use sulcus_tests::{Place, files_with, rows};

/// Number of poses in a piece of the motion.
const PIECE: usize = 20;

/// Poses of the first tool while it is present, as bits.
fn poses(rows: &[Row]) -> Vec<[u64; 7]> {
    let present = rows.iter().filter(|row| row.input.tools[0].present);
    let bits = |row: &Row| {
        let pose = &row.input.tools[0].pose;
        let [x, y, z] = pose.position.map(|x| f64::from(x).to_bits());
        let [w, i, j, k] = pose.orientation.map(|x| f64::from(x).to_bits());
        [x, y, z, w, i, j, k]
    };
    let mut all: Vec<_> = present.map(bits).collect();
    all.dedup();
    all
}

#[test]
fn the_hands_of_a_recording_play_again_and_feel_the_same_tooth() {
    let place = Place::new();
    let server = place.serve(&[]);
    place.perform(&server, &["--duration", "8"]).ok();
    let first = place.recording();
    let device = format!("playback:{}", first.display());
    place
        .perform(&server, &["--device", &device, "--duration", "20"])
        .ok();
    let all = files_with(&place.path("recordings"), "mcap");
    let second = all.iter().find(|file| **file != first);
    let of = |file: &std::path::Path| rows(&Recording::open(file).expect("a recording"));
    let (first, second) = (of(&first), of(second.expect("a second recording")));
    // The recording ends with its hands: no session of 20 s.
    assert!(
        second.len() < first.len() + 2000,
        "{} ticks of {}",
        second.len(),
        first.len()
    );
    let (once, again) = (poses(&first), poses(&second));
    let number: std::collections::BTreeMap<_, _> = once.iter().zip(0..).collect();
    let numbers: Vec<usize> = again
        .iter()
        .filter_map(|pose| number.get(pose).copied())
        .collect();
    assert!(
        numbers.len() * 100 >= again.len() * 99,
        "{} of {}",
        numbers.len(),
        again.len()
    );
    assert!(numbers.is_sorted(), "the hands go back in time");
    // A tick uses the newest pose alone. Which single poses it leaves out depends on how two threads wake, so the
    // motion is compared in pieces of 20 poses. A unit test of the device compares every pose.
    let pieces = |numbers: &mut dyn Iterator<Item = usize>| {
        let pieces: std::collections::BTreeSet<_> = numbers.map(|number| number / PIECE).collect();
        pieces.len()
    };
    let (whole, played) = (
        pieces(&mut (0..once.len())),
        pieces(&mut numbers.into_iter()),
    );
    assert!(
        played * 100 >= whole * 95,
        "{played} of {whole} pieces of {PIECE} poses"
    );
    let most = |rows: &[Row]| {
        let force = |row: &Row| row.wrench[0][2].abs();
        rows.iter().map(force).fold(0.0, f32::max)
    };
    let (once, again) = (most(&first), most(&second));
    assert!(
        once > 0.05 && (again - once).abs() < 0.2 * once,
        "{once} N, {again} N"
    );
}

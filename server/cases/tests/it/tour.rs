//! The simulated operator probes whole teeth of a generated patient: well, and badly in named ways.

use std::sync::LazyLock;

use sulcus_cases::mouth::{examine, mouth};
use sulcus_cases::toured::{Read, Toured, perform};
use sulcus_core::Scene;
use sulcus_core::tissue::gingiva::Site;
use sulcus_operator::habit::Habit;
use sulcus_operator::pocket_path::{Manner, PocketPath};
use sulcus_operator::tour::Tour;
use sulcus_operator::tour_params::{TourParams, Visit};
use sulcus_scene::{BuildOptions, compile_text};

/// Tooth that is probed here, between its neighbours.
const TOOTH: u8 = 36;

/// The teeth 35 to 37 of a patient, with a probe: proximal depths well above the mid ones.
fn part() -> Scene {
    static SCENE: LazyLock<Scene> = LazyLock::new(compiled);
    SCENE.clone()
}

fn compiled() -> Scene {
    let text = r#"
name = "part of a mouth"
[mouth]
condition = "periodontitis"
seed = 1
teeth = [35, 36, 37]
tooth_levels = 3
[[tool]]
name = "probe"
kind = "periodontal_probe"
level = 3
levels = 4
park_mm = [0.0, 0.0, 140.0]
"#;
    compile_text(
        text,
        "part.toml".as_ref(),
        &BuildOptions::cached(),
        &|_, _| {},
    )
    .expect("compiles")
    .scene
}

/// Probes the tooth, with a habit or well.
fn probed(scene: &Scene, habit: Option<Habit>) -> Toured {
    let (mut params, mut tour) = (TourParams::default(), vec![Visit::whole(TOOTH)]);
    if let Some(habit) = habit {
        habit.spoil(&mut params, &mut tour, 3);
    }
    let tour = Tour::new(scene, &tour, params).expect("a tooth with gingiva");
    let toured = perform(scene, Box::new(tour), (0, 7), |_| {});
    println!("{}:\n{toured}", habit.map_or("good", Habit::name));
    assert!(toured.done);
    toured
}

/// From the middle of this tooth to its deep mesial side the floor rises before it falls: a tip let down before it was there slid
/// back, stop after stop, and 0.5 mm were reached of 7.
#[test]
fn a_tip_is_not_let_down_before_it_is_over_a_ridge_of_the_floor() {
    let examined = examine(&mouth(14, false, 3), &[32], None);
    let read = examined.toured.of(32, Site::MesioBuccal);
    assert!(read.holds(), "{read:?}");
    assert!(read.prescribed > 6e-3, "{read:?}");
}

/// A probe that leans over a molar's crown is pressed against the flaring root: 0.19 N of the 0.26 that a hand pressed with were not
/// the floor's, and 6.7 mm were reached of 7.
#[test]
fn what_the_walls_of_a_deep_pocket_push_is_not_taken_for_the_floor() {
    let examined = examine(&mouth(2, false, 3), &[37], None);
    for site in [Site::DistoBuccal, Site::DistoLingual] {
        let read = examined.toured.of(37, site);
        assert!(read.prescribed > 6.9e-3, "{read:?}");
        assert!(read.error().abs() < 0.17e-3, "{read:?}");
    }
}

#[test]
fn a_good_operator_reaches_what_is_prescribed_and_bad_ones_show() {
    let scene = part();
    let good = probed(&scene, None);
    assert_eq!(good.calls.len(), 6);
    for site in Site::ALL {
        let read = good.of(TOOTH, site);
        assert!((read.reached - read.prescribed).abs() <= 0.3e-3, "{read:?}");
        let called = f64::from(read.called.expect("called"));
        assert!((called - read.prescribed * 1e3).abs() <= 1.0, "{read:?}");
        assert!(read.most_force < 0.4, "{read:?}");
    }
    assert!(good.time < 6.0 * 7.2, "{} s", good.time);
    let most = |toured: &Toured| {
        toured
            .reads
            .iter()
            .fold(0.0, |most, read| read.most_force.max(most))
    };

    let heavy = probed(&scene, Some(Habit::HeavyHand));
    assert!(most(&heavy) > 0.5, "{}", most(&heavy));

    // Tilted, the tip catches under the margin: it never comes down into a deep pocket.
    let tilted = probed(&scene, Some(Habit::WrongAngle));
    for site in Site::ALL {
        let (read, right) = (tilted.of(TOOTH, site), good.of(TOOTH, site));
        let apart = read.up.dot(&right.up).clamp(-1.0, 1.0).acos();
        // At 36 buccal a good hand leans over the crown's bulge as it presses: the tilts are 0.247 rad apart.
        let least = if site == Site::Buccal { 0.24 } else { 0.25 };
        assert!(read.tilt > right.tilt + least, "{read:?}");
        // A good hand leans too, but to another side under a contact.
        assert!(apart > 0.3, "{apart}: {read:?}");
        if site.is_proximal() {
            assert!(read.reached <= read.prescribed - 0.5e-3, "{read:?}");
        }
    }

    let skips = probed(&scene, Some(Habit::SkipsSites));
    assert!(skips.of(TOOTH, Site::DistoLingual).called.is_none());
    assert_eq!(skips.calls.len(), 4);

    let impatient = probed(&scene, Some(Habit::Impatient));
    assert!(impatient.time < 0.7 * good.time);
    assert!(most(&impatient) < most(&good));

    let spots = probed(&scene, Some(Habit::SpotProbes));
    assert_eq!(spots.calls.len(), 6);
    assert_eq!((spots.entries, good.entries), (6, 2));

    let misreads = probed(&scene, Some(Habit::Misreads));
    let wrong = Site::ALL
        .into_iter()
        .filter(|site| misreads.of(TOOTH, *site).called != good.of(TOOTH, *site).called);
    assert!(wrong.count() >= 2);
}

#[test]
fn the_shaft_leans_to_its_own_side_and_never_jumps() {
    let scene = part();
    let path = PocketPath::new(&scene, Some(TOOTH), 0.0, Manner::Taught).expect("a tooth");
    let frame = *path.tooth();
    for sign in [1.0, -1.0] {
        let mut last: Option<sulcus_core::Vec3> = None;
        for degrees in 8..=172 {
            let up = path
                .place(sign * f64::from(degrees).to_radians(), 3e-3, 0.0)
                .up;
            assert!(up.dot(&frame.buccal) * sign > -0.1, "{degrees}: {up:?}");
            assert!(up.dot(&frame.axis) > 0.65, "{degrees}: {up:?}");
            if let Some(last) = last {
                let turn = up.dot(&last).clamp(-1.0, 1.0).acos().to_degrees();
                assert!(
                    turn < 4.0,
                    "{turn} degrees between {degrees} and the one before"
                );
            }
            last = Some(up);
        }
    }
    // Beside a neighbour the taught way goes farther in than an upright one.
    let upright = PocketPath::new(&scene, Some(TOOTH), 0.0, Manner::Upright).expect("a tooth");
    let inmost =
        |path: &PocketPath| (0..60).find(|d| path.ceiling(f64::from(*d).to_radians()).is_some());
    assert!(
        inmost(&path) < inmost(&upright),
        "{:?} {:?}",
        inmost(&path),
        inmost(&upright)
    );
}

/// A canine and a molar of a patient; whole mouths are among the long proofs.
#[test]
fn a_good_operator_reaches_every_floor_of_two_teeth_and_is_never_inside_a_tooth() {
    every_floor_is_reached(5, &[33, 46]);
}

/// Asserts that the good operator reads every floor of a patient, of all teeth where none is named, and stays outside of them.
pub fn every_floor_is_reached(seed: u64, teeth: &[u8]) {
    let scene = mouth(seed, false, 3);
    let examined = examine(&scene, teeth, None);
    let toured = &examined.toured;
    println!("patient {seed}:\n{toured}");
    assert!(toured.done);
    let asked = |read: &&Read| teeth.is_empty() || teeth.contains(&read.tooth);
    let reads: Vec<&Read> = toured.reads.iter().filter(asked).collect();
    assert_eq!(toured.calls.len(), reads.len());
    let fewest = if teeth.is_empty() { 10 } else { teeth.len() };
    assert!(reads.len() >= 6 * fewest);
    let short: Vec<_> = reads.iter().filter(|read| !read.holds()).collect();
    assert!(short.is_empty(), "patient {seed}: {short:#?}");
    for (fdi, inside, allowed) in &examined.inside {
        println!(
            "tooth {fdi}: deepest {:.4} mm inside, allowed {:.4} mm",
            inside * 1e3,
            allowed * 1e3
        );
        assert!(inside <= allowed, "tooth {fdi}: {inside:e} m inside");
    }
    assert_eq!(examined.inside.len() * 6, reads.len(), "{}", scene.name);
}

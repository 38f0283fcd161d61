//! The simulated operator probes whole teeth of a generated patient: well, and badly in named ways.

mod charted;

use charted::{Charted, perform, print};
use sulcus_core::Scene;
use sulcus_core::tissue::gingiva::Site;
use sulcus_operator::bimanual::Bimanual;
use sulcus_operator::habit::Habit;
use sulcus_operator::pocket_path::{Manner, PocketPath};
use sulcus_operator::retraction::RetractionParams;
use sulcus_operator::tour::Tour;
use sulcus_operator::tour_params::{TourParams, Visit};
use sulcus_scene::{BuildOptions, compile_file, compile_text};

/// Tooth that is probed here, between its neighbours.
const TOOTH: u8 = 36;

/// The teeth 35 to 37 of a patient, with a probe: proximal depths well above the mid ones.
fn part() -> Scene {
    let text = r#"
name = "part of a mouth"
[mouth]
condition = "periodontitis"
seed = 1
teeth = [35, 36, 37]
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
fn probed(scene: &Scene, habit: Option<Habit>) -> Charted {
    let (mut params, mut tour) = (TourParams::default(), vec![Visit::whole(TOOTH)]);
    if let Some(habit) = habit {
        habit.spoil(&mut params, &mut tour, 3);
    }
    let tour = Tour::new(scene, &tour, params).expect("a tooth with gingiva");
    let charted = perform(scene, Box::new(tour), 0, 7);
    println!("{}:", habit.map_or("good", Habit::name));
    print(&charted);
    assert!(charted.done);
    charted
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
    let most = |charted: &Charted| {
        charted
            .reads
            .iter()
            .fold(0.0, |most, read| read.most_force.max(most))
    };

    let heavy = probed(&scene, Some(Habit::HeavyHand));
    assert!(most(&heavy) > 0.5, "{}", most(&heavy));

    let upright = probed(&scene, Some(Habit::WrongAngle));
    for site in Site::ALL.into_iter().filter(|site| site.is_proximal()) {
        let read = upright.of(TOOTH, site);
        let beside = if site.is_buccal() {
            Site::Buccal
        } else {
            Site::Lingual
        };
        if read.prescribed - upright.of(TOOTH, beside).prescribed >= 1e-3 {
            assert!(read.reached <= read.prescribed - 0.5e-3, "{read:?}");
        }
    }
    assert!(
        upright.of(TOOTH, Site::Buccal).tilt > good.of(TOOTH, Site::Buccal).tilt + 0.25,
        "{:?}",
        upright.of(TOOTH, Site::Buccal)
    );

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

/// All teeth of the mouth with both hands; `TEETH=36,37` probes only those, `HABIT=name` badly.
#[test]
#[ignore = "minutes: the whole mouth"]
fn a_whole_mouth_is_charted() {
    let file = concat!(env!("CARGO_MANIFEST_DIR"), "/../scenes/mouth.toml");
    let compiled = compile_file(file.as_ref(), &BuildOptions::cached(), &|_, _| {});
    let scene = compiled.expect("compiles").scene;
    let only = std::env::var("TEETH").ok();
    let wanted = |fdi: u8| {
        only.as_ref()
            .is_none_or(|only| only.split(',').any(|t| t == fdi.to_string()))
    };
    let teeth = scene
        .objects
        .iter()
        .filter(|object| object.tissue.is_rigid());
    let teeth = teeth
        .map(|tooth| tooth.fdi)
        .filter(|fdi| *fdi != 0 && wanted(*fdi));
    let mut tour: Vec<Visit> = teeth.map(Visit::whole).collect();
    let mut params = TourParams::default();
    let habit: Option<Habit> = std::env::var("HABIT")
        .ok()
        .map(|name| name.parse().expect("a habit"));
    if let Some(habit) = habit {
        habit.spoil(&mut params, &mut tour, 3);
    }
    let zones: usize = tour.iter().map(|visit| visit.sites.len()).sum();
    let until = if habit == Some(Habit::LetsTongueGo) {
        0.5
    } else {
        1.0
    };
    let script = Bimanual::new(&scene, &tour, params, RetractionParams::default(), until);
    let charted = perform(&scene, Box::new(script.expect("a mouth")), 0, 7);
    print(&charted);
    assert!(charted.done);
    assert_eq!(charted.calls.len(), zones);
    let within = |read: &&charted::Read| {
        read.called.is_some() && (read.reached - read.prescribed).abs() <= 0.3e-3
    };
    println!(
        "{} of {zones} within 0.3 mm",
        charted.reads.iter().filter(within).count()
    );
}

//! Whether the target is seen, and what of an exercise a scene lacks.

use sulcus_core::Vec3;
use sulcus_sessions::exercise::{Exercise, Target};
use sulcus_sessions::{Events, Occurrence};

use super::two_teeth::{exercise, output, scene};

/// An exercise whose target is the tongue's side of 36, looked at from the tongue's side.
fn looking() -> Exercise {
    Exercise {
        target: Some(Target {
            tooth: 36,
            eye_mm: [0.0, -200.0, 100.0],
            visible: 0.7,
        }),
        ..exercise()
    }
}

#[test]
fn the_target_is_seen_past_the_tongue_and_told_apart_past_the_mirror() {
    let scene = scene();
    let mut events = Events::new(&scene, &looking());
    assert!(events.missing().is_empty(), "{:?}", events.missing());
    assert_eq!(events.look().len(), 1);
    let hiding = Vec3::new(0.0, -16e-3, 7e-3);
    let away = Vec3::new(0.0, -16e-3, -40e-3);
    let mut all = Vec::new();
    for tick in 1..=1000u64 {
        let mut out = output(tick, None, 1);
        // The mirror comes between from 800 on.
        out.tools[1].status = 0;
        out.tools[1].graphic.position = if tick >= 800 { hiding } else { away };
        let due = events.look().is_due(tick);
        assert_eq!(due, tick % 50 == 0);
        let centre = [if (400..700).contains(&tick) {
            away
        } else {
            hiding
        }];
        let look = due.then_some(centre.as_slice());
        let told: Vec<Occurrence> = events.take(&scene, &out, look).collect();
        assert!(due || told.is_empty());
        all.extend(told);
    }
    let found: Vec<(u64, &str, f64, f64)> = all
        .iter()
        .map(|one| {
            let share = |key: &str| one.data[key].as_f64().unwrap();
            (
                one.tick,
                one.kind.as_str(),
                share("free"),
                share("free_past_mirror"),
            )
        })
        .collect();
    assert_eq!(
        found,
        [
            (50, "target_hidden", 0.0, 0.0),
            (400, "target_visible", 1.0, 1.0),
            (700, "target_hidden", 0.0, 0.0),
        ]
    );
    let tally = events.tally();
    assert_eq!((tally.looks, tally.visible), (20, 6));
    assert_eq!(tally.mean_free(), Some((0.3, 0.3)));
    // The mirror alone hides it for the eye, not past the tongue.
    let mut out = output(1050, None, 1);
    out.tools[1].status = 0;
    out.tools[1].graphic.position = hiding;
    let told: Vec<Occurrence> = events.take(&scene, &out, Some(&[away])).collect();
    assert_eq!(told[0].kind, "target_visible");
    assert_eq!(
        (
            told[0].data["free"].as_f64(),
            told[0].data["free_past_mirror"].as_f64()
        ),
        (Some(1.0), Some(0.0))
    );
}

#[test]
fn what_the_scene_lacks_is_named() {
    let scene = scene();
    let mut exercise = looking();
    exercise.target.as_mut().unwrap().tooth = 37;
    assert_eq!(
        Events::new(&scene, &exercise).missing(),
        ["a tooth 37 with its gingiva as the target"]
    );
    // From the cheek's side none of the tongue's side is seen.
    exercise = looking();
    exercise.target.as_mut().unwrap().eye_mm = [0.0, 200.0, 50.0];
    let events = Events::new(&scene, &exercise);
    assert_eq!(
        events.missing(),
        ["a place of tooth 36 that can be seen from the eye"]
    );
    assert!(!events.look().is_due(50));
    let walk = Exercise::parse(include_str!("../../../exercises/bimanual.toml")).unwrap();
    assert!(
        Events::new(&scene, &walk)
            .missing()
            .contains(&"a pocket at tooth 37".to_owned())
    );
}

//! Frames: the same bytes until a tool meets tissue that differs, and bleeding when it shows.

use std::f64::consts::FRAC_PI_2;

use sulcus_core::{NoProbe, Pose, Scene, State, TickInput, ToolInput, Vec3, Workspace, tick};
use sulcus_display::{Display, Frames};
use sulcus_operator::pocket_path::{Manner, PocketPath};
use sulcus_proto::display::{DisplayFrame, Kind};
use sulcus_scene::anatomy::patient::{Patient, ToothChart};
use sulcus_sessions::{Events, Exercise, Moved, Sampler, Shapes};

use crate::common::compiled;

const TEETH: [u8; 4] = [34, 35, 36, 37];
/// Ticks between two poses of a script.
const LEG: usize = 250;

fn patient(change: impl Fn(&mut ToothChart)) -> Patient {
    let mut patient = Patient::healthy("one");
    patient.teeth = vec![ToothChart::healthy(37)];
    change(&mut patient.teeth[0]);
    patient
}

/// Poses of a probe that dips into the buccal pocket of each tooth: above, at the margin, at the floor, above.
fn script(scene: &Scene, teeth: &[u8]) -> Vec<Pose> {
    let mut poses = vec![scene.tools[0].park];
    for fdi in teeth {
        let path = PocketPath::new(scene, Some(*fdi), 1e-4, Manner::Upright).expect("a pocket");
        for depth in [-6e-3, -1e-3, 2.4e-3, 2.4e-3, -6e-3] {
            poses.push(path.pose(FRAC_PI_2, depth, 0.0, Vec3::zeros()));
        }
    }
    poses
}

/// Frames of a probe that goes along straight lines between `poses`, without sequence numbers, encoded.
fn feed(scene: &Scene, poses: &[Pose]) -> Vec<Vec<u8>> {
    let display = Display::new(scene).expect("a display");
    let (mut state, mut workspace) = (State::new(scene), Workspace::new(scene));
    let mut events = Events::new(scene, &Exercise::free("free", 100.0));
    let (mut sampler, mut shapes) = (Sampler::new(scene), Shapes::new(scene));
    let (mut moved, mut frames) = (Moved::new(scene), Frames::new(scene, &display));
    let mut input = TickInput::IDLE;
    let mut fed = Vec::new();
    for leg in poses.windows(2) {
        for k in 0..LEG {
            let share = (k + 1) as f64 / LEG as f64;
            let position = leg[0].position.lerp(&leg[1].position, share);
            let orientation = leg[0].orientation.slerp(&leg[1].orientation, share);
            input.tools[0] = ToolInput::at(&Pose::new(position, orientation));
            let output = tick(scene, &mut state, &mut workspace, &input, &mut NoProbe);
            for event in events.take(scene, &output, None) {
                frames.occurred(&event);
            }
            if sampler.is_due(output.tick) {
                sampler.read(output.tick, &workspace, &mut shapes);
                moved.follow(&shapes);
            }
            if frames.is_due(output.tick) {
                let frame = frames.frame(&display, &output, false, &moved);
                assert!(frame.fits(display.scene()));
                fed.push(frame.to_bytes().expect("encodes"));
            }
        }
    }
    assert_eq!(frames.faults(), 0);
    fed
}

fn decoded(bytes: &[u8]) -> DisplayFrame {
    DisplayFrame::from_bytes(bytes).expect("a frame")
}

/// Number of frames at the beginning that are the same.
fn common(a: &[Vec<u8>], b: &[Vec<u8>]) -> usize {
    assert_eq!(a.len(), b.len());
    a.iter().zip(b).take_while(|(a, b)| a == b).count()
}

#[test]
fn frames_are_the_same_until_the_tip_meets_a_tooth_that_differs() {
    let one = compiled(&patient(|_| ()), &TEETH);
    let other = patient(|chart| {
        chart.depth_mm.buccal = [6.0, 5.5, 6.0];
        chart.depth_mm.lingual = [5.0, 4.5, 4.0];
        chart.furcation.buccal = 0;
        chart.bleeding.buccal = [true; 3];
    });
    let other = compiled(&other, &TEETH);
    let (near, far) = (script(&one, &[34, 35]), script(&one, &[34, 35, 37]));
    let (a, b) = (feed(&one, &far), feed(&other, &far));
    let same = common(&a, &b);
    // The last legs go to tooth 37; all frames before them are the same.
    let before = (near.len() - 1) * LEG / 16;
    assert!(same >= before, "{same} of {before} frames are the same");
    assert!(same < a.len(), "at tooth 37 the frames differ");
    // The control: the probe has moved tissue in frames that are the same.
    let moved = a[..before]
        .iter()
        .filter(|bytes| !decoded(bytes).moved.is_empty());
    let moved = moved.count();
    assert!(moved > 20, "{moved} frames with moved tissue");
    // Measured: 1.2 kB with one gingiva awake, 0.5 kB on average.
    let largest = a.iter().map(Vec::len).max().unwrap_or(0);
    assert!(largest < 4096, "{largest} bytes");
}

#[test]
fn prescribed_bleeding_shows_after_the_probe_has_left_the_site() {
    let dry = compiled(&patient(|_| ()), &TEETH);
    let bleeds = compiled(&patient(|chart| chart.bleeding.buccal[1] = true), &TEETH);
    let mut poses = script(&dry, &[37]);
    // Deeper than the floor, so that the tip presses it.
    let path = PocketPath::new(&dry, Some(37), 1e-4, Manner::Upright).expect("a pocket");
    for at in [3, 4] {
        poses[at] = path.pose(FRAC_PI_2, 2.2e-3, 0.0, Vec3::zeros());
    }
    // Time above the margin, in which the visit ends.
    poses.extend([poses[5]; 3]);
    let (a, b) = (feed(&dry, &poses), feed(&bleeds, &poses));
    let same = common(&a, &b);
    assert!(same < a.len(), "bleeding shows");
    // The tip is at the floor until the fourth leg ends.
    assert!(same * 16 > 4 * LEG, "{same} frames are the same");
    assert!(a.iter().all(|bytes| decoded(bytes).spots.is_empty()));
    let first = decoded(&b[same]);
    assert_eq!(first.spots.len(), 1);
    assert_eq!(first.spots[0].site, 1, "buccal");
    assert!(first.spots[0].since <= first.tick);
    for (a, b) in a.iter().zip(&b).skip(same) {
        let (a, mut b) = (decoded(a), decoded(b));
        assert_eq!(std::mem::take(&mut b.spots), first.spots);
        assert_eq!(a, b, "nothing else differs");
    }
}

/// Before, a gingiva without a number in its scene file had none on the screen: no pointer, no bleeding, wrong views.
#[test]
fn a_gingiva_without_a_number_has_that_of_its_tooth() {
    let options = sulcus_scene::BuildOptions::cached();
    let pocket = sulcus_scene::BuiltIn::Pocket;
    let compiled = sulcus_scene::compile_built_in(pocket, &options, &|_, _| {});
    let scene = compiled.expect("built in").scene;
    let display = Display::new(&scene).expect("a display");
    let objects = display.scene().objects.iter();
    let gingivae = objects.filter(|one| one.kind == Kind::Gingiva);
    let numbers: Vec<u8> = gingivae.map(|one| one.fdi).collect();
    assert_eq!(numbers, [36]);
    let compiled = scene.objects.iter().map(|object| object.fdi);
    assert_eq!(compiled.collect::<Vec<_>>(), [36, 0]);
}

//! Scenes of displays do not depend on hidden truth.

use proptest::collection::vec;
use proptest::prelude::*;
use sulcus_core::tissue::TissueModel;
use sulcus_display::Display;
use sulcus_proto::display::Kind;
use sulcus_scene::anatomy::patient::{LOWER, Patient};

use crate::common::{any_patient, compiled, disguised};

const SIX: [u8; 6] = [45, 46, 33, 34, 36, 37];

fn display(patient: &Patient, teeth: &[u8]) -> Display {
    Display::new(&compiled(patient, teeth)).expect("a display")
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 10, max_shrink_iters: 0, ..Default::default() })]

    #[test]
    fn patients_who_differ_only_in_hidden_values_have_the_same_bytes(
        seed in 0u64..1 << 40,
        hidden in vec(0.0..1.0, 211),
    ) {
        let seen = any_patient(seed);
        let Some(other) = disguised(&seen, &hidden) else {
            return Err(TestCaseError::reject("no room for these depths"));
        };
        let (a, b) = (compiled(&seen, &SIX), compiled(&other, &SIX));
        // The control: the compiled scenes differ in meshes, spheres and their number.
        let differ = a.objects.iter().zip(&b.objects).filter(|(a, b)| a.mesh != b.mesh).count();
        prop_assert!(differ >= 3, "{differ} meshes differ");
        let (a, b) = (Display::new(&a).expect("one"), Display::new(&b).expect("other"));
        prop_assert!(a.bytes() == b.bytes(), "the bytes differ");
        prop_assert_eq!(a.hash(), b.hash());
    }
}

#[test]
fn a_whole_mouth_has_the_same_bytes() {
    let seen = any_patient(5);
    let other = (1..50).find_map(|k| {
        let hidden: Vec<f64> = (0..300)
            .map(|j| f64::from(j * 37 * k % 101) / 101.0)
            .collect();
        disguised(&seen, &hidden)
    });
    let other = other.expect("room");
    let scene = compiled(&seen, &LOWER);
    let a = Display::new(&scene).expect("one");
    let b = display(&other, &LOWER);
    assert!(a.bytes() == b.bytes());
    // Measured: 6.4 MB, of which the teeth take most.
    assert!(a.bytes().len() < 8_000_000, "{} bytes", a.bytes().len());
}

#[test]
fn recession_shows() {
    let seen = any_patient(4);
    let mut receded = seen.clone();
    let chart = receded.teeth.iter_mut().find(|chart| chart.fdi == 36);
    let chart = chart.expect("generated");
    chart.recession_mm.buccal[1] += 1.0;
    let (a, b) = (display(&seen, &SIX), display(&receded, &SIX));
    let shown = |display: &Display| {
        [36, 33].map(|fdi| {
            let mut all = display.scene().objects.iter();
            let gingiva = all.find(|object| object.kind == Kind::Gingiva && object.fdi == fdi);
            gingiva.expect("there").mesh.clone()
        })
    };
    let ([a36, a33], [b36, b33]) = (shown(&a), shown(&b));
    assert_ne!(a36, b36);
    assert_eq!(a33, b33, "another tooth");
}

#[test]
fn inflammation_shows_at_its_tooth() {
    let of = |inflammation: f64| {
        let mut patient = any_patient(4);
        let chart = patient.teeth.iter_mut().find(|chart| chart.fdi == 36);
        chart.expect("generated").inflammation = inflammation;
        display(&patient, &SIX)
    };
    let (a, b) = (of(0.0), of(1.0));
    let redness = |display: &Display, fdi: u8| {
        let mut all = display.scene().objects.iter();
        let gingiva = all.find(|object| object.kind == Kind::Gingiva && object.fdi == fdi);
        let colours = &gingiva.expect("there").mesh.vertex_colours;
        let sum: f64 = (colours.iter())
            .map(|[r, g, _, _]| f64::from(*r) / f64::from(*g).max(1.0))
            .sum();
        sum / colours.len() as f64
    };
    assert!(
        redness(&b, 36) > 1.1 * redness(&a, 36),
        "{} {}",
        redness(&b, 36),
        redness(&a, 36)
    );
    assert_eq!(redness(&b, 33), redness(&a, 33), "another tooth");
}

/// Whether `bytes` contain `part`.
fn contains(bytes: &[u8], part: &[u8]) -> bool {
    bytes.windows(part.len()).any(|window| window == part)
}

#[test]
fn no_hidden_number_or_text_is_among_the_bytes() {
    let mut patient = any_patient(8);
    patient.name = "KEPTSECRET".into();
    // Numbers that occur nowhere else.
    for (k, chart) in (0..).zip(&mut patient.teeth) {
        for (j, depth) in (0..).zip(
            chart
                .depth_mm
                .buccal
                .iter_mut()
                .chain(&mut chart.depth_mm.lingual),
        ) {
            *depth = 3.0137 + 0.0371 * f64::from(k) + 0.0119 * f64::from(j);
        }
        chart.furcation = Default::default();
    }
    let scene = compiled(&patient, &SIX);
    let bytes = Display::new(&scene).expect("a display").bytes().to_vec();
    let mut hidden: Vec<f64> = Vec::new();
    for object in &scene.objects {
        if let TissueModel::Gingiva(model) = &object.tissue {
            hidden.extend(
                model
                    .sites
                    .iter()
                    .flat_map(|site| [site.depth, site.depth * 1e3]),
            );
            let floor = model
                .places
                .iter()
                .find(|place| place.floor)
                .expect("a floor");
            hidden.extend([floor.height, floor.spread + floor.on_surface.x]);
        }
    }
    assert!(hidden.len() >= 6 * 12);
    for number in hidden {
        let single = (number as f32).to_le_bytes();
        assert!(!contains(&bytes, &number.to_le_bytes()), "{number}");
        assert!(!contains(&bytes, &single), "{number}");
    }
    for text in [
        "SECRET",
        "patient",
        "gingiva",
        "mouth",
        scene.source_hash.as_str(),
    ] {
        assert!(!contains(&bytes, text.as_bytes()), "{text}");
    }
    // The control: a visible number is found.
    let park = scene.tools[0].park.position.x as f32;
    assert!(contains(&bytes, &park.to_le_bytes()));
}

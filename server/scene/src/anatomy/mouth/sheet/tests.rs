//! Geometry of the sheet: one surface without holes, zones of the right width, margins where they are felt.

use std::collections::BTreeMap;
use std::f64::consts::FRAC_PI_2;

use sulcus_core::Vec3;
use sulcus_core::tissue::gingiva::{GingivaParams, Site};

use super::cell::Cell;
use super::path::GINGIVA;
use super::*;
use crate::anatomy::arch::from_world;
use crate::anatomy::mouth::collar;
use crate::anatomy::patient::{Patient, ToothChart, generate};
use crate::file::{Condition, MouthEntry};

/// Triangles of the sheet. A tongue has 13,604, and all soft tissues have at most 45,000.
const MOST: usize = 31_396;

fn mouth_of(patient: &Patient) -> Mouth<'static> {
    let cells = standing().iter().map(|tooth| {
        let chart = patient.tooth(tooth.fdi);
        let seen = chart.map(|chart| (chart.recession_mm.round(), chart.inflammation));
        Cell::new(tooth, seen)
    });
    Mouth::new(cells.collect())
}

fn patients() -> Vec<Patient> {
    let generated = (1..=6).flat_map(|seed| Condition::ALL.map(|c| generate(seed, c)));
    let mut all: Vec<Patient> = generated.collect();
    all.push(Patient::healthy("whole"));
    let mut toothless = Patient::healthy("gaps");
    toothless.missing = vec![47, 46, 44, 41, 31, 33, 36, 37];
    all.push(toothless);
    all
}

/// Whether a mark is that of the first row at a margin.
fn is_margin(mark: &Mark) -> bool {
    mark.part == Part::Gingiva && !mark.is_ridge && mark.below == 0.0
}

/// Points of a side by column and row, mm.
fn points(mouth: &Mouth<'_>, side: usize) -> Woven {
    let [facial, lingual] = woven(mouth);
    if side == 0 { facial } else { lingual }
}

/// Column of a side whose place is nearest to the middle of tooth `k`.
fn middle(mouth: &Mouth<'_>, woven: &Woven, k: usize) -> usize {
    let s = 0.5 * (mouth.gaps[k].s + mouth.gaps[k + 1].s);
    let off = |c: &usize| (woven.strip.columns[*c].low - s).abs();
    let columns = 0..woven.points.len();
    columns
        .min_by(|a, b| off(a).total_cmp(&off(b)))
        .expect("a column")
}

#[test]
fn is_one_sheet_without_holes() {
    for patient in patients() {
        let mouth = mouth_of(&patient);
        let own = vec![true; mouth.cells.len()];
        let (mut pieces, rest) = weave(&mouth, &woven(&mouth), &own);
        pieces.push(rest);
        let (mut known, mut marks) = (BTreeMap::new(), Vec::new());
        let (mut edges, mut triangles) = (BTreeMap::new(), 0);
        for piece in &pieces {
            assert_eq!(piece.mesh.vertices.len(), piece.marks.len());
            let numbers: Vec<usize> = (piece.mesh.vertices.iter().zip(&piece.marks))
                .map(|(v, mark)| {
                    let key = [v.x, v.y, v.z].map(|x| (x + 0.0).to_bits());
                    *known.entry(key).or_insert_with(|| {
                        marks.push(*mark);
                        marks.len() - 1
                    })
                })
                .collect();
            triangles += piece.mesh.triangles.len();
            for t in &piece.mesh.triangles {
                for e in 0..3 {
                    let edge = (numbers[t[e] as usize], numbers[t[(e + 1) % 3] as usize]);
                    let before = edges.insert(edge, ());
                    assert!(
                        before.is_none(),
                        "{}: two triangles on one side of the edge of {:?} and {:?}",
                        patient.name,
                        marks[edge.0],
                        marks[edge.1]
                    );
                }
            }
        }
        assert!(triangles <= MOST, "{triangles} triangles");
        let half = mouth.line.half();
        let mut group: Vec<usize> = (0..marks.len()).collect();
        fn root(group: &mut [usize], mut k: usize) -> usize {
            while group[k] != k {
                group[k] = group[group[k]];
                k = group[k];
            }
            k
        }
        for (a, b) in edges.keys() {
            let (x, y) = (root(&mut group, *a), root(&mut group, *b));
            group[x] = y;
            let is_open = !edges.contains_key(&(*b, *a));
            let may_end = |v: usize| {
                let mark: &Mark = &marks[v];
                let end_of_lip = mark.part == Part::Lip && mark.share == 1.0;
                is_margin(mark) || end_of_lip || mark.s.abs() > half - 1e-6
            };
            assert!(
                !is_open || (may_end(*a) && may_end(*b)),
                "{}: a hole between {:?} and {:?}",
                patient.name,
                marks[*a],
                marks[*b]
            );
        }
        let first = root(&mut group, 0);
        assert!(
            (0..marks.len()).all(|v| root(&mut group, v) == first),
            "{}",
            patient.name
        );
    }
}

#[test]
fn mucogingival_line_lies_where_it_was_measured() {
    // Means and largest standard deviation of the attached gingiva on the facial side, by tooth, with a sulcus of 1.4.
    let measured = [5.0, 5.1, 4.5, 3.8, 4.0, 4.4, 4.3];
    let mouth = mouth_of(&Patient::healthy("whole"));
    let woven = points(&mouth, 0);
    for k in 0..mouth.cells.len() {
        let column = &woven.points[middle(&mouth, &woven, k)];
        // The width is measured along the tooth.
        let width = (column[0].0.z - column[GINGIVA].0.z) / mouth.cells[k].tooth.frame.axis.z;
        let wanted = measured[mouth.cells[k].kind()];
        assert!(
            (width - wanted).abs() < 0.5,
            "{}: {width:.2}",
            mouth.cells[k].tooth.fdi
        );
    }
    // A receded margin keeps a band of gingiva.
    let mut receded = Patient::healthy("receded");
    receded.teeth = vec![ToothChart::healthy(31)];
    receded.teeth[0].recession_mm.buccal[1] = 3.0;
    let mouth = mouth_of(&receded);
    let woven = points(&mouth, 0);
    let column = &woven.points[middle(&mouth, &woven, 7)];
    let width = column[0].0.z - column[GINGIVA].0.z;
    assert!((1.0..2.0).contains(&width), "{width:.2}");
}

#[test]
fn papillae_have_the_height_of_the_literature() {
    let mouth = mouth_of(&Patient::healthy("whole"));
    let mut wrong = false;
    for k in 1..mouth.cells.len() {
        // Heights are measured along the tooth, over the zenith of its facial margin.
        let over = |k: usize, at: &Vec3| {
            let cell = &mouth.cells[k];
            from_world(&cell.tooth.frame_mm(), at).z - cell.margin(FRAC_PI_2)
        };
        let heights = mouth.gaps[k].saddle.iter();
        let heights = heights.map(|at| 0.5 * (over(k - 1, at) + over(k, at)));
        let heights: Vec<f64> = heights.collect();
        let height = heights.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        let (low, high) = match k.abs_diff(7) {
            0..=2 => (3.0, 4.5),
            3..=4 => (2.0, 4.0),
            _ => (1.5, 3.5),
        };
        let names = [k - 1, k].map(|k| mouth.cells[k].tooth.fdi);
        println!("{names:?}: {height:.2} mm");
        wrong |= !(low..high).contains(&height);
        if k.abs_diff(7) <= 2 {
            // One tip in front: no saddle.
            let low = heights.iter().copied().fold(height, f64::min);
            println!("{:.2} mm deep", height - low);
            wrong |= height - low >= 0.3;
        }
    }
    assert!(!wrong, "see above");
}

/// Height of a column's points at a height of the world, as a distance from the line of the arch, mm.
fn distance_at(mouth: &Mouth<'_>, column: &[(Vec3, Mark)], z: f64) -> f64 {
    let pair = column
        .windows(2)
        .find(|pair| pair[0].0.z >= z && pair[1].0.z < z);
    let pair = pair.expect("the wall passes this height");
    let share = (pair[0].0.z - z) / (pair[0].0.z - pair[1].0.z);
    mouth
        .line
        .of(&(pair[0].0 + (pair[1].0 - pair[0].0) * share))[1]
}

#[test]
fn roots_stand_out_by_half_a_millimetre_and_not_farther_down() {
    let mouth = mouth_of(&Patient::healthy("whole"));
    let woven = points(&mouth, 0);
    let mut wrong = false;
    for k in 0..mouth.cells.len() {
        let column = &woven.points[middle(&mouth, &woven, k)];
        let gaps = [k, k + 1].map(|k| &woven.points[woven.strip.gaps[k]]);
        let zenith = column[0].0.z;
        let relief = |below: f64| {
            let z = zenith - below;
            let beside: f64 = gaps
                .iter()
                .map(|gap| 0.5 * distance_at(&mouth, gap, z))
                .sum();
            distance_at(&mouth, column, z) - beside
        };
        let most = if mouth.cells[k].kind() == 2 {
            1.0
        } else {
            0.55
        };
        println!("{}: {:.2}", mouth.cells[k].tooth.fdi, relief(3.5));
        wrong |= relief(3.5) >= most;
    }
    assert!(!wrong, "see above");
}

#[test]
fn margin_touches_the_tooth() {
    for patient in patients() {
        let mouth = mouth_of(&patient);
        for side in [0, 1] {
            let woven = points(&mouth, side);
            let mut before: Option<(usize, Vec3)> = None;
            for (c, column) in woven.strip.columns.iter().enumerate() {
                let strip::Start::Margin { cell: k, .. } = column.start else {
                    before = None;
                    continue;
                };
                let cell = &mouth.cells[k];
                let of = |p: Vec3| {
                    let frame = &cell.tooth.frame;
                    let from = p - frame.origin * 1e3;
                    let own = Vec3::new(
                        from.dot(&frame.mesial),
                        from.dot(&frame.buccal),
                        from.dot(&frame.axis),
                    );
                    cell.tooth.shape.distance(&own)
                };
                let at = woven.points[c][0].0;
                let gap = of(at);
                assert!(
                    (-0.4..0.05).contains(&gap),
                    "{} {}: {gap:.3}",
                    patient.name,
                    cell.tooth.fdi
                );
                if let Some((_, other)) = before.filter(|(other, _)| *other == k) {
                    let gap = of(0.5 * (at + other));
                    assert!(
                        gap < 0.05,
                        "{} {}: {gap:.3} between",
                        patient.name,
                        cell.tooth.fdi
                    );
                }
                before = Some((k, at));
            }
        }
    }
}

/// Largest differences between felt and drawn margin, mm: at the mid sites, at the proximal sites, and on the faces
/// away from the papillae. Teeth with a depth beyond `deepest` are left out.
fn disagreement(deepest: f64) -> [f64; 3] {
    let entry = MouthEntry::default();
    let mut worst = [0.0f64; 3];
    let mut teeth = 0;
    for patient in patients() {
        let mouth = mouth_of(&patient);
        let mut all = standing().to_vec();
        all.retain(|tooth| patient.tooth(tooth.fdi).is_some());
        let there = mouth.cells.iter().filter(|cell| cell.visible.is_some());
        for (k, cell) in there.enumerate() {
            let chart = patient.tooth(cell.tooth.fdi).expect("there");
            if chart.depth_mm.round().iter().any(|depth| *depth > deepest) {
                continue;
            }
            teeth += 1;
            let params = GingivaParams {
                inflammation: chart.inflammation,
                ..GingivaParams::default()
            };
            let felt = collar(&all, k, &chart, &entry, &params)
                .expect("room")
                .sulcus;
            let off = |around: f64| (felt.margin(around) - cell.margin(around)).abs();
            for site in Site::ALL {
                let kind = usize::from(site.is_proximal());
                worst[kind] = worst[kind].max(off(felt.sites()[site as usize]));
            }
            for step in 0..360 {
                let around = f64::from(step).to_radians();
                if libm::sin(around).abs() > 0.75 {
                    worst[2] = worst[2].max(off(around));
                }
            }
        }
    }
    assert!(teeth > 100);
    worst
}

#[test]
fn margin_is_seen_where_it_is_felt() {
    // The sites of a deeper pocket are at other angles; the margin there is the same.
    let [mid, proximal, faces] = disagreement(f64::INFINITY);
    println!("{mid:.3} {proximal:.3} {faces:.3}");
    assert!(
        mid < 1e-9 && proximal < 0.1 && faces < 0.1,
        "{mid:.3} {proximal:.3} {faces:.3}"
    );
}

#[test]
fn inflammation_swells_outwards_and_leaves_the_margin() {
    let of = |inflammation: f64| {
        let mut patient = Patient::healthy("inflamed");
        patient.teeth = vec![ToothChart {
            inflammation,
            ..ToothChart::healthy(34)
        }];
        let mouth = mouth_of(&patient);
        let woven = points(&mouth, 0);
        let c = middle(&mouth, &woven, 10);
        (mouth, woven, c)
    };
    let (mouth, healthy, c) = of(0.0);
    let mut before = 0.0;
    for (grade, low, high) in [(1.0, 0.02, 0.2), (2.0, 0.2, 0.6), (3.0, 0.6, 1.3)] {
        let (_, sick, _) = of(grade / 3.0);
        assert_eq!(
            healthy.points[c][0].0, sick.points[c][0].0,
            "the margin stays"
        );
        let out = |woven: &Woven, row: usize| mouth.line.of(&woven.points[c][row].0)[1];
        let swelling = (1..GINGIVA)
            .map(|row| out(&sick, row) - out(&healthy, row))
            .fold(0.0, f64::max);
        assert!(
            swelling > before && (low..high).contains(&swelling),
            "{grade}: {swelling:.2}"
        );
        before = swelling;
        // A tooth beside the neighbour is as before.
        assert_eq!(healthy.points[c + 60], sick.points[c + 60]);
    }
}

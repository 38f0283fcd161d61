//! Fig. 14 and Fig. 4: a mirror that presses the tongue lightly, deeply, and askance.

use sulcus_cases::tissue_scenes::{tongue, twice};
use sulcus_core::math::{exp_rotation, norm};
use sulcus_core::{Pose, Scene, Vec3};
use sulcus_operator::retraction::{Retraction, RetractionParams};
use sulcus_operator::script::{TwoTools, smoothstep};

use super::Curve;
use super::answers::Answers;
use super::contact::{LOOKED, SEED, Seen, by_hand, slots};

/// Its far edge lightly; deep; tilted and slid along while a second mirror presses elsewhere: when each is held, seconds.
const STATES: [(&str, [f64; 2]); 3] = [
    ("a, light", [1.2, 2.0]),
    ("b, deep", [3.2, 4.0]),
    ("c, with a second mirror, tilted and slid", [4.6, 6.2]),
];
const SECONDS: f64 = 7.0;
/// Contacts farther apart are different regions, metres: those under one side of a disc of 22 mm are one.
const APART: f64 = 11e-3;
/// Displacement from which on a place is said to give way, metres: what an eye sees.
const GIVES_WAY: f64 = 1e-3;
/// Angle by which the disc is turned onto its far edge, and tilted sideways, radians.
const ON_EDGE: f64 = 0.35;
const TILT: f64 = 0.2;
/// How far from the first the second mirror is pressed in, along the tongue, metres.
const BESIDE: f64 = 28e-3;
/// Milliseconds between two points of a curve.
const DRAWN: usize = 10;

/// Where the first mirror is meant to be: how deep, on its edge, tilted by how much, slid by how far.
fn first(mirror: &Retraction, disc: Vec3, t: f64) -> Pose {
    let deep = -4e-3 + 3e-3 * smoothstep(t / 1.0) + 11e-3 * smoothstep((t - 2.0) / 1.0)
        - 16e-3 * smoothstep((t - 6.4) / 0.4);
    let along = 3e-3 * (3.0 * (t - 4.5)).sin() * held(t);
    let straight = mirror.pose(deep, 0.0, along);
    let edge = 1.0 - smoothstep((t - 2.0) / 1.0);
    // About the disc's middle; y of the tool is across handle and disc.
    let turn = Vec3::y() * (ON_EDGE * edge) + Vec3::x() * (TILT * held(t));
    let orientation = straight.orientation * exp_rotation(&turn);
    Pose::new(straight.transform(&disc) - orientation * disc, orientation)
}

/// Where the second is, in the last state: pressed into another place.
fn second(mirror: &Retraction, t: f64) -> Option<Pose> {
    let at = || mirror.pose(-4e-3 + 11e-3 * held(t), 0.0, BESIDE);
    (4.0..6.8).contains(&t).then(at)
}

/// 1 in the last state, 0 outside.
fn held(t: f64) -> f64 {
    smoothstep((t - 4.0) / 0.5) - smoothstep((t - 6.2) / 0.4)
}

/// What a state comes to at most.
#[derive(Clone, Copy, Default)]
struct Peak {
    force: f64,
    torque: f64,
    indentation: f64,
    /// Share of the tongue that gives way, percent.
    extent: f64,
    regions: usize,
    pairs: [f64; 2],
}

/// Answers for Fig. 14, and for Fig. 4 from the same run.
pub(super) fn answer(answers: &mut Answers) {
    let scene = twice(tongue(0.5));
    let params = RetractionParams {
        flank: 0.0,
        ..RetractionParams::default()
    };
    let mirror = Retraction::new(&scene, params).expect("the shipped tongue and its mirror");
    let disc = scene.tools[0].working_point;
    let script = Box::new(TwoTools {
        poses: move |t| [Some(first(&mirror, disc, t)), second(&mirror, t)],
        duration_s: SECONDS,
    });
    let mut peaks = [Peak::default(); STATES.len()];
    let mut lines: [Vec<(f64, f64)>; 3] = Default::default();
    let mut k = 0;
    let (measures, _) = by_hand(&scene, script, (SECONDS, LOOKED), |seen| {
        k += 1;
        if k % DRAWN != 0 {
            return;
        }
        let (force, torque) = seen.wrench();
        let found = [norm(&force), norm(&torque) * 1e3, seen.indentation(0) * 1e3];
        for (line, y) in lines.iter_mut().zip(found) {
            line.push((seen.t, y));
        }
        let state = STATES
            .iter()
            .position(|(_, [from, to])| (*from..*to).contains(&seen.t));
        let Some(peak) = state.map(|state| &mut peaks[state]) else {
            return;
        };
        peak.force = peak.force.max(found[0]);
        peak.torque = peak.torque.max(found[1]);
        peak.indentation = peak.indentation.max(found[2]);
        peak.extent = peak.extent.max(seen.extent(0, GIVES_WAY) * 100.0);
        peak.regions = peak
            .regions
            .max(slots(&scene).map(|t| seen.regions(t, APART)).sum());
        if k % (10 * DRAWN) == 0 {
            let pairs = [overlapping(seen) as f64, f64::from(seen.out.tools[0].rows)];
            if pairs[0] > peak.pairs[0] {
                peak.pairs = pairs;
            }
        }
    });
    let how = format!(
        "the shipped tongue and mirror, 0.5 N/mm, a hand in closed loop for {SECONDS} s, seed {SEED}"
    );
    let list = |value: &dyn Fn(&Peak) -> String| {
        let each = STATES.iter().zip(&peaks);
        let each: Vec<String> = each
            .map(|((name, _), peak)| format!("{name}: {}", value(peak)))
            .collect();
        each.join("; ")
    };
    answers.measured(
        "fig14-states",
        list(&|peak| {
            format!(
                "{} region{}, {:.0} % of the tongue gives way",
                peak.regions,
                if peak.regions == 1 { "" } else { "s" },
                peak.extent
            )
        }),
        &[
            ("regions_a", peaks[0].regions as f64),
            ("regions_b", peaks[1].regions as f64),
            ("regions_c", peaks[2].regions as f64),
            ("extent_percent_a", peaks[0].extent),
            ("extent_percent_b", peaks[1].extent),
            ("extent_percent_c", peaks[2].extent),
        ],
        format!(
            "{how}; regions: groups of loaded contacts more than {} mm apart; what gives way: spheres displaced by more than {} mm",
            APART * 1e3,
            GIVES_WAY * 1e3
        ),
    );
    let three = |value: fn(&Peak) -> f64| -> [(&'static str, f64); 3] {
        [
            ("a", value(&peaks[0])),
            ("b", value(&peaks[1])),
            ("c", value(&peaks[2])),
        ]
    };
    answers.measured(
        "fig14-force-n",
        list(&|p| format!("{:.2} N", p.force)),
        &three(|p| p.force),
        how.clone(),
    );
    answers.measured(
        "fig14-torque",
        list(&|p| format!("{:.1} N mm", p.torque)),
        &three(|p| p.torque),
        format!("{how}; about the disc's middle"),
    );
    answers.measured(
        "fig14-indentation-mm",
        list(&|p| format!("{:.1} mm", p.indentation)),
        &three(|p| p.indentation),
        how.clone(),
    );
    let residual = measures.residual * 1e6;
    answers.measured(
        "fig14-penetration",
        format!("{residual:.3} um at most"),
        &[("um", residual), ("exhausted_um", measures.exhausted_residual * 1e6)],
        format!("{how}; all pairs of spheres on the deformed shape, by a query of its own in every tenth tick"),
    );
    let (jump, buzz) = (measures.jump * 1e3, measures.buzz * 1e3);
    answers.measured(
        "fig14-jump",
        format!("{jump:.3} mm in a tick beyond the hand's; buzz {buzz:.2} mN"),
        &[("jump_mm", jump), ("buzz_mn", buzz)],
        how.clone(),
    );
    let energy = measures.energy * 1e3;
    answers.measured(
        "no-virtual-coupling",
        format!(
            "{energy:.3} mJ put out into the hand at most, {:.1} mJ put in",
            measures.work_in * 1e3
        ),
        &[
            ("put_out_mj", energy),
            ("put_in_mj", measures.work_in * 1e3),
        ],
        format!(
            "{how}; the wrench is the coupling's between hand and graphic tool, as in the paper"
        ),
    );
    let pairs = peaks.map(|peak| peak.pairs);
    answers.measured(
        "fig4-pairs",
        list(&|p| format!("{} without, {} with prediction", p.pairs[0], p.pairs[1])),
        &[("without_b", pairs[1][0]), ("with_b", pairs[1][1])],
        format!("{how}; spheres of the haptic tool inside spheres of the deformed tongue, against rows of the same tick's problem"),
    );
    curves(lines, &how, answers);
}

fn curves(lines: [Vec<(f64, f64)>; 3], how: &str, answers: &mut Answers) {
    let named = [
        "force",
        "torque about the disc's middle",
        "indentation of the tongue",
    ];
    let units = ["N", "N mm", "mm"];
    for ((line, name), unit) in lines.into_iter().zip(named).zip(units) {
        answers.curve(Curve {
            place: "Fig. 14",
            title: format!("A mirror on the tongue: {name}"),
            x: "time, s",
            y: unit,
            series: vec![(name.to_owned(), line)],
            note: format!(
                "{how}; its far edge lightly until 2 s, deep until 4 s, then tilted by 11 degrees and slid while a second mirror presses {:.0} mm farther on; force and torque of the first", BESIDE * 1e3
            ),
        });
    }
}

/// Pairs of spheres of the haptic tool and the tongue as it is that overlap.
fn overlapping(seen: &Seen) -> usize {
    let scene: &Scene = seen.scene;
    let (object, tool) = (&scene.objects[0], &scene.tools[0]);
    let ids: Vec<u32> = object
        .tree
        .shape_at(object.level)
        .map(|(id, _)| id)
        .collect();
    let mut centres = vec![Vec3::zeros(); ids.len()];
    if !seen.ws.centres_of(0, &ids, &mut centres) {
        return 0;
    }
    let nodes = object.tree.nodes();
    let haptic = &seen.out.tools[0].haptic;
    let spheres = tool.tree.shape_at(tool.level);
    let spheres = spheres.map(|(_, node)| (haptic.transform(&node.centre), node.contact_radius));
    spheres
        .map(|(at, radius)| {
            let reach = |id: u32| radius + nodes[id as usize].contact_radius;
            let pairs = ids.iter().zip(&centres);
            pairs
                .filter(|(id, c)| norm(&(at - **c)) < reach(**id))
                .count()
        })
        .sum()
}

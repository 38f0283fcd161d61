//! Table 2: what the stages of a tick cost while a mirror presses the tongue, with confidence intervals over repeats.

use sulcus_cases::comparison::as_printed;
use sulcus_cases::statistics::{Interval, median};
use sulcus_cases::timing::time_stages;
use sulcus_cases::tissue_scenes::tongue;
use sulcus_core::{Scene, Stage, TickInput};
use sulcus_operator::retraction::{Retraction, RetractionParams};
use sulcus_operator::script::smoothstep;

use super::answers::Answers;
use super::contact::{SEED, by_hand, hand_at};

/// The mirror is 5 mm in from this tick on.
const FROM: usize = 600;
/// Ticks that are timed, and in a quick report.
const TIMED: [usize; 2] = [1500, 250];
/// How deep, metres.
const PRESSED: f64 = 5e-3;
/// Repeats of the same inputs.
const REPEATS: usize = 5;

/// Median times of a tick, milliseconds.
#[derive(Clone, Copy)]
struct Times {
    collide: Interval,
    /// Free step of the tissue, and what it takes of the answer.
    deform: Interval,
    optimise: Interval,
    whole: Interval,
}

/// The scene with tool and tissue touched at `level`.
fn at_level(scene: &Scene, level: u8) -> Scene {
    let mut scene = scene.clone();
    scene.tools[0].level = level;
    scene.objects[0].level = level;
    scene
}

/// Times of `scene` under `inputs`, over the ticks from [`FROM`] on.
fn timed(scene: &Scene, inputs: &[TickInput]) -> Times {
    let runs = (0..REPEATS).map(|_| {
        let stages = time_stages(scene, inputs);
        let of = |which: &[Stage]| {
            let tick = |k: usize| which.iter().map(|s| stages[*s as usize][k]).sum::<u64>();
            median(
                (FROM..inputs.len())
                    .map(|k| tick(k) as f64 * 1e-6)
                    .collect(),
            )
        };
        [
            of(&[Stage::Collide]),
            of(&[Stage::Prepare, Stage::Apply]),
            of(&[Stage::Optimise]),
            of(&Stage::ALL),
        ]
    });
    let runs: Vec<[f64; 4]> = runs.collect();
    let of = |k: usize| Interval::of(&runs.iter().map(|run| run[k]).collect::<Vec<f64>>());
    Times {
        collide: of(0),
        deform: of(1),
        optimise: of(2),
        whole: of(3),
    }
}

/// Ids of one case: level, collision, deformation, optimisation.
const CASES: [(u8, [&str; 4]); 2] = [
    (
        2,
        [
            "table2-case1-level",
            "table2-case1-collision-ms",
            "table2-case1-deformation-ms",
            "table2-case1-optimisation-ms",
        ],
    ),
    (
        3,
        [
            "table2-case2-level",
            "table2-case2-collision-ms",
            "table2-case2-deformation-ms",
            "table2-case2-optimisation-ms",
        ],
    ),
];

/// Id of a stage, how long it takes, and what it is.
type Timed = (&'static str, fn(&Times) -> Interval, &'static str);

/// Answers for Table 2.
pub(super) fn answer(quick: bool, answers: &mut Answers) {
    let scene = tongue(0.5);
    let params = RetractionParams {
        flank: 0.0,
        ..RetractionParams::default()
    };
    let mirror = Retraction::new(&scene, params).expect("the shipped tongue and its mirror");
    let pose = move |t: f64| {
        let deep = -4e-3 + (4e-3 + PRESSED) * smoothstep(t / 0.5);
        mirror.pose(deep, 0.0, 3e-3 * (3.0 * (t - 0.5).max(0.0)).sin())
    };
    let ticks = FROM + TIMED[usize::from(quick)];
    let seconds = ticks as f64 * scene.tick_s();
    let (_, inputs) = by_hand(&scene, hand_at(pose, seconds), (seconds, u64::MAX), |_| {});
    for (level, ids) in CASES {
        let coupled = timed(&at_level(&scene, level), &inputs);
        let mut printed = at_level(&scene, level);
        as_printed(&mut printed);
        let printed = timed(&printed, &inputs);
        case(level, ids, coupled, printed, inputs.len() - FROM, answers);
    }
    finer(&scene, &inputs, answers);
}

fn case(
    level: u8,
    ids: [&'static str; 4],
    coupled: Times,
    printed: Times,
    ticks: usize,
    answers: &mut Answers,
) {
    let how = format!(
        "the shipped tongue, a mirror meant 5 mm in and slid, the same recorded hand (seed {SEED}) {REPEATS} times; thread CPU time, median of the {ticks} ticks from {FROM} ms on, mean and 95 % interval of Student over the repeats"
    );
    let both = |of: fn(&Times) -> Interval| {
        let (a, b) = (of(&coupled), of(&printed));
        let text = format!("coupled {a:.4} ms; as printed {b:.4} ms");
        let values = [
            ("coupled_ms", a.mean),
            ("coupled_ms_half", a.half),
            ("printed_ms", b.mean),
            ("printed_ms_half", b.half),
        ];
        (text, values)
    };
    let (text, values) = both(|times| times.whole);
    answers.measured(
        ids[0],
        format!("{level}; the whole tick {text}"),
        &[
            ("level", f64::from(level)),
            values[0],
            values[1],
            values[2],
            values[3],
        ],
        format!("{how}; both tool and tongue touched at level {level}, skeleton at level 2"),
    );
    let stages: [Timed; 3] = [
        (
            ids[1],
            |times| times.collide,
            "contact prediction of all passes, with the spheres brought to their places",
        ),
        (
            ids[2],
            |times| times.deform,
            "free step of the tissue, and its loads",
        ),
        (
            ids[3],
            |times| times.optimise,
            "compliance of the rows and the solver, all passes",
        ),
    ];
    for (id, of, what) in stages {
        let (text, values) = both(of);
        answers.measured(id, text, &values, format!("{how}; {what}"));
    }
}

/// What the finer skeleton costs.
fn finer(scene: &Scene, inputs: &[TickInput], answers: &mut Answers) {
    let fine: Vec<TickInput> = inputs
        .iter()
        .map(|input| TickInput {
            detail: TickInput::MAX_DETAIL,
            ..*input
        })
        .collect();
    let (fine, coarse) = (timed(scene, &fine).whole, timed(scene, inputs).whole);
    answers.measured(
        "open-finer-levels",
        format!("a tick takes {fine:.4} ms with the finer skeleton, {coarse:.4} ms with level 2"),
        &[
            ("fine_ms", fine.mean),
            ("fine_ms_half", fine.half),
            ("coarse_ms", coarse.mean),
            ("coarse_ms_half", coarse.half),
        ],
        format!("the shipped tongue in contact at level 3, the same recorded hand (seed {SEED}), without a graphics card; thread CPU time, median, mean and 95 % interval of {REPEATS} repeats"),
    );
}

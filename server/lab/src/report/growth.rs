//! Model only what a scene needs: what a tick costs by what is in the scene, and by what is touched.

use serde::Serialize;
use sulcus_cases::mouth::mouth;
use sulcus_cases::scenes::{self, device_over};
use sulcus_cases::table::Driver;
use sulcus_cases::tissue_scenes::{changed, twice};
use sulcus_cases::{find, record};
use sulcus_core::{MAX_TOOLS, Pose, Quat, Scene, TickInput, ToolInput, Vec3};
use sulcus_operator::crown::{Crown, CrownParams};
use sulcus_operator::{HandParams, present};
use sulcus_scene::BuiltIn;

use super::shipped::SEED;
use super::times::Times;

/// One point of a line.
#[derive(Clone, Debug, Serialize)]
pub(crate) struct Point {
    /// What there is more of, as a number.
    pub(crate) x: f64,
    /// The same in words.
    pub(crate) what: String,
    #[serde(flatten)]
    pub(crate) times: Times,
    /// Rows and passes of a tick, mean.
    pub(crate) rows: f64,
    pub(crate) passes: f64,
}

/// How times grow with one thing.
#[derive(Clone, Debug, Serialize)]
pub(crate) struct Line {
    pub(crate) with: &'static str,
    pub(crate) should: &'static str,
    pub(crate) points: Vec<Point>,
    /// What is asked of it, in figures: the median of one point over that of another, and the most that it may be.
    pub(crate) asked: Vec<Asked>,
}

/// A ratio of medians that says whether a line grows as it should.
#[derive(Clone, Debug, Serialize)]
pub(crate) struct Asked {
    pub(crate) what: String,
    pub(crate) found: f64,
    pub(crate) at_most: f64,
}

impl Asked {
    /// How much longer `much` takes than `little`, against `at_most`.
    fn of(what: &str, much: &Point, little: &Point, at_most: f64) -> Self {
        Self {
            what: what.to_owned(),
            found: much.times.tick_us.p50 / little.times.tick_us.p50,
            at_most,
        }
    }

    pub(crate) fn holds(&self) -> bool {
        self.found <= self.at_most
    }
}

/// How much longer a tick may take with what is not touched in the scene: boxes are looked at, no more. (A tick takes a microsecond
/// then: half of it is the clock.)
const FREE: f64 = 4.0;
/// The same where other things are at work, so that a box more is nothing.
const HARDLY: f64 = 1.3;

/// All lines.
#[derive(Clone, Debug, Serialize)]
pub(crate) struct Growth {
    pub(crate) lines: Vec<Line>,
}

/// Measures it all.
pub(super) fn measure(quick: bool, progress: &dyn Fn(&str, f64)) -> Growth {
    let runs = if quick { 1 } else { 5 };
    type Make = fn(usize, bool) -> Line;
    let makes: [(&str, Make); 5] = [
        // (The mouth of the part before is kept: first what needs it.)
        ("what is not touched", untouched),
        ("teeth", teeth),
        ("contacts", contacts),
        ("spheres", spheres),
        ("tools", tools),
    ];
    // (A mouth takes seconds to build.)
    let makes = makes.iter().filter(|make| !quick || make.0 != "teeth");
    let makes: Vec<_> = makes.collect();
    let all = makes.len() as f64;
    let lines = makes.iter().enumerate().map(|(k, (name, make))| {
        progress(name, k as f64 / all);
        make(runs, quick)
    });
    Growth {
        lines: lines.collect(),
    }
}

fn point(
    x: f64,
    what: String,
    scene: &Scene,
    inputs: &[TickInput],
    runs: usize,
    from: usize,
) -> Point {
    let (mut rows, mut passes) = (0.0, 0.0);
    sulcus_cases::timing::time(scene, inputs, |k, out| {
        if k >= from {
            rows += out
                .tools
                .iter()
                .map(|tool| f64::from(tool.rows))
                .sum::<f64>();
            passes += out
                .tools
                .iter()
                .map(|tool| f64::from(tool.substeps))
                .sum::<f64>();
        }
    });
    let n = inputs.len().saturating_sub(from).max(1) as f64;
    Point {
        x,
        what,
        times: Times::of(scene, inputs, runs, |k| k >= from),
        rows: rows / n,
        passes: passes / n,
    }
}

/// A flat face of so many spheres pressed on another.
fn contacts(runs: usize, _: bool) -> Line {
    let points = [1, 2, 4, 8, 12].map(|side| {
        let scene = scenes::faces(side);
        let inputs: Vec<TickInput> = (0..1500)
            .map(|k| {
                let t = f64::from(k) * 1e-3;
                let z = 5e-4 - 2e-3 * (t / 0.3).min(1.0);
                let at = Vec3::new(3e-4 * (3.0 * t).sin(), 0.0, z);
                one(Pose::new(device_over(at), Quat::identity()))
            })
            .collect();
        let spheres = side * side;
        let what = format!("{spheres} spheres on {spheres}");
        let mut point = point(0.0, what, &scene, &inputs, runs, 400);
        point.x = point.rows;
        point
    });
    let [.., few, _, many] = &points;
    let mut asked = Asked::of("time of a row, of most and of few", many, few, 2.0);
    asked.found *= few.rows / many.rows;
    Line {
        with: "rows of the optimisation: a face of spheres pressed on the same",
        should: "about in proportion: each row is looked at a few times",
        asked: vec![asked],
        points: points.into(),
    }
}

fn one(pose: Pose) -> TickInput {
    let mut input = TickInput::IDLE;
    input.tools[0] = present(&pose);
    input
}

/// The probe round the molar's crown, level by level.
fn spheres(runs: usize, quick: bool) -> Line {
    let scene = changed(BuiltIn::Crown, &[]);
    let params = CrownParams {
        duration: if quick { 3.0 } else { 6.0 },
        ..CrownParams::default()
    };
    let ticks = (params.duration * 1e3) as u64;
    let script = Crown::new(&scene, None, params).expect("a tooth");
    let hand = (HandParams::default(), 1);
    let inputs = record(&scene, Box::new(script), hand, ticks, |_, _| {});
    let deepest = scene.objects[0].tree.depth();
    let points: Vec<Point> = (1..=deepest)
        .map(|level| {
            let mut scene = scene.clone();
            scene.objects[0].level = level;
            scene.tools[0].level = level.min(scene.tools[0].tree.depth());
            let spheres = scene.objects[0].tree.shape_at(level).count();
            let what = format!("level {level}, {spheres} spheres");
            point(spheres as f64, what, &scene, &inputs, runs, 500)
        })
        .collect();
    let mut asked = Vec::new();
    if let [.., shipped, finest] = points.as_slice() {
        let more = finest.x / shipped.x;
        asked.push(Asked::of(
            "finest level over the one before, median",
            finest,
            shipped,
            0.25 * more,
        ));
        asked.push(Asked {
            what: "the same at p99.9".into(),
            found: finest.times.tick_us.p999 / shipped.times.tick_us.p999,
            at_most: 0.75 * more,
        });
    }
    Line {
        with: "spheres of the touched tooth: the probe round a molar's crown, the same hand at every level",
        should: "slower than the number of spheres, as only what is near is looked at: hardly in the median, less than in proportion at p99.9, where a shaft lies along the crown",
        asked,
        points,
    }
}

/// One tool and two on one tissue.
fn tools(runs: usize, _: bool) -> Line {
    let mut points = Vec::new();
    for (x, name) in [(1.0, "pocket-0.4"), (2.0, "two-probes")] {
        let (scene, inputs) = played(name);
        let what = format!(
            "{} in one pocket",
            if x > 1.0 { "two probes" } else { "one probe" }
        );
        points.push(point(x, what, &scene, &inputs, runs, 300));
    }
    // The same second tool, in the air: it should cost next to nothing.
    let (scene, mut inputs) = played("pocket-0.4");
    let scene = twice(scene);
    let away = scene.tools[1].park;
    for input in &mut inputs {
        input.tools[1] = present(&away);
    }
    points.push(point(
        1.5,
        "one in the pocket, one in the air".into(),
        &scene,
        &inputs,
        runs,
        300,
    ));
    let asked = match points.as_slice() {
        [one, two, air] => vec![
            Asked::of("one more in the air", air, one, HARDLY),
            Asked::of("two in one tissue over one", two, one, 3.0),
        ],
        _ => Vec::new(),
    };
    points.sort_by(|a, b| a.x.total_cmp(&b.x));
    Line {
        with: "tools: 1, one more in the air (1.5), 2 in one tissue",
        should: "a tool in the air costs next to nothing; two in one tissue are one problem of 12 unknowns, so that where both bear a tick may take more than twice that of one",
        asked,
        points,
    }
}

/// Scene and inputs of a case whose hand is moved by a script that feels nothing.
fn played(name: &str) -> (Scene, Vec<TickInput>) {
    let case = find(name).expect("in the table");
    let scene = (case.scene)();
    let (Driver::Kinematic(script) | Driver::Closed(script, _)) = case.driver;
    let script = script(&scene);
    let ticks = (script.duration_s() / scene.tick_s()) as u64;
    let at = |k: u64| {
        let mut input = TickInput::IDLE;
        input.tools = script
            .targets(k as f64 * scene.tick_s())
            .map(|pose| pose.map_or(ToolInput::ABSENT, |pose| present(&pose)));
        input
    };
    let inputs = (0..ticks).map(at).collect();
    (scene, inputs)
}

/// The same probe in the same pocket, with fewer and more teeth beside it.
fn teeth(runs: usize, quick: bool) -> Line {
    let ticks = if quick { 8_500 } else { 14_000 };
    let points = [false, true].map(|four| {
        let built;
        let scene = if four {
            built = mouth(1, true, 3);
            &built
        } else {
            super::mouth::shipped()
        };
        let script = sulcus_cases::mouth::hands(scene, 25.0);
        let hand = (HandParams::default(), SEED);
        let inputs = record(scene, Box::new(script), hand, ticks, |_, _| {});
        let teeth = scene
            .objects
            .iter()
            .filter(|o| o.fdi != 0 && o.tissue.is_rigid())
            .count();
        point(
            teeth as f64,
            format!("{teeth} teeth with their gingivae"),
            scene,
            &inputs,
            runs,
            7_000,
        )
    });
    let [fourteen, four] = points;
    let asked = vec![Asked::of("14 teeth over 4", &fourteen, &four, HARDLY)];
    let points = [four, fourteen];
    Line {
        asked,
        with: "teeth: probe in a pocket and mirror on the tongue",
        should: "hardly at all: a tooth that no tool is near is one box that is looked at",
        points: points.into(),
    }
}

/// A tool in the air, in scenes with less and more in them.
fn untouched(runs: usize, _: bool) -> Line {
    let scenes = [
        ("a molar", changed(BuiltIn::Crown, &[])),
        ("a molar and its gingiva", changed(BuiltIn::Pocket, &[])),
        ("a tongue of springs", changed(BuiltIn::Tongue, &[])),
        ("a tongue of finite elements", changed(BuiltIn::Organ, &[])),
        ("a whole mouth", super::mouth::shipped().clone()),
    ];
    let points: Vec<Point> = scenes
        .into_iter()
        .enumerate()
        .map(|(k, (what, scene))| {
            let mut input = TickInput::IDLE;
            for (t, tool) in scene.tools.iter().enumerate().take(MAX_TOOLS) {
                input.tools[t] = ToolInput::ABSENT;
                let mut pose = tool.park;
                pose.position += Vec3::new(0.0, 0.0, 0.05);
                input.tools[t] = present(&pose);
            }
            let inputs = vec![input; 3000];
            let spheres: usize = scene
                .objects
                .iter()
                .map(|o| o.tree.shape_at(o.level).count())
                .sum();
            let what = format!("{what}: {} objects, {spheres} spheres", scene.objects.len());
            point(k as f64, what, &scene, &inputs, runs, 500)
        })
        .collect();
    let asked = match points.as_slice() {
        [least, .., most] => vec![Asked::of("a whole mouth over a molar", most, least, FREE)],
        _ => Vec::new(),
    };
    Line {
        asked,
        with: "what is not touched: the tools 50 mm above where they are parked",
        should: "a few microseconds, whatever is in the scene: what is at rest and untouched costs nothing",
        points,
    }
}

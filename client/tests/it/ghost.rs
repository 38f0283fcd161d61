//! A recorded hand beside the own one: as a ghost that guides, and played again as a device.

use std::collections::BTreeMap;

use sulcus_connection::progress::Steps;
use sulcus_core::math::norm;
use sulcus_core::{MAX_TOOLS, NoProbe, State, TickInput, Vec3, Workspace, tick};
use sulcus_demo::exercise::{self, Asked, Prepared};
use sulcus_demo::lockstep::as_sent;
use sulcus_haptics::guide::{Guide, GuideParams, Moment};
use sulcus_haptics::{Door, DoorRules, Limits, SlewLimits, Wanted, drawn};
use sulcus_operator::{Habit, Shown};

fn prepared(habit: Option<Habit>) -> Prepared {
    let asked = Asked {
        habit,
        ..Asked::of("probing")
    };
    exercise::prepare(&asked, &Steps).expect("built in")
}

/// Performance of an exercise.
struct Performed {
    /// Poses of the tools, tick by tick.
    path: Vec<Moment>,
    /// Deepest reading of each sixth of the tooth, mm.
    depths: BTreeMap<i32, f64>,
    /// Largest force of the guide, newtons.
    most_n: f64,
}

/// Performs in lock-step behind the door of hands in step, with a guide.
fn perform(mut prepared: Prepared, mut guide: Option<Guide>) -> Performed {
    let scene = prepared.scene.clone();
    let (mut state, mut ws) = (State::new(&scene), Workspace::new(&scene));
    let params = &scene.params;
    let limits = Limits {
        force_n: params.max_force,
        torque_nm: params.max_torque,
    };
    let rules = DoorRules::in_step(limits, SlewLimits::from(params), scene.tick_s());
    let mut doors = [0; MAX_TOOLS].map(|_| Door::new(rules.clone()));
    let mut shown = Shown::NOTHING;
    let mut done = Performed {
        path: Vec::new(),
        depths: BTreeMap::new(),
        most_n: 0.0,
    };
    for k in 1..=prepared.ticks {
        if prepared.operator.is_done() {
            break;
        }
        let now_ns = k * params.tick_ns();
        let mut input = TickInput::IDLE;
        input.tools = prepared.operator.step(&shown);
        let hands = input
            .tools
            .map(|tool| drawn(&tool.pose).filter(|_| tool.present));
        for (door, hand) in doors.iter_mut().zip(&hands) {
            door.moved(hand.as_ref(), 1);
        }
        let output = tick(&scene, &mut state, &mut ws, &input, &mut NoProbe);
        shown = as_sent(&output);
        let pulls = guide
            .as_mut()
            .map(|guide| guide.step(&hands, scene.tick_s()));
        for t in 0..MAX_TOOLS {
            let pull = pulls.map_or(Wanted::NOTHING.guide, |pulls| pulls[t]);
            done.most_n = done.most_n.max(norm(&pull.force));
            doors[t].order(&Wanted {
                wrench: shown.wrenches[t],
                guide: pull,
                heard_ns: Some(now_ns),
                ..Wanted::NOTHING
            });
            shown.wrenches[t] = doors[t].pass(now_ns);
        }
        if let Some(reading) = output.tools[0].pocket {
            let sixth = (reading.around.to_degrees() / 60.0).round() as i32;
            let deepest = done.depths.entry(sixth).or_insert(0.0);
            *deepest = deepest.max(reading.depth * 1e3);
        }
        done.path.push(hands);
    }
    done
}

/// Mean difference of the depths of both in the sixths that `good` has read, mm.
fn error(good: &Performed, other: &Performed) -> f64 {
    let of = |(sixth, depth): (&i32, &f64)| (depth - other.depths.get(sixth).unwrap_or(&0.0)).abs();
    good.depths.iter().map(of).sum::<f64>() / good.depths.len() as f64
}

#[test]
fn a_guide_lowers_the_depth_error_of_a_hand_that_stops_short_and_stays_below_its_limit() {
    let good = perform(prepared(None), None);
    assert!(good.depths.len() >= 3, "{:?}", good.depths);
    let bad = || prepared(Some(Habit::StopsShort));
    let tips = {
        let tools = bad()
            .scene
            .tools
            .iter()
            .map(|tool| tool.tip)
            .collect::<Vec<_>>();
        std::array::from_fn(|t| tools.get(t).copied().unwrap_or(Vec3::zeros()))
    };
    let tick_s = bad().scene.tick_s();
    let alone = perform(bad(), None);
    let guide = Guide::new(GuideParams::default(), good.path.clone(), tick_s, tips);
    let guided = perform(bad(), Some(guide));
    let (before, after) = (error(&good, &alone), error(&good, &guided));
    println!(
        "depth error {before:.3} mm alone, {after:.3} mm with a guide of at most {:.3} N",
        guided.most_n
    );
    assert!(before > 0.5, "the habit shows: {before} mm");
    assert!(after < 0.8 * before, "{before} mm alone, {after} mm guided");
    assert!(guided.most_n <= 0.3 + 1e-9, "{} N", guided.most_n);
}

//! Fig. 16 to 18: a probe into the pocket, turned in it, down to its floor.

use std::f64::consts::{FRAC_PI_2, TAU};

use sulcus_cases::Measures;
use sulcus_cases::tissue_scenes::pocket;
use sulcus_core::Pose;
use sulcus_core::math::{log_rotation, norm};
use sulcus_operator::pocket_path::{Manner, PocketPath};
use sulcus_operator::script::smoothstep;

use super::Curve;
use super::answers::Answers;
use super::contact::{LOOKED, SEED, Seen, by_hand, hand_at};
use super::pocket_states::{State, Tally, state_of};
use super::turning::Turning;

/// Depth of the pocket, metres.
const DEEP: f64 = 4e-3;
/// How deep the tip is meant to be while it is turned, metres.
const HELD: f64 = 3e-3;
/// The middle of the buccal side.
const SIDE: f64 = FRAC_PI_2;
/// How far the tip hugs the tooth's wall, metres.
const HUG: f64 = 1e-4;
/// How far the hand turns the probe, radians, and how often in a second.
const TURN: f64 = 0.1047;
const TURNS: f64 = 0.5;
/// When it is turned, seconds.
const TURNED: [f64; 2] = [3.0, 7.0];
const SECONDS: f64 = 10.0;
/// Milliseconds between two points of a curve.
const DRAWN: usize = 10;

/// Where the hand means to be: along the gingiva, then along the tooth; turned; on the floor.
fn pose(path: &PocketPath, t: f64) -> Pose {
    let down = smoothstep((t - 0.3) / 2.2);
    let floor = smoothstep((t - 7.3) / 0.8) - smoothstep((t - 9.0) / 0.8);
    let away = 3e-4 * (1.0 - smoothstep((t - 2.0) / 0.6));
    let [from, to] = TURNED;
    let held = smoothstep((t - from) / 0.2) - smoothstep((t - to + 0.2) / 0.2);
    let tilt = TURN * (TAU * TURNS * (t - from)).sin() * held;
    let outward = path.place(SIDE, 0.0, 0.0).outward;
    let depth = -2e-3 + (HELD + 2e-3) * down + 2.6e-3 * floor;
    path.pose(SIDE, depth, tilt, outward * away)
}

/// What is drawn, each over time.
#[derive(Default)]
struct Lines {
    turn: Vec<(f64, f64)>,
    torque: Vec<(f64, f64)>,
    axial: Vec<(f64, f64)>,
    lateral: Vec<(f64, f64)>,
    state: Vec<(f64, f64)>,
}

/// Answers for the pocket.
pub(super) fn answer(answers: &mut Answers) {
    let scene = pocket("0.4");
    let path = PocketPath::new(&scene, None, HUG, Manner::Taught).expect("the shipped pocket");
    let (straight, place) = (
        path.pose(SIDE, HELD, 0.0, Default::default()),
        path.place(SIDE, HELD, 0.0),
    );
    let (axis, up) = (path.tooth().axis.cross(&place.outward), place.up);
    let script = hand_at(move |t| pose(&path, t), SECONDS);
    let (mut turning, mut tally, mut lines) =
        (Turning::default(), Tally::default(), Lines::default());
    let mut k = 0;
    let (measures, _) = by_hand(&scene, script, (SECONDS, LOOKED), |seen: &Seen| {
        let (force, torque) = seen.wrench();
        let out = &seen.out.tools[0];
        let turn =
            log_rotation(&(out.haptic.orientation * straight.orientation.inverse())).dot(&axis);
        let torque = torque.dot(&axis) * 1e3;
        let turned = (TURNED[0]..TURNED[1]).contains(&seen.t);
        if turned {
            turning.points.push((turn, torque));
        }
        // The force on the hand along the probe, out of the pocket, and across it.
        let axial = force.dot(&up);
        let lateral = norm(&(force - up * axial));
        let state = state_of(seen, turned);
        let depth = out.pocket.map_or(0.0, |reading| reading.depth);
        tally.add(state, axial, lateral, depth);
        k += 1;
        if k % DRAWN == 0 {
            lines.turn.push((seen.t, turn.to_degrees()));
            lines.torque.push((seen.t, torque));
            lines.axial.push((seen.t, axial));
            lines.lateral.push((seen.t, lateral));
            lines.state.push((seen.t, state as usize as f64));
        }
    });
    let how = format!(
        "the shipped molar with a pocket of 0.4 mm, {} mm deep, probe of 0.5 mm at 0.5 N/mm, a hand in closed loop for {SECONDS} s, seed {SEED}",
        DEEP * 1e3
    );
    turned(&turning, &measures, &how, answers);
    inserted(&tally, &how, answers);
    gaps(&measures, &how, answers);
    curves(lines, &how, answers);
}

fn turned(turning: &Turning, measures: &Measures, how: &str, answers: &mut Answers) {
    let (lag, alike) = turning.lag();
    let (against, peak) = (turning.against(0.1 * TURN) * 100.0, turning.peak());
    let most = turning.most_turn().to_degrees();
    answers.measured(
        "fig17-sequence",
        format!("torque against the turn in {against:.1} % of the ticks, {lag} ms behind it"),
        &[("against_percent", against), ("lag_ms", lag as f64), ("correlation", alike)],
        format!("{how}; turned to and fro twice about the tangent of the tooth; ticks with a torque and a turn over a tenth of the largest, each less its mean; lag where turn and torque are most alike (correlation {alike:.2})"),
    );
    answers.measured(
        "fig17-torque",
        format!("{peak:.2} N mm"),
        &[("n_mm", peak)],
        format!("{how}; about the working point"),
    );
    answers.measured(
        "fig17-angle-deg",
        format!("{most:.1} degrees each way"),
        &[("deg", most)],
        format!("{how}; the hand's, meant {:.0}", TURN.to_degrees()),
    );
    let (buzz, energy) = (measures.buzz * 1e3, measures.energy * 1e3);
    answers.measured(
        "fig17-stable",
        format!("buzz {buzz:.2} mN, {energy:.3} mJ put out at most, largest change of torque in a tick {:.2} N mm", measures.torque_step * 1e3),
        &[("buzz_mn", buzz), ("put_out_mj", energy), ("torque_step_n_mm", measures.torque_step * 1e3)],
        format!("{how}; insertion, turning and withdrawal together"),
    );
    answers.measured(
        "fig18-turn",
        format!("{lag} ms behind the hand, buzz {buzz:.2} mN"),
        &[("lag_ms", lag as f64), ("buzz_mn", buzz)],
        format!("{how}; the same run as Fig. 17"),
    );
}

fn inserted(tally: &Tally, how: &str, answers: &mut Answers) {
    let states = State::TOUCHING;
    let seen: Vec<String> = states
        .iter()
        .map(|state| format!("{}: {} ms", state.name(), tally.ticks(*state)))
        .collect();
    answers.measured(
        "fig18-sequence",
        format!("{}; {} switches", seen.join("; "), tally.switches),
        &[("switches", tally.switches as f64)],
        format!("{how}; by what bears load in each tick"),
    );
    let forces: Vec<String> = states.iter().map(|state| tally.describe(*state)).collect();
    let floor = tally.most_axial(State::Floor);
    answers.measured(
        "fig18-force-n",
        forces.join("; "),
        &[
            ("gingiva_axial_n", tally.most_axial(State::Gingiva)),
            ("both_axial_n", tally.most_axial(State::Both)),
            ("both_turned_axial_n", tally.most_axial(State::BothTurned)),
            ("floor_axial_n", floor),
        ],
        format!("{how}; largest in each state, along the probe and across it"),
    );
    let before = tally
        .most_axial(State::Gingiva)
        .max(tally.most_axial(State::Both));
    answers.measured(
        "fig18-bottom-force",
        format!("{floor:.2} N on the floor, {before:.2} N at most on the way down"),
        &[("floor_n", floor), ("before_n", before)],
        format!("{how}; along the probe; the floor's prescribed depth is read at 0.225 N"),
    );
    let deepest = tally.deepest * 1e3;
    answers.measured(
        "fig18-depth-mm",
        format!("{deepest:.2} mm read at most, {} mm prescribed", DEEP * 1e3),
        &[("read_mm", deepest), ("prescribed_mm", DEEP * 1e3)],
        how.to_owned(),
    );
}

fn gaps(measures: &Measures, how: &str, answers: &mut Answers) {
    let (residual, behind) = (measures.residual * 1e6, measures.exhausted_residual * 1e6);
    let values = [("um", residual), ("exhausted_um", behind)];
    let how = format!(
        "{how}; all pairs of spheres on the deformed shape, by a query of its own in every tenth tick"
    );
    answers.measured(
        "fig16-gap",
        format!("{residual:.3} um of penetration at most"),
        &values,
        how.clone(),
    );
    let imbalance = measures.imbalance;
    answers.measured(
        "exact-contact",
        format!("{residual:.3} um of penetration at most; loads and wrench agree to {imbalance:.0e}"),
        &[("um", residual), ("imbalance", imbalance)],
        format!("{how}; a sphere that bears load lies on the other to the contact compliance of 1e-5 mm/N"),
    );
}

fn curves(lines: Lines, how: &str, answers: &mut Answers) {
    let series = |name: &str, line: Vec<(f64, f64)>| (name.to_owned(), line);
    let keep = |line: &[(f64, f64)]| -> Vec<(f64, f64)> {
        line.iter()
            .copied()
            .filter(|(t, _)| (TURNED[0] - 0.2..TURNED[1] + 0.2).contains(t))
            .collect()
    };
    answers.curve(Curve {
        place: "Fig. 17",
        title: "A probe turned in the pocket".to_owned(),
        x: "time, s",
        y: "degrees; N mm",
        series: vec![
            series("turn of the hand, degrees", keep(&lines.turn)),
            series("torque on the hand, N mm", keep(&lines.torque)),
        ],
        note: how.to_owned(),
    });
    answers.curve(Curve {
        place: "Fig. 18",
        title: "A probe inserted to the floor of the pocket".to_owned(),
        x: "time, s",
        y: "N",
        series: vec![
            series("along the probe", lines.axial),
            series("across the probe", lines.lateral),
        ],
        note: how.to_owned(),
    });
    answers.curve(Curve {
        place: "Fig. 18",
        title: "What bears load: 0 nothing, 1 gingiva, 2 tooth, 3 both, 4 both while turned, 5 the floor".to_owned(),
        x: "time, s",
        y: "state",
        series: vec![series("state", lines.state)],
        note: how.to_owned(),
    });
}

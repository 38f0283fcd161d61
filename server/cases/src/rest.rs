//! A hand at rest in contact for an hour: no drift, no limit cycle.
//!
//! Simulation, display and a hand without tremor are one deterministic machine. If its whole state equals, bit for bit,
//! the state of `p` ticks before, all later states repeat with period `p`. The rest of the hour is then proven without
//! a run. Brent's algorithm finds a repetition with one stored state.

use sulcus_core::math::norm;
use sulcus_core::{
    MAX_TOOLS, NoProbe, Scene, State, TickInput, Vec3, Workspace, output::status, tick,
};
use sulcus_haptics::{Display, PassivityParams, Shown, SlewLimits, drawn};
use sulcus_operator::{Hand, HandParams, present};

use crate::table::{Case, Driver};

/// Ticks of an hour at 1 kHz.
pub const HOUR: u64 = 3_600_000;
/// Time after which everything has settled, ticks. A later motion is drift.
pub const SETTLED: u64 = 10_000;

/// Result of a rest.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rest {
    /// Number of ticks run.
    pub ticks: u64,
    /// Period of the whole state, ticks; 1: the state is constant; `None`: no repetition was found.
    pub period: Option<u64>,
    /// Distance at the end from the positions at [`SETTLED`], metres: largest of the working points of hands and
    /// graphic tools.
    pub drift: f64,
    /// Largest of these distances in any tick after [`SETTLED`], metres.
    pub excursion: f64,
    /// Sum of the forces displayed in the last tick, newtons. Zero means that nothing was touched.
    pub force: f64,
}

/// State that the next tick depends on. The tick's number and hash are excluded, because no motion depends on them.
#[derive(Clone)]
struct Machine {
    state: State,
    hands: [Option<Hand>; MAX_TOOLS],
    displays: [Display; MAX_TOOLS],
    shown: Shown,
}

impl Machine {
    /// Whether the machine moves as it did from `earlier`, for `times` repetitions.
    fn repeats(&self, earlier: &Self, times: f64) -> bool {
        let mut hands = self.hands.iter().zip(&earlier.hands);
        let same = |(a, b): (&Option<Hand>, &Option<Hand>)| match (a, b) {
            (Some(a), Some(b)) => a.goes_on_as(b),
            (a, b) => a.is_none() && b.is_none(),
        };
        // The cheap comparison comes first. It does not distinguish 0 from -0; the comparison of bytes does.
        hands.all(same)
            && self.shown == earlier.shown
            && self
                .displays
                .iter()
                .zip(&earlier.displays)
                .all(|(a, b)| a.repeats(b, times))
            && self.state.tools == earlier.state.tools
            && bytes(&self.state) == bytes(&earlier.state)
    }
}

fn bytes(state: &State) -> Vec<u8> {
    let mut state = state.clone();
    (state.tick, state.hash) = (0, 0);
    state.to_bytes()
}

/// Runs a hand without tremor that follows the script of `case` for `hold` seconds and then rests.
///
/// The run has `ticks` ticks at most, and ends one period after a repetition. The wrench is displayed as at a client
/// with the controller `passivity`.
pub fn rest(case: &Case, hold: f64, ticks: u64, passivity: PassivityParams) -> Rest {
    let scene = (case.scene)();
    let (Driver::Kinematic(script) | Driver::Closed(script, _)) = case.driver;
    let script = script(&scene);
    let params = HandParams {
        tremor: 0.0,
        spin_tremor: 0.0,
        ..HandParams::default()
    };
    let mut ws = Workspace::new(&scene);
    let mut now = Machine {
        state: State::new(&scene),
        hands: [const { None }; MAX_TOOLS],
        displays: [0; MAX_TOOLS].map(|_| Display::new(passivity, SlewLimits::from(&scene.params))),
        shown: Shown::NOTHING,
    };
    let mut earlier: Option<(u64, Machine)> = None;
    let (mut place, mut report) = (
        None,
        Rest {
            ticks: 0,
            period: None,
            drift: 0.0,
            excursion: 0.0,
            force: 0.0,
        },
    );
    // After a repetition the run continues for one period, and at least for one period after `SETTLED`.
    let mut end = ticks;
    let mut next_look = 1;
    for k in 0..ticks {
        let targets = script.targets((k as f64 * scene.tick_s()).min(hold));
        let mut input = TickInput::IDLE;
        for (t, target) in targets.iter().enumerate().take(scene.tools.len()) {
            let Some(target) = *target else { continue };
            let hand = now.hands[t].get_or_insert_with(|| Hand::new(params, target, 0));
            input.tools[t] = present(&hand.step(&target, &now.shown.wrenches[t]));
            now.displays[t].moved(drawn(&input.tools[t].pose).as_ref(), 1);
        }
        let output = tick(&scene, &mut now.state, &mut ws, &input, &mut NoProbe);
        now.shown = Shown::from(&output);
        report.force = 0.0;
        for t in 0..scene.tools.len() {
            now.shown.wrenches[t] = now.displays[t].next(&now.shown.wrenches[t], 1.0);
            report.force += norm(&now.shown.wrenches[t].force);
        }
        if k >= SETTLED {
            let points = points(&scene, &output);
            let place = *place.get_or_insert(points);
            let apart = points.iter().zip(&place).map(|(p, q)| norm(&(p - q)));
            report.drift = apart.fold(0.0, f64::max);
            report.excursion = report.excursion.max(report.drift);
        }
        report.ticks = k + 1;
        if k + 1 >= end {
            break;
        }
        if report.period.is_some() || k as f64 * scene.tick_s() < hold {
            continue;
        }
        if let Some((at, earlier)) = &earlier
            && now.repeats(earlier, (ticks - k) as f64 / (k - *at) as f64 + 1.0)
        {
            report.period = Some(k - *at);
            end = ticks.min(SETTLED.max(k) + (k - *at) + 1);
            continue;
        }
        // Brent's algorithm: the distances between stored states double.
        if earlier.as_ref().is_none_or(|(at, _)| k - at >= next_look) {
            if earlier.is_some() {
                next_look *= 2;
            }
            earlier = Some((k, now.clone()));
        }
    }
    report
}

/// Working point of each tool by its haptic and by its graphic pose, world, metres; zero for an absent tool.
fn points(scene: &Scene, output: &sulcus_core::TickOutput) -> [Vec3; 2 * MAX_TOOLS] {
    std::array::from_fn(|k| {
        let (t, out) = (k / 2, &output.tools[k / 2]);
        let Some(tool) = scene.tools.get(t) else {
            return Vec3::zeros();
        };
        if out.status & status::ABSENT != 0 {
            return Vec3::zeros();
        }
        let pose = if k % 2 == 0 {
            &out.haptic
        } else {
            &out.graphic
        };
        pose.transform(&tool.working_point)
    })
}

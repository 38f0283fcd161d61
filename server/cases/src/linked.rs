//! A hard case over a link: delay and loss of poses and wrenches, and the energy that the loop puts out.

use std::collections::VecDeque;

use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::{Rng, SeedableRng};
use sulcus_core::math::norm;
use sulcus_core::{
    MAX_TOOLS, NoProbe, Scene, State, TickInput, Vec3, Workspace, Wrench, output::status, tick,
};
use sulcus_haptics::{Display, PassivityParams, Shown, SlewLimits, drawn};
use sulcus_operator::Operator;

use crate::comparison::by_hand;
use crate::shake::Shake;
use crate::table::{Case, Driver};

/// A link with a constant delay, so that no datagram is out of order, and with random loss.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LinkModel {
    /// Round-trip delay, ticks. The way to the server takes the larger half.
    pub delay_ticks: u32,
    /// Probability of the loss of a datagram, each way.
    pub loss: f64,
    /// Seed of the losses.
    pub seed: u64,
}

/// Direction of a link: data on the way, and the data that arrived last.
struct Way<T> {
    delay: u64,
    flying: VecDeque<(u64, T)>,
    newest: Option<(u64, T)>,
}

impl<T: Copy> Way<T> {
    fn new(delay: u32) -> Self {
        Self {
            delay: u64::from(delay),
            flying: VecDeque::new(),
            newest: None,
        }
    }

    /// Sends `value` at tick `now`, unless it is lost. Returns the newest arrived value with the tick at which it was
    /// sent.
    fn carry(&mut self, now: u64, value: T, lost: bool) -> Option<(u64, T)> {
        if !lost {
            self.flying.push_back((now, value));
        }
        while let Some((sent, _)) = self.flying.front()
            && sent + self.delay <= now
        {
            self.newest = self.flying.pop_front();
        }
        self.newest
    }
}

/// Result of a case over a link, SI units.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Linked {
    /// Number of ticks run.
    pub ticks: u64,
    /// Largest net energy that the displayed wrench put out into a hand since its contact began, joules. A contact ends
    /// after a tenth of a second without a force.
    pub energy: f64,
    /// Largest work on a hand in one period beyond the energy that it had put in, joules. No controller can foresee it.
    pub period_work: f64,
    /// Whether all numbers were finite and the energy of every hand was within two bounds: [`FELT`] plus twice the
    /// largest work of one period, and [`crate::Bounds::linked_energy`].
    pub passive: bool,
    /// Energy removed by the controllers of all hands, joules.
    pub taken: f64,
    /// Share of the tool-ticks in which a controller acted.
    pub acted: f64,
    /// Root mean square of the difference between the displayed force and the raw force of the same tick, newtons.
    ///
    /// Only tool-ticks with a force count, without a ramp, a clamp or an absence at the server.
    pub force_error: f64,
    /// Root mean square of that raw force over the same tool-ticks, newtons.
    pub force: f64,
    /// Largest force displayed, newtons.
    pub max_force: f64,
    /// *Shake*: root mean square of the working points' motion above the tremor's band, metres, over the second half of
    /// the run and ticks with a displayed force.
    pub shake: f64,
    /// Whether every displayed and reported number was finite.
    pub finite: bool,
}

/// Smallest energy that a hand feels, joules; chosen.
pub const FELT: f64 = 1e-4;

impl Linked {
    /// *Infidelity*: the force error relative to the force; 0 without a force.
    pub fn infidelity(&self) -> f64 {
        if self.force > 0.0 {
            self.force_error / self.force
        } else {
            0.0
        }
    }
}

/// Length of a run that replaces a minute at rest, seconds at 1 kHz.
pub const LONGEST_S: f64 = 5.0;
/// Length from which a case counts as a minute at rest, seconds.
const MINUTE_S: f64 = 30.0;

/// Sums over a run.
#[derive(Default)]
struct Sums {
    tool_ticks: u64,
    felt: u64,
    error: f64,
    force: f64,
    shaken: u64,
    shake: f64,
}

/// Runs `case` over `link` by a hand that feels, with the controller `passivity`. [`PassivityParams::observing`]
/// removes no energy.
pub fn run_linked(case: &Case, link: &LinkModel, passivity: PassivityParams) -> Linked {
    run_linked_on(case, link, passivity, |_| {})
}

/// Runs `case` over `link` on its scene after `change`. The script is that of the unchanged scene.
pub fn run_linked_on(
    case: &Case,
    link: &LinkModel,
    passivity: PassivityParams,
    change: impl FnOnce(&mut Scene),
) -> Linked {
    let mut scene = (case.scene)();
    let Driver::Closed(script, params) = by_hand(case).driver else {
        unreachable!("by a hand");
    };
    let mut operator = Operator::new(script(&scene), params(), case.seed);
    change(&mut scene);
    let ticks = match operator.ticks() {
        long if long as f64 * scene.tick_s() >= MINUTE_S => (LONGEST_S * 1e3) as u64,
        short => short,
    };
    let (mut state, mut ws) = (State::new(&scene), Workspace::new(&scene));
    let mut displays =
        [0; MAX_TOOLS].map(|_| Display::new(passivity, SlewLimits::from(&scene.params)));
    let mut shakes = [Shake::default(); MAX_TOOLS];
    let mut rng = ChaCha8Rng::seed_from_u64(link.seed);
    let mut lost = || {
        let unit = (rng.next_u64() >> 11) as f64 / (1u64 << 53) as f64;
        unit < link.loss
    };
    let mut up = Way::new(link.delay_ticks.div_ceil(2));
    let mut down = Way::new(link.delay_ticks / 2);
    let mut shown = Shown::NOTHING;
    let mut sums = Sums::default();
    let mut linked = Linked {
        ticks,
        finite: true,
        passive: true,
        ..Linked::default()
    };
    for now in 0..ticks {
        let mut input = TickInput::IDLE;
        input.tools = operator.step(&shown);
        let held = input.tools;
        for (display, tool) in displays.iter_mut().zip(&held) {
            let hand = drawn(&tool.pose).filter(|_| tool.present);
            linked.finite &= hand.is_some() || !tool.present;
            display.moved(hand.as_ref(), 1);
        }
        (case.disturb)(now, &mut input);
        let mut heard = TickInput::IDLE;
        if let Some((sent, tools)) = up.carry(now, input.tools, lost()) {
            heard.tools = tools;
            for tool in &mut heard.tools {
                tool.age_ticks = u16::try_from(now - sent).unwrap_or(u16::MAX);
            }
        }
        let output = tick(&scene, &mut state, &mut ws, &heard, &mut NoProbe);
        let arrived = down.carry(now, Shown::from(&output), lost());
        shown = arrived.map_or(Shown::NOTHING, |(_, shown)| shown);
        for t in 0..scene.tools.len() {
            let wanted = as_sent(&shown.wrenches[t]);
            let felt = displays[t].next(&wanted, 1.0);
            shown.wrenches[t] = felt;
            linked.finite &= felt.force.iter().chain(&felt.torque).all(|x| x.is_finite());
            linked.max_force = linked.max_force.max(norm(&felt.force));
            let out = &output.tools[t];
            sums.tool_ticks += u64::from(held[t].present);
            // Forces that the server reduces are no error of the link.
            const HELD_BACK: u16 = status::ABSENT | status::RAMPING | status::SATURATED;
            let raw = out.raw_wrench.force;
            let felt_force = norm(&felt.force);
            if out.status & HELD_BACK == 0 && (felt_force > 0.0 || norm(&raw) > 0.0) {
                sums.felt += 1;
                sums.error += (felt.force - raw).norm_squared();
                sums.force += raw.norm_squared();
            }
            let at = drawn(&held[t].pose).filter(|_| held[t].present);
            let shake = shakes[t].of(at.map(|pose| pose.transform(&scene.tools[t].working_point)));
            if felt_force > 0.0 && now >= ticks / 2 {
                sums.shaken += 1;
                sums.shake += shake.norm_squared();
            }
        }
    }
    let mut acted = 0;
    for energy in displays.map(|display| display.energy()) {
        linked.energy = linked.energy.max(energy.most_out);
        linked.period_work = linked.period_work.max(energy.most_at_once);
        // The controller sees the work after one period, and the hand feels its answer after another.
        linked.passive &= energy.most_out <= FELT + 2.0 * energy.most_at_once;
        // The first bound grows with the work of a period; the second is a constant of the case.
        linked.passive &= energy.most_out <= case.bounds.linked_energy;
        linked.taken += energy.taken;
        acted += energy.acted;
    }
    let rms = |sum: f64, count: u64| (sum / count.max(1) as f64).sqrt();
    linked.acted = acted as f64 / sums.tool_ticks.max(1) as f64;
    linked.force_error = rms(sums.error, sums.felt);
    linked.force = rms(sums.force, sums.felt);
    linked.shake = rms(sums.shake, sums.shaken);
    linked.finite &= linked.energy.is_finite() && linked.force.is_finite();
    linked.passive &= linked.finite;
    linked
}

/// A wrench, rounded to f32 as on the wire.
fn as_sent(wrench: &Wrench) -> Wrench {
    let narrow = |v: &Vec3| v.map(|x| f64::from(x as f32));
    Wrench {
        force: narrow(&wrench.force),
        torque: narrow(&wrench.torque),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_way_delays_and_keeps_the_newest_when_some_are_lost() {
        let mut way = Way::new(2);
        assert_eq!(way.carry(0, 'a', false), None);
        assert_eq!(way.carry(1, 'b', true), None);
        assert_eq!(way.carry(2, 'c', false), Some((0, 'a')));
        assert_eq!(way.carry(3, 'd', false), Some((0, 'a')));
        assert_eq!(way.carry(4, 'e', false), Some((2, 'c')));
    }
}

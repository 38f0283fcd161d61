//! A case by a hand whose poses and wrenches go over a link: delay, loss, and the energy that the loop puts out.

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

/// A link as both ends see it: no jitter, so nothing is out of order.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LinkModel {
    /// Round trip, ticks: the way up takes the larger half.
    pub delay_ticks: u32,
    /// Probability that a datagram never arrives, each way.
    pub loss: f64,
    /// Seed of the losses.
    pub seed: u64,
}

/// One direction: what is on its way, and what arrived last.
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

    /// Sends `value` at `now`, unless it is lost; what arrives by now replaces what came before.
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

/// How a case went over a link. SI units.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Linked {
    /// Ticks run.
    pub ticks: u64,
    /// Most energy that the displayed wrench had put out into a hand, net, since its contact began. (Contact ends when
    /// nothing was felt for a tenth of a second.)
    pub energy: f64,
    /// Most that it put out within one period beyond what had been paid for: what no controller can foresee.
    pub period_work: f64,
    /// Whether every number was one and, of every hand, two such periods explain what came out, but for what is not felt, and it is no more than
    /// [`crate::Bounds::linked_energy`].
    pub passive: bool,
    /// What the controller took out, all hands.
    pub taken: f64,
    /// Share of the tool-ticks in which it acted.
    pub acted: f64,
    /// *Infidelity*: rms difference between the force displayed and the raw force that the simulation computed in the same
    /// tick, over tool-ticks in which either is not zero and the server neither ramps nor clamps it.
    pub force_error: f64,
    /// Rms of that raw force over the same tool-ticks.
    pub force: f64,
    /// Largest force displayed.
    pub max_force: f64,
    /// *Shake*: rms motion of the hands' working points above the tremor's band, over the second half of the run and the
    /// ticks in which a force is displayed.
    pub shake: f64,
    /// Whether every number that was displayed or reported was one.
    pub finite: bool,
}

/// Energy under which nothing is felt, joules.
pub const FELT: f64 = 1e-4;

impl Linked {
    /// The force error relative to the force; 0 where nothing was felt.
    pub fn infidelity(&self) -> f64 {
        if self.force > 0.0 {
            self.force_error / self.force
        } else {
            0.0
        }
    }
}

/// Longest that a case runs here, seconds, in place of the minute at rest.
pub const LONGEST_S: f64 = 5.0;
/// Length from which a case is one of those, seconds.
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

/// Runs `case` by a hand that feels, over `link`; the controller as `passivity` says ([`PassivityParams::observing`]: none).
pub fn run_linked(case: &Case, link: &LinkModel, passivity: PassivityParams) -> Linked {
    run_linked_on(case, link, passivity, |_| {})
}

/// The same on the case's scene as `change` leaves it.
///
/// # Panics
/// Never: a case by a hand is closed.
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
            // What the server itself holds back is not the link's doing.
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
        // One period until it is seen, one until the answer to it is felt.
        linked.passive &= energy.most_out <= FELT + 2.0 * energy.most_at_once;
        // That bound grows with what goes wrong; this one is the case's own.
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

/// A wrench as the wire carries it.
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

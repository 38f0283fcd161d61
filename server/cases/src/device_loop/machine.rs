//! Devices, link and simulation of one run.

use std::collections::VecDeque;

use sulcus_core::{
    MAX_TOOLS, NoProbe, Pose, Scene, State, TickInput, ToolInput, Vec3, Workspace, Wrench, tick,
};
use sulcus_operator::{Felt, Shown};

use super::figures::Dynamics;
use super::filter::{HighPass, Window};
use super::held::{Held, READY_NS};
use super::{Looped, Setup};

/// Direction of a link with a constant delay in ticks.
struct Way<T> {
    delay: u32,
    flying: VecDeque<T>,
}

impl<T> Way<T> {
    fn new(delay: u32) -> Self {
        Self {
            delay,
            flying: VecDeque::new(),
        }
    }

    /// Sends `value`, and returns the value that arrives in this tick.
    fn carry(&mut self, value: T) -> Option<T> {
        self.flying.push_back(value);
        if self.flying.len() > self.delay as usize {
            self.flying.pop_front()
        } else {
            None
        }
    }
}

/// Devices in two hands, link and simulation.
pub(super) struct Machine<'a> {
    scene: &'a Scene,
    setup: &'a Setup<'a>,
    dynamics: Dynamics,
    /// Number of periods of the device in a tick.
    periods: u64,
    state: State,
    ws: Workspace,
    held: [Option<Held>; MAX_TOOLS],
    targets: [Option<Pose>; MAX_TOOLS],
    up: Way<[ToolInput; MAX_TOOLS]>,
    down: Way<Shown>,
    shown: Shown,
    filters: [HighPass; MAX_TOOLS],
    windows: [Window; MAX_TOOLS],
    /// Periods with the passivity controller and with the continuous limit, before the window.
    before: Option<[u64; 2]>,
    live: bool,
    finite: bool,
}

impl<'a> Machine<'a> {
    /// Machine at rest without hands.
    pub(super) fn new(scene: &'a Scene, setup: &'a Setup<'a>) -> Self {
        let dynamics = Dynamics::of(setup.model, &setup.variation, setup.grip);
        Self {
            scene,
            setup,
            dynamics,
            periods: libm::round(scene.tick_s() / dynamics.period_s).max(1.0) as u64,
            state: State::new(scene),
            ws: Workspace::new(scene),
            held: [const { None }; MAX_TOOLS],
            targets: [None; MAX_TOOLS],
            up: Way::new(setup.delay_ticks.div_ceil(2)),
            down: Way::new(setup.delay_ticks / 2),
            shown: Shown::NOTHING,
            filters: [0; MAX_TOOLS].map(|_| HighPass::new(dynamics.period_s)),
            windows: Default::default(),
            before: None,
            live: true,
            finite: true,
        }
    }

    /// Perception of the person.
    pub(super) fn felt(&self) -> Felt {
        let displayed = |held: &Option<Held>| held.as_ref().map_or(Wrench::ZERO, Held::displayed);
        Felt {
            shown: Shown {
                wrenches: std::array::from_fn(|t| displayed(&self.held[t])),
                ..self.shown
            },
            hands: std::array::from_fn(|t| self.held[t].as_ref().map(Held::handle)),
        }
    }

    /// Performs tick `now` with hands on the way to `targets`. `disturb` changes the input of the server. The force
    /// counts in the window.
    pub(super) fn tick(
        &mut self,
        now: u64,
        targets: &[Option<Pose>; MAX_TOOLS],
        disturb: fn(u64, &mut TickInput),
        in_window: bool,
    ) {
        let at_ns = 2 * READY_NS + now * self.scene.params.tick_ns();
        let period_ns = self.scene.params.tick_ns() / self.periods;
        self.hold(targets, at_ns);
        if in_window && self.before.is_none() {
            self.before = Some(self.sums());
        }
        for period in 0..self.periods {
            let now_ns = at_ns + period * period_ns;
            self.exchange(now_ns, in_window);
            if period == 0 {
                self.simulate(now, now_ns, disturb);
            }
            let share = (period + 1) as f64 / self.periods as f64;
            for (t, held) in self.held.iter_mut().enumerate() {
                if let (Some(held), Some(from), Some(to)) = (held, &self.targets[t], &targets[t]) {
                    held.moves(now_ns, &between(from, to, share));
                }
            }
        }
        self.targets = *targets;
    }

    /// Gives a device to each hand that begins, and takes it from a hand that ends.
    fn hold(&mut self, targets: &[Option<Pose>; MAX_TOOLS], at_ns: u64) {
        for (t, tool) in self.scene.tools.iter().enumerate() {
            match &targets[t] {
                None => self.held[t] = None,
                Some(target) if self.held[t].is_none() => {
                    let tool = (self.scene, tool);
                    let ready = Held::ready(self.setup, self.dynamics, tool, *target, at_ns);
                    self.held[t] = Some(ready);
                    self.targets[t] = Some(*target);
                }
                Some(_) => {}
            }
        }
    }

    fn exchange(&mut self, now_ns: u64, in_window: bool) {
        for (t, held) in self.held.iter_mut().enumerate() {
            let Some(held) = held else { continue };
            let force = held.exchange(now_ns, 0);
            let fast = self.filters[t].of(&force);
            self.finite &= force.iter().all(|x| x.is_finite());
            if in_window {
                self.windows[t].take(&force, &fast, held.sent_n());
                self.live &= held.is_live();
            }
        }
    }

    /// Sends the poses, performs a tick of the server and takes the wrench that arrives.
    fn simulate(&mut self, now: u64, now_ns: u64, disturb: fn(u64, &mut TickInput)) {
        let mut input = TickInput::IDLE;
        for (tool, held) in input.tools.iter_mut().zip(&self.held) {
            if let Some(pose) = held.as_ref().and_then(Held::tool) {
                *tool = ToolInput::at(&pose);
            }
        }
        disturb(now, &mut input);
        let arrived = self.up.carry(input.tools);
        input.tools = arrived.unwrap_or([ToolInput::ABSENT; MAX_TOOLS]);
        let (state, ws) = (&mut self.state, &mut self.ws);
        let output = tick(self.scene, state, ws, &input, &mut NoProbe);
        if let Some(shown) = self.down.carry(Shown::from(&output)) {
            self.shown = shown;
            for (held, wrench) in self.held.iter_mut().zip(&shown.wrenches) {
                if let Some(held) = held {
                    held.hears(&as_sent(wrench), now_ns);
                }
            }
        }
    }

    /// Periods of all doors with the passivity controller and with the continuous limit.
    fn sums(&self) -> [u64; 2] {
        let held = || self.held.iter().flatten();
        [
            held().map(Held::acted).sum(),
            held().map(Held::limited).sum(),
        ]
    }

    /// Measures of the window.
    pub(super) fn looped(&self) -> Looped {
        let of = |value: fn(&Window) -> f64| self.windows.iter().map(value).fold(0.0, f64::max);
        let loudest = if self.windows[1].buzz_n() > self.windows[0].buzz_n() {
            &self.windows[1]
        } else {
            &self.windows[0]
        };
        let before = self.before.unwrap_or_default();
        let after = self.sums();
        let periods = self.windows.iter().map(Window::count).sum::<u64>().max(1);
        let share = |k: usize| after[k].saturating_sub(before[k]) as f64 / periods as f64;
        Looped {
            buzz_n: of(Window::buzz_n),
            swing_n: of(Window::swing_n),
            hertz: loudest.hertz(self.dynamics.period_s),
            force_n: of(Window::force_n),
            sent_n: of(Window::sent_n),
            energy: self
                .held
                .iter()
                .flatten()
                .map(Held::energy)
                .fold(0.0, f64::max),
            acted: share(0),
            limited: share(1),
            live: self.live,
            finite: self.finite,
            ..Looped::default()
        }
    }
}

/// Pose at `share` of the way between two poses.
fn between(from: &Pose, to: &Pose, share: f64) -> Pose {
    if share >= 1.0 {
        return *to;
    }
    Pose::new(
        from.position + (to.position - from.position) * share,
        from.orientation.slerp(&to.orientation, share),
    )
}

/// A wrench, rounded to f32 as on the wire.
fn as_sent(wrench: &Wrench) -> Wrench {
    let narrow = |v: &Vec3| v.map(|x| f64::from(x as f32));
    Wrench {
        force: narrow(&wrench.force),
        torque: narrow(&wrench.torque),
    }
}

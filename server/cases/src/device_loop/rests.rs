//! Moments of a case at which the hand comes to rest.

use sulcus_core::math::norm;
use sulcus_core::{NoProbe, State, TickInput, Workspace, tick};
use sulcus_haptics::Shown;
use sulcus_operator::{HandParams, Operator};

use crate::comparison::by_hand;
use crate::linked::LONGEST_S;
use crate::table::{Case, Driver};

/// Time constant of the force that chooses a moment, seconds: a click is no contact.
const SMOOTH_S: f64 = 0.02;
/// Force of probing, newtons: the contact of [`Rests::working_s`].
const WORKING_N: f64 = 0.5;
/// Force of [`Rests::light_s`], newtons: three times the criterion, so that a contact that comes and goes is found.
const LIGHT_N: f64 = 0.15;

/// Moments of a case, seconds from its beginning.
///
/// The moments are those of the simulated operator's hand without tremor at the scene's own coupling. All devices use
/// the same moments. A rest at the end of a script would be vacuous, because many scripts end away from the object.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Rests {
    /// Moment of the largest force: most rows and the deepest contact. A device at its limit of force has no stiffness
    /// along the force, which is why the other moments exist.
    pub hardest_s: f64,
    /// First moment with 0.5 N, or with half of the largest force.
    pub working_s: f64,
    /// First moment with 0.15 N, or with a quarter of the largest force: a contact that is lost in each swing.
    pub light_s: f64,
    /// Largest force, smoothed, newtons.
    pub most_n: f64,
}

impl Rests {
    /// Moments of `case`. A case of more than five seconds is searched for five seconds.
    pub fn of(case: &Case) -> Self {
        let Driver::Closed(script, params) = by_hand(case).driver else {
            unreachable!("by a hand");
        };
        let scene = (case.scene)();
        let hand = HandParams {
            tremor: 0.0,
            spin_tremor: 0.0,
            ..params()
        };
        let mut operator = Operator::new(script(&scene), hand, case.seed);
        let (mut state, mut ws) = (State::new(&scene), Workspace::new(&scene));
        let tick_s = scene.tick_s();
        let ticks = operator.ticks().min((LONGEST_S / tick_s) as u64);
        let mut shown = Shown::NOTHING;
        let (mut forces, mut smooth) = (Vec::new(), 0.0);
        for k in 0..ticks {
            let mut input = TickInput::IDLE;
            input.tools = operator.step(&shown);
            (case.disturb)(k, &mut input);
            let output = tick(&scene, &mut state, &mut ws, &input, &mut NoProbe);
            shown = Shown::from(&output);
            let force: f64 = output.tools.iter().map(|t| norm(&t.raw_wrench.force)).sum();
            smooth += (force - smooth) * tick_s / SMOOTH_S;
            forces.push(smooth);
        }
        let most = forces.iter().copied().fold(0.0, f64::max);
        let first = |least: f64| {
            let at = forces.iter().position(|&force| force >= least).unwrap_or(0);
            at as f64 * tick_s
        };
        Self {
            hardest_s: first(most),
            working_s: first(WORKING_N.min(0.5 * most)),
            light_s: first(LIGHT_N.min(0.25 * most)),
            most_n: most,
        }
    }

    /// The moment of index `k` modulo three: hardest, working, light.
    pub fn nth(&self, k: u32) -> f64 {
        [self.hardest_s, self.working_s, self.light_s][k as usize % 3]
    }
}

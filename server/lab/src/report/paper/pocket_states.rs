//! What bears load while a probe goes down a pocket, and how much.

use super::contact::Seen;

/// What a probe touches.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum State {
    Nothing,
    /// Gingiva alone (the paper's a).
    Gingiva,
    /// Tooth alone.
    Tooth,
    /// Tooth and gingiva (b).
    Both,
    /// The same while the hand turns (c).
    BothTurned,
    /// The pocket's floor bears more than on the way (d).
    Floor,
}

/// Force on the floor along the tooth's axis from which the floor is what bears, newtons.
const ON_FLOOR: f64 = 0.05;

impl State {
    const COUNT: usize = 6;
    /// Those with contact, in the order of an insertion.
    pub(super) const TOUCHING: [State; 5] = [
        State::Gingiva,
        State::Tooth,
        State::Both,
        State::BothTurned,
        State::Floor,
    ];

    /// For people.
    pub(super) fn name(self) -> &'static str {
        match self {
            State::Nothing => "nothing",
            State::Gingiva => "gingiva alone",
            State::Tooth => "tooth alone",
            State::Both => "both",
            State::BothTurned => "both, turned",
            State::Floor => "floor",
        }
    }
}

/// The state of a tick.
pub(super) fn state_of(seen: &Seen, turned: bool) -> State {
    let floor = seen.out.tools[0]
        .pocket
        .is_some_and(|reading| reading.floor_force > ON_FLOOR);
    let bears = |rigid: bool| {
        seen.ws.contacts().any(|(contact, load)| {
            let object = &seen.scene.objects[usize::from(contact.object)];
            load > 1e-4 && object.tissue.is_rigid() == rigid
        })
    };
    match (bears(true), bears(false)) {
        _ if floor => State::Floor,
        (true, true) if turned => State::BothTurned,
        (true, true) => State::Both,
        (true, false) => State::Tooth,
        (false, true) => State::Gingiva,
        (false, false) => State::Nothing,
    }
}

/// Forces by state.
#[derive(Default)]
pub(super) struct Tally {
    /// Ticks, largest force along the probe and across it.
    states: [(usize, f64, f64); State::COUNT],
    last: Option<State>,
    /// How often the state was another than in the tick before.
    pub(super) switches: usize,
    /// Deepest reading, metres.
    pub(super) deepest: f64,
}

impl Tally {
    pub(super) fn add(&mut self, state: State, axial: f64, lateral: f64, depth: f64) {
        let (ticks, along, across) = &mut self.states[state as usize];
        *ticks += 1;
        *along = along.max(axial.abs());
        *across = across.max(lateral);
        self.switches += usize::from(self.last.is_some_and(|last| last != state));
        self.last = Some(state);
        self.deepest = self.deepest.max(depth);
    }

    /// Ticks in a state.
    pub(super) fn ticks(&self, state: State) -> usize {
        self.states[state as usize].0
    }

    /// Largest force along the probe in a state, newtons.
    pub(super) fn most_axial(&self, state: State) -> f64 {
        self.states[state as usize].1
    }

    /// Largest forces in a state, for people.
    pub(super) fn describe(&self, state: State) -> String {
        let (ticks, along, across) = self.states[state as usize];
        if ticks == 0 {
            return format!("{}: does not occur", state.name());
        }
        format!("{}: {along:.2} N along, {across:.2} N across", state.name())
    }
}

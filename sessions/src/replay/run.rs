//! State of a replay.

use sulcus_core::{NoProbe, Scene, State, TickOutput, Workspace, tick};

use super::audit::{AuditReport, audit_tick};
use super::deviation::{Deviating, Deviation};
use super::error::ReplayError;
use super::report::{Difference, Divergence};
use super::stretch::{Stretch, Stretches};
use crate::record::row::Row;
use crate::record::signature::Signed;

/// Ticks between two reports of progress.
pub(super) const REPORT_EVERY: u64 = 500;

pub(super) struct Run<'a> {
    scene: &'a Scene,
    workspace: Workspace,
    state: State,
    started: bool,
    /// Whether the last message was before a gap.
    at_gap: bool,
    stretches: Stretches,
    /// Whether the replay continues from a recorded snapshot that differs.
    led_back: bool,
    pub ticks: u64,
    /// Ticks run and ticks skipped.
    pub simulated_ticks: u64,
    pub first: Option<(u64, Divergence)>,
    deviating: Deviating,
    pub audit: Option<AuditReport>,
}

impl<'a> Run<'a> {
    pub fn new(scene: &'a Scene, audit: bool, led_back: bool) -> Self {
        Self {
            led_back,
            scene,
            workspace: Workspace::new(scene),
            state: State::new(scene),
            started: false,
            at_gap: false,
            stretches: Stretches::default(),
            ticks: 0,
            simulated_ticks: 0,
            first: None,
            deviating: Deviating::default(),
            audit: audit.then(AuditReport::default),
        }
    }

    pub fn workspace(&self) -> &Workspace {
        &self.workspace
    }

    pub fn deviation(&mut self) -> Deviation {
        std::mem::take(&mut self.deviating).done()
    }

    /// Notes a gap. The next message may begin another stretch.
    pub fn gap(&mut self) {
        self.at_gap = true;
    }

    /// Stretches between the gaps.
    pub fn stretches(&mut self, signed: &[Signed]) -> Vec<Stretch> {
        std::mem::take(&mut self.stretches).done(signed)
    }

    /// Begins another stretch. Its state is unknown until the next snapshot.
    fn next_stretch(&mut self) {
        self.stretches.next();
        self.started = false;
    }

    /// Runs a row; `None` if the state is unknown, behind a gap and before the next snapshot.
    pub fn row(&mut self, row: &Row) -> Option<TickOutput> {
        let ticks = 1 + u64::from(row.input.skipped);
        if std::mem::take(&mut self.at_gap)
            && !(self.started && self.state.tick.checked_add(ticks) == Some(row.tick))
        {
            self.next_stretch();
        }
        self.stretches.row(row, self.started);
        self.started.then(|| self.run(row))
    }

    fn run(&mut self, row: &Row) -> TickOutput {
        let output = tick(
            self.scene,
            &mut self.state,
            &mut self.workspace,
            &row.input,
            &mut NoProbe,
        );
        self.ticks += 1;
        self.simulated_ticks += 1 + u64::from(row.input.skipped);
        let again = Row::new(row.time_unix_ns, &row.input, &output);
        self.deviating.row(row, &again);
        let what = if again.tick != row.tick {
            Some(Difference::Tick)
        } else if again.hash != row.hash {
            Some(Difference::Hash)
        } else if again.to_bytes() != row.to_bytes() {
            Some(Difference::Output)
        } else {
            None
        };
        if let Some(what) = what {
            self.differs(row.tick, what, row.hash, again.hash);
        }
        if let Some(audit) = &mut self.audit
            && let Some(found) = audit_tick(self.scene, &self.workspace)
        {
            audit.add(row.tick, &found);
        }
        output
    }

    /// Starts from the first snapshot and compares every other one. After a difference the replay continues from the
    /// recorded state, so each stretch differs by itself. A recording of a former version is an exception, because its
    /// grade must rest on the inputs alone.
    pub fn snapshot(&mut self, of: u64, bytes: &[u8]) -> Result<(), ReplayError> {
        if std::mem::take(&mut self.at_gap) && !(self.started && self.state.tick == of) {
            self.next_stretch();
        }
        if self.started && self.state.to_bytes() == bytes {
            return Ok(());
        }
        let recorded = recorded(self.scene, of, bytes);
        if !self.started {
            self.state = recorded.map_err(ReplayError::Snapshot)?;
            self.started = true;
            self.stretches.begins_with(of);
            return Ok(());
        }
        // After a difference of rows the snapshot adds nothing.
        if self.first.is_none() {
            let hash = recorded.as_ref().map_or(0, |state| state.hash);
            self.differs(of, Difference::Snapshot, hash, self.state.hash);
        }
        match recorded {
            Ok(state) => {
                self.deviating.snapshot(&state, &self.state);
                if self.led_back {
                    self.state = state;
                }
            }
            Err(_) => self.deviating.unusable(),
        }
        Ok(())
    }

    fn differs(&mut self, tick: u64, what: Difference, recorded: u64, replayed: u64) {
        self.stretches.differs(tick);
        let (_, divergence) = self.first.get_or_insert_with(|| {
            let divergence = Divergence {
                what,
                hash_recorded: format!("{recorded:016x}"),
                hash_replayed: format!("{replayed:016x}"),
                ticks: 0,
            };
            (tick, divergence)
        });
        divergence.ticks += 1;
    }
}

/// State in a snapshot's bytes, which must be of the snapshot's tick.
pub(super) fn recorded(scene: &Scene, of: u64, bytes: &[u8]) -> Result<State, String> {
    let state = State::from_bytes(scene, bytes).map_err(|error| error.to_string())?;
    match state.tick {
        tick if tick == of => Ok(state),
        tick => Err(format!(
            "the snapshot is of tick {of}, its state of tick {tick}"
        )),
    }
}

//! What ticks cost: thread CPU time beside wall time, whole and by stage, over inputs that were recorded before, so that
//! nothing but the tick runs between two looks at the clock.

use std::time::Instant;

use sulcus_core::{
    NoProbe, Scene, Stage, StageProbe, State, TickInput, TickOutput, Workspace, tick,
};

/// CPU time of this thread, nanoseconds.
#[cfg(unix)]
pub fn cpu_ns() -> u64 {
    use rustix::time::{ClockId, clock_gettime};
    let now = clock_gettime(ClockId::ThreadCPUTime);
    now.tv_sec as u64 * 1_000_000_000 + now.tv_nsec as u64
}

/// Monotonic time, nanoseconds, in place of the CPU time of this thread. A busy machine makes it larger.
#[cfg(not(unix))]
pub fn cpu_ns() -> u64 {
    static BEGAN: std::sync::OnceLock<Instant> = std::sync::OnceLock::new();
    BEGAN.get_or_init(Instant::now).elapsed().as_nanos() as u64
}

/// Times of the ticks of one run, nanoseconds, tick by tick.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Run {
    /// CPU time of the thread.
    pub cpu: Vec<u64>,
    /// Time on the wall: what a shared machine takes away included.
    pub wall: Vec<u64>,
}

/// Runs `scene` under `inputs` from its beginning and times every tick; `each` sees every output, outside of what is timed.
pub fn time(scene: &Scene, inputs: &[TickInput], mut each: impl FnMut(usize, &TickOutput)) -> Run {
    let (mut state, mut ws) = (State::new(scene), Workspace::new(scene));
    let mut run = Run {
        cpu: Vec::with_capacity(inputs.len()),
        wall: Vec::with_capacity(inputs.len()),
    };
    for (k, input) in inputs.iter().enumerate() {
        let (wall, cpu) = (Instant::now(), cpu_ns());
        let output = tick(scene, &mut state, &mut ws, input, &mut NoProbe);
        run.cpu.push(cpu_ns() - cpu);
        run.wall.push(wall.elapsed().as_nanos() as u64);
        each(k, &output);
    }
    run
}

/// CPU time of every stage in every tick, nanoseconds, by [`Stage::ALL`]; each with the clock's own 0.2 us or so.
pub fn time_stages(scene: &Scene, inputs: &[TickInput]) -> [Vec<u64>; Stage::ALL.len()] {
    let (mut state, mut ws) = (State::new(scene), Workspace::new(scene));
    let mut stages: [Vec<u64>; Stage::ALL.len()] =
        std::array::from_fn(|_| Vec::with_capacity(inputs.len()));
    for input in inputs {
        let mut probe = Stages::default();
        tick(scene, &mut state, &mut ws, input, &mut probe);
        for (times, sum) in stages.iter_mut().zip(probe.sums) {
            times.push(sum);
        }
    }
    stages
}

/// Takes into `fastest` what of `run` was faster: over several runs of the same inputs that leaves out what other processes
/// do to a shared machine's caches, and nothing of the tick's own.
pub fn keep_fastest(fastest: &mut Vec<u64>, run: &[u64]) {
    if fastest.is_empty() {
        fastest.extend_from_slice(run);
    }
    for (least, time) in fastest.iter_mut().zip(run) {
        *least = (*least).min(*time);
    }
}

/// Sums of the stages of one tick.
#[derive(Default)]
struct Stages {
    current: Option<(Stage, u64)>,
    sums: [u64; Stage::ALL.len()],
}

impl StageProbe for Stages {
    fn begin(&mut self, stage: Stage) {
        self.end();
        self.current = Some((stage, cpu_ns()));
    }
    fn end(&mut self) {
        if let Some((stage, since)) = self.current.take() {
            self.sums[stage as usize] += cpu_ns() - since;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scenes;

    #[test]
    fn every_tick_is_timed_and_its_stages_are_most_of_it() {
        let scene = scenes::scene("plate", vec![scenes::thin_plate()]);
        let mut inputs = vec![TickInput::IDLE; 300];
        for input in &mut inputs {
            let over = scenes::device_over(sulcus_core::Vec3::new(0.0, 0.0, -1e-3));
            let pose = sulcus_core::Pose::new(over, sulcus_core::Quat::identity());
            input.tools[0] = sulcus_operator::present(&pose);
        }
        let mut last = 0;
        let run = time(&scene, &inputs, |_, out| last = out.tick);
        let stages = time_stages(&scene, &inputs);
        assert_eq!((run.cpu.len(), run.wall.len(), last), (300, 300, 300));
        let whole: u64 = run.cpu.iter().sum();
        let parts: u64 = stages.iter().flatten().sum();
        assert!(whole > 0 && parts > whole / 10, "{parts} of {whole} ns");
        assert!(stages.iter().all(|times| times.len() == 300));
    }

    #[test]
    fn the_fastest_of_several_runs_is_kept() {
        let mut fastest = Vec::new();
        keep_fastest(&mut fastest, &[3, 5]);
        keep_fastest(&mut fastest, &[4, 2]);
        assert_eq!(fastest, [3, 2]);
    }
}

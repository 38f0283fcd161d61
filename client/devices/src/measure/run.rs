//! Loop of a measurement, by the clock of the machine.

use std::sync::mpsc::{Receiver, Sender, channel};
use std::time::Duration;

use sulcus_haptics::device::Stop;
use sulcus_haptics::{HandEnd, Wanted};
use sulcus_link::clock::{monotonic_ns, sleep_until};
use sulcus_link::schedule::{exact_timers, fifo};

use super::machine::Measurement;
use super::plan::LOOP_NS;
use super::prompt::{Answer, Ask, Progress, Prompt};
use super::report::Measured;

/// SCHED_FIFO priority of the loop, below that of a device's thread.
const PRIORITY: i32 = 45;
/// Number of steps between two reports of the progress.
const TOLD_EVERY: u64 = 100;
/// Number of orders without force at the end.
const LEAVING: u32 = 50;

/// Message of the loop to the person's thread.
enum Told {
    Prompt(Prompt),
    Progress(Progress),
}

/// Message of the person's thread to the loop.
enum Said {
    Answer(Answer),
    Press,
}

/// Measures the device behind `end`. The loop has a thread of its own; prompts and progress come on the calling thread.
/// A request of `stop` ends the measurement within a period, and the force falls to zero.
///
/// The device must run already, with the door of [`super::Plan::rules`].
pub fn run(
    end: &mut HandEnd,
    measurement: Measurement,
    ask: &mut dyn Ask,
    progress: &mut dyn FnMut(&Progress),
    stop: &Stop,
) -> Measured {
    let (tell, told) = channel();
    let (say, said) = channel();
    let unmeasured = measurement.report().clone();
    std::thread::scope(|scope| {
        let stop = stop.clone();
        let pacing = scope.spawn(move || paced(end, measurement, &tell, &said, &stop));
        attend(&told, &say, ask, progress);
        pacing.join().unwrap_or(unmeasured)
    })
}

/// Performs the steps of a measurement.
fn paced(
    end: &mut HandEnd,
    mut measurement: Measurement,
    tell: &Sender<Told>,
    said: &Receiver<Said>,
    stop: &Stop,
) -> Measured {
    exact_timers();
    if let Err(error) = fifo(PRIORITY) {
        tracing::debug!("no real-time scheduling for the measurement: {error}");
    }
    let (mut next_ns, mut steps, mut prompt) = (monotonic_ns(), 0_u64, None);
    loop {
        sleep_until(next_ns);
        let now_ns = monotonic_ns();
        // After a delay the loop goes on from now, without a series of steps.
        next_ns = (next_ns + LOOP_NS).max(now_ns);
        while let Ok(said) = said.try_recv() {
            match said {
                Said::Answer(answer) => measurement.answer(answer),
                Said::Press => measurement.press(),
            }
        }
        if stop.is_asked() {
            measurement.answer(Answer::Stop);
        }
        let order = measurement.step(now_ns, &end.sample());
        end.order(&order.wanted);
        if order.is_done {
            break;
        }
        // A send fails without a receiver only: the person's thread has ended, and the loop ends by its counts.
        if order.prompt != prompt {
            prompt.clone_from(&order.prompt);
            if let Some(prompt) = order.prompt {
                let _ = tell.send(Told::Prompt(prompt));
            }
        }
        if steps.is_multiple_of(TOLD_EVERY) {
            let _ = tell.send(Told::Progress(order.progress));
        }
        steps += 1;
    }
    leave(end, next_ns);
    measurement.report().clone()
}

/// Orders no force until the device has surely none.
fn leave(end: &mut HandEnd, mut next_ns: u64) {
    for _ in 0..LEAVING {
        sleep_until(next_ns);
        next_ns += LOOP_NS;
        end.order(&Wanted {
            heard_ns: Some(monotonic_ns()),
            leaving: true,
            ..Wanted::NOTHING
        });
    }
}

/// Shows prompts and progress until the loop ends.
fn attend(
    told: &Receiver<Told>,
    say: &Sender<Said>,
    ask: &mut dyn Ask,
    progress: &mut dyn FnMut(&Progress),
) {
    use std::sync::mpsc::RecvTimeoutError::Disconnected;
    loop {
        let said = match told.recv_timeout(Duration::from_millis(20)) {
            Ok(Told::Prompt(prompt)) if prompt.needs_answer() => {
                Some(Said::Answer(ask.ask(&prompt)))
            }
            Ok(Told::Prompt(prompt)) => {
                ask.tell(&prompt);
                None
            }
            Ok(Told::Progress(of)) => {
                progress(&of);
                None
            }
            Err(Disconnected) => return,
            Err(_) => None,
        };
        let pressed = ask.pressed().then_some(Said::Press);
        for said in said.into_iter().chain(pressed) {
            // A send fails after the end of the loop only.
            let _ = say.send(said);
        }
    }
}

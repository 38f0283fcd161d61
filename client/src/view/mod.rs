//! `--view`: a window beside a session.
//!
//! The window has the main thread, the session a thread of its own. They exchange the newest state and the acts of the
//! person without waiting. A window that cannot open, or that is closed, ends nothing: the exercise and its force go
//! on. After the session the window stays and shows its end.

mod live;
mod on_screen;
mod outcome;
mod player;
mod programs;
mod pupil;
mod replay;
mod settings;
mod staying;
mod voice;
mod watched;

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{SyncSender, channel, sync_channel};

use anyhow::anyhow;
use sulcus_connection::device::EventDevice;
use sulcus_connection::link::LinkConfig;
use sulcus_demo::seat::{Begun, Ending, Screen, Seat};
use sulcus_program::{output, tell};
use sulcus_screen::error::ScreenError;
use sulcus_screen::hand::Shared;
use sulcus_screen::handed::Person;
use sulcus_screen::show::Show;
use sulcus_screen::window::{self, Report, Settings};

use crate::cli::ViewArgs;
use live::Live;
use on_screen::OnScreen;
use outcome::Outcome;
use player::Player;
use pupil::Pupil;
use settings::{named, settings};
use staying::Staying;
use voice::Voice;
use watched::{Eyes, Watched};

/// Facts of a session that its window needs.
pub(crate) struct Facts {
    config: LinkConfig,
    mode: String,
    device: String,
    title: String,
    task: String,
    length_s: Option<f64>,
    /// Least and largest force of a reading, newtons; `None` without probing.
    zone_n: Option<[f64; 2]>,
    /// Names of the tools.
    tools: Vec<String>,
    /// Sites to be read: FDI number and name of the site.
    tour: Vec<(u8, &'static str)>,
    tick_ns: u64,
}

impl Facts {
    fn of(begun: &Begun<'_>, device: &dyn EventDevice) -> Self {
        let exercise = begun.exercise;
        let sites = |zones: &sulcus_sessions::exercise::Zones| {
            let tooth = zones.tooth;
            let named = zones.sites.iter().map(move |site| (tooth, site.name()));
            named.collect::<Vec<_>>()
        };
        let limit = begun.hello.plan.time_limit_s;
        Self {
            config: begun.config.clone(),
            mode: begun.hello.plan.mode.clone(),
            device: device.name().to_owned(),
            title: exercise.name.clone(),
            task: exercise.task.clone(),
            length_s: (limit > 0).then_some(f64::from(limit)),
            zone_n: (!exercise.zones.is_empty()).then_some(exercise.probing.force_n),
            tools: begun
                .hello
                .tools
                .iter()
                .map(|tool| tool.name.clone())
                .collect(),
            tour: exercise.zones.iter().flat_map(sites).collect(),
            tick_ns: begun.hello.tick_ns,
        }
    }
}

/// Runs `session` on a thread of its own, with a window on this thread, which must be the main thread. `finish` reports
/// the result of the session and returns the exit code, on the session's thread.
///
/// After a loss of the display's server this function does not return: the process ends with the session.
///
/// # Errors
/// A name of `args` is unknown, or the session's thread cannot start or panics.
pub fn beside(
    args: &ViewArgs,
    session: impl FnOnce(Seat<'_>) -> anyhow::Result<u8> + Send,
    finish: impl FnOnce(anyhow::Result<u8>) -> u8 + Send,
) -> anyhow::Result<u8> {
    let settings = settings(args)?;
    let person = Person {
        hand: settings.hand,
        rest: named("--finger-rest", &args.finger_rest)?,
    };
    let (seat_in, seated) = sync_channel::<Seated>(1);
    let (pages_in, pages) = channel();
    let stays = !args.close_at_end;
    let closed = Arc::new(AtomicBool::new(false));
    let over = Arc::new(AtomicBool::new(false));
    let outcome = Arc::new(Outcome::default());
    std::thread::scope(|scope| {
        let (ended, window_closed) = (over.clone(), closed.clone());
        let ending = Outcome::ending(&outcome);
        let thread = std::thread::Builder::new()
            .name("sulcus-session".into())
            .spawn_scoped(scope, move || {
                let closed = args.mouse.then_some(window_closed);
                let take = |begun: &Begun<'_>, device: Box<dyn EventDevice>| {
                    take(begun, device, closed.clone(), &seat_in)
                };
                let end = |ending: &Ending<'_>| {
                    if stays {
                        staying::send(ending, &pages_in);
                    }
                };
                let screen = Screen {
                    device: args.mouse.then_some(on_screen::NAME),
                    take: &take,
                    ended: &end,
                };
                // A panic ends the session, too.
                let over = Flag(ended);
                let code = finish(session(Some(screen)));
                ending.set(code);
                drop(over);
                drop(seat_in);
                code
            })?;
        let mut is_refused = false;
        // A session that never begins drops its end.
        if let Ok(seated) = seated.recv() {
            let is_lesson = seated.facts.title == sulcus_demo::lesson::NAME;
            outlive(args.mouse, outcome, closed.clone(), over.clone());
            let helpers = Helpers {
                voice: helper("--speak", args.speak, Voice::begin),
                player: helper("--sound", args.sound, Player::begin),
            };
            match Live::new(seated, person, helpers, over.clone(), args.stats) {
                Ok(live) => {
                    let ends = args.mouse.then(|| closed.clone());
                    let show: Box<dyn Show> = match stays {
                        _ if is_lesson => Box::new(Pupil::new(live)),
                        true => Box::new(Staying::new(live, pages, over.clone(), ends)),
                        false => Box::new(live),
                    };
                    let ended = in_a_window(show, settings);
                    is_refused = report(args, ended.map_err(|error| error.to_string()), &over);
                }
                Err(error) => is_refused = report(args, Err(error.to_string()), &over),
            }
        }
        // A person without a window holds no tool.
        closed.store(true, Ordering::Release);
        let code = thread
            .join()
            .map_err(|_| anyhow!("the thread of the session panicked"))?;
        Ok(if is_refused { code.max(NO_HAND) } else { code })
    })
}

/// Exit code of a session whose person lost the window, or had none.
const NO_HAND: u8 = 1;

/// Flag that is set when this value is dropped.
struct Flag(Arc<AtomicBool>);

impl Drop for Flag {
    fn drop(&mut self) {
        self.0.store(true, Ordering::Release);
    }
}

/// Programs of the system beside a window.
pub(crate) struct Helpers {
    voice: Option<Voice>,
    player: Option<Player>,
}

/// Helper that an option asks for. Without its program one sentence is told.
fn helper<T>(option: &str, asked: bool, begin: fn() -> Result<T, String>) -> Option<T> {
    let begun = asked.then(begin)?;
    begun
        .inspect_err(|why| tell!("warning: {option}: {why}"))
        .ok()
}

/// Keeps the session alive after a loss of the display's server, whose library would end the process.
fn outlive(mouse: bool, outcome: Arc<Outcome>, closed: Arc<AtomicBool>, over: Arc<AtomicBool>) {
    window::on_loss(move || {
        let goes_on = !over.load(Ordering::Acquire);
        if !goes_on {
        } else if mouse {
            tell!(
                "error: the display was lost. The session ends, because the mouse needs a window"
            );
        } else {
            tell!("warning: the display was lost. The exercise goes on without pictures");
        }
        // A person without a window holds no tool.
        closed.store(true, Ordering::Release);
        let code = outcome.wait();
        let code = if mouse && goes_on {
            code.max(NO_HAND)
        } else {
            code
        };
        std::process::exit(i32::from(output::settled(code)));
    });
}

/// Runs the window. A window that panics is an error: the library of the display does so when its server is gone.
fn in_a_window(show: Box<dyn Show>, settings: Settings) -> Result<Report, ScreenError> {
    let run = || window::run(show, settings);
    let ran = std::panic::catch_unwind(std::panic::AssertUnwindSafe(run));
    ran.unwrap_or_else(|_| Err(ScreenError::NoDisplay("the window failed".into())))
}

/// Session that has begun, for its window.
pub(crate) struct Seated {
    facts: Facts,
    eyes: Eyes,
    hands: Option<Arc<Shared>>,
}

/// Puts a device behind a window's eyes. With `closed` the person at the window takes the place of `device`.
fn take(
    begun: &Begun<'_>,
    device: Box<dyn EventDevice>,
    closed: Option<Arc<AtomicBool>>,
    to: &SyncSender<Seated>,
) -> Box<dyn EventDevice> {
    let (device, hands): (Box<dyn EventDevice>, _) = match closed {
        None => (device, None),
        Some(closed) => {
            let zones = &begun.exercise.zones;
            let force_n = (!zones.is_empty()).then_some(begun.exercise.probing.force_n[1]);
            let (device, hands) = OnScreen::new(begun.hello, force_n, closed);
            (Box::new(device), Some(hands))
        }
    };
    let facts = Facts::of(begun, &*device);
    let (watched, eyes) = Watched::new(device);
    // Refused after the first session of a process: the window belongs to that one.
    let _ = to.try_send(Seated { facts, eyes, hands });
    Box::new(watched)
}

/// Tells how the window ended. Returns whether a person was to hold the tools and had no window.
fn report(args: &ViewArgs, ended: Result<Report, String>, over: &AtomicBool) -> bool {
    let goes_on = !over.load(Ordering::Acquire);
    let has_failed = match &ended {
        Err(_) => true,
        Ok(report) => report.failed.is_some(),
    };
    match ended {
        Err(error) if args.mouse => {
            tell!("error: no window: {error}. The session ends, because the mouse needs one")
        }
        Err(error) => tell!("warning: no window: {error}. The exercise goes on without pictures"),
        Ok(report) => {
            if let Some(why) = &report.failed {
                let then = if args.mouse {
                    "The session ends, because the mouse needs a window"
                } else {
                    "The exercise goes on without pictures"
                };
                tell!("warning: the window has ended: {why}. {then}");
            } else if goes_on && !args.mouse {
                tell!("the window was closed; the exercise goes on");
            }
            if args.stats {
                let (age, cost) = (report.times.age(), report.times.cost());
                tell!(
                    "window        {} frames by {}, quality {} at the end",
                    report.times.frames,
                    report.adapter,
                    report.quality.name()
                );
                tell!(
                    "frame age     p50 {:.1}  p99 {:.1}  max {:.1} ms, from the state to its picture",
                    age.p50,
                    age.p99,
                    age.max
                );
                tell!(
                    "frame time    p50 {:.1}  p99 {:.1}  max {:.1} ms",
                    cost.p50,
                    cost.p99,
                    cost.max
                );
            }
        }
    }
    args.mouse && goes_on && has_failed
}

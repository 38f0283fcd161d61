//! `devices measure`: measures a device and writes its model file.

use std::io::{BufRead, Write};

use anyhow::{Context, bail};
use serde_json::json;
use sulcus_connection::interrupt;
use sulcus_devices::measure::{
    Answer, Ask, Measured, Measurement, Outcome, Part, Plan, Progress, Prompt, run as measure,
};
use sulcus_haptics::device::Stop;
use sulcus_haptics::port;
use sulcus_program::{PathText, say, tell};

use super::{opened, stored};
use crate::cli::MeasureArgs;

/// Person at the terminal.
struct Terminal;

impl Terminal {
    /// A line of the input; `None` at its end.
    fn line() -> Option<String> {
        let mut line = String::new();
        let read = std::io::stdin().lock().read_line(&mut line).ok()?;
        (read > 0).then(|| line.trim().to_lowercase())
    }
}

impl Ask for Terminal {
    fn tell(&mut self, prompt: &Prompt) {
        tell!("{prompt}");
    }

    fn ask(&mut self, prompt: &Prompt) -> Answer {
        let keys = if prompt.needs_grams() {
            "[number, s to skip, q to end]"
        } else {
            "[Return, s to skip, q to end]"
        };
        tell!("{prompt} {keys}");
        loop {
            match Self::line().as_deref() {
                None | Some("q") => return Answer::Stop,
                Some("s") => return Answer::Skip,
                Some("") if !prompt.needs_grams() => return Answer::Ready,
                Some(text) if prompt.needs_grams() => match text.replace(',', ".").parse() {
                    Ok(grams) => return Answer::Grams(grams),
                    Err(_) => tell!("`{text}` is no number of grams {keys}"),
                },
                Some(text) => tell!("`{text}` is no answer {keys}"),
            }
        }
    }
}

/// Measures a device.
///
/// # Errors
/// The device cannot be opened, a measured figure is out of the range of a model, or a file cannot be written.
pub fn run(args: &MeasureArgs) -> anyhow::Result<u8> {
    let (mut settings, file) = stored()?;
    let (mut device, hand) = opened::alone(&args.device, &settings)?;
    let mut plan = Plan::new(&hand.info, &hand.model);
    if args.no_scale {
        plan.parts.retain(|part| *part != Part::Scale);
    }
    let (port, mut end) = port::door(plan.rules());
    let stop = Stop::new();
    let measured = std::thread::scope(|scope| {
        let serve = || {
            if let Err(error) = device.run(vec![port], &stop) {
                tell!("error: {error}");
            }
        };
        scope.spawn(serve);
        let mut told = None;
        let interrupted = Stop::new();
        let mut progress = |now: &Progress| {
            if interrupt::asked() {
                interrupted.ask();
            }
            let part = now.part.map(|part| (part, now.finished));
            if part != told {
                told = part;
                if let Some((part, finished)) = part {
                    tell!("{} of {}: {}", finished + 1, now.all, part.name());
                }
            }
        };
        let measured = measure(
            &mut end,
            Measurement::new(plan),
            &mut Terminal,
            &mut progress,
            &interrupted,
        );
        stop.ask();
        measured
    });
    if interrupt::asked() {
        bail!("the measurement was interrupted; no file was written");
    }
    let model = measured.model(&hand.model)?;
    let mut out = std::fs::File::create(&args.out)
        .with_context(|| format!("{}: cannot write", args.out.shown()))?;
    out.write_all(model.to_toml()?.as_bytes())
        .with_context(|| format!("{}: cannot write", args.out.shown()))?;
    print(&measured);
    say!("model written to {}", args.out.shown());
    if args.store {
        let mut device = settings.of(hand.info.library, &hand.info.serial);
        device.model = Some(std::path::absolute(&args.out)?);
        settings.store(device);
        settings
            .write(&file.context("no folder for the settings: set SULCUS_STATE_DIR or HOME")?)?;
    }
    if args.json {
        say!("{}", json!({ "measured": measured, "model": model }));
    }
    Ok(0)
}

/// Prints the report for a person.
fn print(measured: &Measured) {
    let line = |name: &str, text: Result<String, String>| match text {
        Ok(text) => say!("{name:<22} {text}"),
        Err(why) => say!("{name:<22} not measured: {why}"),
    };
    say!("{} {} {}", measured.library, measured.name, measured.serial);
    line(
        "rate",
        of(&measured.rate, |rate| {
            format!(
                "{:.0} Hz, intervals p50 {:.0}, p99 {:.0}, longest {:.0} us",
                rate.rate_hz, rate.interval_p50_us, rate.interval_p99_us, rate.interval_most_us
            )
        }),
    );
    line(
        "smallest step",
        of(&measured.resolution_mm, |step| {
            format!("{:.4} mm", step.value)
        }),
    );
    line(
        "friction",
        of(&measured.friction, |friction| {
            let of = friction.friction_n;
            format!("{:.3} N, spread {:.3} N", of.value, of.spread)
        }),
    );
    line(
        "latency",
        of(&measured.steps, |steps| {
            let of = steps.latency_ms;
            format!("{:.2} ms, p99 {:.2} ms", of.value, steps.latency_p99_ms)
        }),
    );
    line(
        "apparent mass",
        of(&measured.steps, |steps| {
            format!("{:.0} g", steps.mass_g.value)
        }),
    );
    for (name, grip) in [
        ("stiffness, light grip", &measured.light_grip),
        ("stiffness, firm grip", &measured.firm_grip),
    ] {
        line(
            name,
            of(grip, |stiffness| {
                let unstable = stiffness.unstable_n_per_mm;
                let first = unstable.map_or_else(
                    || "the ramp ended stable".into(),
                    |k| format!("unstable from {k:.2} N/mm"),
                );
                format!("{:.2} N/mm, {first}", stiffness.stable_n_per_mm)
            }),
        );
    }
    line(
        "force on a scale",
        of(&measured.scale, |points| {
            let point = |p: &sulcus_devices::measure::ScalePoint| {
                format!("{:.2} N asked, {:.2} N found", p.asked_n, p.found_n)
            };
            points.iter().map(point).collect::<Vec<_>>().join("; ")
        }),
    );
}

/// Text of a result, or the reason why there is none.
fn of<T>(outcome: &Outcome<T>, text: impl Fn(&T) -> String) -> Result<String, String> {
    match outcome {
        Outcome::Measured(value) => Ok(text(value)),
        Outcome::NotMeasured(why) => Err(why.clone()),
    }
}

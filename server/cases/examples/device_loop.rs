//! Closed loop with the dynamics of real devices: limit cycles of a hand at rest, and the coupling at which a buzz
//! begins.

use std::sync::Mutex;

use clap::Parser;
use sulcus_cases::device_loop::onset::onset;
use sulcus_cases::device_loop::sweep::corners;
use sulcus_cases::device_loop::{Looped, Rests, devices};
use sulcus_cases::{Case, TABLE, find};

/// Run all corners of the figures of each device in hard cases, or search the coupling at which a buzz begins
#[derive(Parser)]
struct Arguments {
    /// Names of hard cases. All cases without a name
    #[arg(value_name = "CASE", value_parser = known)]
    cases: Vec<&'static Case>,
    /// Search the coupling at which a buzz begins
    #[arg(long)]
    onset: bool,
}

/// Returns the hard case of that name.
fn known(name: &str) -> Result<&'static Case, String> {
    find(name).ok_or_else(|| format!("no hard case is called `{name}`"))
}

fn main() {
    let Arguments { cases, onset } = Arguments::parse();
    let chosen = |case: &Case| cases.is_empty() || cases.iter().any(|one| one.name == case.name);
    let all = TABLE.iter().enumerate().filter(|(_, case)| chosen(case));
    let next = Mutex::new(all);
    let take = || next.lock().ok().and_then(|mut all| all.next());
    std::thread::scope(|scope| {
        for _ in 0..2 {
            scope.spawn(|| {
                while let Some((number, case)) = take() {
                    let text = if onset {
                        onsets(case)
                    } else {
                        swept(case, number as u32)
                    };
                    println!("{text}");
                }
            });
        }
    });
}

fn onsets(case: &Case) -> String {
    let line = |model: &sulcus_haptics::DeviceModel| {
        let found = onset(case, model, false);
        let door = onset(case, model, true);
        format!(
            "{:24} {:18} chosen {:5.0} N/m {:5.3} N m/rad, force {:.2} N, buzz {:.4} N; begins {}, {:.0} N/m, {:.0} Hz, {:.3} N; with the controller {}, {:.0} Hz, {:.3} N of {:.2} N",
            case.name,
            model.name,
            found.chosen.n_per_m,
            found.chosen.nm_per_rad,
            door.chosen.force_n,
            door.chosen.buzz_n,
            found
                .factor
                .map_or("never".to_owned(), |factor| format!("at {factor:.1} times")),
            found.at.n_per_m,
            found.at.hertz,
            found.at.buzz_n,
            door.factor
                .map_or("never".to_owned(), |factor| format!("at {factor:.1} times")),
            door.at.hertz,
            door.at.force_n,
            door.at.sent_n,
        )
    };
    devices().iter().map(line).collect::<Vec<_>>().join("\n")
}

fn swept(case: &Case, number: u32) -> String {
    let rests = Rests::of(case);
    let mut text = String::new();
    for model in &devices() {
        let all = corners(case, number, &rests, model);
        let most =
            |of: fn(&Looped) -> f64| all.iter().map(|one| of(&one.found)).fold(0.0, f64::max);
        let sum = |of: fn(&Looped) -> f64| all.iter().map(|one| of(&one.found)).sum::<f64>();
        let count = |is: fn(&Looped) -> bool| all.iter().filter(|one| is(&one.found)).count();
        text += &format!(
            "{:24} {:18} buzz {:.4} N, swing {:.4} N, energy {:.2} mJ, {} with a force, {:.0} % of it kept, {} tripped, {} of {} swing\n",
            case.name,
            model.name,
            most(|found| found.buzz_n),
            most(|found| found.swing_n),
            most(|found| found.energy) * 1e3,
            count(|found| found.force_n > 0.05),
            100.0 * sum(|found| found.force_n) / sum(|found| found.sent_n).max(1e-9),
            count(|found| !found.live),
            count(|found| found.buzzes()),
            all.len()
        );
        for one in all.iter().filter(|one| one.found.buzzes()) {
            text += &format!("    {}\n", one.said(case));
        }
    }
    text
}

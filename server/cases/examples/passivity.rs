//! Energy of the closed loop of hand, device, link and simulation, by a hand that feels, without and with the passivity
//! controller; then an hour at rest.

use clap::Parser;
use sulcus_cases::linked::{LinkModel, Linked, run_linked};
use sulcus_cases::rest::{HOUR, rest};
use sulcus_cases::{Case, TABLE, find};
use sulcus_haptics::PassivityParams;

/// Round trips, ticks.
const DELAYS: [u32; 4] = [0, 1, 2, 5];

/// Print the energy that every hard case puts out into the hand over links of 0, 1, 2 and 5 ms
#[derive(Parser)]
struct Arguments {
    /// Names of hard cases. All cases without a name
    #[arg(value_name = "CASE", value_parser = known)]
    cases: Vec<&'static Case>,
    /// Share of datagrams that the link loses, each way, 0 to 1
    #[arg(long, value_name = "SHARE", default_value_t = 0.02)]
    loss: f64,
    /// Damping of the device that the controller knows of, N s/m
    #[arg(long, value_name = "DAMPING", default_value_t = 0.0)]
    device: f64,
}

/// Returns the hard case of that name.
fn known(name: &str) -> Result<&'static Case, String> {
    find(name).ok_or_else(|| format!("no hard case is called `{name}`"))
}

fn line(linked: &Linked) -> String {
    format!(
        "{:9.4} {:9.3} {:6.2} {:8.2} {:8.4} {:7.3}{}",
        linked.energy * 1e3,
        linked.taken * 1e3,
        linked.acted * 100.0,
        linked.infidelity() * 100.0,
        linked.force_error,
        linked.shake * 1e3,
        if linked.finite { "" } else { "  NOT FINITE" }
    )
}

fn main() {
    let Arguments {
        cases,
        loss,
        device,
    } = Arguments::parse();
    let with = PassivityParams {
        device_damping: device,
        ..PassivityParams::default()
    };
    println!(
        "{:24} {:>2}   {:>9} {:>9} {:>6} {:>8} {:>8} {:>7}",
        "case", "ms", "out mJ", "taken mJ", "acted%", "error %", "error N", "shake mm"
    );
    let chosen = |name: &str| cases.is_empty() || cases.iter().any(|case| case.name == name);
    for case in TABLE.iter().filter(|case| chosen(case.name)) {
        for delay_ticks in DELAYS {
            let link = LinkModel {
                delay_ticks,
                loss,
                seed: 7,
            };
            for (sign, params) in [('-', PassivityParams::observing()), ('+', with)] {
                let linked = run_linked(case, &link, params);
                println!("{:24} {delay_ticks:2} {sign} {}", case.name, line(&linked));
            }
        }
    }
    println!("an hour at rest, hand without tremor:");
    for name in ["hour-rest", "pocket-rest", "tongue-rest", "organ-rest"] {
        let case = find(name).expect("in the table");
        if !chosen(name) {
            continue;
        }
        let rest = rest(case, 2.0, HOUR, PassivityParams::default());
        println!("{name:16} {rest:?}");
    }
}

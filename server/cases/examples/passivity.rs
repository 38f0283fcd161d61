//! The energy of the closed loop of hand, device, link and simulation: every case by a hand that feels, over links of 0, 1, 2
//! and 5 ms with 2 % loss, without and with the passivity controller; then the hour at rest. Names on the command line
//! choose among the cases, `--loss 0.1` sets another loss, `--device 4` tells the controller the device's own damping.

use sulcus_cases::linked::{LinkModel, Linked, run_linked};
use sulcus_cases::rest::{HOUR, rest};
use sulcus_cases::{TABLE, find};
use sulcus_haptics::PassivityParams;

/// Round trips, ticks.
const DELAYS: [u32; 4] = [0, 1, 2, 5];

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
    let mut named = Vec::new();
    let (mut loss, mut device) = (0.02, 0.0);
    let mut arguments = std::env::args().skip(1);
    while let Some(argument) = arguments.next() {
        let mut number = || arguments.next().and_then(|text| text.parse().ok());
        match argument.as_str() {
            "--loss" => loss = number().expect("a number after --loss"),
            "--device" => device = number().expect("a number after --device"),
            name => named.push(name.to_owned()),
        }
    }
    let with = PassivityParams {
        device_damping: device,
        ..PassivityParams::default()
    };
    println!(
        "{:24} {:>2}   {:>9} {:>9} {:>6} {:>8} {:>8} {:>7}",
        "case", "ms", "out mJ", "taken mJ", "acted%", "error %", "error N", "shake mm"
    );
    let chosen = |name: &str| named.is_empty() || named.iter().any(|n| n == name);
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

//! Change of the force by the log of the service.

use sulcus_standin_haply::{Fault, IdleCause, Log, What};

use crate::rig::{PEAK_N, SLEW};

/// Force of a message to an arm with its time in ns, or zero at an idle state that is no work of the client.
struct Moment {
    t_ns: u64,
    force: [f64; 3],
    idle: bool,
}

fn moments(log: &Log, arm: &str) -> Vec<Moment> {
    let mut all = Vec::new();
    let mut unplugged = false;
    for entry in &log.entries {
        let t_ns = entry.t_ns;
        match &entry.what {
            What::Fault {
                fault: Fault::Disconnect { .. },
            } => unplugged = true,
            What::Idle { device, cause, .. } if device == arm => all.push(Moment {
                t_ns,
                force: [0.0; 3],
                idle: unplugged || *cause == IdleCause::Watchdog,
            }),
            What::Message { commands, .. } => {
                let forces = commands.iter().filter(|command| command.device == arm);
                let idle = false;
                all.extend(forces.filter_map(|command| {
                    Some(Moment {
                        t_ns,
                        force: command.force?,
                        idle,
                    })
                }));
            }
            _ => {}
        }
    }
    all.sort_by_key(|moment| moment.t_ns);
    all
}

/// Entries of the log within 60 ms of a time, for a person who reads a failure.
fn around(log: &Log, t_ns: u64) -> String {
    let near = log
        .entries
        .iter()
        .filter(|entry| entry.t_ns.abs_diff(t_ns) < 60_000_000);
    let line = |entry: &sulcus_standin_haply::Entry| {
        let ms = (entry.t_ns as f64 - t_ns as f64) * 1e-6;
        format!("\n{ms:+.3} ms {:?}", entry.what)
    };
    near.map(line).collect()
}

/// Judges the forces sent to an arm: none above the limit, and no change above the limit for the time.
///
/// The service may handle a message late and the next one in time. The time of a change is therefore that between a
/// message and the last but one message before it, and 1 ms at least. An idle state is no message: a late message is
/// often handled directly after the watchdog's idle state. `stale` messages after a stall may repeat the force from
/// before it: they were sent before.
pub fn judge_forces(log: &Log, arm: &str, mut stale: usize, what: &dyn std::fmt::Debug) {
    assert!(log.largest_force(arm) <= PEAK_N + 1e-9, "{what:?}");
    let all = moments(log, arm);
    for (i, two) in all.windows(2).enumerate() {
        let [from, to] = two else { continue };
        let Some(before) = all[..i].iter().rev().find(|moment| !moment.idle) else {
            continue;
        };
        let change = (0..3)
            .map(|i| (to.force[i] - from.force[i]).powi(2))
            .sum::<f64>()
            .sqrt();
        let ms = ((to.t_ns - before.t_ns) as f64 * 1e-6).max(1.0);
        if to.idle || change <= 1.01 * SLEW * ms {
            continue;
        }
        // Up to the stale force and down again.
        assert!(
            stale > 0,
            "{what:?}: {change} N in {ms} ms: {:?} {:?}, around: {}",
            from.force,
            to.force,
            around(log, to.t_ns)
        );
        stale -= 1;
    }
    // The first force of all is zero.
    assert_eq!(
        all.first().map(|moment| moment.force),
        Some([0.0; 3]),
        "{what:?}"
    );
}

//! End of a run: zero force for 30 ms, then the end of the connection.

use sulcus_core::Vec3;
use sulcus_standin_haply::{EndReason, Fault, Log, Options, SafetyCause, What};

use crate::capture::panic_on;
use crate::judged::judge_forces;
use crate::rig::Rig;

fn start() -> Rig {
    let rig = Rig::start(
        &Options::pair(),
        &["049D+61576", "04A1+61577"],
        Box::new(|hand, _| {
            if hand == 0 {
                Vec3::new(1.5, 0.0, 0.0)
            } else {
                Vec3::new(0.0, 0.0, -2.0)
            }
        }),
    );
    rig.wait_live();
    rig.sleep(150);
    rig
}

/// Time of the last messages of an arm without force, in ns.
fn zero_at_end(log: &Log, arm: &str) -> u64 {
    let forces = log.forces(arm);
    let last = forces.last().unwrap().t_ns;
    let loud = forces.iter().rposition(|sent| sent.norm() > 0.0).unwrap();
    last - forces[loud + 1].t_ns
}

#[test]
fn a_stop_falls_and_then_sends_zero_for_thirty_milliseconds() {
    let mut rig = start();
    assert_eq!(rig.end(), Ok(()));
    let log = rig.service.log().unwrap();
    for arm in ["049D", "04A1"] {
        let zero_ns = zero_at_end(&log, arm);
        println!("{arm}: zero for {} us", zero_ns / 1000);
        assert!(zero_ns >= 30_000_000, "{zero_ns}");
        assert!(log.largest_force(arm) > 1.4);
        judge_forces(&log, arm, 0, &"stop");
    }
    let ends: Vec<_> = log
        .entries
        .iter()
        .filter_map(|entry| match entry.what {
            What::Ended { reason, .. } => Some(reason),
            _ => None,
        })
        .collect();
    assert_eq!(ends, [EndReason::ClosedByClient]);
    assert_eq!(log.violations(), []);
}

#[test]
fn a_stop_without_a_connection_or_a_reply_ends_soon() {
    for fault in [Fault::DropConnections, Fault::Stall { ms: 300 }] {
        let mut rig = start();
        rig.service
            .fault(Fault::RefuseConnections { on: true })
            .unwrap();
        rig.service.fault(fault).unwrap();
        rig.ask_stop();
        let begin = std::time::Instant::now();
        assert_eq!(rig.end(), Ok(()));
        assert!(
            begin.elapsed() < std::time::Duration::from_secs(2),
            "{:?}",
            begin.elapsed()
        );
    }
}

/// A panic in the thread of the device: zero at once, for 30 ms, and one sentence.
#[test]
fn a_panic_ends_with_zero_force_and_a_sentence() {
    let mut rig = start();
    panic_on("took the force");
    let fault = Fault::Safety {
        device: "049D".into(),
        cause: SafetyCause::StallDetected,
    };
    rig.service.fault(fault).unwrap();
    rig.sleep(500);
    panic_on("");
    let error = rig.end().unwrap_err();
    assert!(error.0.contains("error of its own"), "{error}");
    let log = rig.service.log().unwrap();
    for arm in ["049D", "04A1"] {
        let zero_ns = zero_at_end(&log, arm);
        assert!((30_000_000..200_000_000).contains(&zero_ns), "{zero_ns}");
    }
    assert_eq!(log.violations(), []);
}

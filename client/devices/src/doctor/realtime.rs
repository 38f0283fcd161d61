//! Check of the right to real-time threads.

use std::path::Path;

use super::check::{Check, part};
use super::roots::Roots;

const NAME: &str = "real-time";
/// Highest SCHED_FIFO priority that the threads of a client ask for.
const PRIORITY: i32 = 46;

/// Limit of the priority of real-time threads.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Limit {
    /// Priority that holds now.
    soft: u64,
    /// Priority up to which the user may raise the limit.
    hard: u64,
}

/// Tries the priority on a thread that ends at once. The limit explains a refusal.
#[cfg(target_os = "linux")]
pub fn check(roots: &Roots) -> Check {
    let attempt = std::thread::spawn(|| sulcus_link::schedule::fifo(PRIORITY))
        .join()
        .unwrap_or_else(|_| Err(std::io::Error::other("the thread failed")));
    let limit = limit(&roots.limits).or_else(own_limit);
    judge(attempt.map_err(|error| error.to_string()), limit)
}

/// Other systems give real-time threads in another way, or to every user.
#[cfg(not(target_os = "linux"))]
pub fn check(roots: &Roots) -> Check {
    // The file of the limits exists on Linux alone.
    let _ = limit(&roots.limits);
    Check::elsewhere(NAME)
}

/// Limit as the system call tells it, for a system without `/proc`.
#[cfg(target_os = "linux")]
fn own_limit() -> Option<Limit> {
    use rustix::process::{Resource, getrlimit};
    let limit = getrlimit(Resource::Rtprio);
    Some(Limit {
        soft: limit.current.unwrap_or(u64::MAX),
        hard: limit.maximum.unwrap_or(u64::MAX),
    })
}

/// Limit in a file of the form of `/proc/self/limits`.
fn limit(path: &Path) -> Option<Limit> {
    parse(&String::from_utf8_lossy(&std::fs::read(path).ok()?))
}

fn parse(text: &str) -> Option<Limit> {
    let line = text
        .lines()
        .find_map(|line| line.strip_prefix("Max realtime priority"))?;
    let mut numbers = line.split_whitespace().map(|word| match word {
        "unlimited" => Some(u64::MAX),
        number => number.parse().ok(),
    });
    Some(Limit {
        soft: numbers.next()??,
        hard: numbers.next()??,
    })
}

#[cfg_attr(not(target_os = "linux"), allow(dead_code))]
fn judge(attempt: Result<(), String>, limit: Option<Limit>) -> Check {
    let needed = PRIORITY as u64;
    let reason = match attempt {
        Ok(()) => {
            return Check::fine(
                NAME,
                format!("threads may have SCHED_FIFO at priority {PRIORITY}."),
            );
        }
        Err(reason) => part(&reason),
    };
    match limit {
        Some(limit) if limit.soft >= needed => Check::wrong(
            NAME,
            format!(
                "the limit allows SCHED_FIFO at priority {PRIORITY}, but the system refuses it: {reason}. In a \
                 container add the capability SYS_NICE; else look at cpu.rt_runtime_us of the control group."
            ),
        ),
        Some(limit) if limit.hard >= needed => Check::wrong(
            NAME,
            format!(
                "SCHED_FIFO at priority {PRIORITY} is refused: the limit is {}. Run in the shell before the client: \
                 ulimit -r {PRIORITY}",
                limit.soft
            ),
        ),
        _ => Check::wrong(
            NAME,
            format!(
                "SCHED_FIFO at priority {PRIORITY} is refused, so ticks are late under load. Put this line into \
                 /etc/security/limits.d/70-sulcus.conf: * - rtprio 50 Then log in again; the command ulimit -r prints \
                 50."
            ),
        ),
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    const LINES: &str = "Limit                     Soft Limit           Hard Limit           Units     \n\
        Max nice priority         0                    0                    \n\
        Max realtime priority     10                   unlimited            \n\
        Max realtime timeout      unlimited            unlimited            us        \n";

    #[test]
    fn the_line_of_the_limit_is_read() {
        assert_eq!(
            parse(LINES),
            Some(Limit {
                soft: 10,
                hard: u64::MAX
            })
        );
        assert_eq!(parse("Max realtime priority 3"), None);
        assert_eq!(parse("Max realtime priority -1 x"), None);
    }

    #[test]
    fn each_cause_of_a_refusal_has_its_remedy() {
        let refused = || Err("Operation not permitted (os error 1)".to_owned());
        assert!(judge(Ok(()), None).ok);
        for (limit, remedy) in [
            (None, "limits.d/70-sulcus.conf: * - rtprio 50"),
            (
                Some(Limit { soft: 0, hard: 0 }),
                "limits.d/70-sulcus.conf: * - rtprio 50",
            ),
            (Some(Limit { soft: 0, hard: 46 }), "ulimit -r 46"),
            (Some(Limit { soft: 99, hard: 99 }), "SYS_NICE"),
        ] {
            let check = judge(refused(), limit);
            assert!(!check.ok && check.message.contains(remedy), "{check:?}");
            assert!(check.message.chars().count() <= 300 && !check.message.contains("..."));
        }
    }

    #[cfg(target_os = "linux")]
    #[test]
    fn this_machine_answers() {
        let check = check(&Roots::system());
        assert_eq!(check.ok, sulcus_link::schedule::may_fifo(), "{check:?}");
        assert!(own_limit().is_some() && limit(Path::new("/proc/self/limits")) == own_limit());
    }

    proptest! {
        #[test]
        fn garbage_is_no_limit_or_a_limit(text in any::<String>()) {
            parse(&text);
            parse(&format!("Max realtime priority {text}"));
        }
    }
}

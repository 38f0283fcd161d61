//! Section 8: the machine of the paper beside the machine of this report.

use super::answers::Answers;
use crate::report::Machine;

/// Answers for processor, clock and memory.
pub(super) fn answer(answers: &mut Answers) {
    let machine = Machine::here();
    let how = "the machine of this report, by its system";
    answers.measured("machine-processor", machine.processor, &[], how);
    let (clock, values) = match clock_ghz() {
        Some(ghz) => (format!("{ghz:.2} GHz"), vec![("ghz", ghz)]),
        None => ("not reported by the system".to_owned(), Vec::new()),
    };
    answers.measured("machine-clock-ghz", clock, &values, how);
    let gib = machine.memory_gib;
    answers.measured(
        "machine-memory-gb",
        format!("{gib:.1} GiB"),
        &[("gib", gib)],
        how,
    );
}

/// Present clock of the first processor, gigahertz.
fn clock_ghz() -> Option<f64> {
    let text = std::fs::read_to_string("/proc/cpuinfo").ok()?;
    let line = text.lines().find(|line| line.starts_with("cpu MHz"))?;
    let mhz: f64 = line.split(':').nth(1)?.trim().parse().ok()?;
    Some(mhz * 1e-3)
}

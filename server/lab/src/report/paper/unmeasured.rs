//! What nothing can be measured for here, and why.

use sulcus_core::Stage;

use super::answers::Answers;

/// Ids and reasons.
const REASONS: &[(&str, &str)] = &[
    (
        "fig1-bimanual",
        "a picture; both hands at once are measured at Fig. 19",
    ),
    ("prior-gpu-rate-hz", "other people's program; not run here"),
    (
        "prior-deformation-rate-hz",
        "other people's programs; not run here (a loop of about 60 Hz is, at section 9)",
    ),
    (
        "prior-multirate-rate-khz",
        "other people's program; what it does in principle is measured at section 9",
    ),
    (
        "fig5-internal-force",
        "a definition, drawn; computed as Eq. 1 says by the method as printed",
    ),
    (
        "fig6-penetration",
        "a definition, drawn; computed as Eq. 3 says by the method as printed",
    ),
    ("fig7-cases", "a picture; the cases are measured at Table 1"),
    (
        "table1-other-damping-ratios",
        "the video is not at hand; the limits at other ratios stand at Eq. 9",
    ),
    (
        "fig10-direction",
        "a definition, drawn; computed as Eq. 13 says by the method as printed",
    ),
    (
        "fig11-switches",
        "a picture; switches of contact are counted at Fig. 18",
    ),
    (
        "fig12-interaction-types",
        "the default model has no types: one problem answers for tooth and gingiva together; the method as printed has the paper's",
    ),
    (
        "fig13-parent-update",
        "a definition, drawn; here bounds are computed from the rest radii, as Eq. 17 in every tick, so that they shrink again",
    ),
    (
        "machine-device",
        "no device here: a simulated hand with mass, damping and tremor closes the loop",
    ),
    (
        "machine-graphics",
        "nothing is computed on a graphics card here either",
    ),
    (
        "open-dynamic-fem",
        "not done: the reference here is static, too",
    ),
    ("open-user-study", "needs people; not done"),
];

/// Gives the reasons.
pub(super) fn answer(answers: &mut Answers) {
    for (id, why) in REASONS {
        answers.unmeasured(id, *why);
    }
    let stages = Stage::ALL.map(|stage| format!("{stage:?}").to_lowercase());
    answers.measured(
        "fig2-modules",
        stages.join(", "),
        &[("stages", Stage::ALL.len() as f64)],
        "stages of a tick of this program; the tree's update is part of collide, deformation of prepare and apply",
    );
    machine(answers);
}

/// The machine of this run, as far as it says.
fn machine(answers: &mut Answers) {
    let read = |path: &str| std::fs::read_to_string(path).unwrap_or_default();
    let after = |text: &str, key: &str| {
        let line = text.lines().find(|line| line.starts_with(key))?;
        Some(line.split(':').nth(1)?.trim().to_owned())
    };
    let (cpu, memory) = (read("/proc/cpuinfo"), read("/proc/meminfo"));
    let how = "the machine that this was measured on, as its system says";
    let unknown = "the system of this machine does not say";
    match after(&cpu, "model name") {
        Some(name) => answers.measured("machine-processor", name, &[], how),
        None => answers.unmeasured("machine-processor", unknown),
    }
    let number = |text: Option<String>| text?.split(' ').next()?.parse::<f64>().ok();
    match number(after(&cpu, "cpu MHz")) {
        Some(mhz) => {
            let ghz = mhz * 1e-3;
            answers.measured(
                "machine-clock-ghz",
                format!("{ghz:.2} GHz"),
                &[("ghz", ghz)],
                how,
            );
        }
        None => answers.unmeasured("machine-clock-ghz", unknown),
    }
    match number(after(&memory, "MemTotal")) {
        Some(kib) => {
            let gib = kib / f64::from(1 << 20);
            answers.measured(
                "machine-memory-gb",
                format!("{gib:.1} GiB"),
                &[("gib", gib)],
                how,
            );
        }
        None => answers.unmeasured("machine-memory-gb", unknown),
    }
}

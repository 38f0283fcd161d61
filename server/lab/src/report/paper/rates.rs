//! Section 9 and section 1.2.2: one loop of 1 kHz against two rates.

use sulcus_cases::multi_rate::{MultiRate, Rated, Rates, Study};

use super::Curve;
use super::answers::Answers;

/// Milliseconds between two points of a curve.
const DRAWN: usize = 5;

/// One rate in words.
fn describe(rated: &Rated) -> String {
    format!(
        "{}: force off by {:.0} mN rms, {:.0} mN at most; buzz {:.2} mN, largest force step {:.1} mN, jump {:.3} mm, {:.3} mJ put out, {}",
        rated.rates.name(),
        rated.rms_difference * 1e3,
        rated.max_difference * 1e3,
        rated.closed.buzz * 1e3,
        rated.closed.force_step * 1e3,
        rated.closed.jump * 1e3,
        rated.closed.energy * 1e3,
        if rated.stable { "stable" } else { "not stable" },
    )
}

fn of(study: &Study, rates: Rates) -> Option<&Rated> {
    study.rates.iter().find(|rated| rated.rates == rates)
}

/// Answers for what the study says.
pub(super) fn answer(found: &MultiRate, answers: &mut Answers) {
    let hz = 1.0 / found.slow_step_s;
    let words = |study: &Study| {
        let each: Vec<String> = study.rates.iter().map(describe).collect();
        format!("at {} N/mm: {}", study.coupling_n_per_mm, each.join("; "))
    };
    let all: Vec<String> = found.studies.iter().map(words).collect();
    let how = format!(
        "{}, and the same with 2 N/mm; tissue at {hz:.1} Hz by one implicit step, force at 1 kHz against its shape and compliance, or its shape alone, as it was left; differences of force on the same recorded hand, the rest in closed loop; both loops without delay, so the better half of what two threads do",
        found.studies.first().map_or("", |study| &study.about)
    );
    let mut values = Vec::new();
    let names = [
        [
            "compliance_rms_n_k0.5",
            "shape_rms_n_k0.5",
            "single_buzz_n_k0.5",
            "compliance_buzz_n_k0.5",
            "shape_buzz_n_k0.5",
        ],
        [
            "compliance_rms_n_k2",
            "shape_rms_n_k2",
            "single_buzz_n_k2",
            "compliance_buzz_n_k2",
            "shape_buzz_n_k2",
        ],
    ];
    for (study, names) in found.studies.iter().zip(names) {
        if let [single, compliance, shape] = &study.rates[..] {
            let numbers = [
                compliance.rms_difference,
                shape.rms_difference,
                single.closed.buzz,
                compliance.closed.buzz,
                shape.closed.buzz,
            ];
            values.extend(names.into_iter().zip(numbers));
        }
    }
    answers.measured("open-multirate", all.join(". "), &values, how.clone());
    loss(found, &how, answers);
    limit(found, answers);
    curves(found, &how, answers);
}

/// What is lost in force while sliding on the tissue.
fn loss(found: &MultiRate, how: &str, answers: &mut Answers) {
    let share = |study: &Study, rates| {
        of(study, rates).map_or(0.0, |rated| rated.rms_difference / rated.rms_force * 100.0)
    };
    let each = |study: &Study| {
        format!(
            "{:.1} % of the force with frozen compliance, {:.1} % with frozen shape, at {} N/mm",
            share(study, Rates::FrozenCompliance),
            share(study, Rates::FrozenShape),
            study.coupling_n_per_mm
        )
    };
    let all: Vec<String> = found.studies.iter().map(each).collect();
    answers.measured("multirate-loss", all.join("; "), &[], format!("{how}; rms of the difference of force over rms of the force. No one felt it: what a hand misses is not measured"));
}

/// The stiffest coupling that was tried, with one loop.
fn limit(found: &MultiRate, answers: &mut Answers) {
    let stable = found
        .studies
        .iter()
        .filter(|study| of(study, Rates::Single).is_some_and(|one| one.stable));
    let most = stable
        .map(|study| study.coupling_n_per_mm)
        .fold(0.0, f64::max);
    answers.measured(
        "coupling-limit",
        format!("stable at {most} N/mm, the stiffest tried here"),
        &[("n_per_mm", most)],
        "on the soft tongue with a simulated hand and device (damping 4 N s/m), whose own limit is about 8 N/mm; a real device's was not measured",
    );
}

fn curves(found: &MultiRate, how: &str, answers: &mut Answers) {
    for study in &found.studies {
        let line = |rated: &Rated| {
            let points = rated.forces.iter().enumerate().step_by(DRAWN);
            let points = points.map(|(k, force)| (k as f64 * 1e-3, *force));
            (rated.rates.name().to_owned(), points.collect())
        };
        answers.curve(Curve {
            place: "multi-rate",
            title: format!(
                "Force on the same hand, mirror coupled with {} N/mm",
                study.coupling_n_per_mm
            ),
            x: "time, s",
            y: "N",
            series: study.rates.iter().map(line).collect(),
            note: how.to_owned(),
        });
    }
}

//! Grade as text for a terminal, and words that pages share with it.

use super::report::{Grade, MetricGrade, Source};

/// Value of a metric with its unit.
pub fn value(metric: &MetricGrade) -> String {
    match metric.value {
        None => "-".into(),
        Some(value) if metric.unit.is_empty() => format!("{value}"),
        Some(value) => format!("{value} {}", metric.unit),
    }
}

/// Rubric of a grade, in words.
pub fn rubric(grade: &Grade) -> String {
    let Some(used) = &grade.rubric else {
        return "none".into();
    };
    let from = match used.source {
        Source::Recording => "from the recording",
        Source::BuiltIn => "built in, because the recording has none",
        Source::File => "GIVEN INSTEAD of the recording's rubric",
    };
    let safe = used.name.escape_debug();
    format!(
        "{safe}, version {} ({}), {from}",
        used.version,
        &used.blake3[..12]
    )
}

/// Signer of a grade, in words.
pub fn signer(grade: &Grade) -> String {
    let short = &grade.signer[..grade.signer.len().min(16)];
    let whose = if grade.signer_trusted {
        "a trusted key"
    } else {
        "key from the recording, not checked; --signer names the right key"
    };
    format!("{short} ({whose})")
}

impl Grade {
    /// Grade as text. `exam`: without advice and without values that tell depths. `truth`: with prescribed depths.
    pub fn text(&self, exam: bool, truth: bool) -> String {
        let safe = |text: &str| text.escape_debug().to_string();
        let learner = if self.learner_id.is_empty() {
            "(none)".into()
        } else {
            safe(&self.learner_id)
        };
        let mut lines = vec![
            format!("  learner    {learner}, exercise {}", safe(&self.exercise)),
            format!("  rubric     {}", rubric(self)),
            format!("  signer     {}", signer(self)),
        ];
        if let Some(migrated) = &self.migrated {
            lines.push(format!("  migrated   {migrated}"));
        }
        for (says, what) in self.reservations() {
            lines.push(format!("  WARNING    {says}: {}", safe(&what)));
        }
        let Some(score) = self.score else {
            let why = self.reason.as_deref().unwrap_or("reason unknown");
            lines.push(format!("  NO GRADE   {}", safe(why)));
            return lines.join("\n");
        };
        let passed = match self.passed {
            Some(true) => "passed",
            Some(false) => "NOT PASSED",
            None => "NOT DECIDED",
        };
        lines.push(format!(
            "  score      {score:.1} of 100, {passed} (pass mark {:.1}; proposed by the program)",
            self.pass_mark.unwrap_or_default()
        ));
        lines.extend(
            self.failures
                .iter()
                .map(|why| format!("             {}", safe(why))),
        );
        lines.push(String::new());
        lines.push(format!(
            "  {:42} {:>12} {:>14} {:>7} {:>6}",
            "metric", "value", "target", "weight", "score"
        ));
        for metric in &self.metrics {
            let score = match metric.score {
                _ if metric.not_judged.is_some() => "not judged".into(),
                Some(score) => format!("{score:.0}"),
                None => "-".into(),
            };
            lines.push(format!(
                "  {:42} {:>12} {:>14} {:>7} {score:>6}",
                metric.title,
                value(metric),
                metric.target.to_string(),
                metric.weight,
            ));
        }
        if !self.sites.is_empty() {
            lines.push(String::new());
            let header = if truth { "   truth" } else { "" };
            lines.push(if exam {
                format!("  {:18} called   force", "site")
            } else {
                format!("  {:18}{header} reached  called   force  finding", "site")
            });
        }
        for site in &self.sites {
            let mm = |x: Option<f64>| x.map_or("-".into(), |x| format!("{x:.1}"));
            let truth = if truth {
                format!("{:>8}", mm(site.truth_mm))
            } else {
                String::new()
            };
            let called = site.called_mm.map_or("-".into(), |mm| mm.to_string());
            let force = site.max_force_n.map_or("-".into(), |n| format!("{n:.2} N"));
            let zone = format!("  {} {:15}", site.tooth, site.site.name());
            lines.push(if exam {
                format!("{zone}{called:>8}{force:>8}")
            } else {
                let (reached, finding) = (mm(site.measured_mm), site.finding.words());
                format!("{zone}{truth}{reached:>8}{called:>8}{force:>8}  {finding}")
            });
        }
        if !exam && !self.advice.is_empty() {
            lines.push(String::new());
            lines.push("  advice".into());
            for advice in &self.advice {
                lines.push(format!("  - {}: {}", advice.title, advice.text));
                lines.extend(advice.sites.iter().map(|site| format!("      {site}")));
            }
        }
        lines.join("\n")
    }
}

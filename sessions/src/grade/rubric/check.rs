//! Checks of a rubric: ranges of its values, and metrics that its exercise cannot have.

use super::{Bound, Rubric};
use crate::exercise::Exercise;
use crate::grade::definitions;
use crate::grade::definitions::METRICS;
use crate::record::written::{Written, WrittenError};

impl Rubric {
    /// Checks that the exercise has something to measure for each metric that counts. Other metrics would be left out,
    /// and a session without any task would have a full score.
    ///
    /// # Errors
    /// The first metric that counts and has nothing to measure in the exercise.
    pub fn fits(&self, exercise: &Exercise) -> Result<(), WrittenError> {
        let weighed = self.metrics.iter().filter(|one| {
            one.weight > 0.0 || one.pass.is_some() || one.deduct.is_some_and(|points| points > 0.0)
        });
        let criticals = self.critical.iter().map(|one| one.metric.as_str());
        for name in weighed.map(|one| one.name.as_str()).chain(criticals) {
            let needs = definitions::find(name).map(|known| known.needs);
            let Some(needs) = needs.filter(|needs| !needs.may_be_weighed(exercise)) else {
                continue;
            };
            let found = format!("`{name}` in the rubric `{}`", self.name);
            let expected = format!(
                "a metric of exercise `{}`, which does not have {}",
                exercise.name,
                needs.what()
            );
            return wrong("metric", found, expected);
        }
        Ok(())
    }

    /// Checks every value.
    ///
    /// # Errors
    /// The first field out of range: its name, the value found and the value expected.
    pub fn validate(&self) -> Result<(), WrittenError> {
        Self::check_name(&self.name)?;
        if self.version == 0 {
            return wrong("version", "0", "1 or more");
        }
        if self.about.len() > 1024 {
            let found = format!("{} bytes long", self.about.len());
            return wrong("about", found, "at most 1024 bytes");
        }
        within("pass_mark", self.pass_mark, 0.0, 100.0)?;
        let set = &self.settings;
        let [low, high] = set.force_n;
        within("settings.force_n", low, 0.02, 5.0)?;
        within("settings.force_n", high, 0.02, 5.0)?;
        if low >= high {
            let found = format!("[{low}, {high}]");
            return wrong(
                "settings.force_n",
                found,
                "the lower bound before the upper",
            );
        }
        within("settings.reached_mm", set.reached_mm, 0.1, 5.0)?;
        within("settings.misread_mm", set.misread_mm, 0.5, 5.0)?;
        within("settings.steady_mm", set.steady_mm, 0.1, 20.0)?;
        self.check_metrics()?;
        self.check_critical()
    }

    fn check_metrics(&self) -> Result<(), WrittenError> {
        for (k, weighed) in self.metrics.iter().enumerate() {
            let field = |name: &str| format!("metric[{k}].{name}");
            known_metric(&field("name"), &weighed.name)?;
            if self.metrics[..k].iter().any(|one| one.name == weighed.name) {
                let found = format!("`{}` again", weighed.name);
                return wrong(&field("name"), found, "each metric once");
            }
            within(&field("weight"), weighed.weight, 0.0, 100.0)?;
            if let Some(pass) = weighed.pass {
                within(&field("pass"), pass, 0.0, 100.0)?;
            }
            if let Some(deduct) = weighed.deduct {
                within(&field("deduct"), deduct, 0.0, 100.0)?;
                if weighed.pass.is_none() {
                    let found = "missing where `deduct` is given";
                    return wrong(&field("pass"), found, "0 to 100");
                }
            }
            let (target, zero) = (weighed.target, weighed.zero);
            let found = format!("{zero} with target {target}");
            let sound = match (target, zero) {
                (Bound::One(a), Bound::One(b)) => {
                    (a - b).abs() > 0.0 && a.is_finite() && b.is_finite()
                }
                (Bound::Band([a, b]), Bound::Band([c, d])) => {
                    c < a && a <= b && b < d && c.is_finite() && d.is_finite()
                }
                _ => false,
            };
            if !sound {
                let expected =
                    "another number than `target`, or a band [from, to] around that of `target`";
                return wrong(&field("zero"), found, expected);
            }
        }
        let sum: f64 = self.metrics.iter().map(|weighed| weighed.weight).sum();
        if sum <= 0.0 {
            let found = format!("{sum} in all");
            return wrong("metric.weight", found, "more than 0 in all");
        }
        Ok(())
    }

    fn check_critical(&self) -> Result<(), WrittenError> {
        for (k, critical) in self.critical.iter().enumerate() {
            let field = |name: &str| format!("critical[{k}].{name}");
            known_metric(&field("metric"), &critical.metric)?;
            let bounds = [critical.above, critical.below];
            let given: Vec<f64> = bounds.into_iter().flatten().collect();
            if given.len() != 1 || !given[0].is_finite() {
                let found = match given[..] {
                    [] => "missing, as is `below`".to_owned(),
                    [only] => only.to_string(),
                    _ => "given, as is `below`".to_owned(),
                };
                return wrong(
                    &field("above"),
                    found,
                    "either `above` or `below`, a number",
                );
            }
            if let Some(cap) = critical.cap {
                within(&field("cap"), cap, 0.0, 100.0)?;
            }
            if critical.why.is_empty() || critical.why.len() > 256 {
                let found = format!("{} bytes long", critical.why.len());
                return wrong(&field("why"), found, "1 to 256 bytes");
            }
        }
        Ok(())
    }
}

fn known_metric(field: &str, name: &str) -> Result<(), WrittenError> {
    if definitions::find(name).is_some() {
        return Ok(());
    }
    let names: Vec<&str> = METRICS.iter().map(|metric| metric.name).collect();
    let found = format!("`{}`", name.escape_debug());
    wrong(field, found, format!("one of: {}", names.join(", ")))
}

impl Written for Rubric {
    const WHAT: &'static str = "rubric";

    fn check(&self) -> Result<(), WrittenError> {
        self.validate()
    }
}

fn wrong(
    field: &str,
    found: impl Into<String>,
    expected: impl Into<String>,
) -> Result<(), WrittenError> {
    Rubric::wrong(field, found, expected)
}

/// Checks that a number lies in a range. A NaN lies in none.
fn within(field: &str, x: f64, low: f64, high: f64) -> Result<(), WrittenError> {
    if (low..=high).contains(&x) {
        return Ok(());
    }
    wrong(field, x.to_string(), format!("{low} to {high}"))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Exercise;

    #[test]
    fn every_exercise_has_a_rubric_whose_metrics_apply() {
        let all = Rubric::built_in();
        assert_eq!(all.len(), 4);
        for exercise in Exercise::built_in() {
            let rubric = Rubric::of(&exercise).unwrap_or_else(|| panic!("{}", exercise.name));
            assert_eq!(rubric.name, exercise.name);
            for weighed in &rubric.metrics {
                let known = definitions::find(&weighed.name).map(|m| m.needs.are_met(&exercise));
                assert_eq!(known, Some(true), "{} in {}", weighed.name, rubric.name);
            }
            for critical in &rubric.critical {
                let weighed = rubric.metrics.iter().any(|m| m.name == critical.metric);
                assert!(
                    weighed,
                    "{} is not measured in {}",
                    critical.metric, rubric.name
                );
            }
        }
        assert_eq!(Rubric::of(&Exercise::free("free", 1.0)), None);
    }

    #[test]
    fn the_recorded_text_carries_definitions_and_says_what_has_another() {
        let exercise = Exercise::built_in().remove(1);
        let rubric = Rubric::of(&exercise).unwrap_or_else(|| panic!("built in"));
        let text = rubric.definition().unwrap_or_default();
        for weighed in &rubric.metrics {
            let known = definitions::find(&weighed.name).map_or("", |m| m.definition);
            assert!(
                !known.is_empty() && text.contains(known),
                "{}",
                weighed.name
            );
        }
        let back = Rubric::parse(&text).unwrap_or_else(|error| panic!("{error}"));
        assert!(back.redefined().is_empty());
        let other = text.replace(
            "called depth is at most 1 mm",
            "called depth is at most a mile",
        );
        let other = Rubric::parse(&other).unwrap_or_else(|error| panic!("{error}"));
        assert_eq!(other.redefined(), ["called_within_1mm"]);
    }

    #[test]
    fn what_is_asked_for_besides_depth_travels_with_the_rubric() {
        let mut rubric = Rubric::built_in().remove(1);
        let unasked = rubric.definition().unwrap_or_default();
        assert!(
            !unasked.contains("ask_bleeding ="),
            "what is not asked for is not written"
        );
        rubric.settings.ask_bleeding = true;
        let text = rubric.definition().unwrap_or_default();
        let back = Rubric::parse(&text).unwrap_or_else(|error| panic!("{error}"));
        assert_eq!(back.settings, rubric.settings);
        let found = Rubric::parse(&text.replace("ask_bleeding = true", "ask_bleeding = 1"));
        let error = found.map_or_else(|error| error.to_string(), |_| String::new());
        assert!(error.contains("ask_bleeding"), "{error}");
    }

    #[test]
    fn an_error_names_the_field_the_value_found_and_the_value_expected() {
        let exercise = Exercise::built_in().remove(1);
        let good = Rubric::of(&exercise).unwrap_or_else(|| panic!("built in"));
        let text = toml::to_string(&good).unwrap_or_default();
        let version = format!("version = {}", good.version);
        let coloured = format!("{version}\ncolour = 3");
        let told = |from: &str, to: &str| {
            assert!(text.contains(from), "{from} is not in {text}");
            Rubric::parse(&text.replacen(from, to, 1))
                .err()
                .map_or(String::new(), |error| error.to_string())
        };
        for (from, to, words) in [
            (
                version.as_str(),
                "version = 0",
                "version is 0, expected 1 or more",
            ),
            (
                version.as_str(),
                coloured.as_str(),
                "unknown field `colour`",
            ),
            (
                "force_n = [0.1,",
                "force_n = [0.3,",
                "[0.3, 0.25], expected the lower bound",
            ),
            (
                "force_n = [0.1, 0.25]",
                "force_n = [0,1, 0,25]",
                "settings.force_n: 4 numbers found, 2 expected; a decimal is written with a point",
            ),
            (
                "target = [-0.4, 0.4]",
                "target = [-0,4, 0,4]",
                "target: 4 numbers found, 2 expected",
            ),
            (
                "target = [-0.4, 0.4]",
                "target = \"none\"",
                "expected a number, or a list of two numbers",
            ),
            (
                "reached_mm = 0",
                "reached_mm = 9",
                "settings.reached_mm is 9",
            ),
            (
                "\"floor_reached\"",
                "\"charm\"",
                "`charm`, expected one of: zones_charted, ",
            ),
            (
                "\"floor_reached\"",
                "\"misread\"",
                "`misread` again, expected each metric once",
            ),
            ("weight = ", "weight = -", "expected 0 to 100"),
            ("pass_mark = ", "pass_mark = 1", "pass_mark is 1"),
            (
                "above = 0.0",
                "below = 1.0\nabove = 0.0",
                "either `above` or `below`",
            ),
        ] {
            let said = told(from, to);
            assert!(said.contains(words), "{from} -> {to}: {said}");
        }
        assert!(Rubric::parse("{}").is_err());
        assert!(Rubric::parse(&"#".repeat(70_000)).is_err());
    }

    #[test]
    fn a_rubric_weighs_what_its_exercise_asks_for_and_no_other() {
        for exercise in Exercise::built_in() {
            let own = Rubric::of(&exercise).expect("one");
            assert_eq!(own.fits(&exercise), Ok(()), "{}", exercise.name);
        }
        let of = |name: &str| {
            let mut all = Exercise::built_in().into_iter();
            all.find(|one| one.name == name).expect(name)
        };
        let rubric = |name: &str| Rubric::of(&of(name)).expect("one");
        // Zones in the middle of a side are enough.
        let mut mid = of("probing");
        mid.zones[0].sites = vec![sulcus_core::tissue::gingiva::Site::Buccal];
        assert_eq!(rubric("probing").fits(&mid), Ok(()));
        for (weighs, asks) in [
            ("probing", "crown"),
            ("bimanual", "probing"),
            ("retraction", "crown"),
            ("crown", "retraction"),
        ] {
            let wrong = rubric(weighs).fits(&of(asks)).expect_err("another's");
            let said = wrong.to_string();
            assert!(said.contains(&format!("rubric `{weighs}`")), "{said}");
            assert!(said.contains(&format!("exercise `{asks}`")), "{said}");
        }
        assert!(rubric("crown").fits(&Exercise::free("free", 1.0)).is_err());
    }

    #[test]
    fn a_metric_of_another_program_is_left_out_where_a_recording_defines_it() {
        let rubric = Rubric::built_in().remove(0);
        let text = rubric.definition().expect("text");
        let whole = Rubric::parse(&text).expect("a rubric");
        assert_eq!(Rubric::recorded(&text), Ok((whole, vec![])));
        let renamed = text.replace("\"probe_peak\"", "\"probe_push\"");
        assert_ne!(renamed, text);
        let (left, unknown) = Rubric::recorded(&renamed).expect("the rest holds");
        assert_eq!(unknown, ["probe_push"]);
        assert_eq!(left.metrics.len(), rubric.metrics.len() - 1);
        assert!(left.critical.iter().all(|one| one.metric != "probe_peak"));
        // In a file by hand, an unknown metric is an error.
        let told = Rubric::parse(&renamed).expect_err("unknown").to_string();
        assert!(told.contains("`probe_push`"), "{told}");
        // Without a definition, an unknown metric of a recording is an error, too.
        let bare = toml::to_string(&rubric).expect("text");
        let bare = bare.replace("\"probe_peak\"", "\"probe_push\"");
        assert!(Rubric::recorded(&bare).is_err());
    }
}

//! Which grip is on which arm.

use super::inventory::Inventory;
use super::reply::Array;

/// Name of an arm without a grip, after the plus sign.
const NO_GRIP: &str = "none";

/// Arm and grip of one hand.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Pair {
    /// Id of the arm.
    pub(super) arm: String,
    /// Array and id of the grip; `None` for an arm without a grip.
    pub(super) grip: Option<(Array, String)>,
    /// Whether the order of the service alone decided among several grips.
    pub(super) by_order: bool,
}

/// Finds arm and grip of each name: `049D`, `049D+61576` or `049D+none`.
///
/// # Errors
/// An arm or a grip is absent or given twice, or the grip of an arm is not clear: one sentence.
pub(super) fn pair(names: &[String], all: &Inventory) -> Result<Vec<Pair>, String> {
    let named: Vec<(&str, Option<&str>)> = names.iter().map(|name| split(name)).collect();
    for (i, (arm, grip)) in named.iter().enumerate() {
        if all.arm(arm).is_none() {
            return Err(absent(
                "arm",
                arm,
                all.arms.iter().map(|arm| arm.id.as_str()),
            ));
        }
        let before = &named[..i];
        if before.iter().any(|(other, _)| other == arm) {
            return Err(format!(
                "the arm {arm} is named twice, expected one hand for each arm"
            ));
        }
        let Some(grip) = grip.filter(|grip| *grip != NO_GRIP) else {
            continue;
        };
        if all.grip(grip).is_none() {
            return Err(absent(
                "grip",
                grip,
                all.grips.iter().map(|grip| grip.id.as_str()),
            ));
        }
        if before.iter().any(|(_, other)| *other == Some(grip)) {
            return Err(format!(
                "the grip {grip} is named twice, expected one arm for each grip"
            ));
        }
    }
    named
        .iter()
        .map(|(arm, grip)| {
            let (grip, by_order) = match grip {
                Some(NO_GRIP) => (None, false),
                Some(grip) => (Some(*grip), false),
                None => by_order(arm, &named, all)?,
            };
            let grip = grip.and_then(|id| all.grip(id));
            Ok(Pair {
                arm: (*arm).into(),
                grip: grip.map(|grip| (grip.array, grip.id.clone())),
                by_order,
            })
        })
        .collect()
}

/// Grip of an arm without a named grip, and whether several grips were left.
fn by_order<'a>(
    arm: &str,
    named: &[(&str, Option<&str>)],
    all: &'a Inventory,
) -> Result<(Option<&'a str>, bool), String> {
    let is_left = |id: &str| !named.iter().any(|(_, grip)| *grip == Some(id));
    let has_own = |id: &str| {
        named
            .iter()
            .any(|(other, grip)| *other == id && grip.is_some())
    };
    let grips: Vec<&str> = all
        .grips
        .iter()
        .map(|grip| grip.id.as_str())
        .filter(|id| is_left(id))
        .collect();
    let arms: Vec<&str> = all
        .arms
        .iter()
        .map(|arm| arm.id.as_str())
        .filter(|id| !has_own(id))
        .collect();
    if grips.is_empty() {
        return Ok((None, false));
    }
    let at = arms.iter().position(|other| *other == arm);
    match at.filter(|_| arms.len() == grips.len()) {
        Some(at) => Ok((Some(grips[at]), grips.len() > 1)),
        None => Err(format!(
            "the grip of the arm {arm} is not clear, found the grips {}: name it as {arm}+{} or {arm}+{NO_GRIP}",
            grips.join(", "),
            grips[0]
        )),
    }
}

fn split(name: &str) -> (&str, Option<&str>) {
    match name.trim().split_once('+') {
        Some((arm, grip)) => (arm.trim(), Some(grip.trim())),
        None => (name.trim(), None),
    }
}

fn absent<'a>(kind: &str, id: &str, found: impl Iterator<Item = &'a str>) -> String {
    let found: Vec<&str> = found.collect();
    let found = if found.is_empty() {
        "none".into()
    } else {
        found.join(", ")
    };
    format!(
        "the Haply service has no {kind} {id}, found {found}: connect the {kind}, or correct its name"
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    fn inventory(arms: &[&str], grips: &[&str]) -> Inventory {
        let list = |ids: &[&str]| {
            let all: Vec<String> = ids
                .iter()
                .map(|id| format!("{{\"device_id\":\"{id}\"}}"))
                .collect();
            all.join(",")
        };
        let text = format!(
            "{{\"inverse3\":[{}],\"wireless_verse_grip\":[{}]}}",
            list(arms),
            list(grips)
        );
        Inventory::parse(&text).unwrap()
    }

    fn grips(names: &[&str], all: &Inventory) -> Result<Vec<String>, String> {
        let names: Vec<String> = names.iter().map(|&name| name.into()).collect();
        let pairs = pair(&names, all)?;
        Ok(pairs
            .into_iter()
            .map(|pair| pair.grip.map(|(_, id)| id).unwrap_or_default())
            .collect())
    }

    #[test]
    fn a_name_decides_and_otherwise_the_order() {
        let two = inventory(&["A", "B"], &["1", "2"]);
        assert_eq!(grips(&["B", "A"], &two).unwrap(), ["2", "1"]);
        assert_eq!(grips(&["A"], &two).unwrap(), ["1"]);
        assert_eq!(grips(&["A+2", "B"], &two).unwrap(), ["2", "1"]);
        assert_eq!(grips(&["A+2", "B+1"], &two).unwrap(), ["2", "1"]);
        assert_eq!(grips(&["A+none"], &two).unwrap(), [""]);
        assert_eq!(grips(&["A"], &inventory(&["A", "B"], &[])).unwrap(), [""]);
        assert_eq!(
            grips(&["A+1", "B"], &inventory(&["A", "B"], &["1"])).unwrap(),
            ["1", ""]
        );
        let by_order = |names: &[String]| pair(names, &two).unwrap()[0].by_order;
        assert!(by_order(&["A".into()]) && !by_order(&["A+1".into()]));
    }

    #[test]
    fn what_is_not_clear_is_one_sentence() {
        let all = inventory(&["A", "B"], &["1"]);
        for (names, part) in [
            (vec!["A"], "the grip of the arm A is not clear"),
            (vec!["C"], "no arm C, found A, B"),
            (vec!["A+9"], "no grip 9, found 1"),
            (vec!["A+1", "A+none"], "the arm A is named twice"),
            (vec!["A+1", "B+1"], "the grip 1 is named twice"),
        ] {
            let sentence = grips(&names, &all).unwrap_err();
            assert!(sentence.contains(part), "{sentence}");
        }
    }
}

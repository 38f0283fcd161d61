//! Changes of a patient in the text of its file. Comments and unchanged values stay as they are written.

use sulcus_scene::anatomy::patient::{LOWER, Patient, Sides, ToothChart};
use toml_edit::{Array, ArrayOfTables, DocumentMut, InlineTable, Item, Table, TableLike, Value};

use crate::exact;

/// Text of a new patient file.
pub fn written(patient: &Patient) -> Option<String> {
    edited("", patient)
}

/// Text of a patient file after a change to `new`; `None` if the form of the text allows no change without loss.
pub fn edited(text: &str, new: &Patient) -> Option<String> {
    let mut file: DocumentMut = text.parse().ok()?;
    let old: Option<Patient> = exact::read(text).ok();
    if old.as_ref().is_none_or(|old| old.name != new.name) {
        set(file.as_table_mut(), "name", new.name.clone().into());
    }
    if old.as_ref().is_none_or(|old| old.missing != new.missing) {
        let missing: Array = new.missing.iter().map(|fdi| i64::from(*fdi)).collect();
        set(file.as_table_mut(), "missing", missing.into());
    }
    let changed: Vec<(u8, Option<ToothChart>, Option<ToothChart>)> = LOWER
        .into_iter()
        .map(|fdi| {
            let old = old.as_ref().map(|old| charted(old, fdi));
            (fdi, old.flatten(), charted(new, fdi))
        })
        .filter(|(_, old, new)| normal(old) != normal(new) || old.is_some() && new.is_none())
        .collect();
    for (fdi, old, new) in changed {
        tooth(&mut file, fdi, old.as_ref(), new.as_ref())?;
    }
    let text = file.to_string();
    let found: Patient = exact::read(&text).ok()?;
    is_same(&found, new).then_some(text)
}

/// Chart of a tooth that the patient has; `None` for a missing tooth and for one without an entry.
fn charted(patient: &Patient, fdi: u8) -> Option<ToothChart> {
    patient.teeth.iter().find(|tooth| tooth.fdi == fdi).cloned()
}

/// A tooth without an entry is healthy.
fn normal(tooth: &Option<ToothChart>) -> Option<&ToothChart> {
    tooth
        .as_ref()
        .filter(|tooth| **tooth != ToothChart::healthy(tooth.fdi))
}

/// Whether two patients are the same: a tooth without an entry is healthy, the order of entries counts nothing.
pub fn is_same(one: &Patient, other: &Patient) -> bool {
    let missing = |patient: &Patient| {
        let mut missing = patient.missing.clone();
        missing.sort_unstable();
        missing
    };
    let mut teeth = LOWER.into_iter();
    one.name == other.name
        && missing(one) == missing(other)
        && teeth.all(|fdi| normal(&charted(one, fdi)) == normal(&charted(other, fdi)))
}

/// Sets a value and keeps the comments around the present one.
fn set(table: &mut dyn TableLike, key: &str, mut value: Value) {
    match table.get_mut(key) {
        Some(Item::Value(present)) => {
            *value.decor_mut() = present.decor().clone();
            *present = value;
        }
        _ => {
            table.insert(key, Item::Value(value));
        }
    }
}

/// Changes, adds or removes the entry of a tooth.
fn tooth(
    file: &mut DocumentMut,
    fdi: u8,
    old: Option<&ToothChart>,
    new: Option<&ToothChart>,
) -> Option<()> {
    let all = file
        .as_table_mut()
        .entry("tooth")
        .or_insert(Item::ArrayOfTables(ArrayOfTables::new()));
    let is_it =
        |table: &dyn TableLike| table.get("fdi").and_then(Item::as_integer) == Some(i64::from(fdi));
    match all {
        Item::ArrayOfTables(all) => {
            let at = all.iter().position(|table| is_it(table));
            match (at, new) {
                (Some(at), Some(new)) => entry(all.get_mut(at)?, old?, new),
                (Some(at), None) => {
                    all.remove(at);
                    Some(())
                }
                (None, Some(new)) => {
                    let mut table = Table::new();
                    set(&mut table, "fdi", i64::from(fdi).into());
                    entry(&mut table, &ToothChart::healthy(fdi), new)?;
                    all.push(table);
                    Some(())
                }
                (None, None) => Some(()),
            }
        }
        Item::Value(Value::Array(all)) => {
            let tables = || all.iter().map(|value| value.as_inline_table());
            let at = tables().position(|table| table.is_some_and(|table| is_it(table)));
            match (at, new) {
                (Some(at), Some(new)) => entry(all.get_mut(at)?.as_inline_table_mut()?, old?, new),
                (Some(at), None) => {
                    all.remove(at);
                    Some(())
                }
                (None, Some(new)) => {
                    let mut table = InlineTable::new();
                    set(&mut table, "fdi", i64::from(fdi).into());
                    entry(&mut table, &ToothChart::healthy(fdi), new)?;
                    all.push(table);
                    Some(())
                }
                (None, None) => Some(()),
            }
        }
        _ => None,
    }
}

/// Writes the values of a tooth that differ.
fn entry(table: &mut dyn TableLike, old: &ToothChart, new: &ToothChart) -> Option<()> {
    sides(table, "depth_mm", &old.depth_mm, &new.depth_mm, number)?;
    sides(
        table,
        "recession_mm",
        &old.recession_mm,
        &new.recession_mm,
        number,
    )?;
    sides(table, "bleeding", &old.bleeding, &new.bleeding, Value::from)?;
    if old.inflammation != new.inflammation {
        set(table, "inflammation", number(new.inflammation));
    }
    let [one, other] = [old, new].map(|tooth| [tooth.furcation.buccal, tooth.furcation.lingual]);
    for (k, side) in ["buccal", "lingual"].into_iter().enumerate() {
        if one[k] != other[k] {
            set(
                inside(table, "furcation")?,
                side,
                i64::from(other[k]).into(),
            );
        }
    }
    if old.mobility != new.mobility {
        set(table, "mobility", i64::from(new.mobility).into());
    }
    Some(())
}

fn sides<T: Copy + PartialEq>(
    table: &mut dyn TableLike,
    key: &str,
    old: &Sides<T>,
    new: &Sides<T>,
    value: impl Fn(T) -> Value + Copy,
) -> Option<()> {
    for (side, old, new) in [
        ("buccal", old.buccal, new.buccal),
        ("lingual", old.lingual, new.lingual),
    ] {
        if old != new {
            let values: Array = new.into_iter().map(value).collect();
            set(inside(table, key)?, side, values.into());
        }
    }
    Some(())
}

/// Table of the sides of a value, made in the dotted form if missing.
fn inside<'a>(table: &'a mut dyn TableLike, key: &str) -> Option<&'a mut dyn TableLike> {
    if !table.contains_key(key) {
        let mut made = Table::new();
        made.set_dotted(true);
        let item = match table.get("fdi") {
            // An inline table holds values alone.
            Some(Item::Value(_)) => Item::Table(made),
            _ => return None,
        };
        table.insert(key, item);
    }
    table.get_mut(key)?.as_table_like_mut()
}

/// A number as people write it: whole millimetres without a point.
fn number(value: f64) -> Value {
    if value.fract() == 0.0 && value.abs() < 1e9 {
        Value::from(value as i64)
    } else {
        Value::from(value)
    }
}

#[cfg(test)]
#[path = "edit_tests.rs"]
mod tests;

//! Reader of the form's JSON. A value of another form is refused with the name of its field.

use serde_json::{Map, Value};

use crate::house::cases::{Chart, Sides, ToothChart};

/// Longest label, bytes.
const LABEL: usize = 200;
/// Largest length that the form takes, mm. The server's check has the ranges of the model.
const MOST_MM: f64 = 99.0;
/// Largest number of teeth of a mouth.
const TEETH: usize = 32;

/// Value of a form that is refused.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Problem {
    /// Name of the field.
    pub field: String,
    /// Sentence with field, value found and value expected.
    pub why: String,
}

impl Problem {
    /// A field with the value found and the value expected.
    pub fn new(field: &str, found: &str, expected: &str) -> Self {
        Self {
            field: field.to_owned(),
            why: format!("{field} is {found}, expected {expected}"),
        }
    }
}

/// Short text of a value.
fn shown(value: Option<&Value>) -> String {
    let Some(value) = value else {
        return "missing".into();
    };
    let text = value.to_string();
    let mut short: String = text.chars().take(40).collect();
    if short.len() < text.len() {
        short.push('…');
    }
    format!("`{short}`")
}

/// Fields of an object, each of which must be taken.
pub(super) struct Fields<'a> {
    name: String,
    all: &'a Map<String, Value>,
}

impl<'a> Fields<'a> {
    /// Fields of `value`, which has no others than `known`.
    pub fn of(name: &str, value: Option<&'a Value>, known: &[&str]) -> Result<Self, Problem> {
        let Some(Value::Object(all)) = value else {
            return Err(Problem::new(name, &shown(value), "an object"));
        };
        let known = |key: &&String| known.contains(&key.as_str());
        if let Some(unknown) = all.keys().find(|key| !known(key)) {
            let unknown: String = unknown.escape_debug().take(40).collect();
            return Err(Problem::new(&unknown, "given", "no such field"));
        }
        Ok(Self {
            name: name.to_owned(),
            all,
        })
    }

    fn field(&self, key: &str) -> String {
        match self.name.as_str() {
            "body" | "chart" => key.to_owned(),
            name => format!("{key} of {name}"),
        }
    }

    /// A field of any form.
    pub fn any(&self, key: &str) -> Option<&'a Value> {
        self.all.get(key)
    }

    /// A text of at most `most` bytes.
    pub fn text(&self, key: &str, most: usize) -> Result<&'a str, Problem> {
        let value = self.all.get(key);
        let found = value.and_then(Value::as_str);
        let is_plain = |text: &&str| text.len() <= most && !text.contains(char::is_control);
        found.filter(is_plain).ok_or_else(|| {
            let expected = format!("a text of at most {most} bytes without control characters");
            Problem::new(&self.field(key), &shown(value), &expected)
        })
    }

    /// A whole number from 0 to `most`.
    pub fn whole(&self, key: &str, most: u64) -> Result<u64, Problem> {
        whole(&self.field(key), self.all.get(key), most)
    }

    fn number(&self, key: &str) -> Result<f64, Problem> {
        number(&self.field(key), self.all.get(key))
    }

    fn list(&self, key: &str, most: usize) -> Result<&'a [Value], Problem> {
        let value = self.all.get(key);
        match value.and_then(Value::as_array) {
            Some(list) if list.len() <= most => Ok(list),
            _ => {
                let expected = format!("a list of at most {most} entries");
                Err(Problem::new(&self.field(key), &shown(value), &expected))
            }
        }
    }

    /// Six values, three for each side.
    fn sides<T: Copy + Default>(
        &self,
        key: &str,
        read: impl Fn(&str, Option<&Value>) -> Result<T, Problem>,
    ) -> Result<Sides<T>, Problem> {
        let name = self.field(key);
        let sides = Fields::of(&name, self.all.get(key), &["buccal", "lingual"])?;
        let side = |side: &str| {
            let field = format!("{name}, {side}");
            let list = sides.all.get(side).and_then(Value::as_array);
            let Some(list) = list.filter(|list| list.len() == 3) else {
                let found = shown(sides.all.get(side));
                return Err(Problem::new(&field, &found, "three values, mesial first"));
            };
            let mut three = [T::default(); 3];
            for (value, of) in list.iter().zip(&mut three) {
                *of = read(&field, Some(value))?;
            }
            Ok(three)
        };
        Ok(Sides {
            buccal: side("buccal")?,
            lingual: side("lingual")?,
        })
    }
}

fn whole(field: &str, value: Option<&Value>, most: u64) -> Result<u64, Problem> {
    let found = value.and_then(Value::as_u64);
    found.filter(|found| *found <= most).ok_or_else(|| {
        let expected = format!("a whole number from 0 to {most}");
        Problem::new(field, &shown(value), &expected)
    })
}

fn small(field: &str, value: Option<&Value>, most: u8) -> Result<u8, Problem> {
    let found = whole(field, value, most.into())?;
    Ok(u8::try_from(found).unwrap_or(most))
}

fn number(field: &str, value: Option<&Value>) -> Result<f64, Problem> {
    let found = value.and_then(Value::as_f64);
    found.filter(|found| found.abs() <= MOST_MM).ok_or_else(|| {
        let expected = format!("a number from -{MOST_MM} to {MOST_MM}");
        Problem::new(field, &shown(value), &expected)
    })
}

fn truth(field: &str, value: Option<&Value>) -> Result<bool, Problem> {
    let found = value.and_then(Value::as_bool);
    found.ok_or_else(|| Problem::new(field, &shown(value), "true or false"))
}

impl Chart {
    /// Chart of a form's JSON. Ranges of the model are not checked.
    ///
    /// # Errors
    /// Name of the first field of another form.
    pub fn parse(bytes: &[u8]) -> Result<Self, Problem> {
        Self::of(Some(&json(bytes)?))
    }

    /// Chart of a JSON value.
    ///
    /// # Errors
    /// The errors of [`Chart::parse`].
    pub fn of(value: Option<&Value>) -> Result<Self, Problem> {
        let fields = Fields::of("chart", value, &["label", "missing", "teeth"])?;
        let label = fields.text("label", LABEL)?.trim().to_owned();
        let missing = fields.list("missing", TEETH)?;
        let missing = missing.iter().map(|fdi| small("missing", Some(fdi), 99));
        let teeth = fields.list("teeth", TEETH)?.iter().map(tooth);
        Ok(Self {
            label,
            missing: missing.collect::<Result<_, _>>()?,
            teeth: teeth.collect::<Result<_, _>>()?,
        })
    }
}

/// Any JSON.
pub(super) fn json(bytes: &[u8]) -> Result<Value, Problem> {
    serde_json::from_slice(bytes)
        .map_err(|error| Problem::new("body", &format!("no JSON ({error})"), "an object"))
}

fn tooth(value: &Value) -> Result<ToothChart, Problem> {
    let known = [
        "fdi",
        "depth_mm",
        "recession_mm",
        "bleeding",
        "inflammation",
        "furcation",
        "mobility",
    ];
    let fdi = small("fdi", value.get("fdi"), 99)?;
    let fields = Fields::of(&format!("tooth {fdi}"), Some(value), &known)?;
    let degrees = fields.list("furcation", 2)?;
    let [buccal, lingual] = degrees else {
        let found = shown(fields.any("furcation"));
        let field = fields.field("furcation");
        return Err(Problem::new(&field, &found, "two degrees, buccal first"));
    };
    let field = fields.field("furcation");
    Ok(ToothChart {
        fdi,
        depth_mm: fields.sides("depth_mm", number)?,
        recession_mm: fields.sides("recession_mm", number)?,
        bleeding: fields.sides("bleeding", truth)?,
        inflammation: fields.number("inflammation")?,
        furcation: [
            small(&field, Some(buccal), 9)?,
            small(&field, Some(lingual), 9)?,
        ],
        mobility: small(&fields.field("mobility"), fields.any("mobility"), 9)?,
    })
}

#[cfg(test)]
#[path = "parse_tests.rs"]
mod tests;

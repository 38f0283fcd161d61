//! Readings that a person types, or that a program which listens to a person writes: a line each, while the hands work.

use std::io::{BufRead, Read as _};
use std::sync::Arc;
use std::sync::mpsc::{Receiver, TryRecvError, channel};

use serde_json::{Value, json};
use sulcus_core::tissue::gingiva::Site;
use sulcus_core::{MAX_TOOLS, Scene, ToolInput};
use sulcus_haptics::Shown;
use sulcus_program::tell;
use sulcus_sessions::exercise::events::call::{Call, CallError};

use sulcus_haptics::Device;

use crate::device::CallingDevice;

/// How a reading is written.
pub const FORM: &str = "TOOTH SITE DEPTH, then as called: RECESSION b|nb f0..f3 (36 mb 5 -2 b)";
/// Longest line that is a reading, bytes.
const LONGEST: u64 = 200;

/// A line that is no reading.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum TypedError {
    /// Something is missing.
    #[error("{0} is missing, expected {FORM}")]
    Missing(&'static str),
    /// A word too many, or said before.
    #[error("`{0}` is left over, expected {FORM}")]
    LeftOver(String),
    /// A comma within a number. Taken for a blank it would make two readings of one.
    #[error(
        "`{found}` has a comma between two digits: for a decimal write `{meant}`, for two numbers put a blank between them"
    )]
    DecimalComma {
        /// The digits with their comma.
        found: String,
        /// The same as a decimal number.
        meant: String,
    },
    /// A value that cannot be.
    #[error(transparent)]
    Call(#[from] CallError),
    /// No line of a person.
    #[error("a line of more than {LONGEST} bytes, expected {FORM}")]
    Long,
}

/// The reading in a line, about a tooth of `scene`: FDI number, site (`mb` or `mesiobuccal`, ...), depth in whole
/// millimetres; then, in any order and only where called, recession in whole millimetres (negative: the margin lies above the
/// cemento-enamel junction), `b` (bleeds) or `nb` (does not), and the furcation's grade as `f0` to `f3`. Blanks or commas
/// between, but no comma alone between two digits; capitals do not matter.
///
/// # Errors
/// Says what is missing, left over, or impossible.
pub fn parse(line: &str, scene: &Scene) -> Result<Call, TypedError> {
    let line = line.to_lowercase();
    if let Some(error) = decimal_comma(&line) {
        return Err(error);
    }
    let mut words = line
        .split(|c: char| c.is_whitespace() || c == ',')
        .filter(|word| !word.is_empty());
    let tooth = words.next().ok_or(TypedError::Missing("the tooth"))?;
    let site = words.next().ok_or(TypedError::Missing("the site"))?;
    let depth = words.next().ok_or(TypedError::Missing("the depth"))?;
    let mut data = json!({ "tooth": number(tooth), "site": full(site), "depth_mm": number(depth) });
    for word in words {
        let (key, value) = match word.strip_prefix('f') {
            Some(grade) => ("furcation", number(grade)),
            None if word == "b" => ("bleeding", Value::Bool(true)),
            None if word == "nb" => ("bleeding", Value::Bool(false)),
            None => match number(word) {
                Value::String(word) => return Err(TypedError::LeftOver(word)),
                number => ("recession_mm", number),
            },
        };
        if data.get(key).is_some() {
            return Err(TypedError::LeftOver(word.into()));
        }
        data[key] = value;
    }
    Ok(Call::read(&data, scene)?)
}

/// The first number of a line that is written with a decimal comma.
fn decimal_comma(line: &str) -> Option<TypedError> {
    let is_part = |c: char| c.is_ascii_digit() || c == ',';
    let runs = line.split(|c: char| !is_part(c));
    let mut decimals = runs.filter_map(|run| {
        let run = run.trim_matches(',');
        let (whole, rest) = run.split_once(',')?;
        // Two commas in a row have nothing between them: a word that was left out.
        let share = rest.split(',').next().filter(|share| !share.is_empty())?;
        Some(TypedError::DecimalComma {
            found: run.to_owned(),
            meant: format!("{whole}.{share}"),
        })
    });
    decimals.next()
}

/// A whole number, or the word itself, which the call's own check then names.
fn number(word: &str) -> Value {
    word.parse::<i64>()
        .map_or_else(|_| Value::from(word), Value::from)
}

/// A site's name in full, by its initials as dentists write them.
fn full(word: &str) -> &str {
    let site = match word {
        "mb" => Site::MesioBuccal,
        "b" => Site::Buccal,
        "db" => Site::DistoBuccal,
        "dl" => Site::DistoLingual,
        "l" => Site::Lingual,
        "ml" => Site::MesioLingual,
        name => return name,
    };
    site.name()
}

/// A line of at most [`LONGEST`] bytes; none at the end. The rest of a longer one is passed over.
fn next(lines: &mut dyn BufRead) -> std::io::Result<Option<Result<String, TypedError>>> {
    let mut line = Vec::new();
    if (&mut *lines).take(LONGEST).read_until(b'\n', &mut line)? == 0 {
        return Ok(None);
    }
    if line.len() as u64 == LONGEST && line.last() != Some(&b'\n') {
        lines.skip_until(b'\n')?;
        return Ok(Some(Err(TypedError::Long)));
    }
    Ok(Some(Ok(String::from_utf8_lossy(&line).into_owned())))
}

/// Reads `lines` to their end on a thread of its own. What is no reading is said on standard error and costs nothing else.
///
/// # Errors
/// If the system gives no thread.
pub fn listen(
    mut lines: impl BufRead + Send + 'static,
    scene: Arc<Scene>,
) -> std::io::Result<Receiver<Call>> {
    let (to, calls) = channel();
    std::thread::Builder::new()
        .name("sulcus-readings".into())
        .spawn(move || {
            loop {
                let line = match next(&mut lines) {
                    Ok(None) => break,
                    Ok(Some(line)) => line,
                    Err(error) => {
                        tell!("warning: no more readings are taken: {error}");
                        break;
                    }
                };
                match line.and_then(|line| match line.trim() {
                    "" => Ok(None),
                    line => parse(line, &scene).map(Some),
                }) {
                    Ok(None) => {}
                    Ok(Some(call)) => {
                        if to.send(call).is_err() {
                            break;
                        }
                    }
                    Err(error) => tell!("not taken: {error}"),
                }
            }
        })?;
    Ok(calls)
}

/// A device beside which a person calls the readings; what the device itself would call is not called.
pub struct WithReadings<D> {
    device: D,
    calls: Receiver<Call>,
    ended: bool,
}

impl<D> WithReadings<D> {
    /// The device, and what is called beside it.
    pub fn new(device: D, calls: Receiver<Call>) -> Self {
        Self {
            device,
            calls,
            ended: false,
        }
    }
}

impl<D: CallingDevice> Device for WithReadings<D> {
    fn name(&self) -> &str {
        self.device.name()
    }
    fn exchange(&mut self, shown: &Shown) -> [ToolInput; MAX_TOOLS] {
        self.device.exchange(shown)
    }
    fn is_done(&self) -> bool {
        // Who still has something to call may.
        self.ended && self.device.is_done()
    }
}

impl<D: CallingDevice> CallingDevice for WithReadings<D> {
    fn calls(&mut self) -> Vec<Call> {
        drop(self.device.calls());
        let mut heard = Vec::new();
        loop {
            match self.calls.try_recv() {
                Ok(call) => heard.push(call),
                Err(TryRecvError::Empty) => return heard,
                Err(TryRecvError::Disconnected) => {
                    self.ended = true;
                    return heard;
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;
    use std::io::Cursor;
    use std::sync::LazyLock;

    static SCENE: LazyLock<Arc<Scene>> = LazyLock::new(|| {
        let asked = crate::exercise::Asked {
            duration_s: Some(1.0),
            ..crate::exercise::Asked::of("probing")
        };
        crate::exercise::prepare(&asked, &crate::progress::Steps)
            .expect("built in")
            .scene
    });

    #[test]
    fn a_line_is_a_reading_as_dentists_write_them() {
        let bare = Call {
            tooth: 36,
            site: Site::MesioBuccal,
            depth_mm: 5,
            recession_mm: None,
            bleeding: None,
            furcation: None,
        };
        for (line, call) in [
            ("36 MB 5", bare),
            (
                "36, mb, 5, -2, b",
                Call {
                    recession_mm: Some(-2),
                    bleeding: Some(true),
                    ..bare
                },
            ),
            (
                "  36 Buccal 3 nb f1 +2 ",
                Call {
                    site: Site::Buccal,
                    depth_mm: 3,
                    recession_mm: Some(2),
                    bleeding: Some(false),
                    furcation: Some(1),
                    ..bare
                },
            ),
            (
                "36 b 3 b",
                Call {
                    site: Site::Buccal,
                    depth_mm: 3,
                    bleeding: Some(true),
                    ..bare
                },
            ),
        ] {
            assert_eq!(parse(line, &SCENE), Ok(call), "{line}");
        }
    }

    #[test]
    fn what_is_no_reading_is_told_by_word() {
        for (line, words) in [
            ("36 mb", "the depth is missing"),
            ("36 mb five", "depth_mm is \"five\", expected 0 to 20"),
            ("36 mb -1", "depth_mm is -1"),
            ("99 mb 5", "tooth is 99, expected the FDI number"),
            ("36 x 5", "site is \"x\", expected one of: mesiobuccal"),
            ("36 mb 5 b nb", "`nb` is left over"),
            ("36 mb 5 2 3", "`3` is left over"),
            ("36 mb 5 ouch", "`ouch` is left over"),
            (
                "36 mb 5 f1",
                "furcation is 1, expected 0 to 3, in the middle",
            ),
            ("36 b 5 f9", "furcation is 9"),
        ] {
            let told = parse(line, &SCENE).expect_err(line).to_string();
            assert!(told.contains(words), "{line}: {told}");
        }
    }

    /// `36 mb 4,5` was taken for a depth of 4 mm and a recession of 5 mm.
    #[test]
    fn a_decimal_comma_makes_no_two_readings_of_one() {
        for (line, found, meant) in [
            ("36 mb 4,5", "4,5", "4.5"),
            ("36 db 3,5 -1 b", "3,5", "3.5"),
            ("36 mb 5 -1,5", "1,5", "1.5"),
            ("36,mb,10,25,b", "10,25", "10.25"),
            ("36 mb 4,5mm", "4,5", "4.5"),
            ("36 mb 1,2,3", "1,2,3", "1.2"),
            ("36,5 mb 4", "36,5", "36.5"),
            (", 36 mb 4,5,", "4,5", "4.5"),
        ] {
            let told = parse(line, &SCENE).expect_err(line);
            let (found, meant) = (found.to_owned(), meant.to_owned());
            let expected = TypedError::DecimalComma { found, meant };
            assert_eq!(told, expected, "{line}");
        }
        let told = parse("36 mb 4,5", &SCENE)
            .expect_err("a decimal")
            .to_string();
        assert!(told.contains("write `4.5`"), "{told}");
        // A comma beside a blank, a sign or a letter separates as before.
        for line in [
            "36,mb,4,-1,b",
            "36, mb, 4, 2",
            "36 ,mb ,4 ,2",
            "36,mb,4,+2",
            "36 mb 4,,2",
        ] {
            assert_eq!(
                parse(line, &SCENE).map(|call| call.depth_mm),
                Ok(4),
                "{line}"
            );
        }
    }

    /// What became of each line of a file of readings: the depth taken, or a word of the refusal.
    #[test]
    fn files_of_readings_give_each_line_its_own_answer() {
        let file = |name: &str| {
            let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/../tests/inputs/readings/");
            std::fs::read_to_string(format!("{folder}{name}")).expect("an input")
        };
        let answers = |text: &str| -> Vec<Result<(u8, Option<i8>), String>> {
            let lines = text.lines().map(str::trim);
            let answer = |line| parse(line, &SCENE).map(|call| (call.depth_mm, call.recession_mm));
            lines
                .map(|line| answer(line).map_err(|error| error.to_string()))
                .collect()
        };
        let comma = answers(&file("comma.txt"));
        let taken: Vec<_> = comma.iter().map(|one| one.clone().ok()).collect();
        assert_eq!(taken, [None, Some((2, None)), None], "{comma:?}");
        let mixed = answers(&file("mixed.txt"));
        let told = |k: usize| mixed[k].clone().expect_err("refused");
        let taken: Vec<usize> = (0..mixed.len()).filter(|k| mixed[*k].is_ok()).collect();
        assert_eq!(taken, [0, 1, 5, 9, 11], "{mixed:?}");
        assert_eq!(mixed[9], Ok((4, Some(-1))));
        for (k, words) in [
            (3, "tooth is 19"),
            (4, "depth_mm is \"4.5\""),
            (6, "depth_mm is -1"),
            (7, "depth_mm is \"5mm\""),
            (8, "`b` is left over"),
            (12, "tooth is 99"),
        ] {
            assert!(told(k).contains(words), "{k}: {}", told(k));
        }
    }

    #[test]
    fn what_is_wrong_costs_no_other_line_however_long_it_is() {
        let long = "7".repeat(100_000);
        let exact = format!("36 b 4{}\n", " ".repeat(LONGEST as usize - 7));
        assert_eq!(exact.len() as u64, LONGEST);
        let text = format!("36 mb 5\nnonsense\n\n{long}\n36 \u{fffd} 3\n{exact}36 b 3");
        let calls: Vec<Call> = listen(Cursor::new(text), SCENE.clone())
            .expect("a thread")
            .iter()
            .collect();
        assert_eq!(
            calls.iter().map(|call| call.depth_mm).collect::<Vec<_>>(),
            [5, 4, 3]
        );
    }

    /// A device that calls all the time and has nothing left to do.
    struct Talks;

    impl Device for Talks {
        fn name(&self) -> &str {
            "talks"
        }
        fn exchange(&mut self, _: &Shown) -> [ToolInput; MAX_TOOLS] {
            sulcus_core::TickInput::IDLE.tools
        }
        fn is_done(&self) -> bool {
            true
        }
    }

    impl CallingDevice for Talks {
        fn calls(&mut self) -> Vec<Call> {
            vec![parse("36 b 9", &SCENE).expect("a reading")]
        }
    }

    #[test]
    fn a_person_is_heard_instead_of_the_device_until_nothing_is_said_any_more() {
        let (to, calls) = channel();
        let mut device = WithReadings::new(Talks, calls);
        let said = parse("36 b 3", &SCENE).expect("a reading");
        assert_eq!(device.calls(), []);
        to.send(said).expect("it listens");
        to.send(said).expect("it listens");
        assert_eq!(device.calls(), [said, said]);
        assert!(!device.is_done());
        drop(to);
        assert_eq!(device.calls(), []);
        assert!(device.is_done());
    }

    proptest! {
        #[test]
        fn any_line_is_a_call_or_an_error(line in ".{0,80}") {
            let _ = parse(&line, &SCENE);
        }

        #[test]
        fn what_is_called_can_be_written(
            site in proptest::sample::select(Site::ALL.to_vec()),
            depth_mm in 0u8..=20,
            recession_mm in proptest::option::of(-10i8..=20),
            bleeding in proptest::option::of(proptest::bool::ANY),
        ) {
            let call = Call { tooth: 36, site, depth_mm, recession_mm, bleeding, furcation: None };
            let mut line = format!("36 {} {depth_mm}", site.name());
            if let Some(mm) = recession_mm {
                line += &format!(" {mm}");
            }
            if let Some(bleeds) = bleeding {
                line += if bleeds { " b" } else { " nb" };
            }
            prop_assert_eq!(parse(&line, &SCENE), Ok(call));
        }
    }
}

//! Called findings from standard input, one line each, from a person or a speech program during the session.

use std::io::{BufRead, Read as _};
use std::sync::Arc;
use std::sync::mpsc::{Receiver, TryRecvError, channel};

use serde_json::{Value, json};
use sulcus_connection::device::{DeviceEvent, EventDevice, Glance};
use sulcus_core::tissue::gingiva::Site;
use sulcus_core::{MAX_TOOLS, Scene, ToolInput};
use sulcus_demo::calls::event;
use sulcus_haptics::guide::Guide;
use sulcus_haptics::{HandSource, Merger, Shown};
use sulcus_program::tell;
use sulcus_proto::control::Command;
use sulcus_sessions::exercise::events::call::{Call, CallError, READING_CALLED};

/// Form of a line, for messages.
pub const FORM: &str =
    "TOOTH SITE DEPTH, then optional RECESSION, b or nb, f0 to f3; for example 36 mb 5 -2 b";
/// Longest valid line, bytes, with its end.
const LONGEST: u64 = 200;

/// Error of a line.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum TypedError {
    /// Tooth, site or depth is missing.
    #[error("{0} is missing, expected {FORM}")]
    Missing(&'static str),
    /// A word is unknown, or repeats a finding.
    #[error("`{0}` is left over, expected {FORM}")]
    LeftOver(String),
    /// A comma stands between two digits. As a separator it would make two numbers of one decimal number.
    #[error(
        "`{found}` has a comma between two digits: for a decimal write `{meant}`, for two numbers put a blank between them"
    )]
    DecimalComma {
        /// Digits with the comma.
        found: String,
        /// The decimal number with a point.
        meant: String,
    },
    /// A value is out of range.
    #[error(transparent)]
    Call(#[from] CallError),
    /// The line is too long.
    #[error("a line has more than {LONGEST} bytes, expected {FORM}")]
    Long,
}

/// Called findings of one line for a tooth of `scene`.
///
/// The line holds the FDI number, the site as `mb` or `mesiobuccal`, and the depth in whole millimetres. These optional
/// words follow in any order:
/// - recession in whole millimetres, negative if the margin lies above the cemento-enamel junction
/// - `b` for bleeding, `nb` for none
/// - grade of the furcation, `f0` to `f3`
///
/// Blanks or commas separate words. A comma alone between two digits is refused. Letter case has no meaning.
///
/// # Errors
/// A missing, surplus or invalid word. The message names the word.
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

/// First number of a line with a decimal comma, as an error.
fn decimal_comma(line: &str) -> Option<TypedError> {
    let is_part = |c: char| c.is_ascii_digit() || c == ',';
    let runs = line.split(|c: char| !is_part(c));
    let mut decimals = runs.filter_map(|run| {
        let run = run.trim_matches(',');
        let (whole, rest) = run.split_once(',')?;
        // Two commas in a row stand for an omitted word.
        let share = rest.split(',').next().filter(|share| !share.is_empty())?;
        Some(TypedError::DecimalComma {
            found: run.to_owned(),
            meant: format!("{whole}.{share}"),
        })
    });
    decimals.next()
}

/// A whole number, or the word itself. The check of the call names a word that is no number.
fn number(word: &str) -> Value {
    word.parse::<i64>()
        .map_or_else(|_| Value::from(word), Value::from)
}

/// Full name of a site from its initials, as dentists write them. Another word stays as it is.
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

/// Next line of at most [`LONGEST`] bytes; `None` at the end of the input. A longer line is an error, and its rest is
/// skipped. Bytes that are not UTF-8 are replaced.
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

/// Reads `lines` to their end on a thread of its own, and sends the calls to the receiver. An invalid line is reported
/// on standard error and skipped. An error of the input ends the thread with a warning.
///
/// # Errors
/// The system gives no thread.
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
                        tell!("warning: standard input cannot be read; later readings are ignored: {error}");
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

/// A device with the calls of a person. The events of the device itself are dropped.
pub struct WithReadings<D> {
    device: D,
    calls: Receiver<Call>,
    ended: bool,
}

impl<D> WithReadings<D> {
    /// A device and the receiver of [`listen`].
    pub fn new(device: D, calls: Receiver<Call>) -> Self {
        Self {
            device,
            calls,
            ended: false,
        }
    }
}

impl<D: EventDevice> HandSource for WithReadings<D> {
    fn name(&self) -> &str {
        self.device.name()
    }
    fn exchange(&mut self, shown: &Shown) -> [ToolInput; MAX_TOOLS] {
        self.device.exchange(shown)
    }
    fn is_done(&self) -> bool {
        // Until the input ends, a call may still arrive.
        self.ended && self.device.is_done()
    }
}

impl<D: EventDevice> EventDevice for WithReadings<D> {
    fn events(&mut self) -> Vec<DeviceEvent> {
        // The person calls the readings, in place of the simulated operator.
        let mut heard = self.device.events();
        heard.retain(|event| event.kind != READING_CALLED);
        loop {
            match self.calls.try_recv() {
                Ok(call) => heard.push(event(&call)),
                Err(TryRecvError::Empty) => return heard,
                Err(TryRecvError::Disconnected) => {
                    self.ended = true;
                    return heard;
                }
            }
        }
    }

    fn commands(&mut self) -> Vec<Command> {
        self.device.commands()
    }

    fn glance(&mut self, glance: &Glance) {
        self.device.glance(glance);
    }

    fn hear(&mut self, text: &str) {
        self.device.hear(text);
    }

    fn threaded(&mut self) -> Option<&mut Merger> {
        self.device.threaded()
    }

    fn guide(&mut self) -> Option<&mut Guide> {
        self.device.guide()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;
    use std::io::Cursor;
    use std::sync::LazyLock;

    static SCENE: LazyLock<Arc<Scene>> = LazyLock::new(|| {
        let asked = sulcus_demo::exercise::Asked {
            duration_s: Some(1.0),
            ..sulcus_demo::exercise::Asked::of("probing")
        };
        sulcus_demo::exercise::prepare(&asked, &sulcus_connection::progress::Steps)
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

    /// `36 mb 4,5` was once read as a depth of 4 mm and a recession of 5 mm.
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
        // A comma beside a blank, a sign or a letter is a separator.
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

    /// Each line of a file of readings gives its depth, or the word of its error.
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

    /// A device that calls in every period and is done.
    struct Talks;

    impl HandSource for Talks {
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

    impl EventDevice for Talks {
        fn events(&mut self) -> Vec<DeviceEvent> {
            vec![event(&parse("36 b 9", &SCENE).expect("a reading"))]
        }
    }

    #[test]
    fn a_person_is_heard_instead_of_the_device_until_nothing_is_said_any_more() {
        let (to, calls) = channel();
        let mut device = WithReadings::new(Talks, calls);
        let said = parse("36 b 3", &SCENE).expect("a reading");
        assert_eq!(device.events(), []);
        to.send(said).expect("it listens");
        to.send(said).expect("it listens");
        assert_eq!(device.events(), [event(&said), event(&said)]);
        assert!(!device.is_done());
        drop(to);
        assert_eq!(device.events(), []);
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

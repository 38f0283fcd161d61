//! Instructions of an instructor, typed as lines.

use sulcus_proto::control::Instruction;

/// Form of the lines, for messages.
pub(super) const FORM: &str = "pause S, resume S, limit S NEWTONS, note S TEXT, flag S [TEXT], say S TEXT, ghost S FILE, ghost S off, end S, quit";

/// A typed line.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Typed {
    /// Instruction to a station.
    Instruct {
        station: String,
        instruction: Instruction,
    },
    /// End of the program.
    Quit,
}

/// Instruction of a line; `None` for an empty line.
///
/// # Errors
/// Sentence about an unknown word, a missing part or a number that is no force.
pub(super) fn parse(line: &str) -> Result<Option<Typed>, String> {
    let line = line.trim();
    let (verb, rest) = split(line);
    let (station, text) = split(rest);
    let instruction = match verb {
        "" => return Ok(None),
        "quit" | "q" => return Ok(Some(Typed::Quit)),
        "pause" => Instruction::Pause,
        "resume" => Instruction::Resume,
        "limit" => Instruction::ForceLimit(newtons(text)?),
        "note" => Instruction::Note(some(text, "note")?),
        "flag" => Instruction::Flag(text.to_owned()),
        "say" => Instruction::Say(some(text, "message")?),
        "ghost" if text == "off" => Instruction::Ghost(String::new()),
        "ghost" => Instruction::Ghost(some(text, "ghost")?),
        "end" => Instruction::End,
        other => {
            return Err(format!(
                "`{}` is unknown, expected one of: {FORM}",
                other.escape_debug()
            ));
        }
    };
    if station.is_empty() {
        return Err(format!("the station is missing after `{verb}`"));
    }
    let takes_text = matches!(verb, "limit" | "note" | "flag" | "say" | "ghost");
    if !takes_text && !text.is_empty() {
        return Err(format!(
            "`{}` is left over after `{verb} {station}`",
            text.escape_debug()
        ));
    }
    Ok(Some(Typed::Instruct {
        station: station.to_owned(),
        instruction,
    }))
}

/// First word, and the rest.
fn split(text: &str) -> (&str, &str) {
    text.split_once(char::is_whitespace)
        .map_or((text, ""), |(word, rest)| (word, rest.trim()))
}

fn some(text: &str, name: &str) -> Result<String, String> {
    if text.is_empty() {
        return Err(format!("the text of the {name} is missing"));
    }
    Ok(text.to_owned())
}

fn newtons(text: &str) -> Result<f32, String> {
    match text.parse::<f32>() {
        Ok(force) if force.is_finite() && force >= 0.0 => Ok(force),
        _ => Err(format!(
            "`{}` is no force in newtons; 0 is the limit of the scene",
            text.escape_debug()
        )),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_line_is_its_instruction() {
        let cases = [
            ("pause a", Instruction::Pause),
            ("  resume   a ", Instruction::Resume),
            ("limit a 0.5", Instruction::ForceLimit(0.5)),
            (
                "note a hold it  flat",
                Instruction::Note("hold it  flat".into()),
            ),
            ("flag a", Instruction::Flag(String::new())),
            ("say a slowly", Instruction::Say("slowly".into())),
            ("ghost a b c.mcap", Instruction::Ghost("b c.mcap".into())),
            ("ghost a off", Instruction::Ghost(String::new())),
            ("end a", Instruction::End),
        ];
        for (line, instruction) in cases {
            let station = "a".to_owned();
            let expected = Typed::Instruct {
                station,
                instruction,
            };
            assert_eq!(parse(line), Ok(Some(expected)), "{line}");
        }
        assert_eq!(parse("  "), Ok(None));
        assert_eq!(parse("quit"), Ok(Some(Typed::Quit)));
    }

    #[test]
    fn a_wrong_line_is_named_and_instructs_nobody() {
        for (line, named) in [
            ("stop a", "`stop` is unknown"),
            ("pause", "station is missing"),
            ("pause a b", "`b` is left over"),
            ("limit a", "no force"),
            ("limit a -1", "no force"),
            ("limit a NaN", "no force"),
            ("note a", "text of the note"),
        ] {
            let told = parse(line).expect_err(line);
            assert!(told.contains(named), "{line}: {told}");
        }
    }
}

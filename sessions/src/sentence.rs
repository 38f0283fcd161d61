//! An error with its causes as one line of text.

/// One line with the error and its causes, for standard error. A cause with which the line already ends is left out.
pub fn sentence(error: &anyhow::Error) -> String {
    error.chain().fold(String::new(), |said, cause| {
        let cause = cause.to_string();
        match said.as_str() {
            "" => cause,
            said if said.ends_with(&cause) => said.to_owned(),
            said => format!("{said}: {cause}"),
        }
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_cause_is_said_once() {
        let cause = std::io::Error::other("disk on fire");
        let error = anyhow::Error::new(cause).context("cannot write");
        assert_eq!(sentence(&error), "cannot write: disk on fire");
        let error = anyhow::anyhow!("disk on fire")
            .context("cannot write: disk on fire")
            .context("a.toml");
        assert_eq!(sentence(&error), "a.toml: cannot write: disk on fire");
        // A cause that stands elsewhere in the line is not left out.
        let error = anyhow::anyhow!("disk").context("disk.toml");
        assert_eq!(sentence(&error), "disk.toml: disk");
    }
}

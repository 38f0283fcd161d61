//! An error as people read it.

/// The error and its causes in one line, for standard error; a cause that the line already ends with is not said twice.
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
        // What only happens to stand somewhere before is not the cause told.
        let error = anyhow::anyhow!("disk").context("disk.toml");
        assert_eq!(sentence(&error), "disk.toml: disk");
    }
}

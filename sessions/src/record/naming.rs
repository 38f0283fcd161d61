//! File names of recordings, `FOLDER/TIME-EXERCISE.mcap`: sorted by time, never the name of an existing file.

use std::path::{Path, PathBuf};

use crate::record::header::SessionHeader;
use crate::record::key::StationKey;
use crate::record::recorder::{RecordError, Recorder};
use crate::record::utc::utc;

/// Largest number of sessions that begin within the same second in the same folder.
const ATTEMPTS: u32 = 1000;

impl Recorder {
    /// New recording in `folder`, as by [`Recorder::create`], and its path. The name consists of the header's start and
    /// exercise, and no file has it yet.
    ///
    /// # Errors
    /// The file cannot be written, or a thousand sessions began in this second.
    pub fn create_in(
        folder: &Path,
        header: &SessionHeader,
        key: &StationKey,
    ) -> Result<(Self, PathBuf), RecordError> {
        let exercise = header.exercise_name.replace(['/', '\\'], "-");
        let stem = format!("{}-{exercise}", utc(header.started_unix_ns));
        let mut attempt = 1;
        loop {
            let name = match attempt {
                1 => format!("{stem}.mcap"),
                n => format!("{stem}-{n}.mcap"),
            };
            let path = folder.join(name);
            match Self::create(&path, header, key.clone()) {
                Err(RecordError::Exists(_)) if attempt < ATTEMPTS => attempt += 1,
                Ok(recorder) => return Ok((recorder, path)),
                Err(error) => return Err(error),
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn two_sessions_of_one_second_get_two_names() {
        let folder = tempfile::tempdir().expect("a folder");
        let mut header = SessionHeader::new(Vec::new());
        header.exercise_name = "hard/wedge".into();
        header.started_unix_ns = 1_795_241_730_000_000_000;
        let key = StationKey::from_seed([7; 32]);
        let names: Vec<_> = (0..2)
            .map(|_| {
                let (_, path) = Recorder::create_in(folder.path(), &header, &key).expect("creates");
                path.file_name()
                    .expect("a name")
                    .to_string_lossy()
                    .into_owned()
            })
            .collect();
        assert_eq!(
            names,
            [
                "20261121T061530Z-hard-wedge.mcap",
                "20261121T061530Z-hard-wedge-2.mcap"
            ]
        );
    }
}

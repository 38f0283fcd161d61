//! File names of recordings, `FOLDER/TIME-EXERCISE.mcap`: sorted by time, never the name of an existing file.

use std::path::{Path, PathBuf};

use crate::record::header::SessionHeader;
use crate::record::key::StationKey;
use crate::record::recorder::{RecordError, Recorder};

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

/// Time since 1970 as `YYYYMMDDTHHMMSSZ`.
pub fn utc(unix_ns: u64) -> String {
    let seconds = unix_ns / 1_000_000_000;
    let (days, second) = (seconds / 86_400, seconds % 86_400);
    let (hour, minute, second) = (second / 3600, second / 60 % 60, second % 60);
    // Days to a Gregorian date with years that begin in March. Source: Hinnant, "chrono-compatible low-level date
    // algorithms", without the part for dates before 1970.
    let z = days + 719_468;
    let (era, day_of_era) = (z / 146_097, z % 146_097);
    let year_of_era =
        (day_of_era - day_of_era / 1460 + day_of_era / 36_524 - day_of_era / 146_096) / 365;
    let day_of_year = day_of_era - (365 * year_of_era + year_of_era / 4 - year_of_era / 100);
    let from_march = (5 * day_of_year + 2) / 153;
    let day = day_of_year - (153 * from_march + 2) / 5 + 1;
    let month = if from_march < 10 {
        from_march + 3
    } else {
        from_march - 9
    };
    let year = era * 400 + year_of_era + u64::from(month <= 2);
    format!("{year:04}{month:02}{day:02}T{hour:02}{minute:02}{second:02}Z")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn dates_are_gregorian() {
        // Expected values by `date -u -d @N`.
        let cases = [
            (0, "19700101T000000Z"),
            (951_782_399, "20000228T235959Z"),
            (951_782_400, "20000229T000000Z"),
            (1_704_067_199, "20231231T235959Z"),
            (1_795_241_730, "20261121T061530Z"),
            (4_107_542_400, "21000301T000000Z"),
        ];
        for (seconds, text) in cases {
            assert_eq!(utc(seconds * 1_000_000_000), text);
        }
    }

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

//! Dates for people, UTC.

use sulcus_sessions::record::utc::utc;

/// Seconds of a day.
pub const DAY_S: u64 = 86_400;

/// Present time, seconds since 1970.
pub fn now_s() -> u64 {
    sulcus_link::clock::unix_ns() / 1_000_000_000
}

/// Date of a time in seconds since 1970, such as `2026-11-26`, UTC.
pub fn day(unix_s: u64) -> String {
    let text = utc(unix_s.saturating_mul(1_000_000_000));
    format!("{}-{}-{}", &text[..4], &text[4..6], &text[6..8])
}

/// Date and time in seconds since 1970, such as `2026-11-26 04:20 UTC`.
pub fn minute(unix_s: u64) -> String {
    let text = utc(unix_s.saturating_mul(1_000_000_000));
    format!("{} {}:{} UTC", day(unix_s), &text[9..11], &text[11..13])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_date_reads_as_people_write_it() {
        // Expected value by `date -u -d @1795241730`.
        assert_eq!(day(1_795_241_730), "2026-11-21");
        assert_eq!(minute(1_795_241_730), "2026-11-21 06:15 UTC");
        // Any time is a text of the same length.
        assert_eq!(day(u64::MAX).len(), 10);
    }
}

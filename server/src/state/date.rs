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

/// Begin of a day such as `2026-12-01`, seconds since 1970, UTC. `None`: no day from 1970 to 9999.
pub fn parse_day(text: &str) -> Option<u64> {
    let mut parts = text.split('-');
    let mut number = |digits: usize| {
        let part = parts.next()?;
        let is_plain = part.len() == digits && part.bytes().all(|c| c.is_ascii_digit());
        is_plain.then(|| part.parse::<u64>().ok())?
    };
    let (year, month, day) = (number(4)?, number(2)?, number(2)?);
    if parts.next().is_some() || year < 1970 {
        return None;
    }
    let is_leap = |year: u64| {
        year.is_multiple_of(4) && (!year.is_multiple_of(100) || year.is_multiple_of(400))
    };
    let lengths = [
        31,
        28 + u64::from(is_leap(year)),
        31,
        30,
        31,
        30,
        31,
        31,
        30,
        31,
        30,
        31,
    ];
    let before = usize::try_from(month.checked_sub(1)?).ok()?;
    if !(1..=*lengths.get(before)?).contains(&day) {
        return None;
    }
    let of_years: u64 = (1970..year)
        .map(|year| 365 + u64::from(is_leap(year)))
        .sum();
    let of_months: u64 = lengths.iter().take(before).sum();
    Some((of_years + of_months + day - 1) * DAY_S)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn days_are_read_as_they_are_written() {
        // Every day of 400 years, whose number is that of the former plus one.
        for count in 0..146_097 {
            let at = count * DAY_S;
            assert_eq!(parse_day(&day(at)), Some(at), "{}", day(at));
        }
        for text in [
            "",
            "2026-13-01",
            "2026-00-01",
            "2026-02-29",
            "2026-2-9",
            "2026-01-01-01",
            "+026-01-01",
            "1969-12-31",
        ] {
            assert_eq!(parse_day(text), None, "{text}");
        }
    }

    #[test]
    fn a_date_reads_as_people_write_it() {
        // Expected value by `date -u -d @1795241730`.
        assert_eq!(day(1_795_241_730), "2026-11-21");
        assert_eq!(minute(1_795_241_730), "2026-11-21 06:15 UTC");
        // Any time is a text of the same length.
        assert_eq!(day(u64::MAX).len(), 10);
    }
}

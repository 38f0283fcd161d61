//! Conditions of one direction of a network.

use std::fmt;
use std::time::Duration;

/// Conditions of one direction. [`Conditions::default`] carries every packet at once.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Conditions {
    /// Mean delay of a packet that waits in no queue, one way.
    pub delay: Duration,
    /// Half the width of the uniform distribution of the delay.
    pub jitter: Duration,
    /// Whether each packet has a delay of its own, so that packets overtake. Otherwise packets wait for slots, as in a
    /// mobile network: a slot comes every twice the jitter, and all waiting packets arrive together.
    pub reorder: bool,
    /// Mean share of the packets that are lost, 0 to 1.
    pub loss: f64,
    /// Mean number of packets that are lost in a row, at least 1. Losses follow the chain of two states of Gilbert
    /// (1960, doi:10.1002/j.1538-7305.1960.tb03959.x) that loses every packet in its bad state.
    pub burst: f64,
    /// Share of the packets that arrive twice, 0 to 1.
    pub duplicate: f64,
    /// Rate of the slowest link, bits per second of UDP payload and 28 bytes of headers. `None`: no limit.
    pub rate: Option<u64>,
    /// Longest wait in the queue before the slowest link. A packet that would wait longer is lost.
    pub queue: Duration,
    /// Regular stall: period and length. A packet that is sent in a stall arrives after its end.
    pub stall: Option<(Duration, Duration)>,
}

impl Default for Conditions {
    fn default() -> Self {
        Self {
            delay: Duration::ZERO,
            jitter: Duration::ZERO,
            reorder: true,
            loss: 0.0,
            burst: 1.0,
            duplicate: 0.0,
            rate: None,
            queue: Duration::from_millis(100),
            stall: None,
        }
    }
}

impl Conditions {
    /// Checks all fields.
    ///
    /// # Errors
    /// A share outside 0 to 1, a burst below 1 or too short for the loss, a rate of zero, a stall without an end.
    pub fn check(&self) -> Result<(), ConditionsError> {
        let refuse = |field, found: String, expected| {
            Err(ConditionsError {
                field,
                found,
                expected,
            })
        };
        // A share of one would need a bad state without an end; an outage states that better.
        if !(0.0..1.0).contains(&self.loss) {
            return refuse("loss", self.loss.to_string(), "at least 0 and below 1");
        }
        if !(0.0..=1.0).contains(&self.duplicate) {
            return refuse("duplicate", self.duplicate.to_string(), "0 to 1");
        }
        if !self.burst.is_finite() || self.burst < 1.0 {
            return refuse("burst", self.burst.to_string(), "at least 1");
        }
        if self.worsening() > 1.0 {
            return refuse(
                "burst",
                self.burst.to_string(),
                "at least loss / (1 - loss), the shortest mean of that loss",
            );
        }
        if self.rate == Some(0) {
            return refuse("rate", "0".into(), "above 0 bits per second");
        }
        if let Some((period, length)) = self.stall
            && length >= period
        {
            return refuse("stall", format!("{length:?}"), "shorter than its period");
        }
        if self.jitter > self.delay {
            return refuse(
                "jitter",
                format!("{:?}", self.jitter),
                "at most the mean delay",
            );
        }
        Ok(())
    }

    /// Probability of the step from the good state to the bad one, for the stated mean loss and mean burst.
    pub(crate) fn worsening(&self) -> f64 {
        self.loss / (self.burst * (1.0 - self.loss))
    }
}

/// A field of [`Conditions`] outside its range.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ConditionsError {
    /// Name of the field.
    pub field: &'static str,
    /// Value found.
    pub found: String,
    /// Range of the field.
    pub expected: &'static str,
}

impl fmt::Display for ConditionsError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self {
            field,
            found,
            expected,
        } = self;
        write!(f, "{field}: found {found}, expected {expected}")
    }
}

impl std::error::Error for ConditionsError {}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_field_outside_its_range_is_named() {
        let ms = Duration::from_millis;
        let good = Conditions {
            delay: ms(10),
            ..Conditions::default()
        };
        assert_eq!(good.check(), Ok(()));
        let bad = |change: fn(&mut Conditions)| {
            let mut conditions = good;
            change(&mut conditions);
            conditions.check().expect_err("a refusal").field
        };
        assert_eq!(bad(|c| c.loss = 1.0), "loss");
        assert_eq!(bad(|c| c.loss = f64::NAN), "loss");
        assert_eq!(bad(|c| c.duplicate = -0.1), "duplicate");
        assert_eq!(bad(|c| c.burst = 0.5), "burst");
        assert_eq!(bad(|c| c.loss = 0.9), "burst");
        assert_eq!(bad(|c| c.rate = Some(0)), "rate");
        assert_eq!(bad(|c| c.jitter = Duration::from_secs(1)), "jitter");
        let endless = (Duration::from_secs(1), Duration::from_secs(1));
        let stalled = Conditions {
            stall: Some(endless),
            ..good
        };
        assert_eq!(stalled.check().expect_err("a refusal").field, "stall");
    }
}

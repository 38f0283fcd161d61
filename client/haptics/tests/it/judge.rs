//! Rules of the contract, written without the code under test.
//!
//! # Time
//! The judge sees the time that the door sees. A call at which the clock stands still or steps back counts as one
//! period for everything that takes force away, and as nothing for everything that gives force.
//!
//! # Slew
//! A decrease is no blow, so the limit applies to the distance from the new force to the segment between zero and the
//! former force. An elapsed time above 2 ms counts as 2 ms: a late call must not give a blow. Towards zero the whole
//! change is bounded by the elapsed time up to 20 ms; [`Terms::exact_slew`] selects this second rule for worlds in
//! which nothing else than watchdog, silence and interlock reduces a force.
//!
//! # Continuous force
//! A force counts from its call to the next call. The mean square with the time constant of the model stays within the
//! square of the continuous force. A device that was held up for more than 20 ms may exceed this, as nothing can take
//! the force away meanwhile; the next force is then at most the continuous force.

use std::fmt::Display;

use sulcus_core::{Pose, Vec3, Wrench};
use sulcus_haptics::{Unready, Wanted};

/// Limits of a device and its session.
#[derive(Clone, Copy, Debug)]
pub struct Terms {
    pub force: Bound,
    pub torque: Bound,
    pub period_ms: f64,
    pub has_torque: bool,
    pub clutch: u16,
    pub exact_slew: bool,
}

/// Bounds of force or torque, newtons or newton-metres.
#[derive(Clone, Copy, Debug)]
pub struct Bound {
    pub peak: f64,
    pub slew_per_ms: f64,
    pub lasting: f64,
    pub time_s: f64,
}

/// Inputs of one call of the door.
#[derive(Clone, Copy, Debug)]
pub struct Call<'a> {
    pub now_ns: u64,
    pub pose: Result<&'a Pose, Unready>,
    pub buttons: u16,
    pub order: &'a Wanted,
    /// Whether the driver reported an error before this call.
    pub driver_trip: bool,
}

/// Counts of the judge, against tests that judge nothing.
#[derive(Clone, Copy, Debug, Default)]
pub struct Seen {
    pub calls: u64,
    pub starts: u64,
    /// Calls with more than half of the peak.
    pub strong: u64,
    /// Calls in the rise with a force.
    pub rising: u64,
    /// Ends of a force by silence, by the interlock, by leaving.
    pub silenced: u64,
    pub stopped: u64,
    pub left: u64,
    /// Calls at which the mean square is above 95 % of the square of the continuous force.
    pub hot: u64,
    /// Largest mean square after a call within 20 ms, as a share of the square of the continuous force.
    pub most_heat: f64,
    /// The same after any call.
    pub most_heat_ever: f64,
}

/// State of the judgement of one door.
pub struct Judge {
    terms: Terms,
    pub seen: Seen,
    before: Wrench,
    last_ns: Option<u64>,
    heat: [f64; 2],
    stamp_ns: Option<u64>,
    age_ms: f64,
    leaving_ms: Option<f64>,
    /// Time since the start, milliseconds; `None`: the force is off.
    on_ms: Option<f64>,
    off_ms: f64,
    /// Whether the release of the clutch starts the force again.
    resumes: bool,
    buttons: u16,
    presses: u32,
    was_absent: bool,
    at: Option<Vec3>,
}

const HOLD_MS: f64 = 5.0;
const SILENT_MS: f64 = 20.0;
const LATE_MS: f64 = 2.0;
const FALL_MS: f64 = 20.0;
const RISE_MS: f64 = 500.0;
/// Numbers within this share are equal.
const ROUNDING: f64 = 1e-9;
/// Tolerance of the mean square: the door may integrate with the step of the device.
const HEAT: f64 = 1.01;

fn length(v: &Vec3) -> f64 {
    let square = v.dot(v);
    if square > 1e-200 && square < 1e200 {
        return square.sqrt();
    }
    // `hypot` needs no square of a denormal or huge number.
    v.x.hypot(v.y).hypot(v.z)
}

fn smooth(x: f64) -> f64 {
    let x = x.clamp(0.0, 1.0);
    x * x * (3.0 - 2.0 * x)
}

/// Distance from `point` to the segment from zero to `end`.
fn off_segment(point: &Vec3, end: &Vec3) -> f64 {
    let square = end.dot(end);
    let along = if square > 0.0 {
        (point.dot(end) / square).clamp(0.0, 1.0)
    } else {
        0.0
    };
    length(&(point - end * along))
}

fn is_valid(pose: &Pose) -> bool {
    let q = pose.orientation.coords;
    let turn = q.iter().map(|x| x * x).sum::<f64>().sqrt();
    // No arm of a device reaches ten metres.
    pose.position.iter().all(|x| x.is_finite())
        && length(&pose.position) <= 10.0
        && turn > 0.99
        && turn < 1.01
}

fn require(holds: bool, what: impl Display, found: f64, bound: f64) -> Result<(), String> {
    if holds {
        Ok(())
    } else {
        Err(format!("{what}: {found:e}, bound {bound:e}"))
    }
}

impl Judge {
    pub fn new(terms: Terms) -> Self {
        Self {
            terms,
            seen: Seen::default(),
            before: Wrench::ZERO,
            last_ns: None,
            heat: [0.0; 2],
            stamp_ns: None,
            age_ms: 0.0,
            leaving_ms: None,
            on_ms: None,
            off_ms: 0.0,
            resumes: false,
            buttons: 0,
            presses: 0,
            was_absent: true,
            at: None,
        }
    }

    /// Judges the answer to one call.
    pub fn call(&mut self, call: &Call<'_>, answer: &Wrench) -> Result<(), String> {
        let step_ms = self
            .last_ns
            .map_or(0.0, |last| call.now_ns.saturating_sub(last) as f64 * 1e-6);
        let taking_ms = if step_ms > 0.0 {
            step_ms
        } else {
            self.terms.period_ms
        };
        let is_first = self.last_ns.replace(call.now_ns).is_none();
        self.seen.calls += 1;
        self.warm(taking_ms)?;
        self.listen(call, taking_ms);
        self.interlock(call, step_ms, taking_ms);
        let giving_ms = if is_first {
            self.terms.period_ms
        } else {
            step_ms.min(LATE_MS)
        };
        self.judge(answer, giving_ms, taking_ms)?;
        self.before = *answer;
        Ok(())
    }

    /// Accounts for the force of the former call up to this call.
    fn warm(&mut self, ms: f64) -> Result<(), String> {
        let parts = [
            (&self.before.force, self.terms.force),
            (&self.before.torque, self.terms.torque),
        ];
        for (heat, (held, bound)) in self.heat.iter_mut().zip(parts) {
            let (square, most) = (held.dot(held), bound.lasting * bound.lasting);
            if most == 0.0 {
                continue;
            }
            let former = *heat;
            *heat = square + (former - square) * (-ms * 1e-3 / bound.time_s).exp();
            let share = *heat / most;
            self.seen.most_heat_ever = self.seen.most_heat_ever.max(share);
            self.seen.hot += u64::from(share > 0.95);
            if ms <= FALL_MS && former <= most * HEAT {
                self.seen.most_heat = self.seen.most_heat.max(share);
                require(share <= HEAT, "mean square", share, HEAT)?;
            }
        }
        Ok(())
    }

    fn listen(&mut self, call: &Call<'_>, ms: f64) {
        if call.order.heard_ns == self.stamp_ns {
            self.age_ms += ms;
        } else {
            self.stamp_ns = call.order.heard_ns;
            self.age_ms = self
                .stamp_ns
                .map_or(0.0, |at| call.now_ns.saturating_sub(at) as f64 * 1e-6);
        }
        self.leaving_ms = call
            .order
            .leaving
            .then(|| self.leaving_ms.map_or(0.0, |since| since + ms));
    }

    /// Whether nothing is known that forbids a start.
    fn is_free(&self, order: &Wanted) -> bool {
        self.stamp_ns.is_some()
            && self.age_ms < SILENT_MS
            && length(&order.wrench.force) < 0.02
            && length(&order.wrench.torque) < 0.0008
    }

    fn interlock(&mut self, call: &Call<'_>, step_ms: f64, taking_ms: f64) {
        let own = !self.terms.clutch;
        let newly = call.buttons & !self.buttons & own != 0 || call.order.presses > self.presses;
        let pressed = newly && !self.was_absent;
        let clutched = call.buttons & self.terms.clutch != 0;
        (self.buttons, self.presses) = (call.buttons, call.order.presses);
        self.was_absent = call.pose.is_err();
        let pose = call.pose.ok().filter(|pose| is_valid(pose));
        let place = pose.map(|pose| pose.position);
        let from = std::mem::replace(&mut self.at, place);
        let jumped = match (from, place) {
            (Some(from), Some(to)) => length(&(to - from)) > 5e-3 && step_ms <= 2.2,
            _ => false,
        };
        let rests = self.before == Wrench::ZERO;
        if pose.is_none() || jumped || call.driver_trip {
            self.resumes = false;
            self.stop();
        }
        if clutched && self.on_ms.is_some() {
            self.resumes = true;
            self.stop();
        }
        match &mut self.on_ms {
            Some(since) => *since += step_ms.min(LATE_MS),
            None => {
                self.off_ms += taking_ms;
                let starts = (pressed && self.is_free(call.order)) || self.resumes;
                if starts && pose.is_some() && !jumped && !clutched && rests {
                    (self.on_ms, self.resumes) = (Some(0.0), false);
                    self.seen.starts += 1;
                }
            }
        }
    }

    fn stop(&mut self) {
        if self.on_ms.take().is_some() {
            self.seen.stopped += u64::from(self.before != Wrench::ZERO);
            self.off_ms = 0.0;
        }
    }

    fn judge(&mut self, answer: &Wrench, giving_ms: f64, taking_ms: f64) -> Result<(), String> {
        let terms = self.terms;
        let [was, is] = [self.before, *answer].map(|wrench| wrench != Wrench::ZERO);
        for (name, after, before, bound, heat) in [
            (
                "force",
                &answer.force,
                &self.before.force,
                terms.force,
                self.heat[0],
            ),
            (
                "torque",
                &answer.torque,
                &self.before.torque,
                terms.torque,
                self.heat[1],
            ),
        ] {
            let size = length(after);
            let at_most = |what: &str, found: f64, most: f64| {
                let rounding = ROUNDING * (1.0 + bound.peak);
                require(
                    found <= most + rounding,
                    format_args!("{name}, {what}"),
                    found,
                    most,
                )
            };
            // In this form a NaN is no number within a bound.
            require(
                after.iter().all(|x| x.is_finite()),
                format_args!("{name}, finite"),
                size,
                0.0,
            )?;
            if name == "torque" && !terms.has_torque {
                require(
                    *after == Vec3::zeros(),
                    "torque of a device without torque",
                    size,
                    0.0,
                )?;
            }
            require(
                size <= bound.peak * (1.0 + ROUNDING),
                format_args!("{name}, peak"),
                size,
                bound.peak,
            )?;
            at_most(
                "slew",
                off_segment(after, before),
                bound.slew_per_ms * giving_ms,
            )?;
            if terms.exact_slew {
                // The fall of a silence takes the force away whatever its direction: the slew limit comes on top.
                let both = if self.age_ms > HOLD_MS {
                    giving_ms
                } else {
                    0.0
                };
                let most = bound.slew_per_ms * (taking_ms.min(FALL_MS) + both);
                at_most("exact slew", length(&(after - before)), most)?;
            }
            if heat > bound.lasting * bound.lasting * HEAT {
                at_most("force of hot motors", size, bound.lasting * HEAT)?;
            }
            match self.on_ms {
                Some(since) => at_most("rise", size, bound.peak * smooth(since / RISE_MS))?,
                None => at_most("growth while the force is off", size, length(before))?,
            }
        }
        let size = length(&answer.force) + length(&answer.torque);
        if self.stamp_ns.is_none() || self.age_ms >= SILENT_MS {
            require(!is, "zero after silence", size, self.age_ms)?;
        }
        self.seen.silenced += u64::from(self.age_ms > HOLD_MS && was && !is);
        if self.on_ms.is_none() && (self.off_ms >= FALL_MS || self.seen.starts == 0) {
            require(!is, "zero while the force is off", size, self.off_ms)?;
        }
        if self.leaving_ms.is_some_and(|since| since >= FALL_MS) {
            require(
                !is,
                "zero after leaving",
                size,
                self.leaving_ms.unwrap_or(0.0),
            )?;
        }
        self.seen.left += u64::from(self.leaving_ms.is_some() && was && !is);
        self.seen.strong += u64::from(length(&answer.force) > 0.5 * terms.force.peak);
        self.seen.rising += u64::from(is && self.on_ms.is_some_and(|since| since < RISE_MS));
        Ok(())
    }
}

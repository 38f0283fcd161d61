//! Opening of hands: checks, pairs of arm and grip, and the measured period.

use std::time::{Duration, Instant};

use sulcus_haptics::device::{HandInfo, Reported};
use sulcus_haptics::model::shipped_for;

use super::NAME;
use super::address::Address;
use super::connect::{Connected, connect};
use super::connector::Connector;
use super::device::HaplyDevice;
use super::events::Events;
use super::flow::Flow;
use super::hand::Hand;
use super::message::message;
use super::pairing::{Pair, pair};

/// Time limit of the connection.
const MOST: Duration = Duration::from_millis(3_000);
/// Number of messages of the measurement of the period, and its time limit.
const MEASURED: usize = 200;
const MEASURING: Duration = Duration::from_millis(300);
/// Period of a model that is not known, nanoseconds.
const UNKNOWN_NS: u64 = 1_000_000;
/// Shortest and longest period, nanoseconds: 4 kHz and 500 Hz.
const SHORTEST_NS: u64 = 250_000;
const LONGEST_NS: u64 = 2_000_000;

/// Opens the hands of `names` at the service of `address`.
///
/// # Errors
/// One sentence with the remedy.
pub(super) fn open(address: &str, names: &[String]) -> Result<HaplyDevice, String> {
    let address = Address::parse(address)?;
    if names.is_empty() {
        return Err("no arm is named, expected the serial number of one or more: look at the list of devices".into());
    }
    let mut connected = connect(&address, MOST).map_err(|no| no.sentence)?;
    let pairs = pair(names, &connected.inventory)?;
    if let Some(sentence) = connected.against(pairs.iter().map(|pair| pair.arm.as_str())) {
        return Err(sentence);
    }
    for pair in &pairs {
        let arm = connected.inventory.arm(&pair.arm);
        if arm.is_some_and(|arm| arm.status.in_use == Some(true)) {
            return Err(format!(
                "another program uses the arm {}: close that program",
                pair.arm
            ));
        }
    }
    remark(&connected, &pairs);
    let hands: Vec<Hand> = pairs
        .iter()
        .map(|pair| Hand::new(pair.clone(), &connected.inventory))
        .collect();
    let answer_ns = measure(&mut connected, &hands).map_err(|cause| {
        format!("the Haply service at {address} gives no replies ({cause}): restart the service")
    })?;
    let models: Vec<String> = pairs
        .iter()
        .map(|pair| {
            connected
                .inventory
                .arm(&pair.arm)
                .map(|arm| arm.model.clone())
                .unwrap_or_default()
        })
        .collect();
    let wanted_ns = models
        .iter()
        .map(|model| period_of(model))
        .max()
        .unwrap_or(UNKNOWN_NS);
    let period_ns = period(wanted_ns, answer_ns);
    if period_ns > UNKNOWN_NS {
        tracing::warn!(
            "the Haply service at {address} answers {} messages a second, expected 1000: close other programs",
            1_000_000_000 / period_ns
        );
    }
    let infos = pairs.iter().zip(models).map(|(pair, model)| HandInfo {
        library: NAME,
        model,
        serial: pair.arm.clone(),
        motion_dof: if pair.grip.is_some() { 6 } else { 3 },
        force_axes: 3,
        torque_axes: 0,
        period_ns,
        reported: Reported::default(),
    });
    let no_thread = |error: std::io::Error| {
        format!("the system gives no thread ({error}): close other programs")
    };
    let events = address
        .events()
        .map(Events::start)
        .transpose()
        .map_err(no_thread)?;
    Ok(HaplyDevice {
        infos: infos.collect(),
        hands,
        flow: Some(Flow::new(connected.line, connected.field, false)),
        period_ns,
        connector: Connector::start(&address).map_err(no_thread)?,
        events,
        address,
    })
}

fn remark(connected: &Connected, pairs: &[Pair]) {
    for remark in &connected.remarks {
        tracing::warn!("{remark}");
    }
    for pair in pairs.iter().filter(|pair| pair.by_order) {
        let grip = pair.grip.as_ref().map_or("", |(_, id)| id);
        tracing::warn!(
            "the order of the Haply service puts the grip {grip} on the arm {arm}: name {arm}+{grip} to fix it",
            arm = pair.arm
        );
    }
}

/// Period of the shipped model that the service names `model`, nanoseconds.
fn period_of(model: &str) -> u64 {
    let rate_hz = shipped_for(NAME, model).map(|model| model.rate_hz.value);
    rate_hz.map_or(UNKNOWN_NS, |rate_hz| (1e9 / rate_hz) as u64)
}

/// Period for a wanted one and the time in which the service answers, nanoseconds: a quarter of the period is spare.
fn period(wanted_ns: u64, answer_ns: u64) -> u64 {
    let answered_ns = answer_ns
        .saturating_add(answer_ns / 4)
        .next_multiple_of(10_000);
    wanted_ns.max(answered_ns).clamp(SHORTEST_NS, LONGEST_NS)
}

/// Measures the time in which the service answers messages with zero force, nanoseconds: nine of ten are faster.
fn measure(connected: &mut Connected, hands: &[Hand]) -> Result<u64, String> {
    let begin = Instant::now();
    let mut times = Vec::with_capacity(MEASURED);
    while times.len() < MEASURED && (times.is_empty() || begin.elapsed() < MEASURING) {
        let orders = hands.iter().map(|hand| hand.order());
        let text = message(times.is_empty(), connected.field, orders);
        let sent = Instant::now();
        connected.line.send(text)?;
        connected.line.within(Duration::from_millis(500))?;
        times.push(sent.elapsed().as_nanos() as u64);
    }
    times.sort_unstable();
    Ok(times[times.len() * 9 / 10])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_period_is_that_of_the_model_if_the_service_answers() {
        assert_eq!(period_of("inverse3"), 250_000);
        assert_eq!(period_of("unheard of"), UNKNOWN_NS);
        assert_eq!(period(250_000, 80_000), 250_000);
        assert_eq!(period(250_000, 400_000), 500_000);
        assert_eq!(period(250_000, 7_000_000), LONGEST_NS);
        assert_eq!(period(100_000, 10_000), SHORTEST_NS);
    }
}

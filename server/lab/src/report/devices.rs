//! Real devices in the closed loop: chosen coupling, limit cycle at that coupling, and coupling at which a buzz begins.

use serde::Serialize;
use sulcus_cases::device_loop::onset::{LARGEST, Onset, onset};
use sulcus_cases::device_loop::{LIMIT_N, devices};
use sulcus_cases::find;
use sulcus_haptics::DeviceModel;

use super::together::on_all_cores;

/// Cases of the section: rigid teeth, wedge, pocket, tongue.
const CASES: [&str; 4] = ["teeth-gap-0.02", "wedge", "pocket-0.65", "tongue-10-k2"];
/// Case of a quick report.
const QUICK: [&str; 1] = ["wedge"];

/// One device in one case: the loudest of six rests, with a light and a firm grip at three moments in contact. The link
/// has no delay.
#[derive(Clone, Debug, Serialize)]
pub(crate) struct DeviceLoop {
    /// Name of the hard case.
    pub(crate) case: &'static str,
    /// Name of the device.
    pub(crate) device: String,
    /// Trust in the figures of the device: `guess`, `vendor` or `measured`.
    pub(crate) figures: &'static str,
    /// Chosen coupling: the softer of scene and device, N/m and N m/rad.
    pub(crate) coupling_n_per_m: f64,
    pub(crate) coupling_nm_per_rad: f64,
    /// Root mean square of the displayed force above 20 Hz at this coupling, 1.0 to 1.5 s after the hand's rest, newtons.
    pub(crate) buzz_n: f64,
    /// The same of the whole force about its mean.
    pub(crate) swing_n: f64,
    /// Mean displayed force in that time, newtons.
    pub(crate) force_n: f64,
    /// Mean force of the simulation in that time, newtons. The passivity controller takes the difference.
    pub(crate) sent_n: f64,
    /// Smallest coupling with a buzz of more than 0.05 N behind the whole door, as a multiple of the chosen one; `null`:
    /// none up to 40 times. The passivity controller takes the force of a coupling that is too stiff.
    pub(crate) controlled_onset_factor: Option<f64>,
    /// Smallest coupling with a buzz of more than 0.05 N without the passivity controller, as a multiple of the chosen
    /// coupling. `null`: none up to 40 times.
    pub(crate) onset_factor: Option<f64>,
    /// The same coupling, N/m.
    pub(crate) onset_n_per_m: Option<f64>,
    /// Frequency of that buzz, Hz.
    pub(crate) onset_hz: Option<f64>,
}

impl DeviceLoop {
    /// Whether the device is quiet at the chosen coupling.
    pub(crate) fn holds(&self) -> bool {
        self.buzz_n <= LIMIT_N
    }

    /// The onset behind the whole door, in words.
    pub(crate) fn controlled_onset(&self) -> String {
        match self.controlled_onset_factor {
            Some(factor) => format!("{factor:.1} times"),
            None => format!("none up to {LARGEST} times"),
        }
    }

    /// The onset without the passivity controller, in words.
    pub(crate) fn onset(&self) -> String {
        match (self.onset_factor, self.onset_n_per_m, self.onset_hz) {
            (Some(factor), Some(n_per_m), Some(hz)) => {
                format!("{n_per_m:.0} N/m, {factor:.1} times, at {hz:.0} Hz")
            }
            _ => format!("none up to {LARGEST} times"),
        }
    }
}

/// Sentence about one device: chosen coupling, onset and margin over its cases.
pub(crate) fn sentences(all: &[DeviceLoop]) -> Vec<String> {
    let mut names: Vec<&str> = all.iter().map(|one| one.device.as_str()).collect();
    names.dedup();
    let sentence = |name: &str| {
        let of: Vec<&DeviceLoop> = all.iter().filter(|one| one.device == name).collect();
        let couplings = of.iter().map(|one| one.coupling_n_per_m);
        let (soft, stiff) =
            couplings.fold((f64::INFINITY, 0.0_f64), |(a, b), k| (a.min(k), b.max(k)));
        let chosen = if soft == stiff {
            format!("{stiff:.0} N/m")
        } else {
            format!("{soft:.0} to {stiff:.0} N/m")
        };
        let first = of
            .iter()
            .filter_map(|one| one.onset_factor.map(|factor| (factor, one)))
            .min_by(|a, b| a.0.total_cmp(&b.0));
        match first {
            Some((factor, one)) => format!(
                "{name}: the chosen coupling is {chosen}; without the passivity controller the first buzz begins at {:.0} N/m ({}), a margin of {factor:.1}.",
                one.onset_n_per_m.unwrap_or(f64::NAN),
                one.case
            ),
            None => format!(
                "{name}: the chosen coupling is {chosen}; without the passivity controller no buzz begins up to {LARGEST} times that coupling."
            ),
        }
    };
    names.into_iter().map(sentence).collect()
}

/// Measures all devices, in the order of the devices and then of the cases.
pub(super) fn measure(quick: bool, progress: &dyn Fn(f64)) -> Vec<DeviceLoop> {
    let models = devices();
    let cases: &[&'static str] = if quick { &QUICK } else { &CASES };
    let runs: Vec<(&DeviceModel, &'static str)> = models
        .iter()
        .flat_map(|model| cases.iter().map(move |case| (model, *case)))
        .collect();
    on_all_cores(&runs, progress, |&(model, name)| {
        let case = find(name).expect("in the table");
        let [alone, held] = [false, true].map(|controlled| onset(case, model, controlled));
        device_loop(name, model, (&alone, &held))
    })
}

fn device_loop(
    case: &'static str,
    model: &DeviceModel,
    (alone, held): (&Onset, &Onset),
) -> DeviceLoop {
    let Onset { factor, at, .. } = alone;
    let chosen = &held.chosen;
    DeviceLoop {
        case,
        device: model.name.clone(),
        figures: model.trust().name(),
        coupling_n_per_m: chosen.n_per_m,
        coupling_nm_per_rad: chosen.nm_per_rad,
        buzz_n: chosen.buzz_n,
        swing_n: chosen.swing_n,
        force_n: chosen.force_n,
        sent_n: chosen.sent_n,
        controlled_onset_factor: held.factor,
        onset_factor: *factor,
        onset_n_per_m: factor.map(|_| at.n_per_m),
        onset_hz: factor.map(|_| at.hertz),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_sentence_of_a_device_names_its_first_onset() {
        let one = |case, onset: Option<(f64, f64)>| DeviceLoop {
            case,
            device: "Touch".into(),
            figures: "guess",
            coupling_n_per_m: 500.0,
            coupling_nm_per_rad: 0.5,
            buzz_n: 0.001,
            swing_n: 0.001,
            force_n: 0.5,
            sent_n: 0.5,
            controlled_onset_factor: None,
            onset_factor: onset.map(|(factor, _)| factor),
            onset_n_per_m: onset.map(|(factor, _)| factor * 500.0),
            onset_hz: onset.map(|(_, hz)| hz),
        };
        let all = [
            one("wedge", Some((8.0, 90.0))),
            one("plate", Some((4.0, 70.0))),
        ];
        assert_eq!(
            sentences(&all),
            [
                "Touch: the chosen coupling is 500 N/m; without the passivity controller the first buzz begins at 2000 N/m (plate), a margin of 4.0."
            ]
        );
        assert_eq!(all[0].onset(), "4000 N/m, 8.0 times, at 90 Hz");
        assert!(sentences(&[one("wedge", None)])[0].ends_with("up to 40 times that coupling."));
    }
}

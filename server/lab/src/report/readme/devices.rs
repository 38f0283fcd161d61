//! Table of real devices in the closed loop.

use super::table::{Table, number};
use super::{COMMAND, yes_no};
use crate::report::{Report, sentences};

/// Chosen coupling, buzz and onset of each device in each case.
pub(super) fn couplings(report: &Report) -> Table {
    let rows = report.devices.iter().map(|one| {
        vec![
            one.device.clone(),
            format!("`{}`", one.case),
            number(one.coupling_n_per_m),
            number(one.buzz_n),
            yes_no(one.holds()),
            one.onset(),
            one.controlled_onset(),
            one.figures.to_owned(),
        ]
    });
    Table {
        caption: "Case: a hand without tremor that rests in contact, the loudest of three moments with a light and a firm grip, with the dynamics of a device's model file and its door; reference: 0.05 N above 20 Hz; quantities: rms of the displayed force above 20 Hz at the chosen coupling, and the coupling at which it passes the reference.".to_owned(),
        command: COMMAND.to_owned(),
        columns: vec![
            "device",
            "case",
            "chosen coupling, N/m",
            "buzz, N",
            "within the reference",
            "buzz begins without the controller at",
            "with the controller at",
            "figures",
        ],
        rows: rows.collect(),
        notes: sentences(&report.devices),
    }
}

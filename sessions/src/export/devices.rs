//! `devices.csv`: what the devices measured and displayed, a line for every sample.

use std::path::Path;

use sulcus_core::Scene;

use super::cells;
use super::error::ExportError;
use super::table::Table;
use crate::record::row::Row;

/// Columns. Times count as in `ticks.csv`; forces and torques are those that the device displayed, world axes, about
/// the device point.
const COLUMNS: [&str; 13] = [
    "tick",
    "time_s",
    "tool",
    "name",
    "sequence",
    "device_time_ns",
    "age_us",
    "force_x_n",
    "force_y_n",
    "force_z_n",
    "torque_x_nm",
    "torque_y_nm",
    "torque_z_nm",
];

pub(super) struct DeviceTable {
    table: Table,
    names: Vec<String>,
    began_unix_ns: u64,
}

impl DeviceTable {
    pub fn create(folder: &Path, scene: &Scene, began_unix_ns: u64) -> Result<Self, ExportError> {
        let table = Table::create(folder.join("devices.csv"), COLUMNS)?;
        Ok(Self {
            table,
            names: scene.tools.iter().map(|tool| tool.name.clone()).collect(),
            began_unix_ns,
        })
    }

    /// Writes the samples of a row.
    pub fn row(&mut self, row: &Row) -> Result<(), ExportError> {
        let seconds = row.time_unix_ns.saturating_sub(self.began_unix_ns) as f64 / 1e9;
        for (tool, sample) in row.device.iter().enumerate() {
            let Some(sample) = sample else { continue };
            let name = self.names.get(tool).map_or("", String::as_str);
            let mut line = vec![
                row.tick.to_string(),
                seconds.to_string(),
                tool.to_string(),
                cells::text(name).into_owned(),
                sample.sequence.to_string(),
                sample.device_time_ns.to_string(),
                sample.age_us.to_string(),
            ];
            line.extend(sample.displayed.iter().map(f32::to_string));
            self.table.line(&line)?;
        }
        Ok(())
    }

    /// Closes the table; number of lines.
    pub fn finish(self) -> Result<u64, ExportError> {
        self.table.finish()
    }
}

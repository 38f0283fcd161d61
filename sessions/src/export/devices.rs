//! `devices.csv`: what the devices measured and displayed, a line for every sample.

use std::path::{Path, PathBuf};

use sulcus_core::Scene;

use super::cells;
use super::error::{ExportError, create};
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
    path: PathBuf,
    csv: csv::Writer<std::io::BufWriter<std::fs::File>>,
    names: Vec<String>,
    began_unix_ns: u64,
    lines: u64,
}

impl DeviceTable {
    pub fn create(folder: &Path, scene: &Scene, began_unix_ns: u64) -> Result<Self, ExportError> {
        let path = folder.join("devices.csv");
        let mut csv = csv::Writer::from_writer(create(&path)?);
        csv.write_record(COLUMNS)
            .map_err(|source| ExportError::write(&path, source))?;
        Ok(Self {
            path,
            csv,
            names: scene.tools.iter().map(|tool| tool.name.clone()).collect(),
            began_unix_ns,
            lines: 0,
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
            self.csv
                .write_record(&line)
                .map_err(|source| ExportError::write(&self.path, source))?;
            self.lines += 1;
        }
        Ok(())
    }

    /// Closes the table; number of lines.
    pub fn finish(mut self) -> Result<u64, ExportError> {
        let flushed = self.csv.flush();
        flushed.map_err(|source| ExportError::write(&self.path, source))?;
        Ok(self.lines)
    }
}

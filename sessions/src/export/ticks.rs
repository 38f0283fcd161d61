//! `ticks.csv`: a line for every tick, or for every number of ticks.

use std::path::Path;

use sulcus_core::{Pose, Scene, TickOutput, ToolOutput, Vec3};

use super::cells;
use super::error::ExportError;
use super::table::Table;
use crate::record::channels::{is_held, paths};
use crate::record::occurrence::zone_name;
use crate::record::row::Row;

/// Columns of the session. The time counts from the first row.
const SESSION: [&str; 8] = [
    "tick",
    "time_s",
    "time_unix_ns",
    "skipped",
    "paused",
    "force_limit_n",
    "detail",
    "hash",
];

/// Columns of each tool, after its name. Poses are `world_from_tool`. Forces are about the device point in world axes:
/// those sent to the hand, and raw ones before ramp, clamp and slew limit. The cells are empty while no hand holds the
/// tool.
const TOOL: [&str; 42] = [
    "status",
    "age_ticks",
    "buttons",
    "haptic_x_m",
    "haptic_y_m",
    "haptic_z_m",
    "haptic_qw",
    "haptic_qx",
    "haptic_qy",
    "haptic_qz",
    "graphic_x_m",
    "graphic_y_m",
    "graphic_z_m",
    "graphic_qw",
    "graphic_qx",
    "graphic_qy",
    "graphic_qz",
    "force_x_n",
    "force_y_n",
    "force_z_n",
    "torque_x_nm",
    "torque_y_nm",
    "torque_z_nm",
    "raw_force_x_n",
    "raw_force_y_n",
    "raw_force_z_n",
    "raw_torque_x_nm",
    "raw_torque_y_nm",
    "raw_torque_z_nm",
    "tip_x_m",
    "tip_y_m",
    "tip_z_m",
    "substeps",
    "rows",
    "active",
    "converged",
    "min_gap_m",
    "pocket",
    "around_deg",
    "depth_mm",
    "floor_force_n",
    "zone",
];

pub(super) struct TickTable {
    table: Table,
    objects: Vec<String>,
    tips: Vec<Vec3>,
    began_unix_ns: u64,
    every: u64,
    ticks: u64,
    line: csv::StringRecord,
}

impl TickTable {
    pub fn create(
        folder: &Path,
        scene: &Scene,
        began_unix_ns: u64,
        every: u64,
    ) -> Result<Self, ExportError> {
        let tools = paths(scene.tools.iter().map(|tool| tool.name.as_str()));
        let of_tools = tools
            .iter()
            .flat_map(|tool| TOOL.map(|column| format!("{tool}_{column}")));
        let columns = SESSION.map(str::to_owned).into_iter().chain(of_tools);
        let table = Table::create(folder.join("ticks.csv"), columns)?;
        Ok(Self {
            table,
            objects: scene.objects.iter().map(|of| of.name.clone()).collect(),
            tips: scene.tools.iter().map(|tool| tool.tip).collect(),
            began_unix_ns,
            every,
            ticks: 0,
            line: csv::StringRecord::new(),
        })
    }

    pub fn line(&mut self, row: &Row, output: &TickOutput) -> Result<(), ExportError> {
        self.ticks += 1;
        if !(self.ticks - 1).is_multiple_of(self.every) {
            return Ok(());
        }
        let input = &row.input;
        let seconds = row.time_unix_ns.saturating_sub(self.began_unix_ns) as f64 / 1e9;
        let mut line = std::mem::take(&mut self.line);
        line.clear();
        for field in [
            output.tick.to_string(),
            seconds.to_string(),
            row.time_unix_ns.to_string(),
            input.skipped.to_string(),
            u8::from(input.paused).to_string(),
            input.force_limit_n.to_string(),
            input.detail.to_string(),
            cells::code(&format!("{:016x}", output.hash)),
        ] {
            line.push_field(&field);
        }
        for (t, tip) in self.tips.iter().enumerate() {
            let (held, out) = (&input.tools[t], &output.tools[t]);
            line.push_field(&out.status.to_string());
            line.push_field(&held.age_ticks.to_string());
            line.push_field(&held.buttons.to_string());
            if is_held(out) {
                self.tool(&mut line, out, tip);
            } else {
                (3..TOOL.len()).for_each(|_| line.push_field(""));
            }
        }
        let written = self.table.line(&line);
        self.line = line;
        written
    }

    fn tool(&self, line: &mut csv::StringRecord, out: &ToolOutput, tip: &Vec3) {
        let mut put = |x: f64| line.push_field(&x.to_string());
        let pose = |pose: &Pose| {
            let (p, q) = (&pose.position, &pose.orientation);
            [p.x, p.y, p.z, q.w, q.i, q.j, q.k]
        };
        pose(&out.haptic).into_iter().for_each(&mut put);
        pose(&out.graphic).into_iter().for_each(&mut put);
        for wrench in [&out.wrench, &out.raw_wrench] {
            wrench.force.iter().for_each(|x| put(*x));
            wrench.torque.iter().for_each(|x| put(*x));
        }
        out.graphic.transform(tip).iter().for_each(|x| put(*x));
        for field in [
            out.substeps.to_string(),
            out.rows.to_string(),
            out.active.to_string(),
            u8::from(out.converged).to_string(),
        ] {
            line.push_field(&field);
        }
        // Without contact rows there is no gap.
        if out.min_gap.is_finite() {
            line.push_field(&out.min_gap.to_string());
        } else {
            line.push_field("");
        }
        let Some(reading) = &out.pocket else {
            (0..5).for_each(|_| line.push_field(""));
            return;
        };
        let object = self.objects.get(usize::from(reading.object));
        line.push_field(&object.map_or("".into(), |name| cells::text(name)));
        line.push_field(&reading.around.to_degrees().to_string());
        line.push_field(&(reading.depth * 1e3).to_string());
        line.push_field(&reading.floor_force.to_string());
        line.push_field(zone_name(reading.zone));
    }

    /// Closes the table; number of lines.
    pub fn finish(self) -> Result<u64, ExportError> {
        self.table.finish()
    }
}

//! What the rows say: a table for people, JSON for the report, and the ratios that were promised, held or not.

use serde_json::{Value, json};
use sulcus_cases::statistics::Percentiles;

use crate::scene::Row;

/// What the names of rows begin with, or say.
const OURS_ON_BLOCK: &str = "sulcus surface_compliance, level 3";
const PEER: &str = "rapier3d";
const BARE: &str = "no skin";
const SKINNED: &str = "as it comes";

/// Something promised of ours against a peer.
pub struct Ratio {
    name: String,
    value: f64,
    at_least: f64,
}

impl Ratio {
    fn new(name: &str, theirs: f64, ours: f64, at_least: f64) -> Self {
        // Two that are nothing are equal; what is something beside nothing is as much as is told.
        let value = if theirs == ours {
            1.0
        } else {
            (theirs / ours).min(MOST)
        };
        Self {
            name: name.to_owned(),
            value,
            at_least,
        }
    }

    /// Whether it is what was promised.
    pub fn holds(&self) -> bool {
        self.value >= self.at_least
    }
}

/// Largest ratio that is told.
const MOST: f64 = 1e6;
/// Residual that counts as none, metres: what the hard cases of contact allow.
const NONE: f64 = 1e-6;

/// What is compared.
type Measure = fn(&Row) -> f64;
const P50: Measure = |row| row.touching.p50;
const P999: Measure = |row| row.touching.p999;
const PENETRATION: Measure = |row| row.penetration;
const RESIDUAL: Measure = |row| row.residual;
/// In or off what is drawn, under load.
const AMISS: Measure = |row| f64::max(row.penetration, row.apart);

/// What was promised, and what belongs to it: by each measure the best of their rows over ours.
pub fn ratios(rows: &[Row]) -> Vec<Ratio> {
    let ratio = |name: &str, engine: &str, kind: &str, measure: Measure, at_least: f64| {
        let own = rows.iter().find(|row| row.engine.starts_with(engine));
        let own = own.expect("our rows are in the table");
        let peers = rows.iter().filter(|row| row.scene == own.scene);
        let peers = peers.filter(|row| row.engine.starts_with(PEER) && row.engine.contains(kind));
        let best = peers.map(measure).fold(f64::INFINITY, f64::min);
        Ratio::new(
            &format!("{}, {name}", own.scene),
            best,
            measure(own),
            at_least,
        )
    };
    let block = |name: &str, kind: &str, measure: Measure, at_least: f64| {
        ratio(name, OURS_ON_BLOCK, kind, measure, at_least)
    };
    let mut all = vec![
        block("time at p50", PEER, P50, 5.0),
        block("time at p99.9", PEER, P999, 3.0),
        block(
            "penetration of what is drawn, theirs touching there",
            BARE,
            PENETRATION,
            1.0,
        ),
        block(
            "penetration of what is drawn, theirs held 3.3 mm off it",
            SKINNED,
            PENETRATION,
            1.0,
        ),
        block("penetration of what touches", PEER, RESIDUAL, 1.0),
        block("tool in or off what is drawn, under load", PEER, AMISS, 1.0),
    ];
    for level in ["level 3", "level 4"] {
        let engine = format!("sulcus, {level}, blended");
        let tooth = |name: &str, measure: Measure| {
            ratio(&format!("{level}: {name}"), &engine, PEER, measure, 1.0)
        };
        all.push(tooth("time at p50", P50));
        all.push(tooth("time at p99.9", P999));
        all.push(tooth("penetration of the mesh", PENETRATION));
        let own = rows.iter().find(|row| row.engine.starts_with(&engine));
        let name = format!(
            "rigid tooth, {level}: 1 um (none, in the hard cases) over penetration of what touches"
        );
        let own = own.expect("our rows are in the table").residual;
        all.push(Ratio::new(&name, NONE, own, 1.0));
    }
    all
}

fn micro(x: f64) -> f64 {
    (x * 1e8).round() * 0.01
}

/// The table.
pub fn print(rows: &[Row], ratios: &[Ratio], runs: usize) {
    println!(
        "thread CPU time of a tick, us, over ticks in which the hand touches, then over all; each tick its fastest of {runs} runs"
    );
    println!(
        "{:58} {:>8} {:>8} {:>8} {:>8} | {:>8} {:>8} {:>8} | {:>7} {:>7} {:>8} {:>7} {:>7}",
        "",
        "p50",
        "p99",
        "p99.9",
        "max",
        "all p50",
        "p99",
        "p99.9",
        "pen um",
        "apart",
        "resid um",
        "step N",
        "most N"
    );
    let mut scene = "";
    for row in rows {
        if row.scene != scene {
            scene = row.scene;
            println!("{scene}");
        }
        let (t, a) = (&row.touching, &row.all);
        println!(
            "  {:56} {:8.1} {:8.1} {:8.1} {:8.1} | {:8.1} {:8.1} {:8.1} | {:7.0} {:7.0} {:8.2} {:7.4} {:7.3}",
            row.engine,
            t.p50,
            t.p99,
            t.p999,
            t.max,
            a.p50,
            a.p99,
            a.p999,
            row.penetration * 1e6,
            row.apart * 1e6,
            row.residual * 1e6,
            row.force_step,
            row.max_force
        );
        println!("      {}", row.note);
    }
    for ratio in ratios {
        let held = if ratio.holds() {
            "holds"
        } else {
            "DOES NOT HOLD"
        };
        println!(
            "{}: {:.2}, at least {}: {held}",
            ratio.name, ratio.value, ratio.at_least
        );
    }
}

fn times(of: &Percentiles) -> Value {
    json!({"p50": of.p50, "p99": of.p99, "p999": of.p999, "max": of.max})
}

/// The file.
pub fn json(ticks: usize, rows: &[Row], ratios: &[Ratio]) -> String {
    let rows: Vec<Value> = rows
        .iter()
        .map(|row| {
            json!({
                "scene": row.scene, "engine": row.engine,
                "tick_us": times(&row.touching), "all_tick_us": times(&row.all),
                "penetration_um": micro(row.penetration), "apart_um": micro(row.apart),
                "residual_um": micro(row.residual),
                "force_step_n": row.force_step, "max_force_n": row.max_force,
                "note": row.note,
            })
        })
        .collect();
    let ratios: Vec<Value> = ratios
        .iter()
        .map(|ratio| json!({"name": ratio.name, "value": ratio.value, "at_least": ratio.at_least, "holds": ratio.holds()}))
        .collect();
    let all = json!({"ticks": ticks, "rows": rows, "ratios": ratios});
    serde_json::to_string_pretty(&all).expect("plain values") + "\n"
}

//! Table 3, Fig. 19 and the counts of section 3.2: the whole mouth with two hands at work.

use sulcus_cases::mouth::{PROBED, hands, mouth};
use sulcus_cases::statistics::{Interval, Percentiles, percentiles_us};
use sulcus_cases::timing::time;
use sulcus_cases::{find, run};
use sulcus_core::Scene;
use sulcus_core::tissue::TissueModel;

use super::answers::Answers;
use super::contact::{Counts, SEED, by_hand, slots};

/// When both hands are at work, seconds.
const BEGINS: f64 = 7.0;
/// How long is measured from then on, and in a quick report.
const MEASURED: [f64; 2] = [10.0, 2.0];
/// Repeats of the same inputs, and in a quick report.
const REPEATS: [usize; 2] = [5, 2];
/// Time for the hands to leave, which nobody waits for, seconds.
const LEAVING: f64 = 8.0;
/// Contacts of one tool farther apart are different regions, metres.
const APART: f64 = 2e-3;

/// Answers for the whole mouth.
pub(super) fn answer(quick: bool, answers: &mut Answers) {
    let scene = mouth(1, false, 3);
    let seconds = BEGINS + MEASURED[usize::from(quick)];
    let script = hands(&scene, seconds + LEAVING);
    let mut counts: [Counts; 4] = Default::default();
    let (measures, inputs) = by_hand(&scene, Box::new(script), (seconds, u64::MAX), |seen| {
        if seen.t < BEGINS {
            return;
        }
        let [rows, active, regions, per_region] = &mut counts;
        let tools = || seen.out.tools.iter();
        rows.add(tools().map(|tool| u32::from(tool.rows)).sum::<u32>());
        active.add(tools().map(|tool| u32::from(tool.active)).sum::<u32>());
        let places = slots(&scene).map(|t| (seen.regions(t, APART), seen.out.tools[t].rows));
        let mut all = 0;
        for (regions, rows) in places {
            all += regions as u32;
            if regions > 0 {
                per_region.add(u32::from(rows) / regions as u32);
            }
        }
        regions.add(all);
    });
    let begins = scene.params.ticks_in(BEGINS) as usize;
    let repeats = REPEATS[usize::from(quick)];
    let runs: Vec<Percentiles> = (0..repeats)
        .map(|_| percentiles_us(time(&scene, &inputs, |_, _| {}).cpu.split_off(begins)))
        .collect();
    // Milliseconds.
    let over = |of: fn(&Percentiles) -> f64| {
        Interval::of(&runs.iter().map(|run| of(run) * 1e-3).collect::<Vec<f64>>())
    };
    let (p50, p999, most) = (over(|p| p.p50), over(|p| p.p999), over(|p| p.max));
    let times = [
        ("tick_ms_p50", p50.mean),
        ("tick_ms_p50_half", p50.half),
        ("tick_ms_p999", p999.mean),
        ("tick_ms_p999_half", p999.half),
        ("tick_ms_max", most.mean),
        ("tick_ms_max_half", most.half),
    ];
    let timed = format!(
        "thread CPU time, {repeats} runs of the same inputs, mean and 95 % interval of Student"
    );
    let how = format!(
        "generated mouth, patient 1, all teeth of the lower jaw at level 3; a probe walks round tooth {PROBED}, a mirror holds the tongue; two hands in closed loop, {:.0} s from when both are at work, seed {SEED}",
        seconds - BEGINS
    );
    let mut percentiles = counts
        .each_mut()
        .map(|count| count.percentiles())
        .into_iter();
    let mut next = || percentiles.next().unwrap_or_default();
    let (rows, active, regions, per_region) = (next(), next(), next(), next());
    let shape = shape(&scene);
    answers.measured(
        "fig8-sub-gingivae",
        format!("{}", shape.gums),
        &[("sub_gingivae", shape.gums as f64)],
        "generated mouth, patient 1: one for each tooth of the lower jaw",
    );
    answers.measured(
        "table3-data",
        format!(
            "{} objects ({} teeth, {} other rigid, {} gingivae, {} tongue), 2 tools; {} spheres in contact trees, {} in the tools'; {} triangles; rows {:.0} (median), {:.0} (most), {:.0} bearing load (median); tick {p50:.3} ms (median), {p999:.3} ms (99.9 %)",
            shape.objects, shape.teeth, shape.rigid - shape.teeth, shape.gums, shape.tongues, shape.spheres, shape.tool_spheres, shape.triangles, rows[0], rows[2], active[0],
        ),
        &[
            ("objects", shape.objects as f64),
            ("spheres", shape.spheres as f64),
            ("tool_spheres", shape.tool_spheres as f64),
            ("triangles", shape.triangles as f64),
            ("rows_p50", rows[0]),
            ("rows_max", rows[2]),
            ("active_p50", active[0]),
            times[0],
            times[1],
            times[2],
            times[3],
            times[4],
            times[5],
        ],
        format!("{how}; {timed}"),
    );
    answers.measured(
        "update-rate-khz",
        format!(
            "1 kHz; a tick in the whole mouth takes {p50:.3} ms, 99.9 % of them {p999:.3} ms at most"
        ),
        &times,
        format!("{how}; one thread; {timed}"),
    );
    let three = |name: &str, p: [f64; 3]| {
        format!(
            "{name}{:.0} (median), {:.0} (99 %), {:.0} (most)",
            p[0], p[1], p[2]
        )
    };
    let values = |p: [f64; 3]| [("p50", p[0]), ("p99", p[1]), ("max", p[2])];
    answers.measured(
        "pairs-per-region",
        three("", per_region),
        &values(per_region),
        format!(
            "{how}; rows of a tool by regions that bear load, contacts more than {} mm apart",
            APART * 1e3
        ),
    );
    answers.measured(
        "contact-regions",
        three("", regions),
        &values(regions),
        format!(
            "{how}; both tools together, contacts more than {} mm apart",
            APART * 1e3
        ),
    );
    answers.measured(
        "constraints-max",
        three("", rows),
        &values(rows),
        format!("{how}; rows of both tools together"),
    );
    let (buzz, energy) = (measures.buzz * 1e3, measures.energy * 1e3);
    answers.measured(
        "fig19-stable",
        format!(
            "buzz {buzz:.2} mN, {energy:.2} mJ put out into the hands at most, jump {:.3} mm",
            measures.jump * 1e3
        ),
        &[
            ("buzz_mn", buzz),
            ("put_out_mj", energy),
            ("jump_mm", measures.jump * 1e3),
        ],
        how,
    );
    through(answers);
}

/// What a scene is made of.
struct Shape {
    objects: usize,
    /// Rigid objects with a tooth's number, and all rigid ones.
    teeth: usize,
    rigid: usize,
    gums: usize,
    tongues: usize,
    spheres: usize,
    tool_spheres: usize,
    triangles: usize,
}

fn shape(scene: &Scene) -> Shape {
    let count = |is: fn(&TissueModel) -> bool| {
        scene
            .objects
            .iter()
            .filter(|object| is(&object.tissue))
            .count()
    };
    let triangles = |meshes: &mut dyn Iterator<Item = usize>| meshes.sum::<usize>();
    Shape {
        objects: scene.objects.len(),
        teeth: scene
            .objects
            .iter()
            .filter(|object| object.tissue.is_rigid() && object.fdi != 0)
            .count(),
        rigid: count(TissueModel::is_rigid),
        gums: count(|tissue| matches!(tissue, TissueModel::Gingiva(_))),
        tongues: count(|tissue| {
            matches!(tissue, TissueModel::Skeleton(_) | TissueModel::Surface(_))
        }),
        spheres: scene
            .objects
            .iter()
            .map(|object| object.tree.shape_at(object.level).count())
            .sum(),
        tool_spheres: scene
            .tools
            .iter()
            .map(|tool| tool.tree.shape_at(tool.level).count())
            .sum(),
        triangles: triangles(
            &mut scene
                .objects
                .iter()
                .map(|object| object.mesh.triangles.len()),
        ) + triangles(&mut scene.tools.iter().map(|tool| tool.mesh.triangles.len())),
    }
}

/// Thin plates that a probe is stabbed through: the paper leaves these open.
fn through(answers: &mut Answers) {
    let names = ["thin-plate-0.5", "thin-plate-0.3mm-2"];
    let margins = names.map(|name| {
        let case = find(name).expect("a case of the table");
        run(case, |_| {}).margin * 1e3
    });
    answers.measured(
        "open-pop-through",
        format!("never through: the tip's centre stays {:.3} mm above the middle of a plate of 0.5 mm at 0.5 m/s, {:.3} mm of one of 0.3 mm at 2 m/s", margins[0], margins[1]),
        &[("margin_0.5_mm", margins[0]), ("margin_0.3_mm", margins[1])],
        format!("hard cases `{}` and `{}`, a hand that feels nothing, seed 1", names[0], names[1]),
    );
}

//! The check at the end of a demo: the recording replayed, every tick observed, the session graded.

use std::path::{Path, PathBuf};

use sulcus_cases::{Chart, Measures, Observer};
use sulcus_sessions::exercise::events::Tally;
use sulcus_sessions::grade::{Grade, Graded, Standard, finish, run};
use sulcus_sessions::{
    Exercise, Mode, Recording, ReplayOptions, ReplayReport, Signature, replay_observed,
};

use crate::calls::Called;
use crate::page;
use crate::summary::{EventsSummary, PocketSummary, SiteSummary, TissueSummary};
use crate::zones::{entered, zone_line};
use sulcus_connection::progress::Steps;

/// Looks at the residual and at the shape of tissue in a session, about: each goes over all pairs of spheres and takes as long as ten
/// ticks in the whole mouth. A short session is looked at in every tick.
const LOOKS: u64 = 6000;

/// What the replay found.
pub struct Checked {
    /// The replay's own report.
    pub report: ReplayReport,
    /// The measures of the session, by full queries of all pairs.
    pub measures: Measures,
    /// Every how many ticks such a query was made.
    pub residual_every: u64,
    /// A line for each time that a hand became too heavy in a pocket.
    pub zones: Vec<String>,
    /// What a probe read.
    pub chart: Chart,
    /// How often what happened.
    pub tally: Tally,
    /// Depths that were called.
    pub calls: Vec<Called>,
    /// The grade; none where nothing is asked that is graded.
    pub grade: Option<Grade>,
    /// The student's page, or why it could not be written; none where there is no grade to show.
    pub page: Option<Result<PathBuf, String>>,
    /// Whether anything in the scene yields.
    yields: bool,
    /// Size of the file.
    pub bytes: u64,
}

impl Checked {
    /// Whether the signatures hold.
    pub fn signature_valid(&self) -> bool {
        matches!(self.report.signature, Signature::Valid { .. }) && self.report.chain_ok
    }

    /// What was read in pockets; none where no tool was in one.
    pub fn pocket(&self) -> Option<PocketSummary> {
        let sites = self.chart.sites();
        let [_, too_heavy, trauma, damage] = self.chart.zones;
        (!sites.is_empty()).then(|| PocketSummary {
            sites: sites
                .iter()
                .map(|site| SiteSummary {
                    tooth: site.tooth,
                    site: site.site.name(),
                    truth_mm: site.truth * 1e3,
                    measured_mm: site.measured.map(|depth| depth * 1e3),
                    deepest_mm: site.deepest * 1e3,
                    max_force_n: site.max_force,
                })
                .collect(),
            too_heavy,
            trauma,
            damage,
        })
    }

    /// What happened, in numbers.
    pub fn events(&self) -> EventsSummary {
        EventsSummary::new(&self.tally, self.calls.clone())
    }

    /// How tissue fared; none where nothing yields.
    pub fn tissue(&self) -> Option<TissueSummary> {
        let m = &self.measures;
        self.yields.then_some(TissueSummary {
            indentation_mm: m.indentation * 1e3,
            unrest_um: m.unrest * 1e6,
            max_raw_force_n: m.max_raw_force,
            buzz_n: m.buzz,
            imbalance: m.imbalance,
            flips: m.flips,
        })
    }
}

/// Replays the recording at `path`, and writes the student's page beside it where the mode shows a grade.
///
/// # Errors
/// When it cannot be read.
pub fn check(path: &Path, steps: &Steps) -> anyhow::Result<Checked> {
    let recording = Recording::open(path)?;
    let scene = recording.scene()?;
    let (mut observer, mut chart) = (Observer::new(&scene), Chart::default());
    let exercise = Exercise::recorded(&recording.header().exercise);
    let standard = Standard::of(recording.header(), &exercise, None)?;
    let mut watcher = run::watcher(&scene, &exercise, standard.as_ref());
    let mut zones = Vec::new();
    let rows = recording.facts().rows;
    let last = recording.facts().ticks.map(|ticks| ticks.1);
    observer.residual_every = rows.div_ceil(LOOKS).max(1);
    let residual_every = observer.residual_every;
    let bar = steps.bar("replaying");
    let report = replay_observed(
        &recording,
        &ReplayOptions::default(),
        &mut |ticks| bar.set("replaying", ticks as f64 / rows as f64),
        &mut |scene, input, output, ws| {
            // How tissue is left is looked at in any case.
            if Some(output.tick) == last {
                observer.residual_every = 1;
            }
            observer.observe(scene, input, output, ws);
            chart.observe(scene, output);
            watcher.observe(scene, output, ws);
            zones.extend(
                entered(output)
                    .map(|(_, reading)| zone_line(output.tick as f64 * scene.tick_s(), &reading)),
            );
        },
    )?;
    bar.done();
    let bytes = std::fs::metadata(path)?.len();
    let tally = *watcher.events.tally();
    // One replay for the check and the grade.
    let grade = standard.map(|standard| {
        let standard = Some(&standard);
        finish(&recording, &scene, &exercise, standard, watcher, &report)
    });
    let graded: Option<Graded> = grade.transpose()?;
    let mode = recording.header().mode;
    let shown = mode.unwrap_or_default() == Mode::Practice;
    let page = graded.as_ref().filter(|_| shown);
    let page = page.map(|graded| page::write(path, mode, graded));
    let called = run::Log::read(&recording, &scene)?.calls;
    Ok(Checked {
        report,
        measures: observer.measures(),
        residual_every,
        zones,
        chart,
        tally,
        calls: called
            .iter()
            .filter_map(|(_, call)| Called::of(call, &scene))
            .collect(),
        grade: graded.map(|graded| graded.grade),
        page,
        yields: scene.yields(),
        bytes,
    })
}

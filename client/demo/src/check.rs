//! Check at the end of a demo: a replay of the recording in which every tick is observed, and the grade.

use std::path::{Path, PathBuf};

use sulcus_cases::{Chart, Measures, Observer};
use sulcus_program::tell;
use sulcus_sessions::cli::drawn;
use sulcus_sessions::exercise::events::Tally;
use sulcus_sessions::grade::{Grade, Graded, Standard, finish, run};
use sulcus_sessions::pages::Pictures;
use sulcus_sessions::pages::instants::{Instant, instants};
use sulcus_sessions::{
    Exercise, Mode, Recording, ReplayOptions, ReplayReport, Signature, replay_observed,
};

use crate::calls::Called;
use crate::page;
use crate::summary::{EventsSummary, PocketSummary, SiteSummary, TissueSummary};
use crate::zones::{entered, zone_line};
use sulcus_connection::progress::Steps;

/// Largest number of full queries in a session, without the query of the last tick.
///
/// A full query measures the residual and the shape of tissue over all pairs of spheres. In the whole mouth it takes as
/// long as ten ticks. A session of at most this many ticks has a query in every tick.
const LOOKS: u64 = 6000;

/// Result of the check.
pub struct Checked {
    /// Report of the replay.
    pub report: ReplayReport,
    /// Measures of the session, SI units. Residual and shapes of tissue come from full queries of all pairs.
    pub measures: Measures,
    /// Number of ticks from one full query to the next; 1 in a short session. The last tick always has a query.
    pub residual_every: u64,
    /// Lines for a person, each for the entry of a hand into a heavier zone of force in a pocket.
    pub zones: Vec<String>,
    /// Readings of the probe for each site that the tip reached.
    pub chart: Chart,
    /// Counts of the events.
    pub tally: Tally,
    /// Called depths in the order of the recording, without calls for teeth that have no pocket in the scene.
    pub calls: Vec<Called>,
    /// Grade; `None` for an exercise without a rubric.
    pub grade: Option<Grade>,
    /// Instant of the worst finding that cost points; `None` without such a finding.
    pub worst: Option<Instant>,
    /// Path of the student's page, or the reason why it could not be written. `None` without a grade, and in a mode
    /// other than practice.
    pub page: Option<Result<PathBuf, String>>,
    /// Whether the scene has an object that yields.
    yields: bool,
    /// Size of the recording, bytes.
    pub bytes: u64,
}

impl Checked {
    /// Whether the signature of the whole recording is valid and every recorded head of the chain is correct.
    pub fn signature_valid(&self) -> bool {
        matches!(self.report.signature, Signature::Valid { .. }) && self.report.chain_ok
    }

    /// Readings in pockets; `None` if no tool was in a pocket.
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

    /// Counts of the events, and the calls.
    pub fn events(&self) -> EventsSummary {
        EventsSummary::new(&self.tally, self.calls.clone())
    }

    /// Motion of the tissue; `None` for a scene in which nothing yields.
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

/// Replays and grades the recording at `path`. In practice the student's page is written beside the recording.
///
/// # Errors
/// The errors of [`with`].
pub fn check(path: &Path, steps: &Steps) -> anyhow::Result<Checked> {
    with(path, false, steps)
}

/// The same; with `pictures` the page has pictures of the findings.
///
/// # Errors
/// The recording or its scene, exercise or rubric cannot be read. A page that cannot be written is no error: see
/// [`Checked::page`].
pub fn with(path: &Path, pictures: bool, steps: &Steps) -> anyhow::Result<Checked> {
    let recording = Recording::open(path)?;
    let scene = recording.scene()?;
    let (mut observer, mut chart) = (Observer::new(&scene), Chart::default());
    let exercise = Exercise::recorded(&recording.header().exercise);
    let standard = Standard::of(recording.header(), &exercise, None)?;
    let mut watcher = run::watcher(&scene, &exercise, standard.as_ref());
    watcher.begin(&scene, &recording)?;
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
            // The shape of the tissue at the end is measured in every session.
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
    // Check and grade share one replay.
    let grade = standard.map(|standard| {
        let standard = Some(&standard);
        finish(&recording, &scene, &exercise, standard, watcher, &report)
    });
    let graded: Option<Graded> = grade.transpose()?;
    let mode = recording.header().mode;
    let shown = mode.unwrap_or_default() == Mode::Practice;
    let page = graded.as_ref().filter(|_| shown);
    let page = page.map(|graded| {
        let pictures = pictures.then(|| drawn::findings(path, graded));
        if let Some(Pictures::Missing(why)) = &pictures {
            tell!("warning: no pictures of the findings: {why}");
        }
        page::write(path, mode, graded, pictures.as_ref())
    });
    let worst = graded.as_ref().and_then(|graded| instants(graded, 1).pop());
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
        worst,
        page,
        yields: scene.yields(),
        bytes,
    })
}

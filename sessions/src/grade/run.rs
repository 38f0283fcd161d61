//! Grading of a recording: one replay, and the grade from its evidence.

use sulcus_core::Scene;
use sulcus_core::math::fmin;
use sulcus_core::scene::displayable::too_stiff;
use sulcus_core::tissue::TissueModel;

use super::advice::advice;
use super::definitions::{Definition, find};
use super::felt::{Feeling, Felt};
use super::measured::Measured;
use super::parts::{PartFacts, unlinked};
use super::patient::PatientChart;
use super::report::{CriticalError, Gaps, Grade, MetricGrade, Migrated, Standard, Thresholds};
use super::score::{happened, score, total};
use super::settings::Settings;
use super::sites::sites;
use super::stats::rounded;
use super::unfelt::Devices;
use super::watcher::Watcher;
use super::{Rubric, floor_time::FloorTime};
use crate::exercise::Exercise;
use crate::exercise::events::call::{Call, READING_CALLED};
use crate::grade::motion::series::Series;
use crate::record::device::DeviceFacts;
use crate::record::ended;
use crate::record::key::PublicKey;
use crate::record::message::Message;
use crate::record::mode::Mode;
use crate::record::occurrence::Occurrence;
use crate::record::read::{ReadError, Recording};
use crate::record::written::WrittenError;
use crate::replay::{ReplayError, ReplayOptions, ReplayReport, replay_observed, why_not_continued};

/// Version of this program's measures: the beginning of a hash over the sources of tick, events, exercise and grade.
pub const MEASURES_SOURCE: &str = env!("SULCUS_MEASURES_SOURCE");

/// Options of grading.
#[derive(Clone, Debug, Default)]
pub struct Options {
    /// Rubric instead of the recording's own.
    pub rubric: Option<Rubric>,
    /// Only key whose signature is accepted. None: the key in the recording.
    pub trust: Option<PublicKey>,
}

/// Failure of grading: a recording or a rubric that cannot be read.
#[derive(Debug, thiserror::Error)]
pub enum GradeError {
    /// The recording cannot be replayed.
    #[error(transparent)]
    Replay(#[from] ReplayError),
    /// The recording cannot be read.
    #[error(transparent)]
    Read(#[from] ReadError),
    /// The rubric is not valid.
    #[error(transparent)]
    Rubric(#[from] WrittenError),
}

/// Grade with the data of its plots.
#[derive(Clone, Debug, PartialEq)]
pub struct Graded {
    /// Grade.
    pub grade: Grade,
    /// Depth and force over time; empty without a grade.
    pub series: Series,
    /// Teeth of the scene, FDI numbers.
    pub teeth: Vec<u8>,
    /// Text of the patient; empty without a patient.
    pub patient: String,
    /// Name of the leading tool. The series has its forces.
    pub leads: String,
    /// Length of the session, seconds.
    pub seconds: f64,
    /// Force on a pocket's floor from which healthy tissue bleeds, newtons: the least of the scene's gingivae.
    /// None without a gingiva.
    pub trauma_n: Option<f64>,
}

/// Settings for a session without a rubric. Nothing is graded; events are found all the same.
const PLAIN: Settings = Settings {
    force_n: [0.1, 0.25],
    reached_mm: 0.5,
    misread_mm: 0.75,
    steady_mm: 1.5,
    ask_recession: false,
    ask_bleeding: false,
    ask_furcation: false,
};

/// Watcher for a session, with the settings of its rubric.
pub fn watcher(scene: &Scene, exercise: &Exercise, standard: Option<&Standard>) -> Watcher {
    let set = standard.map_or(PLAIN, |standard| standard.rubric.settings);
    Watcher::new(scene, exercise, set)
}

/// Replays a recording and grades it. `progress` receives the number of ticks done from time to time.
///
/// # Errors
/// A recording that cannot be read or replayed, or a rubric that is not valid. A recording that fails its checks is no
/// error: the grade contains the reason.
pub fn grade(
    recording: &Recording,
    options: &Options,
    progress: &mut dyn FnMut(u64),
) -> Result<Graded, GradeError> {
    grade_session(recording, &[], options, progress)
}

/// Replays the recordings of one session and grades the session, as by [`grade`]. `last` is the last recording, and
/// `before` the recordings before it, in the order of the session. Each recording replays by itself.
///
/// # Errors
/// The errors of [`grade`].
pub fn grade_session(
    last: &Recording,
    before: &[&Recording],
    options: &Options,
    progress: &mut dyn FnMut(u64),
) -> Result<Graded, GradeError> {
    let scene = last.scene()?;
    let exercise = Exercise::recorded(&last.header().exercise);
    let standard = Standard::of(last.header(), &exercise, options.rubric.as_ref())?;
    let mut watcher = watcher(&scene, &exercise, standard.as_ref());
    let how = ReplayOptions {
        trust: options.trust,
        ..ReplayOptions::default()
    };
    let parts = [before, &[last]].concat();
    let mut against = unlinked(&parts);
    let (mut log, mut feeling) = (Log::default(), Feeling::new(scene.tick_s()));
    let mut done = 0;
    for part in before {
        if against.is_some() {
            break;
        }
        let offset = watcher.begin(&scene, part)?;
        let report = replay_observed(
            part,
            &how,
            &mut |ticks| progress(done + ticks),
            &mut |scene, _, output, shapes| watcher.observe(scene, output, shapes),
        )?;
        done += report.ticks;
        log.add(part, &scene, (offset, &mut feeling))?;
        against = why_not_continued(part, &report);
    }
    let offset = watcher.begin(&scene, last)?;
    let mut report = replay_observed(
        last,
        &how,
        &mut |ticks| progress(done + ticks),
        &mut |scene, _, output, shapes| watcher.observe(scene, output, shapes),
    )?;
    log.add(last, &scene, (offset, &mut feeling))?;
    if let Some(against) = against {
        report.gradable = false;
        report.reason = Some(against);
    }
    let standard = standard.as_ref();
    let mut graded = finish_with(last, &scene, &exercise, standard, watcher, &report, log);
    graded.grade.parts = PartFacts::of(&parts);
    if let Some(first) = before.first() {
        graded.grade.started_unix_ns = first.header().started_unix_ns;
    }
    Ok(graded)
}

/// Grade of a session in one recording, from the `watcher` of its replay.
///
/// # Errors
/// A file that changed after it was opened.
pub fn finish(
    recording: &Recording,
    scene: &Scene,
    exercise: &Exercise,
    standard: Option<&Standard>,
    watcher: Watcher,
    report: &ReplayReport,
) -> Result<Graded, ReadError> {
    let log = Log::read(recording, scene)?;
    let mut report = report.clone();
    if let Some(against) = unlinked(&[recording]) {
        report.gradable = false;
        report.reason.get_or_insert(against);
    }
    Ok(finish_with(
        recording, scene, exercise, standard, watcher, &report, log,
    ))
}

fn finish_with(
    recording: &Recording,
    scene: &Scene,
    exercise: &Exercise,
    standard: Option<&Standard>,
    mut watcher: Watcher,
    report: &ReplayReport,
    log: Log,
) -> Graded {
    let header = recording.header();
    let mut teeth: Vec<u8> = scene
        .objects
        .iter()
        .map(|o| o.fdi)
        .filter(|fdi| *fdi != 0)
        .collect();
    teeth.sort_unstable();
    teeth.dedup();
    let mut graded = Graded {
        grade: Grade {
            learner_id: header.learner_id.clone(),
            exercise: header.exercise_name.clone(),
            station: header.station.clone(),
            seed: header.seed,
            started_unix_ns: header.started_unix_ns,
            signer: recording.signer().fingerprint(),
            signer_trusted: report.signer_trusted,
            gradable: report.gradable,
            reason: report.reason.clone(),
            migrated: Migrated::of(report),
            rubric: standard.map(Standard::used),
            score: None,
            pass_mark: standard.map(|standard| standard.rubric.pass_mark),
            passed: None,
            failures: Vec::new(),
            critical: Vec::new(),
            metrics: Vec::new(),
            sites: Vec::new(),
            force_band_n: standard.map(|standard| standard.rubric.settings.force_n),
            thresholds: standard.map(|standard| Thresholds {
                settings: standard.rubric.settings,
                mid_tilt_deg: exercise.probing.mid_tilt_deg,
                proximal_tilt_deg: exercise.probing.proximal_tilt_deg,
            }),
            floor_time: FloorTime::default(),
            advice: Vec::new(),
            missing: watcher.events.missing().to_vec(),
            ended_early: None,
            gaps: gaps(recording, scene, &watcher),
            felt: log.felt,
            unfelt: Vec::new(),
            parts: Vec::new(),
        },
        series: Series::default(),
        teeth,
        patient: header.patient.clone(),
        leads: scene
            .tools
            .get(watcher.evidence.leading)
            .map_or(String::new(), |tool| tool.name.clone()),
        seconds: 0.0,
        trauma_n: scene
            .objects
            .iter()
            .filter_map(|object| match &object.tissue {
                TissueModel::Gingiva(gingiva) => Some(gingiva.params.trauma),
                _ => None,
            })
            .reduce(fmin),
    };
    let Some(standard) = standard else {
        graded.grade.gradable = false;
        let none = format!("exercise `{}` has no rubric", header.exercise_name);
        graded.grade.reason.get_or_insert(none);
        return graded;
    };
    if !report.gradable {
        return graded;
    }
    if let Err(error) = standard.rubric.fits(exercise) {
        graded.grade.gradable = false;
        graded.grade.reason = Some(error.to_string());
        return graded;
    }
    if let Some(coupling) = too_stiff(scene).first() {
        graded.grade.gradable = false;
        graded.grade.reason = Some(coupling.to_string());
        return graded;
    }
    let set = &standard.rubric.settings;
    if let Some(reason) = nothing_there(exercise, &graded) {
        graded.grade.gradable = false;
        graded.grade.reason = Some(reason);
        return graded;
    }
    graded.grade.ended_early = log.ended_early;
    let heard = log.calls;
    let calls: Vec<Call> = heard.iter().map(|(_, call)| *call).collect();
    let leading = watcher.evidence.leading;
    let smoothness = watcher.evidence.moves[leading].smoothness();
    let patient = PatientChart::of(&header.patient);
    let patient = patient.as_ref();
    let sites = sites(scene, exercise, &watcher.evidence, &heard, patient, set);
    let measured = Measured {
        exercise,
        evidence: &watcher.evidence,
        sites: &sites,
        calls: &calls,
        touches: &watcher.evidence.touches.all(),
        smoothness: smoothness.map(|(median, _)| median),
        set,
    };
    let mut devices = Devices::new(&log.devices, scene, set);
    let rubric = &standard.rubric;
    weigh(&mut graded.grade, exercise, rubric, &measured, &mut devices);
    graded.grade.unfelt = devices.found();
    if header.mode.unwrap_or_default() != Mode::Practice {
        leave_open(&mut graded.grade, rubric);
    }
    let time = &watcher.evidence.floor;
    let grade = &mut graded.grade;
    grade.floor_time = FloorTime {
        light_s: rounded(time.light_s, 2),
        in_band_s: rounded(time.in_band_s, 2),
        heavy_s: rounded(time.heavy_s, 2),
        trauma_s: rounded(time.trauma_s, 2),
        damage_s: rounded(time.damage_s, 2),
    };
    grade.advice = advice(&grade.metrics, &grade.critical, &sites, set);
    grade.sites = sites;
    graded.seconds = watcher.evidence.series.0.len() as f64 * crate::grade::motion::series::STEP_S;
    graded.series = watcher.evidence.series;
    graded
}

/// Gaps of the connection that the watcher has seen; `None` without a gap.
fn gaps(recording: &Recording, scene: &Scene, watcher: &Watcher) -> Option<Gaps> {
    let gone = watcher.evidence.gone();
    let plan = recording.header().plan.as_ref();
    (gone.gaps > 0).then(|| Gaps {
        count: gone.gaps,
        seconds: rounded(gone.ticks as f64 * scene.tick_s(), 2),
        clock_ran: plan.is_some_and(|plan| plan.clock_runs_in_gaps),
    })
}

/// Reason against a grade if the scene lacks all teeth with zones, or the target.
fn nothing_there(exercise: &Exercise, graded: &Graded) -> Option<String> {
    let is_there = |fdi: &u8| graded.teeth.contains(fdi);
    let mut zones = exercise.zones.iter().map(|zones| zones.tooth);
    let target = exercise.target.as_ref().map(|target| target.tooth);
    let lacks_all = !exercise.zones.is_empty() && !zones.any(|fdi| is_there(&fdi));
    let lacks_target = target.is_some_and(|fdi| !is_there(&fdi));
    (lacks_all || lacks_target).then(|| {
        format!(
            "the scene lacks parts of exercise `{}`: {}",
            exercise.name,
            graded.grade.missing.join(", ")
        )
    })
}

/// Fills in metrics, critical errors, total score and failures.
fn weigh(
    grade: &mut Grade,
    exercise: &Exercise,
    rubric: &Rubric,
    measured: &Measured<'_>,
    devices: &mut Devices<'_>,
) {
    let mut scores = Vec::new();
    let mut failures = Vec::new();
    let is_there = |known: &&Definition| {
        let there = measured.sites.iter().filter(|site| site.asked);
        known.needs.are_met(exercise) && known.needs.are_there(there.map(|site| site.site))
    };
    for weighed in &rubric.metrics {
        let Some(known) = find(&weighed.name).filter(is_there) else {
            continue;
        };
        let value = known.value(measured);
        let not_judged = devices.against(known, Some(&weighed.target));
        let points = match value {
            _ if not_judged.is_some() => None,
            Some(value) => Some(score(value, weighed)),
            None if known.missing_is_zero => Some(0.0),
            None => None,
        };
        scores.extend(points.map(|points| (weighed.weight, points)));
        let under = weighed
            .pass
            .zip(points)
            .filter(|(pass, points)| points < pass);
        let mut deducted = 0.0;
        if let Some((pass, points)) = under {
            deducted = weighed.deduct.unwrap_or_default();
            let off = if deducted > 0.0 {
                format!("; {deducted} points off the total")
            } else {
                String::new()
            };
            failures.push(format!(
                "{}: {points:.0} points, {pass} needed{off}",
                known.title
            ));
        }
        grade.metrics.push(MetricGrade {
            name: known.name,
            title: known.title,
            value: value.map(|value| rounded(value, digits(known))),
            unit: known.unit,
            target: weighed.target,
            zero: weighed.zero,
            weight: weighed.weight,
            score: points.map(|points| rounded(points, 1)),
            not_judged,
            pass: weighed.pass,
            deducted,
            definition: known.definition,
            recorded_definition: weighed
                .definition
                .clone()
                .filter(|recorded| recorded != known.definition),
            source: known.source,
        });
    }
    let Some(mut sum) = total(&scores) else {
        grade.gradable = false;
        grade.reason = Some("no metric with a weight has a value".into());
        return;
    };
    let deducted: f64 = grade.metrics.iter().map(|metric| metric.deducted).sum();
    sum = if sum > deducted { sum - deducted } else { 0.0 };
    for critical in &rubric.critical {
        let Some(known) = find(&critical.metric).filter(is_there) else {
            continue;
        };
        let is_open = match grade.metric(&critical.metric) {
            Some(metric) => metric.not_judged.is_some(),
            None => devices.against(known, None).is_some(),
        };
        if is_open {
            continue;
        }
        let value = known.critical_value(measured);
        if !happened(critical, value, known.missing_is_zero) {
            continue;
        }
        if let Some(cap) = critical.cap.filter(|cap| *cap < sum) {
            sum = cap;
        }
        failures.push(format!("critical error: {}", critical.why));
        grade.critical.push(CriticalError {
            metric: critical.metric.clone(),
            why: critical.why.clone(),
            cap: critical.cap,
        });
    }
    let sum = rounded(sum, 1);
    if sum < rubric.pass_mark {
        failures.insert(
            0,
            format!("{sum:.1} points, {:.1} needed", rubric.pass_mark),
        );
    }
    grade.score = Some(sum);
    grade.passed = Some(failures.is_empty());
    grade.failures = failures;
}

/// Leaves a pass open if nothing failed and a part of the rubric is not judged. Otherwise a device without force would
/// be the way to a pass.
fn leave_open(grade: &mut Grade, rubric: &Rubric) {
    let counts = |metric: &&MetricGrade| {
        let mut critical = rubric.critical.iter();
        metric.weight > 0.0 || critical.any(|one| one.metric == metric.name)
    };
    let mut counted = grade.metrics.iter().filter(counts);
    if grade.passed == Some(true) && counted.any(|metric| metric.not_judged.is_some()) {
        grade.passed = None;
    }
}

/// Digits of a metric's value after the point.
fn digits(metric: &Definition) -> u32 {
    match (metric.unit, metric.name) {
        ("%", _) | ("mm", "path_length") | ("s", _) => 1,
        ("mm", _) | ("N", _) => 2,
        _ => 3,
    }
}

/// Parts of a session's rows and log for the grade.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Log {
    /// Valid calls, each with the number of the last tick before it.
    pub calls: Vec<(u64, Call)>,
    /// Reason for an early end of the session, in words.
    pub ended_early: Option<&'static str>,
    /// Force that the hand felt; `None` without samples of a device.
    pub felt: Option<Felt>,
    /// Devices of the headers, and other devices after gaps of the connection.
    pub devices: Vec<DeviceFacts>,
}

impl Log {
    /// Reads the log of a session in one recording.
    ///
    /// # Errors
    /// A file that changed after it was opened.
    pub fn read(recording: &Recording, scene: &Scene) -> Result<Self, ReadError> {
        let mut log = Self::default();
        let mut feeling = Feeling::new(scene.tick_s());
        log.add(recording, scene, (0, &mut feeling))?;
        Ok(log)
    }

    /// Adds a recording. Its ticks are counted from `offset` on.
    fn add(
        &mut self,
        recording: &Recording,
        scene: &Scene,
        (offset, feeling): (u64, &mut Feeling),
    ) -> Result<(), ReadError> {
        let mut tick = offset;
        self.devices.extend_from_slice(&recording.header().devices);
        feeling.begin();
        // The end of a recording that another one continues is no end of the session.
        self.ended_early = None;
        for message in recording.messages() {
            match message? {
                Message::Row(row) => {
                    tick = row.tick.saturating_add(offset);
                    feeling.row(&row);
                }
                Message::Event(event) => {
                    self.ended_early = ended::early(&event.text).or(self.ended_early);
                    let later = DeviceFacts::hear(&event.text);
                    self.devices.extend(later.unwrap_or_default());
                    let said = Occurrence::parse(&event.text);
                    let said = said.filter(|said| said.kind == READING_CALLED);
                    let call = said.and_then(|said| Call::read(&said.data, scene).ok());
                    self.calls.extend(call.map(|call| (tick, call)));
                }
                _ => {}
            }
        }
        self.felt = feeling.felt();
        Ok(())
    }
}

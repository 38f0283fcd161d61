//! The method as printed in the paper and the coupled method on the same cases, with the same measures.

use std::fmt;

use sulcus_core::math::norm;
use sulcus_core::output::status;
use sulcus_core::tissue::printed::PenaltyMeter;
pub use sulcus_core::tissue::printed::as_printed;
use sulcus_core::tissue::{Hand, Hands, TissueModel};
use sulcus_core::{MAX_TOOLS, Scene, State, TickOutput, Vec3};
use sulcus_operator::HandParams;

use crate::measure::Measures;
use crate::run::run_on;
use crate::table::{Case, Driver};

/// Method for the tissue of a case.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Method {
    /// Compliance inside the optimisation, which is the default of the program.
    Coupled,
    /// The printed method, in a tick with the usual limit of the tool's motion.
    Printed,
    /// The printed method, with a tool that moves up to 63 mm in one tick. The paper has no limit.
    PrintedUnlimited,
}

impl Method {
    /// All methods.
    pub const ALL: [Method; 3] = [Method::Coupled, Method::Printed, Method::PrintedUnlimited];
}

impl fmt::Display for Method {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(match self {
            Method::Coupled => "coupled",
            Method::Printed => "as printed",
            Method::PrintedUnlimited => "as printed, unlimited",
        })
    }
}

/// Allows the tool 64 substeps of 0.99 mm in a tick, with a prediction distance of a millimetre, without bounds on the
/// work and on the change of force.
fn unlimited(scene: &mut Scene) {
    scene.params.predict_min = 1e-3;
    scene.params.predict_max = 1e-3;
    scene.params.trust = 0.99;
    scene.params.max_substeps = 64;
    (scene.params.max_work, scene.params.max_arrival_step) = (0, 0.0);
}

/// Result of one case by one method.
#[derive(Clone, Debug, PartialEq)]
pub struct Compared {
    /// Name of the case.
    pub case: &'static str,
    /// Method of the run.
    pub method: Method,
    /// Measures of the run.
    pub measures: Measures,
    /// Ratio of the mean force on the tissue to the mean force on the device, over ticks with more than 0.05 N on the
    /// device. `None` without such a tick, and for a printed gingiva, which has displacements but no force.
    pub load_ratio: Option<f64>,
    /// Largest number of pairs of spheres that load a printed skeleton.
    pub pairs: u32,
    /// Number of tool-ticks in which the graphic tip is more than 2 mm above the haptic tip, after both were once
    /// within 2 mm.
    pub ejected: u64,
    /// Number of tool-ticks with [`status::FAULT`], after which a diverged tissue is at rest again.
    pub faults: u64,
}

/// Sums over a run.
#[derive(Default)]
struct Sums {
    meters: Option<Vec<Option<PenaltyMeter>>>,
    tissue: f64,
    device: f64,
    unknown: bool,
    arrived: [bool; MAX_TOOLS],
    pairs: u32,
    ejected: u64,
    faults: u64,
}

impl Sums {
    fn tick(&mut self, scene: &Scene, before: &State, output: &TickOutput, after: &State) {
        let meters = self.meters.get_or_insert_with(|| {
            let meter = |object: &sulcus_core::Object| match &object.tissue {
                TissueModel::PrintedSkeleton(model) => {
                    Some(PenaltyMeter::new(model, object, scene.tick_s()))
                }
                _ => None,
            };
            scene.objects.iter().map(meter).collect()
        });
        let objects = scene.objects.len();
        let present =
            |t: usize| t < scene.tools.len() && output.tools[t].status & status::ABSENT == 0;
        let hands = Hands {
            tools: std::array::from_fn(|t| {
                present(t).then(|| Hand {
                    tool: &scene.tools[t],
                    haptic: output.tools[t].haptic,
                    graphic: before.tools[t].graphic,
                    loads: &before.loads[t * objects..(t + 1) * objects],
                })
            }),
            detail: 0,
        };
        let (mut on_tissue, mut begin) = (Vec3::zeros(), 0);
        for (k, object) in scene.objects.iter().enumerate() {
            let state = &before.tissue[begin..];
            begin += object.tissue.state_len(&object.tree);
            match (&mut meters[k], &object.tissue) {
                (Some(meter), _) => {
                    let (force, pairs) = meter.load(state, &hands);
                    on_tissue += force;
                    self.pairs = self.pairs.max(pairs);
                }
                (None, TissueModel::PrintedGingiva(_)) => self.unknown = true,
                (None, _) => {
                    for t in 0..scene.tools.len() {
                        on_tissue += after.loads[t * objects + k].force;
                    }
                }
            }
        }
        let device = (0..MAX_TOOLS).fold(Vec3::zeros(), |sum, t| {
            sum + output.tools[t].raw_wrench.force
        });
        if norm(&device) > 0.05 {
            self.tissue += norm(&on_tissue);
            self.device += norm(&device);
        }
        for (t, tool) in scene.tools.iter().enumerate().filter(|(t, _)| present(*t)) {
            let out = &output.tools[t];
            let above = out.graphic.transform(&tool.tip) - out.haptic.transform(&tool.tip);
            self.arrived[t] |= norm(&above) < 2e-3;
            self.ejected += u64::from(self.arrived[t] && above.z > 2e-3);
            self.faults += u64::from(out.status & status::FAULT != 0);
        }
    }
}

/// The case with a hand and its device, which feel the wrench. A case that has a hand is unchanged.
pub fn by_hand(case: &Case) -> Case {
    let driver = match case.driver {
        Driver::Kinematic(script) => Driver::Closed(script, HandParams::default),
        closed => closed,
    };
    Case { driver, ..*case }
}

/// Runs `case` by `method`.
pub fn compare(case: &Case, method: Method) -> Compared {
    compare_changed(case, method, |_| {})
}

/// Runs `case` by `method` on the method's scene after `change`.
///
/// # Panics
/// The changed scene is not valid.
pub fn compare_changed(case: &Case, method: Method, change: impl FnOnce(&mut Scene)) -> Compared {
    let mut sums = Sums::default();
    let report = run_on(
        case,
        |scene| {
            if method != Method::Coupled {
                as_printed(scene);
            }
            if method == Method::PrintedUnlimited {
                unlimited(scene);
            }
            change(scene);
            scene.validate().expect("a scene that may run");
        },
        |seen| sums.tick(seen.scene, seen.before, seen.output, seen.after),
    );
    Compared {
        case: case.name,
        method,
        measures: report.measures,
        load_ratio: (!sums.unknown && sums.device > 0.0).then(|| sums.tissue / sums.device),
        pairs: sums.pairs,
        ejected: sums.ejected,
        faults: sums.faults,
    }
}

impl Compared {
    /// Heading for the lines of [`Compared`].
    pub fn heading() -> String {
        format!(
            "{:16} {:22} {:>9} {:>12} {:>10} {:>9} {:>11} {:>10} {:>8} {:>8} {:>8} {:>7} {:>10} {:>7}",
            "case",
            "method",
            "buzz N",
            "penetr. um",
            "(exh.) um",
            "jump mm",
            "torque Nmm",
            "step N",
            "most N",
            "dent mm",
            "F_t/F_d",
            "pairs",
            "exhausted",
            "ejected",
        )
    }
}

impl fmt::Display for Compared {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let m = &self.measures;
        let ratio = self
            .load_ratio
            .map_or("-".to_owned(), |ratio| format!("{ratio:.3}"));
        write!(
            f,
            "{:16} {:22} {:9.4} {:12.3} {:10.1} {:9.3} {:11.3} {:10.3} {:8.3} {:8.3} {:>8} {:7} {:10} {:7}",
            self.case,
            self.method,
            m.buzz,
            m.residual * 1e6,
            m.exhausted_residual * 1e6,
            m.jump * 1e3,
            m.torque_step * 1e3,
            m.force_step,
            m.max_raw_force,
            m.indentation * 1e3,
            ratio,
            self.pairs,
            m.exhausted,
            self.ejected,
        )
    }
}

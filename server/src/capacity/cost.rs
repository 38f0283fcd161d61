//! CPU time of the ticks of a scene.

use serde::{Deserialize, Serialize};
use sulcus_core::{NoProbe, Scene, State, TickInput, ToolInput, Vec3, Workspace, tick};
use sulcus_link::clock::thread_cpu_ns;

use super::motion::Motion;

/// Ticks of the approach to the first contact, which do not count.
pub(super) const APPROACH: u64 = 300;
/// Ticks of a measurement, the approach included: two seconds at 1 kHz.
const TICKS: u64 = 2000;
/// Most CPU time of a measurement, nanoseconds. A slower scene is measured by fewer ticks, at least [`LEAST`].
const MOST_CPU_NS: u64 = 3_000_000_000;
/// Least number of counted ticks.
const LEAST: u64 = 50;
/// Number of passes over the same inputs. The faster time of each tick counts: other processes only add time.
const PASSES: u32 = 2;
/// Share of the difference by which an estimate falls at each update.
const FALL: f64 = 1.0 / 16.0;

/// CPU time of a tick, microseconds.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Cost {
    /// Mean.
    pub mean_us: f64,
    /// Median.
    pub p50_us: f64,
    /// 99th percentile.
    pub p99_us: f64,
    /// 99.9th percentile.
    pub p999_us: f64,
}

impl Cost {
    /// Whether every time is finite, not negative, and in order.
    pub fn is_sound(&self) -> bool {
        let ascending = [0.0, self.p50_us, self.p99_us, self.p999_us, 1e9];
        ascending.is_sorted() && self.mean_us.is_finite() && self.mean_us >= 0.0
    }
}

/// Upper estimate of a cost that follows running sessions: it rises at once and falls slowly.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Estimate(Cost);

impl Estimate {
    /// Estimate that begins with a measured cost.
    pub fn new(cost: Cost) -> Self {
        Self(cost)
    }

    /// Present estimate.
    pub fn cost(&self) -> Cost {
        self.0
    }

    /// Takes the cost of the last seconds of a session. A cost that is not sound is ignored.
    pub fn take(&mut self, seen: Cost) {
        if !seen.is_sound() {
            return;
        }
        let follow = |estimate: &mut f64, seen: f64| {
            *estimate = if seen > *estimate {
                seen
            } else {
                *estimate + (seen - *estimate) * FALL
            };
        };
        follow(&mut self.0.mean_us, seen.mean_us);
        follow(&mut self.0.p50_us, seen.p50_us);
        follow(&mut self.0.p99_us, seen.p99_us);
        follow(&mut self.0.p999_us, seen.p999_us);
    }
}

/// Measured cost, and the number of ticks behind it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Measured {
    /// CPU time of the counted ticks.
    pub cost: Cost,
    /// Number of counted ticks.
    pub ticks: u64,
    /// Number of counted ticks with a force on at least one tool.
    pub in_contact: u64,
}

/// Cost of the scene's ticks on this machine, with all tools in contact. See [`measure`].
///
/// # Errors
/// The system gives no thread, or the tick panics.
pub fn measure_cost(scene: &Scene) -> std::io::Result<Cost> {
    Ok(measure(scene)?.cost)
}

/// Runs up to 2000 ticks twice in a thread of its own at normal priority and takes their CPU time.
///
/// A probe walks in a pocket, any other tool presses the nearest surface. The motion is the same at every call. The
/// faster of the two times of a tick counts.
///
/// # Errors
/// The system gives no thread, or the tick panics.
pub fn measure(scene: &Scene) -> std::io::Result<Measured> {
    std::thread::scope(|scope| {
        let thread = std::thread::Builder::new().name("sulcus-cost".into());
        let thread = thread.spawn_scoped(scope, || run(scene))?;
        thread
            .join()
            .map_err(|_| std::io::Error::other("the measurement of a tick's cost panicked"))
    })
}

fn run(scene: &Scene) -> Measured {
    let motions: Vec<Motion> = (0..scene.tools.len())
        .map(|t| Motion::of(scene, t))
        .collect();
    let mut fastest = Vec::with_capacity((TICKS - APPROACH) as usize);
    let (mut spent_ns, mut in_contact) = (0, 0);
    for pass in 0..PASSES {
        let touched = run_once(scene, &motions, &mut fastest, &mut spent_ns);
        if pass == 0 {
            in_contact = touched;
        }
        if spent_ns > MOST_CPU_NS {
            break;
        }
    }
    Measured {
        cost: cost_of(&mut fastest),
        ticks: fastest.len() as u64,
        in_contact,
    }
}

/// Runs all ticks, or fewer when the CPU time is spent. Lowers the times of `fastest`, nanoseconds, which the first
/// pass fills. Returns the number of counted ticks with a force.
fn run_once(scene: &Scene, motions: &[Motion], fastest: &mut Vec<u64>, spent_ns: &mut u64) -> u64 {
    let (mut state, mut workspace) = (State::new(scene), Workspace::new(scene));
    let is_first = fastest.is_empty();
    let mut in_contact = 0;
    for k in 0..TICKS {
        let mut input = TickInput::IDLE;
        for (slot, motion) in input.tools.iter_mut().zip(motions) {
            *slot = ToolInput::at(&motion.pose(k));
        }
        let before = thread_cpu_ns();
        let output = tick(scene, &mut state, &mut workspace, &input, &mut NoProbe);
        let took = thread_cpu_ns().saturating_sub(before);
        *spent_ns += took;
        let Some(counted) = k.checked_sub(APPROACH) else {
            continue;
        };
        if is_first {
            fastest.push(took);
        } else if let Some(known) = fastest.get_mut(counted as usize) {
            *known = took.min(*known);
        } else {
            break;
        }
        let touches = |tool: &sulcus_core::ToolOutput| tool.wrench.force != Vec3::zeros();
        in_contact += u64::from(output.tools.iter().any(touches));
        if *spent_ns > MOST_CPU_NS && counted + 1 >= LEAST {
            break;
        }
    }
    in_contact
}

/// Cost of ticks by their times, nanoseconds. The times are sorted.
fn cost_of(times: &mut [u64]) -> Cost {
    times.sort_unstable();
    let at = |share: f64| {
        let place = (share * times.len() as f64).ceil() as usize;
        let time = times.get(place.clamp(1, times.len().max(1)) - 1);
        time.map_or(0.0, |ns| *ns as f64 / 1e3)
    };
    let sum: u64 = times.iter().sum();
    Cost {
        mean_us: sum as f64 / times.len().max(1) as f64 / 1e3,
        p50_us: at(0.5),
        p99_us: at(0.99),
        p999_us: at(0.999),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use sulcus_scene::{BuildOptions, BuiltIn, compile_built_in};

    fn cost(us: f64) -> Cost {
        Cost {
            mean_us: us,
            p50_us: us,
            p99_us: 2.0 * us,
            p999_us: 3.0 * us,
        }
    }

    #[test]
    fn a_measurement_counts_ticks_in_contact() {
        for scene in [BuiltIn::Crown, BuiltIn::Pocket, BuiltIn::Tongue] {
            let options = BuildOptions {
                deepest: Some(4),
                ..BuildOptions::cached()
            };
            let scene = compile_built_in(scene, &options, &|_, _| ())
                .expect("compiles")
                .scene;
            let measured = measure(&scene).expect("a thread");
            assert!(
                measured.cost.is_sound() && measured.cost.p50_us > 0.0,
                "{measured:?}"
            );
            assert!(
                (LEAST..=TICKS - APPROACH).contains(&measured.ticks),
                "{measured:?}"
            );
            assert!(
                2 * measured.in_contact > measured.ticks,
                "{}: {measured:?}",
                scene.name
            );
        }
    }

    #[test]
    fn an_estimate_rises_at_once_and_falls_slowly() {
        let mut estimate = Estimate::new(cost(10.0));
        estimate.take(cost(40.0));
        assert_eq!(estimate.cost(), cost(40.0));
        estimate.take(cost(8.0));
        assert_eq!(estimate.cost().mean_us, 38.0);
        for _ in 0..200 {
            estimate.take(cost(8.0));
        }
        assert!((estimate.cost().p999_us - 24.0).abs() < 0.1, "{estimate:?}");
        assert!(estimate.cost().is_sound());
    }

    #[test]
    fn a_cost_that_is_no_cost_changes_nothing() {
        let mut estimate = Estimate::new(cost(10.0));
        for wrong in [f64::NAN, -1.0, f64::INFINITY] {
            estimate.take(Cost {
                p99_us: wrong,
                ..cost(20.0)
            });
            estimate.take(Cost {
                mean_us: wrong,
                ..cost(20.0)
            });
        }
        estimate.take(Cost {
            p50_us: 500.0,
            ..cost(20.0)
        });
        assert_eq!(estimate.cost(), cost(10.0));
    }
}

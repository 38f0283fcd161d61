//! Loop at a single rate against two rates, in the same task: a mirror in one hand presses the soft tongue, slides on
//! it and lets go.

use sulcus_core::math::norm;
use sulcus_core::output::status;
use sulcus_core::{Params, Scene, TickInput, Vec3};
use sulcus_operator::retraction::{Retraction, RetractionParams};
use sulcus_operator::{HandParams, Operator, Shown};

use super::{Loops, Rates};
use crate::measure::{Measures, Observer};
use crate::table::find;
use crate::tissue_scenes::tongue;

/// Couplings of the mirror, N/mm.
const COUPLINGS: [f64; 2] = [0.5, 2.0];
/// Seed of the hand's tremor.
const SEED: u64 = 7;
/// Length of the task, seconds: in a full study, and in a quick one.
const SECONDS: [f64; 2] = [8.0, 4.0];
/// Hard case whose bounds every loop is compared with.
const CASE: &str = "tongue-10-k0.5";

/// Result of one simulation.
#[derive(Clone, Debug)]
pub struct Rated {
    /// Rates of the simulation.
    pub rates: Rates,
    /// Measures with a hand that feels this simulation.
    pub closed: Measures,
    /// Measures on the inputs of the hand with one loop, which are the same for all rates.
    pub open: Measures,
    /// Root mean square of the difference from the raw force of one loop on the same inputs, newtons, over ticks with
    /// more than 1 mN in either.
    pub rms_difference: f64,
    /// Largest length of that difference, newtons.
    pub max_difference: f64,
    /// Root mean square of the raw force of one loop over the same ticks, newtons.
    pub rms_force: f64,
    /// Number of ticks of the closed loop with [`status::FAULT`] or [`status::SOLVER_FAILED`].
    pub faults: u64,
    /// Broken bounds of the hard case in the closed loop, in words. Unrest, margin and the length of contact are not
    /// compared.
    pub broken: Vec<String>,
    /// Whether the energy of the closed loop is within the bound of the hard case, without faults.
    pub stable: bool,
    /// Length of the raw force on the common inputs, newtons, for every tick.
    pub forces: Vec<f64>,
}

/// Results of one scene at all rates.
#[derive(Clone, Debug)]
pub struct Study {
    /// Scene, hand and seed, in words.
    pub about: String,
    /// Coupling of the tool, N/mm.
    pub coupling_n_per_mm: f64,
    /// Results in the order of [`Rates::ALL`].
    pub rates: Vec<Rated>,
}

/// Results of the study.
#[derive(Clone, Debug)]
pub struct MultiRate {
    /// Length of a step of the slow loop, seconds.
    pub slow_step_s: f64,
    /// Results by coupling.
    pub studies: Vec<Study>,
}

/// Runs the study; a `quick` one takes half of the time.
///
/// # Panics
/// The shipped tongue does not compile, which is a fault of the scene.
pub fn study(quick: bool) -> MultiRate {
    let seconds = SECONDS[usize::from(quick)];
    MultiRate {
        slow_step_s: super::EVERY as f64 * Params::default().tick_s(),
        studies: COUPLINGS
            .map(|coupling| one(&tongue(coupling), coupling, seconds))
            .to_vec(),
    }
}

fn one(scene: &Scene, coupling: f64, seconds: f64) -> Study {
    // The inputs are those of one loop, so its closed and open results are the same.
    let single = closed(scene, Rates::Single, seconds);
    let rates = Rates::ALL.map(|rates| match rates {
        Rates::Single => rated(rates, &single, &single, &single.forces),
        _ => {
            let felt = closed(scene, rates, seconds);
            let open = open(scene, rates, &single.inputs);
            rated(rates, &felt, &open, &single.forces)
        }
    });
    Study {
        about: format!(
            "the shipped tongue, mirror coupled with {coupling} N/mm, pressed 7 mm in, slid and let go by a hand in {seconds} s, seed {SEED}"
        ),
        coupling_n_per_mm: coupling,
        rates: rates.to_vec(),
    }
}

/// Record of a run.
struct Ran {
    inputs: Vec<TickInput>,
    forces: Vec<Vec3>,
    measures: Measures,
    faults: u64,
}

/// Runs `scene` at `rates`. `input` gives the input of each tick from its number and the last output.
fn ran(
    scene: &Scene,
    rates: Rates,
    ticks: usize,
    mut input: impl FnMut(usize, &Shown) -> TickInput,
) -> Ran {
    let mut loops = Loops::new(scene, rates);
    let mut observer = Observer::new(scene);
    // Measures of shapes are of no use here, and a query takes longer than a tick.
    observer.residual_every = u64::MAX;
    let mut ran = Ran {
        inputs: Vec::with_capacity(ticks),
        forces: Vec::with_capacity(ticks),
        measures: Measures::default(),
        faults: 0,
    };
    let mut shown = Shown::NOTHING;
    for k in 0..ticks {
        let input = input(k, &shown);
        let output = loops.tick(&input);
        observer.observe(scene, &input, &output, loops.workspace());
        shown = Shown::from(&output);
        let trouble = status::FAULT | status::SOLVER_FAILED;
        ran.faults += u64::from(output.tools[0].status & trouble != 0);
        ran.inputs.push(input);
        ran.forces.push(output.tools[0].raw_wrench.force);
    }
    ran.measures = observer.measures();
    ran
}

fn closed(scene: &Scene, rates: Rates, seconds: f64) -> Ran {
    let params = RetractionParams {
        duration: seconds,
        flank: 0.0,
        aside: 0.0,
        hold: 0.5,
        times: 1,
        ..RetractionParams::default()
    };
    let script = Retraction::new(scene, params).expect("a tongue and a mirror");
    let mut hand = Operator::new(Box::new(script), HandParams::default(), SEED);
    ran(
        scene,
        rates,
        (seconds / scene.tick_s()) as usize,
        |_, shown| {
            let mut input = TickInput::IDLE;
            input.tools = hand.step(shown);
            input
        },
    )
}

fn open(scene: &Scene, rates: Rates, inputs: &[TickInput]) -> Ran {
    ran(scene, rates, inputs.len(), |k, _| inputs[k])
}

/// Smallest raw force of a contact, newtons.
const TOUCHED: f64 = 1e-3;

fn rated(rates: Rates, felt: &Ran, open: &Ran, single: &[Vec3]) -> Rated {
    let (mut squared, mut force, mut most, mut n) = (0.0, 0.0, 0.0_f64, 0_u32);
    for (ours, theirs) in open.forces.iter().zip(single) {
        if norm(ours).max(norm(theirs)) > TOUCHED {
            let off = ours - theirs;
            squared += off.norm_squared();
            force += theirs.norm_squared();
            most = most.max(norm(&off));
            n += 1;
        }
    }
    let mean = |sum: f64| (sum / f64::from(n.max(1))).sqrt();
    let bounds = find(CASE).expect("a case of the table").bounds;
    // The tissue may still move at the end.
    let asked = crate::Bounds {
        unrest: f64::INFINITY,
        contact_ticks: 1,
        ..bounds
    };
    Rated {
        rates,
        broken: asked.broken(&felt.measures, f64::INFINITY),
        stable: felt.faults == 0 && felt.measures.energy <= bounds.energy,
        faults: felt.faults,
        closed: felt.measures,
        open: open.measures,
        rms_difference: mean(squared),
        max_difference: most,
        rms_force: mean(force),
        forces: open.forces.iter().map(norm).collect(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn two_rates_differ_in_force_and_buzz() {
        let found = study(true);
        for study in &found.studies {
            println!("{}", study.about);
            for rated in &study.rates {
                let (c, o) = (&rated.closed, &rated.open);
                println!(
                    "  {:28} rms {:.4} max {:.4} of {:.3} N; open buzz {:.5} step {:.4} jump {:.3} mm; closed buzz {:.5} step {:.4} jump {:.3} mm energy {:.4} mJ work {:.2} mJ exhausted {} settling {} contact {}; {} {:?}",
                    rated.rates.name(),
                    rated.rms_difference,
                    rated.max_difference,
                    rated.rms_force,
                    o.buzz,
                    o.force_step,
                    o.jump * 1e3,
                    c.buzz,
                    c.force_step,
                    c.jump * 1e3,
                    c.energy * 1e3,
                    c.work_in * 1e3,
                    c.exhausted,
                    c.settling,
                    c.contact_ticks,
                    rated.stable,
                    rated.broken,
                );
            }
            let [single, others @ ..] = &study.rates[..] else {
                panic!("no rates");
            };
            assert_eq!(single.rms_difference, 0.0, "the same inputs, the same bits");
            assert!(single.rms_force > 0.1 && single.stable, "{single:?}");
            for other in others {
                assert!(other.rms_difference > 0.0);
                assert!(
                    other.open.buzz > single.open.buzz,
                    "{}: {} against {}",
                    other.rates.name(),
                    other.open.buzz,
                    single.open.buzz
                );
            }
        }
    }
}

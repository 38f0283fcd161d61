//! `devices handle`: finds the tip of the instrument that is fixed to a device.
//!
//! The person holds the tip in a dimple and turns the handle. No order reaches the device, so that no force is
//! displayed.

use std::time::{Duration, Instant};

use anyhow::{Context, bail};
use sulcus_connection::interrupt;
use sulcus_devices::handle::{Guide, Handle, Hint, Side};
use sulcus_haptics::device::Stop;
use sulcus_haptics::hands::drawn;
use sulcus_haptics::{HandEnd, port};
use sulcus_program::{PathText, say, tell};

use super::identify::closed;
use super::settings::Hand;
use super::{opened, stored};
use crate::cli::HandleArgs;

/// Time for all touches.
const PATIENCE: Duration = Duration::from_secs(180);
/// Period of the reading of samples.
const PERIOD: Duration = Duration::from_millis(1);

/// Finds the tip and writes the handle file.
///
/// # Errors
/// The device cannot be opened, the touches do not agree, or a file cannot be written.
pub fn run(args: &HandleArgs) -> anyhow::Result<u8> {
    let (mut settings, file) = stored()?;
    let (mut device, hand) = opened::alone(&args.device, &settings)?;
    if hand.info.motion_dof < 6 {
        bail!(
            "{} measures motion in {} axes, expected 6: without rotation the tip cannot be found",
            hand.model.name,
            hand.info.motion_dof
        );
    }
    let (port, mut end) = port::door(closed(&*device));
    let stop = Stop::new();
    let pivot = std::thread::scope(|scope| {
        let run = || {
            if let Err(error) = device.run(vec![port], &stop) {
                tell!("error: {error}");
            }
        };
        scope.spawn(run);
        let found = collect(&mut end, usize::from(args.touches));
        stop.ask();
        found
    })?;
    let side = match hand.settings.hand {
        Some(Hand::Left) => Side::Left,
        Some(Hand::Right) => Side::Right,
        None => Side::Either,
    };
    let handle = Handle::straight(&args.name, side, 0.0, &pivot);
    std::fs::write(&args.out, handle.to_toml()?)
        .with_context(|| format!("{}: cannot write", args.out.shown()))?;
    let [x, y, z] = handle.gimbal_from_tip_mm;
    say!(
        "tip of {}: {x:.1}, {y:.1}, {z:.1} mm from the centre of the gimbal, residual {:.2} mm",
        args.name,
        handle.residual_mm.unwrap_or(0.0)
    );
    say!("written to {}", args.out.shown());
    if args.store {
        let mut stored = settings.of(hand.info.library, &hand.info.serial);
        stored.handle = Some(std::path::absolute(&args.out)?);
        settings.store(stored);
        settings
            .write(&file.context("no folder for the settings: set SULCUS_STATE_DIR or HOME")?)?;
    }
    Ok(0)
}

/// Collects the touches.
fn collect(end: &mut HandEnd, touches: usize) -> anyhow::Result<sulcus_devices::handle::Pivot> {
    tell!("put the tip into a dimple, hold the handle still, then turn it and hold it still again");
    let (mut guide, begin) = (Guide::new(), Instant::now());
    let mut told = Hint::Turn;
    let mut last = 0;
    while begin.elapsed() < PATIENCE && !interrupt::asked() {
        std::thread::sleep(PERIOD);
        let sample = end.sample();
        let pose = drawn(&sample.pose).filter(|_| sample.present && sample.sequence != last);
        last = sample.sequence;
        let Some(pose) = pose else { continue };
        let hint = guide.step(&pose);
        if hint != told {
            match &hint {
                Hint::Turn => {
                    tell!("turn the handle by more than 20 degrees, the tip in the dimple")
                }
                Hint::Still => tell!("hold still"),
                Hint::Taken(number) => tell!("touch {number} of {touches} taken"),
            }
            told = hint;
        }
        if guide.is_enough() && guide.poses().len() >= touches {
            match guide.finish() {
                Ok(pivot) => return Ok(pivot),
                Err(error) => tell!("{error}; touch again"),
            }
        }
    }
    bail!(
        "{} of {touches} touches were taken within {} s; the device must give a pose, and the handle must stand still",
        guide.poses().len(),
        PATIENCE.as_secs()
    )
}

//! A tissue model from a scene file: a tongue that deforms under a mouth mirror.
//!
//! ```text
//! cargo run --release -p sulcus-scene --example tongue
//! ```

use std::path::Path;

use sulcus_core::math::norm;
use sulcus_core::*;
use sulcus_scene::{BuildOptions, compile_file};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("../scenes/tongue.toml");
    let compiled = compile_file(&file, &BuildOptions::cached(), &|stage, done| {
        eprintln!("{:3.0} %  {stage}", 100.0 * done);
    })?;
    // `tissue` names the model: rigid, skeleton, surface compliance, gingiva, and two models as printed in the paper.
    let scene = compiled.scene;
    let (mut state, mut workspace) = (State::new(&scene), Workspace::new(&scene));
    let park = scene.tools[0].park;
    for k in 1..=2000 {
        // The mirror moves down by 55 mm in 1.5 s, 15 mm of them into the tongue, and rests there.
        let down = 55e-3 * f64::min(f64::from(k) / 1500.0, 1.0);
        let pose = Pose::new(park.position - Vec3::z() * down, park.orientation);
        let mut input = TickInput::IDLE;
        input.tools[0] = ToolInput::at(&pose);
        let out = tick(&scene, &mut state, &mut workspace, &input, &mut NoProbe).tools[0];
        if k % 200 == 0 {
            let moved = workspace.carriers_moved(&scene, 0);
            let most = moved.iter().map(norm).fold(0.0, f64::max);
            println!(
                "mirror {:4.1} mm down, force {:4.2} N, tissue moved {:4.1} mm",
                down * 1e3,
                norm(&out.wrench.force),
                most * 1e3
            );
        }
    }
    Ok(())
}

//! The core alone: two sphere trees, one tool, one second of ticks, the wrench at the hand.
//!
//! ```text
//! cargo run --release -p sulcus-core --example press
//! ```

#![expect(clippy::disallowed_macros, reason = "an example prints")]

use sulcus_core::tissue::TissueModel;
use sulcus_core::*;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let radius = 1e-3;
    let ball = |x: i32, y: i32| Sphere {
        centre: Vec3::new(f64::from(x), f64::from(y), 0.0) * radius,
        radius,
    };
    let plate: Vec<Sphere> = (-3..=3)
        .flat_map(|x| (-3..=3).map(move |y| ball(x, y)))
        .collect();
    let probe = Tool {
        name: "probe".into(),
        tree: SphereTree::over_leaves(&[ball(0, 0)])?,
        level: 3,
        working_point: Vec3::zeros(),
        tip: Vec3::new(0.0, 0.0, -radius),
        tip_axis: -Vec3::z(),
        stiffness_n_per_m: 500.0,
        stiffness_nm_per_rad: 0.5,
        park: Pose::new(Vec3::new(0.0, 0.0, 0.02), Quat::identity()),
        bands: vec![],
        mesh: DisplayMesh::default(),
    };
    let plate = Object {
        name: "plate".into(),
        fdi: 0,
        tree: SphereTree::over_leaves(&plate)?,
        level: 3,
        tissue: TissueModel::Rigid,
        mesh: DisplayMesh::default(),
        carriers: vec![],
    };
    let scene = Scene {
        name: "plate".into(),
        source_hash: "none".into(),
        params: Params::default(),
        tools: vec![probe],
        objects: vec![plate],
    };
    scene.validate()?;
    let (mut state, mut workspace) = (State::new(&scene), Workspace::new(&scene));
    for k in 1..=1000 {
        // The hand moves down through the plate: 4 mm above to 2 mm below in 0.6 s, then it rests.
        let z = 4e-3 - 6e-3 * sulcus_core::math::fmin(f64::from(k) / 600.0, 1.0);
        let mut input = TickInput::IDLE;
        input.tools[0] = ToolInput::at(&Pose::new(Vec3::new(0.0, 0.0, z), Quat::identity()));
        let out = tick(&scene, &mut state, &mut workspace, &input, &mut NoProbe).tools[0];
        if k % 100 == 0 {
            let graphic = out.graphic.position.z * 1e3;
            println!(
                "hand {:5.2} mm, tool {graphic:5.2} mm, force {:5.2} N",
                z * 1e3,
                out.wrench.force.z
            );
        }
    }
    Ok(())
}

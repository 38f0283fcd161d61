//! Poses from a random walk with leaps, turns, absences and bad numbers: nothing panics, nothing is
//! penetrated in a converged tick, nothing that is not finite comes out.

use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::{Rng, SeedableRng};
use sulcus_cases::scenes::TIP_BELOW_DEVICE;
use sulcus_cases::{Observer, find};
use sulcus_core::{NoProbe, Pose, RawPose, State, TickInput, ToolInput, Vec3, Workspace, tick};

#[test]
fn twenty_thousand_ticks_of_random_poses() {
    for (seed, case) in [(1, "wedge"), (2, "thin-plate-0.5"), (3, "sharp-edge")] {
        let scene = (find(case).expect("in the table").scene)();
        let (mut state, mut ws) = (State::new(&scene), Workspace::new(&scene));
        let mut observer = Observer::new(&scene);
        let mut rng = ChaCha8Rng::seed_from_u64(seed);
        let mut unit = || (rng.next_u64() >> 40) as f32 / (1u32 << 24) as f32;
        let (mut tip, mut facing) = ([0.0f32, 0.0, 0.005], [1.0f32, 0.0, 0.0, 0.0]);
        for _ in 0..20_000 {
            // Mostly small steps; now and then a leap, a turn, a bad number.
            let reach = if unit() < 0.01 { 0.02 } else { 3e-4 };
            for (k, x) in tip.iter_mut().enumerate() {
                let home = if k == 2 { -5e-4 } else { 0.0 };
                *x += (unit() - 0.5) * reach + (home - *x) * 0.005;
            }
            let turn = if unit() < 0.005 { 2.0 } else { 0.01 };
            for (k, q) in facing.iter_mut().enumerate() {
                let home = if k == 0 { 1.0 } else { 0.0 };
                *q += (unit() - 0.5) * turn + (home - *q) * 0.01;
            }
            let [w, x, y, z] = facing.map(f64::from);
            let facing = sulcus_core::math::normalised(w, x, y, z);
            let at =
                Vec3::from(tip.map(f64::from)) + facing * Vec3::new(0.0, 0.0, TIP_BELOW_DEVICE);
            let pose = RawPose::from(&Pose::new(at, facing));
            let mut input = TickInput::IDLE;
            input.tools[0] = ToolInput {
                pose,
                present: unit() > 0.002,
                ..ToolInput::ABSENT
            };
            if unit() < 0.01 {
                let slot = (unit() * 7.0) as usize;
                let bad =
                    [f32::NAN, f32::INFINITY, f32::MIN_POSITIVE / 4.0][(unit() * 3.0) as usize % 3];
                if slot < 3 {
                    input.tools[0].pose.position[slot] = bad;
                } else {
                    input.tools[0].pose.orientation[slot - 3] = bad;
                }
            }
            let output = tick(&scene, &mut state, &mut ws, &input, &mut NoProbe);
            let sent = &output.tools[0].wrench;
            assert!(
                sent.force
                    .iter()
                    .chain(sent.torque.iter())
                    .all(|x| x.is_finite())
            );
            observer.observe(&scene, &input, &output, &ws);
        }
        let m = observer.measures();
        println!("{case}: {m:?}");
        assert!(
            m.contact_ticks > 2_000,
            "{case}: only {} ticks in contact",
            m.contact_ticks
        );
        assert!(m.residual <= 1e-6, "{case}: residual {:e} m", m.residual);
        assert!(
            m.max_force <= scene.params.max_force + 1e-9,
            "{case}: {} N",
            m.max_force
        );
        assert!(
            m.sent_step <= scene.params.max_force_step + 1e-9,
            "{case}: {} N in a tick",
            m.sent_step
        );
    }
}

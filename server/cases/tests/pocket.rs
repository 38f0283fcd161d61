//! A probe in the pocket of one molar, through the whole tick: depths, forces, turning, release.

use std::f64::consts::PI;
use std::path::Path;
use std::sync::{Mutex, PoisonError};

use sulcus_cases::pocket::{Way, gingiva_of};
use sulcus_cases::{Measures, Observer};
use sulcus_core::math::norm;
use sulcus_core::output::{ForceZone, PocketReading, status};
use sulcus_core::tissue::TissueModel;
use sulcus_core::tissue::gingiva::Gingiva;
use sulcus_core::{
    MAX_TOOLS, NoProbe, Pose, Scene, State, TickInput, TickOutput, Vec3, Workspace, Wrench, tick,
};
use sulcus_operator::script::{OneTool, smoothstep};
use sulcus_operator::{HandParams, Operator, present};
use sulcus_scene::{BuildOptions, compile_file};

fn shipped() -> &'static str {
    sulcus_scene::BuiltIn::Pocket.text()
}

/// Prescribed depths of the shipped scene, metres, and their angles, degrees from mesial over buccal.
const SITES: [(f64, f64); 6] = [
    (35.0, 3e-3),
    (90.0, 2e-3),
    (145.0, 3e-3),
    (215.0, 4e-3),
    (270.0, 2.5e-3),
    (325.0, 3e-3),
];

/// The shipped scene with some of its text changed; trees come from the cache where they can.
fn scene_with(changes: &[(&str, &str)]) -> Scene {
    // One at a time: two tests must not build the same tree side by side.
    static BUILDING: Mutex<()> = Mutex::new(());
    let _building = BUILDING.lock().unwrap_or_else(PoisonError::into_inner);
    let text = changes
        .iter()
        .fold(shipped().to_owned(), |text, (from, to)| {
            assert!(text.contains(from), "{from}");
            text.replace(from, to)
        });
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR"));
    let file = folder.join(format!("pocket-{:?}.toml", std::thread::current().id()));
    std::fs::write(&file, text).expect("a scene file");
    compile_file(&file, &BuildOptions::cached(), &|_, _| ())
        .expect("a scene")
        .scene
}

fn model(scene: &mut Scene) -> &mut Gingiva {
    match &mut scene.objects[1].tissue {
        TissueModel::Gingiva(model) => model,
        other => panic!("{other:?}"),
    }
}

/// A simulation with its measures.
struct Run {
    scene: Scene,
    state: State,
    ws: Workspace,
    observer: Observer,
    last: Option<TickOutput>,
    /// Largest change of the torque in a tick, N m.
    torque_step: f64,
}

impl Run {
    fn new(scene: &Scene) -> Self {
        let mut observer = Observer::new(scene);
        observer.residual_every = 100;
        Self {
            scene: scene.clone(),
            state: State::new(scene),
            ws: Workspace::new(scene),
            observer,
            last: None,
            torque_step: 0.0,
        }
    }

    fn input(pose: &Pose) -> TickInput {
        let mut input = TickInput::IDLE;
        input.tools[0] = present(pose);
        input
    }

    fn tick(&mut self, pose: &Pose) -> TickOutput {
        self.step(&Self::input(pose))
    }

    fn step(&mut self, input: &TickInput) -> TickOutput {
        let out = tick(
            &self.scene,
            &mut self.state,
            &mut self.ws,
            input,
            &mut NoProbe,
        );
        self.observer.observe(&self.scene, input, &out, &self.ws);
        if let Some(last) = &self.last {
            // About the tip's working point, so that the lever to the hand does not hide or make anything.
            let change = norm(&(self.torque(&out) - self.torque(last)));
            self.torque_step = self.torque_step.max(change);
        }
        self.last = Some(out);
        out
    }

    /// Raw torque about the working point of the haptic tool.
    fn torque(&self, out: &TickOutput) -> Vec3 {
        let lever = -(out.tools[0].haptic.orientation * self.scene.tools[0].working_point);
        out.tools[0].raw_wrench.moved(&lever).torque
    }

    fn measures(&self) -> Measures {
        self.observer.measures()
    }
}

fn way(scene: &Scene, degrees: f64, depth: f64) -> Way {
    let (_, _, model) = gingiva_of(scene).expect("a gingiva");
    let around = degrees.to_radians();
    let around = if around > PI {
        around - 2.0 * PI
    } else {
        around
    };
    let height = model.margin_at(around) - depth + model.params.sink();
    Way::new(scene, 0, &model.tooth, around, height)
}

/// Comes in 8 mm over the floor, goes down at 8 mm/s to `end` over it.
fn go_in(run: &mut Run, way: &Way, end: f64) {
    let tool = run.scene.tools[0].clone();
    for k in 0..1500 {
        let t = f64::from(k) * 1e-3;
        let above = (8e-3 - 8e-3 * (t - 0.3).max(0.0)).max(end);
        run.tick(&way.pose(&tool, above, 0.0, 0.0));
    }
}

/// A hand that presses along the tooth's axis and yields to and from the tooth, as one does that feels for the floor and not
/// against the tooth; round the tooth it holds, or it would slide down to where the floor is deeper.
#[derive(Clone, Copy, Default)]
struct Feeler {
    /// How far it has pressed, metres.
    pressed: f64,
    /// How far it has yielded.
    aside: Vec3,
}

impl Feeler {
    fn step(&mut self, run: &mut Run, way: &Way, by: f64) -> TickOutput {
        self.pressed += by;
        let mut pose = way.pose(&run.scene.tools[0], 0.0, 0.0, 0.0);
        pose.position += self.aside - Vec3::z() * self.pressed;
        let out = run.tick(&pose);
        let force = out.tools[0].raw_wrench.force;
        // A coupling of 500 N/m follows in 200 ticks.
        self.aside += way.outward * (way.outward.dot(&force) * 1e-5);
        out
    }

    /// Presses at a millimetre a second until the floor bears `newtons`; the reading there.
    fn press_to(&mut self, run: &mut Run, way: &Way, newtons: f64) -> PocketReading {
        for _ in 0..10_000 {
            let out = self.step(run, way, 1e-6);
            if let Some(reading) = out.tools[0].pocket.filter(|p| p.floor_force >= newtons) {
                return reading;
            }
        }
        panic!("the floor never bore {newtons} N: {:?}", run.last);
    }
}

#[test]
fn the_prescribed_depth_is_read_at_probing_force_and_more_at_more() {
    let mut scene = scene_with(&[]);
    let params = model(&mut scene).params;
    for (degrees, depth) in SITES {
        let way = way(&scene, degrees, depth);
        let mut run = Run::new(&scene);
        go_in(&mut run, &way, 0.0);
        let mut hand = Feeler::default();
        let mut read = |newtons| hand.press_to(&mut run, &way, newtons);
        let readings = [0.2, 0.25, 0.6].map(&mut read);
        let over = (0.6 - params.reading_force) / params.floor_stiffness;
        let [light, firm, heavy] = readings.map(|p| p.depth);
        println!(
            "{degrees}: {:.2} mm prescribed; {:.2} at 0.2 N, {:.2} at 0.25 N, {:.2} at 0.6 N (by the parameters {:.2})",
            depth * 1e3,
            light * 1e3,
            firm * 1e3,
            heavy * 1e3,
            (depth + over) * 1e3
        );
        for found in [light, firm] {
            assert!((found - depth).abs() <= 0.3e-3, "{degrees}: {found:e} m");
        }
        assert!(
            (heavy - depth - over).abs() <= 0.3e-3,
            "{degrees}: {heavy:e} m"
        );
        let around = if degrees > 180.0 {
            degrees - 360.0
        } else {
            degrees
        };
        for reading in readings {
            assert!((reading.around.to_degrees() - around).abs() < 10.0);
            assert_eq!(reading.object, 1);
        }
        let residual = run.measures().residual;
        assert!(residual < 1e-6, "{residual:e} m");
    }
    // Inflamed: the same force goes deeper, by what the parameters say.
    model(&mut scene).params.inflammation = 1.0;
    let (degrees, depth) = SITES[3];
    let way = way(&scene, degrees, depth);
    let mut run = Run::new(&scene);
    go_in(&mut run, &way, 0.0);
    let inflamed = Feeler::default()
        .press_to(&mut run, &way, params.reading_force)
        .depth;
    let more = params.sink() * (1.0 / (1.0 - params.softening) - 1.0);
    println!(
        "inflamed: {:.2} mm, by the parameters {:.2}",
        inflamed * 1e3,
        (depth + more) * 1e3
    );
    assert!((inflamed - depth - more).abs() <= 0.3e-3, "{inflamed:e} m");
}

#[test]
fn turning_in_pockets_of_four_widths_is_calm() {
    for width in ["0.4", "0.5", "0.65", "0.8"] {
        let scene = scene_with(&[("width_mm = 0.4", &format!("width_mm = {width}"))]);
        for (degrees, depth) in SITES {
            let way = way(&scene, degrees, depth);
            let mut run = Run::new(&scene);
            let tool = run.scene.tools[0].clone();
            go_in(&mut run, &way, 2e-4);
            let insertion = run.measures();
            let side = way.up.cross(&way.outward).normalize();
            let (mut out_torque, mut in_torque) = (0.0, 0.0);
            for k in 0..4000 {
                // A whole turn to each side in four seconds, about the working point.
                let turn = 10_f64.to_radians() * libm::sin(0.5e-3 * PI * f64::from(k));
                let out = run.tick(&way.pose(&tool, 2e-4, turn, 4e-3));
                assert!(out.tools[0].converged, "{width} {degrees}: tick {k}");
                match k {
                    1000 => out_torque = run.torque(&out).dot(&side),
                    3000 => in_torque = run.torque(&out).dot(&side),
                    _ => {}
                }
            }
            let m = run.measures();
            println!(
                "{width} mm, {degrees}: insertion buzz {:.4} N, whole {:.4} N, jump {:.3} mm, torque step {:.2} N mm, torque {:.2} and {:.2} N mm, residual {:.3} um",
                insertion.buzz,
                m.buzz,
                m.jump * 1e3,
                run.torque_step * 1e3,
                out_torque * 1e3,
                in_torque * 1e3,
                m.residual * 1e6
            );
            assert!(insertion.buzz <= 3e-3 && m.buzz <= 3e-3);
            assert!(run.torque_step <= 1e-3, "{:e} N m", run.torque_step);
            // Against the turn on either side.
            assert!(out_torque < 0.0 && in_torque > 0.0);
            assert!(m.jump <= 0.35e-3 && m.solver_failed == 0 && m.exhausted == 0);
            assert!(m.residual <= 1e-6);
        }
    }
}

#[test]
fn a_hand_in_closed_loop_goes_in_bobs_and_leaves_without_a_kick() {
    let scene = scene_with(&[]);
    for (degrees, depth) in SITES {
        let way = way(&scene, degrees, depth);
        let tool = scene.tools[0].clone();
        let pose = move |t: f64| {
            let bob = 3e-4 * (1.0 - libm::cos(9.0 * (t - 2.0).clamp(0.0, 2.0)));
            let above = 8e-3 * (1.0 - smoothstep(t - 0.3)) - 8e-4 * smoothstep(t - 1.3) + bob;
            // Out again faster than in.
            let above = above + 9e-3 * smoothstep(4.0 * (t - 4.5));
            let turn = 10_f64.to_radians() * libm::sin(2.0 * (t - 2.0).clamp(0.0, PI));
            way.pose(&tool, above, turn, 4e-3)
        };
        let script = OneTool {
            pose,
            duration_s: 5.5,
        };
        let mut operator = Operator::new(Box::new(script), HandParams::default(), 3);
        let mut run = Run::new(&scene);
        let mut felt = [Wrench::ZERO; MAX_TOOLS];
        for _ in 0..operator.ticks() {
            let mut input = TickInput::IDLE;
            input.tools = operator.step(&felt);
            let out = run.step(&input);
            felt = std::array::from_fn(|t| out.tools[t].wrench);
        }
        let m = run.measures();
        println!(
            "{degrees}: buzz {:.4} N, jump {:.3} mm, torque step {:.2} N mm, energy {:.4} mJ, exhausted {}, most {:.2} N",
            m.buzz,
            m.jump * 1e3,
            run.torque_step * 1e3,
            m.energy * 1e3,
            m.exhausted,
            m.max_raw_force
        );
        assert!(m.buzz <= 3e-3 && m.jump <= 0.35e-3 && m.solver_failed == 0);
        assert!(run.torque_step <= 1e-3, "{:e} N m", run.torque_step);
    }
}

/// Stiffness of the wall at a site, N/m: force over the way of the tip when a probe that cannot turn is pushed against it, and
/// no tooth is in its way. From 0.3 to 0.9 mm deep: no first touch, no edge. Mean over three places 4 degrees apart: at one
/// place alone it tells as much of the bumps of a level as of its stiffness.
fn mean_wall_stiffness(scene: &Scene, (degrees, depth): (f64, f64), level: u8) -> f64 {
    let places = [-4.0, 0.0, 4.0].map(|off| wall_stiffness(scene, (degrees + off, depth), level));
    places.iter().sum::<f64>() / 3.0
}

fn wall_stiffness(with_tooth: &Scene, (degrees, depth): (f64, f64), level: u8) -> f64 {
    let way = way(with_tooth, degrees, depth);
    let mut scene = with_tooth.clone();
    scene.objects[1].level = level;
    model(&mut scene).level = level;
    scene.objects.remove(0);
    scene.tools[0].stiffness_n_per_m = 5e3;
    scene.tools[0].stiffness_nm_per_rad = 100.0;
    let mut run = Run::new(&scene);
    let tool = run.scene.tools[0].clone();
    go_in(&mut run, &way, 2e-4);
    let mut seen: Vec<(f64, f64)> = Vec::new();
    let mut touched = None;
    for k in 0..4000 {
        let mut pose = way.pose(&tool, 2e-4, 0.0, 0.0);
        pose.position += way.outward * (5e-7 * f64::from(k) - 3e-4);
        let out = run.tick(&pose);
        let at = out.tools[0].graphic.transform(&tool.tip).dot(&way.outward);
        let force = run.state.loads[0].force.dot(&way.outward);
        if force > 0.01 {
            let touched = *touched.get_or_insert(at);
            seen.push((at - touched, force));
        }
    }
    let past = |depth: f64| {
        let found = seen.iter().find(|(at, _)| *at >= depth);
        *found.unwrap_or_else(|| panic!("never {depth} m deep: {:?}", seen.last()))
    };
    let (from, to) = (past(3e-4), past(9e-4));
    (to.1 - from.1) / (to.0 - from.0)
}

#[test]
fn the_wall_is_as_stiff_at_level_4_as_at_level_3() {
    let mut scene = scene_with(&[("levels = 3", "levels = 4")]);
    let mut stiffness = [0.0; 2];
    for (degrees, depth) in [SITES[0], SITES[3], SITES[4]] {
        for (level, found) in [3, 4].into_iter().zip(&mut stiffness) {
            scene.objects[1].level = level;
            model(&mut scene).level = level;
            let way = way(&scene, degrees, depth);
            let mut run = Run::new(&scene);
            let tool = run.scene.tools[0].clone();
            go_in(&mut run, &way, 6e-4);
            // Away from the tooth, slowly; force on the gingiva over the way of the working point.
            let mut seen = Vec::new();
            for k in 0..2400 {
                let mut pose = way.pose(&tool, 6e-4, 0.0, 0.0);
                pose.position += way.outward * (1e-6 * f64::from(k));
                let out = run.tick(&pose);
                let at = out.tools[0].graphic.transform(&tool.working_point);
                let force = run.state.loads[1].force.dot(&way.outward);
                seen.push((at.dot(&way.outward), force));
            }
            let (from, to) = (seen[1200], seen[2399]);
            *found = (to.1 - from.1) / (to.0 - from.0);
        }
        let [three, four] = stiffness;
        println!("{degrees}: wall {three:.0} N/m at level 3, {four:.0} N/m at level 4");
        assert!((three / four - 1.0).abs() <= 0.05, "{three} {four}");
    }
}

#[test]
fn the_wall_alone_is_as_stiff_at_level_4_as_at_level_3() {
    let scene = scene_with(&[("levels = 3", "levels = 4")]);
    let pairs = SITES.map(|site| [3, 4].map(|level| mean_wall_stiffness(&scene, site, level)));
    for ((degrees, _), [three, four]) in SITES.iter().zip(&pairs) {
        println!(
            "{degrees}: wall {three:.0} N/m at level 3, {four:.0} N/m at level 4: {:+.1} %",
            100.0 * (three / four - 1.0)
        );
    }
    let [three, four] = [0, 1].map(|k| pairs.iter().map(|pair| pair[k]).sum::<f64>() / 6.0);
    println!("mean {three:.0} and {four:.0} N/m");
    assert!((three / four - 1.0).abs() <= 0.02, "{three} {four}");
    for ((degrees, depth), [three, four]) in SITES.iter().zip(&pairs) {
        // Where the pocket is shallow the ends of the contact still tell.
        let bound = if *depth > 2e-3 { 0.05 } else { 0.1 };
        assert!(
            (three / four - 1.0).abs() <= bound,
            "{degrees}: {three} {four}"
        );
    }
}

#[test]
fn let_go_it_gives_no_energy_and_comes_back() {
    let scene = scene_with(&[]);
    let (degrees, depth) = SITES[0];
    let way = way(&scene, degrees, depth);
    let mut run = Run::new(&scene);
    let tool = run.scene.tools[0].clone();
    go_in(&mut run, &way, 0.0);
    let (mut work_in, mut work_out) = (0.0, 0.0_f64);
    let mut last: Option<(Pose, Wrench)> = None;
    // Pressed down and outwards, and back the same way.
    for k in 0..=4000_i32 {
        let share = f64::from(2000 - (2000 - k).abs()) / 2000.0;
        let mut pose = way.pose(&tool, -1.2e-3 * share, 0.0, 0.0);
        pose.position += way.outward * (1e-3 * share);
        let out = run.tick(&pose);
        let o = &out.tools[0];
        if let Some((before, raw)) = last {
            let work = -raw.force.dot(&(o.haptic.position - before.position));
            work_in += if work > 0.0 { work } else { 0.0 };
            work_out += if work < 0.0 { -work } else { 0.0 };
        }
        last = Some((o.haptic, o.raw_wrench));
    }
    println!(
        "work in {:.3} mJ, out again {:.3} mJ",
        work_in * 1e3,
        work_out * 1e3
    );
    assert!(work_in > 1e-4 && work_out <= 1.01 * work_in);
    // Pressed again, and the hand opens: nothing holds the tool, the tissue comes back.
    let mut before = f64::INFINITY;
    Feeler::default().press_to(&mut run, &way, 0.3);
    for k in 0..500 {
        run.step(&TickInput::IDLE);
        let most = run
            .ws
            .shape_of(1)
            .iter()
            .fold(0.0, |most, x| if x.abs() > most { x.abs() } else { most });
        assert!(most <= before, "tick {k}: {most:e} m after {before:e}");
        before = most;
    }
    assert!(before <= 1e-6, "{before:e} m from rest");
    assert!(
        run.state.tissue.iter().all(|x| *x == 0.0),
        "at rest, and asleep"
    );
}

#[test]
fn normals_never_flip_two_millimetres_deep_in_soft_gingiva() {
    let mut scene = scene_with(&[]);
    model(&mut scene).params.wall_stiffness = 100.0;
    model(&mut scene).params.shear_stiffness = 200.0;
    scene.tools[0].stiffness_n_per_m = 1000.0;
    for (degrees, depth) in [SITES[0], SITES[3]] {
        let way = way(&scene, degrees, depth);
        let mut run = Run::new(&scene);
        let tool = run.scene.tools[0].clone();
        go_in(&mut run, &way, 8e-4);
        let mut last: Vec<(u32, u32, Vec3)> = Vec::new();
        let start = run.state.tools[0].graphic.transform(&tool.working_point);
        // Least cosine between a normal and itself a tick before: up to 2 mm deep, and on the way out past the wall.
        let (mut least, mut least_after, mut pairs, mut gone) = (1.0_f64, 1.0_f64, 0, 0.0);
        for k in 0..4000 {
            let mut pose = way.pose(&tool, 8e-4, 0.0, 0.0);
            pose.position += way.outward * (1e-6 * f64::from(k));
            let out = run.tick(&pose);
            assert!(out.tools[0].converged, "tick {k}");
            let now: Vec<_> = run
                .ws
                .contacts()
                .filter(|(contact, load)| contact.object == 1 && *load > 0.0)
                .map(|(contact, _)| (contact.object_sphere, contact.tool_sphere, contact.normal))
                .collect();
            for (object, tool, normal) in &now {
                // No wall is pulled: what bears load pushes the tool inwards, upwards or along, not outwards. From about
                // 1.5 mm on the tip parts single spheres of a wall so soft, and lies beyond them.
                let outward = normal.dot(&way.outward);
                assert!(gone > 1.4e-3 || outward < 0.5, "tick {k}: {normal:?}");
                let same = last.iter().find(|(o, t, _)| o == object && t == tool);
                if let Some((_, _, before)) = same {
                    let cosine = normal.dot(before);
                    if gone <= 2e-3 {
                        least = least.min(cosine);
                    } else {
                        least_after = least_after.min(cosine);
                    }
                    pairs += 1;
                }
            }
            last = now;
            // All in all the wall pushes back; it does not let the tool through and push it on from behind.
            let push = run.state.loads[1].force.dot(&way.outward);
            assert!(k < 10 || gone > 2e-3 || push > 0.0, "tick {k}: {push} N");
            gone = (out.tools[0].graphic.transform(&tool.working_point) - start).dot(&way.outward);
        }
        println!(
            "{degrees}: {:.2} mm deep, {pairs} pairs from tick to tick, least cosine {least:.4}, past 2 mm {least_after:.4}",
            gone * 1e3
        );
        assert!(gone > 2e-3 && pairs > 1000, "{gone:e} m, {pairs} pairs");
        assert!(least > 0.9 && least_after > 0.85, "{least} {least_after}");
    }
}

#[test]
fn never_a_number_that_is_not_finite() {
    for stiff in [1.0, 1000.0] {
        let mut scene = scene_with(&[]);
        let params = &mut model(&mut scene).params;
        params.wall_stiffness *= stiff;
        params.shear_stiffness *= stiff;
        params.floor_stiffness *= stiff;
        params.shear_stiffness = params.shear_stiffness.min(1e6);
        scene.validate().expect("in range");
        let (degrees, depth) = SITES[1];
        let way = way(&scene, degrees, depth);
        let mut run = Run::new(&scene);
        let tool = run.scene.tools[0].clone();
        go_in(&mut run, &way, 0.0);
        for k in 0..1500 {
            // To and fro by 20 mm, across tooth and gingiva, and straight into the floor by 15.
            let mut pose = way.pose(
                &tool,
                -1.5e-2 * f64::from(k % 3 == 1),
                0.3 * f64::from(k % 5),
                4e-3,
            );
            pose.position += way.outward * (2e-2 * f64::from(k / 7 % 3) - 2e-2);
            let out = run.tick(&pose);
            let o = &out.tools[0];
            assert_eq!(o.status & status::FAULT, 0, "tick {k}");
            let parts = [
                o.raw_wrench.force,
                o.raw_wrench.torque,
                o.wrench.force,
                o.graphic.position,
            ];
            assert!(parts.iter().flatten().all(|x| x.is_finite()), "tick {k}");
            assert!(run.state.tissue.iter().all(|x| x.is_finite()), "tick {k}");
        }
        let m = run.measures();
        let residual = m.residual.max(m.exhausted_residual);
        assert!(residual < 1e-4, "{stiff}: {residual:e} m");
    }
}

#[test]
fn a_heavy_hand_is_an_event_once_until_it_was_lighter() {
    let scene = scene_with(&[]);
    let (degrees, depth) = SITES[4];
    let way = way(&scene, degrees, depth);
    let mut run = Run::new(&scene);
    go_in(&mut run, &way, 0.0);
    let mut events = Vec::new();
    let mut hand = Feeler::default();
    // Target forces on the floor; each is gone to at two millimetres a second.
    for target in [0.2, 0.3, 0.22, 0.3, 0.15, 0.3, 0.6, 0.45, 0.6, 0.1] {
        let mut tick = |run: &mut Run, step: f64| {
            let out = hand.step(run, &way, step);
            let reading = out.tools[0].pocket.expect("in the pocket");
            if reading.entered_zone {
                events.push((target, reading.zone));
            }
            reading.floor_force
        };
        let mut now = tick(&mut run, 0.0);
        let step = if now < target { 2e-6 } else { -2e-6 };
        while (now < target) == (step > 0.0) {
            now = tick(&mut run, step);
        }
    }
    use ForceZone::{TooHeavy, Trauma};
    assert_eq!(events, [(0.3, TooHeavy), (0.3, TooHeavy), (0.6, Trauma)]);
}

#[test]
fn the_same_inputs_give_the_same_bits_also_from_a_state_saved_midway() {
    let scene = scene_with(&[]);
    let (degrees, depth) = SITES[2];
    let way = way(&scene, degrees, depth);
    let tool = scene.tools[0].clone();
    let input = |k: u32| {
        let t = f64::from(k) * 1e-3;
        let turn = 0.15 * libm::sin(5.0 * t);
        Run::input(&way.pose(&tool, 4e-3 - 8e-3 * t.min(0.6), turn, 4e-3))
    };
    let mut first = Run::new(&scene);
    let mut hashes = Vec::new();
    let mut saved = Vec::new();
    for k in 0..1200 {
        hashes.push(first.step(&input(k)).hash);
        if k == 700 {
            saved = first.state.to_bytes();
        }
    }
    assert!(first.state.tissue.iter().any(|x| *x != 0.0));
    let mut second = Run::new(&scene);
    // Tables and scratch of a longer life do not show.
    second.ws = first.ws;
    for k in 0..1200 {
        assert_eq!(second.step(&input(k)).hash, hashes[k as usize], "tick {k}");
    }
    let mut third = Run::new(&scene);
    third.state = State::from_bytes(&scene, &saved).expect("a state");
    for k in 701..1200 {
        assert_eq!(third.step(&input(k)).hash, hashes[k as usize], "tick {k}");
    }
    // And the scene is bytes.
    let bytes = scene.to_bytes().expect("bytes");
    assert_eq!(Scene::from_bytes(&bytes).expect("a scene"), scene);
}

#[test]
fn an_answer_that_is_not_applied_is_no_load_and_no_event() {
    let scene = scene_with(&[]);
    let (degrees, depth) = SITES[4];
    let way = way(&scene, degrees, depth);
    let mut run = Run::new(&scene);
    go_in(&mut run, &way, 0.0);
    let mut hand = Feeler::default();
    hand.press_to(&mut run, &way, 0.3);
    let reading = |out: &TickOutput| out.tools[0].pocket.expect("in the pocket");
    let before = reading(&run.last.expect("a tick"));
    let iterations = run.scene.params.max_iterations;
    for failing in [true, false] {
        // Without iterations the solver has nothing that could be applied; what it began with is in its output.
        run.scene.params.max_iterations = if failing { 0 } else { iterations };
        for k in 0..20 {
            let out = hand.step(&mut run, &way, 0.0);
            assert_eq!(out.tools[0].status & status::SOLVER_FAILED != 0, failing);
            let now = reading(&out);
            assert!(!now.entered_zone && now.zone == before.zone, "{k}: {now:?}");
            let same = (now.floor_force - before.floor_force).abs() < 0.05;
            assert!(same, "{k}: {now:?}, before {before:?}");
            assert!(!failing || now.floor_force == before.floor_force);
        }
    }
}

#[test]
fn nothing_is_read_above_the_margin_or_outside() {
    let scene = scene_with(&[]);
    let (_, _, gingiva) = gingiva_of(&scene).expect("a gingiva");
    let tool = scene.tools[0].clone();
    for (degrees, depth) in SITES {
        let way = way(&scene, degrees, depth);
        let mut run = Run::new(&scene);
        let mut entered = None;
        for k in 0..1500 {
            let above = (8e-3 - 8e-6 * f64::from(k)).max(0.0);
            let out = run.tick(&way.pose(&tool, above, 0.0, 0.0));
            let tip = out.tools[0].graphic.transform(&tool.tip);
            let (around, height) = gingiva.tooth.cylindrical(&tip);
            let below = gingiva.margin_at(around) - height;
            let reading = out.tools[0].pocket;
            assert_eq!(reading.is_some(), below > 0.0, "{degrees}: {below:e} m");
            entered = entered.or(reading.map(|_| k));
            if let Some(reading) = reading {
                assert!((reading.depth - below).abs() < 1e-12);
            }
        }
        assert!(entered.is_some(), "{degrees}");
        // Along the outer face, as deep: not a pocket.
        let mut run = Run::new(&scene);
        for k in 0..1500 {
            let mut pose = way.pose(&tool, (8e-3 - 8e-6 * f64::from(k)).max(0.0), 0.0, 0.0);
            pose.position += way.outward * 4e-3;
            let out = run.tick(&pose);
            assert_eq!(out.tools[0].pocket, None, "{degrees}: tick {k}");
        }
    }
}

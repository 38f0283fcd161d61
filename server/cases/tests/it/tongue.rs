//! A mouth mirror on the parametric tongue: what must hold while it presses, lets go, and while the level of
//! detail changes under it.

use std::sync::OnceLock;

use sulcus_core::math::{exp_rotation, norm};
use sulcus_core::output::status;
use sulcus_core::tissue::TissueModel;
use sulcus_core::{
    DisplaySkin, NoProbe, Pose, Quat, Scene, State, TickInput, TickOutput, Vec3, Workspace, tick,
};
use sulcus_operator::present;
use sulcus_operator::script::smoothstep;
use sulcus_scene::BuildOptions;
use sulcus_scene::compile::built_in::{BuiltIn, compile_built_in};
use sulcus_scene::mesh::TriMesh;
use sulcus_scene::mesh::turned::turned;
use sulcus_scene::organ::skeleton;

/// Height of the tongue's back over its underside where the mirror presses, metres.
const BACK: f64 = 0.0305;

fn tongue() -> &'static Scene {
    static SCENE: OnceLock<Scene> = OnceLock::new();
    SCENE.get_or_init(|| {
        let compiled = compile_built_in(BuiltIn::Tongue, &BuildOptions::cached(), &|_, _| {})
            .expect("the tongue");
        assert!(compiled.warnings.is_empty(), "{:?}", compiled.warnings);
        compiled.scene
    })
}

/// The disc flat, its back down, the handle forwards and up.
fn flat() -> Quat {
    exp_rotation(&Vec3::new(0.0, 0.0, std::f64::consts::PI))
        * exp_rotation(&Vec3::new(0.0, -std::f64::consts::FRAC_PI_4, 0.0))
}

/// A run with the haptic tool's disc where the caller says.
struct Run<'a> {
    scene: &'a Scene,
    state: State,
    ws: Workspace,
    detail: u8,
}

impl<'a> Run<'a> {
    fn new(scene: &'a Scene) -> Self {
        Self {
            scene,
            state: State::new(scene),
            ws: Workspace::new(scene),
            detail: 0,
        }
    }

    /// One tick with the underside of the disc's middle at `place`; without one the hand holds nothing.
    fn tick(&mut self, place: Option<Vec3>) -> TickOutput {
        let mut input = TickInput::IDLE;
        input.detail = self.detail;
        if let Some(place) = place {
            let (tool, turned) = (&self.scene.tools[0], flat());
            let at = place + Vec3::new(0.0, 0.0, 1e-3) - turned * tool.working_point;
            input.tools[0] = present(&Pose::new(at, turned));
        }
        let out = tick(
            self.scene,
            &mut self.state,
            &mut self.ws,
            &input,
            &mut NoProbe,
        );
        let said = out.tools[0].status;
        assert_eq!(
            said & (status::FAULT | status::SOLVER_FAILED),
            0,
            "{said:x}"
        );
        out
    }

    /// Comes down on the back of the tongue to `deep` metres in a second, and stays for another.
    fn press(&mut self, deep: f64) -> TickOutput {
        for k in 0..2000 {
            self.tick(Some(over(
                0.005 - (0.005 + deep) * smoothstep(f64::from(k) * 1e-3),
            )));
        }
        self.tick(Some(over(-deep)))
    }

    /// How deep the disc is as seen, metres.
    fn depth(&self) -> f64 {
        let tool = &self.scene.tools[0];
        BACK + 1e-3 - self.state.tools[0].graphic.transform(&tool.working_point).z
    }

    /// Farthest that any sphere of the tongue is from its rest, metres.
    fn displaced(&self) -> f64 {
        let nodes = self.scene.objects[0].tree.nodes();
        let ids: Vec<u32> = (0..nodes.len() as u32).collect();
        let mut centres = vec![Vec3::zeros(); nodes.len()];
        assert!(self.ws.centres_of(0, &ids, &mut centres));
        let moved = centres
            .iter()
            .zip(nodes)
            .map(|(c, n)| norm(&(c - n.centre)));
        moved.fold(0.0, f64::max)
    }
}

fn over(height: f64) -> Vec3 {
    Vec3::new(0.005, 0.0, BACK + height)
}

#[test]
fn gives_way_ten_millimetres_to_one_or_two_newtons() {
    let mut run = Run::new(tongue());
    let mut before = (0.0, 0.0);
    // Slowly down until the disc is 10 mm in.
    for k in 0..20_000 {
        let out = run.tick(Some(over(0.002 - 2e-6 * f64::from(k))));
        let now = (run.depth(), out.tools[0].raw_wrench.force.z);
        if now.0 >= 0.01 {
            println!(
                "10 mm at {:.3} N, stiffness there {:.3} N/mm",
                now.1,
                (now.1 - before.1) / (now.0 - before.0) * 1e-3
            );
            assert!((1.0..2.0).contains(&now.1), "{now:?}");
            return;
        }
        if k % 100 == 0 {
            before = now;
        }
    }
    panic!("never that deep");
}

#[test]
fn both_levels_of_detail_feel_alike() {
    let TissueModel::Skeleton(model) = &tongue().objects[0].tissue else {
        panic!("a skeleton");
    };
    let fine = model.fine.as_ref().expect("a fine level");
    let tree = &tongue().objects[0].tree;
    let (a, b) = (
        skeleton::pressed(&model.coarse, tree),
        skeleton::pressed(fine, tree),
    );
    println!(
        "a rigid disc 6 mm in: {a:.4} and {b:.4} N; {} and {} nodes, {} and {} free",
        model.coarse.nodes.len(),
        fine.nodes.len(),
        model.coarse.free(),
        fine.free()
    );
    assert!((a / b - 1.0).abs() < 1e-6, "calibrated: {a} {b}");
    // Felt through the tick: at the depth that the levels are matched at, and on both sides of it.
    let mut ratios = Vec::new();
    for deep in [0.0035, 0.0073, 0.013] {
        let felt = [0, 1].map(|detail| {
            let mut run = Run::new(tongue());
            run.detail = detail;
            let out = run.press(deep);
            (out.tools[0].raw_wrench.force.z, run.depth())
        });
        let stiffness = felt.map(|(force, depth)| force / depth);
        println!("hand {:.1} mm in: {felt:?}, {stiffness:?} N/m", deep * 1e3);
        ratios.push(stiffness[1] / stiffness[0]);
    }
    println!("fine over coarse: {ratios:?}");
    assert!((0.95..1.05).contains(&ratios[1]), "{ratios:?}");
    // Away from the depth at which they are matched they drift apart.
    assert!(
        ratios.iter().all(|r| (0.75..1.25).contains(r)),
        "{ratios:?}"
    );
}

#[test]
fn a_change_of_level_under_load_steps_the_force_by_less_than_two_hundredths() {
    let mut run = Run::new(tongue());
    run.press(0.0062);
    assert!((0.0045..0.0055).contains(&run.depth()), "{}", run.depth());
    let mut last = run.tick(Some(over(-0.0062))).tools[0].raw_wrench.force;
    let held = last;
    let (mut step, mut away) = (0.0_f64, 0.0_f64);
    for k in 0..4000 {
        // To the fine level and back, back before it is there, and to and fro.
        run.detail = u8::from(
            (200..900).contains(&k)
                || (1600..1700).contains(&k)
                || (2200..3000).contains(&k) && k % 37 < 20,
        );
        let force = run.tick(Some(over(-0.0062))).tools[0].raw_wrench.force;
        step = step.max(norm(&(force - last)));
        away = away.max(norm(&(force - held)));
        last = force;
    }
    println!(
        "largest step {step:.5} N, the other level {away:.4} N away of {:.4} N",
        norm(&held)
    );
    assert!(away > 1e-3, "the levels differ: {away}");
    assert!(step < 0.02, "{step}");
    assert!(norm(&(last - held)) < 1e-6, "back where it was");
}

#[test]
fn pressing_and_letting_go_gives_back_less_than_was_put_in_and_ends_at_rest() {
    for detail in [0, 1] {
        let mut run = Run::new(tongue());
        run.detail = detail;
        let (mut put_in, mut given_back) = (0.0, 0.0);
        let mut last: Option<(Vec3, Vec3)> = None;
        let mut net_most = f64::NEG_INFINITY;
        for k in 0..2500 {
            let t = f64::from(k) * 1e-3;
            let down = smoothstep(t) - smoothstep((t - 1.3) / 0.3);
            let place = over(0.003 - 0.016 * down);
            let force = run.tick(Some(place)).tools[0].raw_wrench.force;
            if let Some((before, at)) = last {
                // The force of a tick acts until the next.
                let work = 0.5 * (before + force).dot(&(place - at));
                if work < 0.0 {
                    put_in -= work
                } else {
                    given_back += work
                }
                net_most = f64::max(net_most, given_back - put_in);
            }
            last = Some((force, place));
        }
        println!(
            "detail {detail}: put in {:.3} mJ, given back {:.3} mJ",
            put_in * 1e3,
            given_back * 1e3
        );
        assert!(
            put_in > 3e-3 && given_back < put_in,
            "{put_in} {given_back}"
        );
        assert!(net_most < 0.01 * put_in, "{net_most}");
        // The fine level hums on longer, by nanometres.
        for _ in 0..2500 + 4500 * u32::from(detail) {
            run.tick(None);
        }
        assert!(run.displaced() < 1e-6, "{} m from rest", run.displaced());
        let (_, all_but_the_share) = run.state.tissue.split_last().expect("a skeleton");
        assert!(
            all_but_the_share.iter().all(|x| *x == 0.0),
            "detail {detail}: not still in the end"
        );
    }
}

#[test]
fn let_go_from_depth_nothing_swings_beyond_where_it_was_held() {
    let mut run = Run::new(tongue());
    run.press(0.013);
    let (held, mut last, mut rose) = (run.displaced(), f64::INFINITY, 0.0_f64);
    for k in 0..3000 {
        run.tick(None);
        let now = run.displaced();
        assert!(now <= held * (1.0 + 1e-9), "{now} after {held}, tick {k}");
        rose = rose.max(now - last);
        last = now;
    }
    println!(
        "held at {:.3} mm; largest rise of the farthest sphere {:.4} mm",
        held * 1e3,
        rose * 1e3
    );
    assert!(last < 1e-6, "{last}");
}

/// The tongue relaxes into a hand that is away. Behind the gap the overlaps filled the list of contacts at any distance, and the mirror
/// left the tongue by 7 um in a tick: it was 15.4 mm deep after 100 ticks.
#[test]
fn a_mirror_that_returns_deep_in_the_tongue_is_nearly_out_after_a_hundred_ticks() {
    let mut run = Run::new(tongue());
    run.press(0.022);
    let held = run.depth();
    for _ in 0..3000 {
        run.tick(None);
    }
    for _ in 0..100 {
        run.tick(Some(over(-0.022)));
    }
    let depth = run.depth();
    println!(
        "held {:.2} mm deep, 100 ticks after the return {:.2} mm",
        1e3 * held,
        1e3 * depth
    );
    assert!(held > 0.015 && depth < 0.003, "{held} {depth}");
    // The force has grown again, and presses the mirror to where it was.
    for _ in 0..1900 {
        run.tick(Some(over(-0.022)));
    }
    assert!((run.depth() - held).abs() < 1e-4, "{}", run.depth());
}

#[test]
fn a_run_from_its_middle_is_the_same_run() {
    let place = |k: u32| {
        let t = f64::from(k) * 1e-3;
        let slide = Vec3::new(0.004 * libm::sin(3.0 * t), 0.003 * libm::sin(2.0 * t), 0.0);
        over(0.003 - 0.012 * smoothstep(2.0 * t)) + slide
    };
    let detail = |k: u32| u8::from(k % 500 > 280);
    let play = |run: &mut Run, from: u32, to: u32| {
        let step = |k: u32| {
            run.detail = detail(k);
            run.tick(Some(place(k)).filter(|_| k % 700 < 640)).hash
        };
        (from..to).map(step).collect::<Vec<_>>()
    };
    let scene = tongue();
    let mut whole = Run::new(scene);
    let first = play(&mut whole, 0, 731);
    let bytes = whole.state.to_bytes();
    let second = play(&mut whole, 731, 1300);
    let mut again = Run::new(scene);
    assert_eq!(play(&mut again, 0, 731), first);
    let mut resumed = Run::new(scene);
    resumed.state = State::from_bytes(scene, &bytes).expect("a state");
    assert_eq!(play(&mut resumed, 731, 1300), second);
}

#[test]
fn the_skin_follows_a_press_of_fifteen_millimetres_smoothly_and_turns_no_triangle() {
    for detail in [0, 1] {
        let (depth, _) = skin_follows(tongue(), detail, 0.022);
        assert!(depth > 0.015, "only {depth} m deep");
    }
    // The organ has a back that gives way farther under the disc's edge than under its middle. At 10 N (the disc 15 mm deep) its skin
    // folds at six triangles, farther than a hand that is held by 3.3 N ever presses.
    let compiled = compile_built_in(BuiltIn::Organ, &BuildOptions::cached(), &|_, _| {});
    let (_, most) = skin_follows(&compiled.expect("the organ").scene, 0, 0.034);
    assert!(most > 0.015, "only {most} m away");
}

/// Presses the hand `deep` metres in and looks at the skin; returns how deep the disc is and how far the skin has gone, metres.
fn skin_follows(scene: &Scene, detail: u8, deep: f64) -> (f64, f64) {
    let object = &scene.objects[0];
    let skin = DisplaySkin::of(object);
    let mesh = TriMesh {
        vertices: object
            .mesh
            .vertices
            .iter()
            .map(|v| Vec3::from(v.map(f64::from)))
            .collect(),
        triangles: object.mesh.triangles.clone(),
    };
    // A press of 22 mm at the fine level needs more work than a tick may do by default; the skin alone is judged here.
    let mut scene = scene.clone();
    scene.params.max_work = 0;
    let scene = &scene;
    let mut run = Run::new(scene);
    run.detail = detail;
    run.press(deep);
    let moved = run.ws.carriers_moved(scene, 0);
    let mut by = vec![Vec3::zeros(); mesh.vertices.len()];
    skin.displacements(&moved, &mut by);
    let (count, least) = turned(&mesh, &by);
    let most = by.iter().map(norm).fold(0.0, f64::max);
    // Where one carrier carried a vertex and another its neighbour, they would part by what the carriers do.
    let alone = |v: usize| match object.tissue {
        TissueModel::Surface(_) => {
            let most = skin.carriers(v).iter().max_by(|a, b| a.1.total_cmp(&b.1));
            most.map_or(Vec3::zeros(), |(master, _)| moved[*master as usize])
        }
        _ => moved[object.carriers[v] as usize],
    };
    let (mut steepest, mut parted) = (0.0_f64, 0.0_f64);
    for [a, b, c] in &mesh.triangles {
        for (a, b) in [(a, b), (b, c), (c, a)] {
            let (a, b) = (*a as usize, *b as usize);
            let away = norm(&(mesh.vertices[a] - mesh.vertices[b]));
            steepest = steepest.max(norm(&(by[a] - by[b])) / away);
            parted = parted.max(norm(&(alone(a) - alone(b))) / away);
        }
    }
    println!(
        "detail {detail}: disc {:.1} mm deep, skin up to {:.1} mm; {count} turned, least area {least:.3}; steepest {steepest:.2} against {parted:.2} with one carrier each",
        1e3 * run.depth(),
        1e3 * most
    );
    assert_eq!(count, 0);
    // The skin is smooth over two or three spheres: at the fine level it rounds a dent as narrow as the disc.
    assert!(most > 0.8 * run.depth(), "{most}");
    assert!(steepest < 0.25 * parted, "{steepest} {parted}");
    (run.depth(), most)
}

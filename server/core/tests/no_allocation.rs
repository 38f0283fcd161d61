//! A tick allocates nothing: counted, not believed.

use std::alloc::{GlobalAlloc, Layout, System};
use std::cell::Cell;

use sulcus_core::tissue::TissueModel;
use sulcus_core::tissue::gingiva::{Gingiva, GingivaParams, Place, ToothFrame};
use sulcus_core::*;

struct Counting;

thread_local! {
    static COUNT: Cell<u64> = const { Cell::new(0) };
}

// SAFETY: forwards to the system allocator unchanged; the counter is a thread-local `Cell` that
// needs no allocation itself.
unsafe impl GlobalAlloc for Counting {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        COUNT.with(|count| count.set(count.get() + 1));
        // SAFETY: the caller's contract is passed on.
        unsafe { System.alloc(layout) }
    }
    unsafe fn dealloc(&self, at: *mut u8, layout: Layout) {
        COUNT.with(|count| count.set(count.get() + 1));
        // SAFETY: the caller's contract is passed on.
        unsafe { System.dealloc(at, layout) }
    }
    unsafe fn realloc(&self, at: *mut u8, layout: Layout, size: usize) -> *mut u8 {
        COUNT.with(|count| count.set(count.get() + 1));
        // SAFETY: the caller's contract is passed on.
        unsafe { System.realloc(at, layout, size) }
    }
}

#[global_allocator]
static ALLOCATOR: Counting = Counting;

fn bumpy_plate() -> Object {
    let spheres: Vec<Sphere> = (0..900)
        .map(|k| Sphere {
            centre: Vec3::new(
                f64::from(k % 30 - 15) * 3e-4,
                f64::from(k / 30 - 15) * 3e-4,
                -4e-4,
            ),
            radius: 4e-4,
        })
        .collect();
    let tree = SphereTree::over_leaves(&spheres).expect("valid");
    Object {
        name: "plate".into(),
        fdi: 0,
        tree,
        level: 7,
        tissue: TissueModel::Rigid,
        mesh: DisplayMesh::default(),
        carriers: Vec::new(),
    }
}

fn rod(x: f64) -> Tool {
    let spheres: Vec<Sphere> = (0..60)
        .map(|k| Sphere {
            centre: Vec3::new(0.0, 0.0, -0.09 + 2.5e-4 * f64::from(k)),
            radius: 2.5e-4,
        })
        .collect();
    Tool {
        name: "rod".into(),
        tree: SphereTree::over_leaves(&spheres).expect("valid"),
        level: 7,
        working_point: Vec3::new(0.0, 0.0, -0.086),
        tip: Vec3::new(0.0, 0.0, -0.09025),
        tip_axis: -Vec3::z(),
        stiffness_n_per_m: 500.0,
        stiffness_nm_per_rad: 0.5,
        park: Pose::new(Vec3::new(x, 0.0, 0.1), Quat::identity()),
        bands: vec![],
        mesh: DisplayMesh::default(),
    }
}

fn blended(mut plate: Object) -> Object {
    let blending = Blending {
        lengths: vec![3e-5; usize::from(plate.tree.depth()) + 1],
        insets: vec![6e-5; plate.tree.nodes().len()],
    };
    plate.tree = plate.tree.with_blending(blending).expect("valid");
    plate
}

#[test]
fn five_thousand_ticks_in_contact_allocate_nothing() {
    let scene = Scene {
        name: "plate".into(),
        source_hash: String::new(),
        params: Params::default(),
        tools: vec![rod(0.0), rod(0.002)],
        objects: vec![bumpy_plate(), blended(bumpy_plate())],
    };
    let (mut state, mut ws) = (State::new(&scene), Workspace::new(&scene));
    let mut touched = 0;
    let before = COUNT.with(Cell::get);
    for k in 0..5000 {
        let mut input = TickInput::IDLE;
        for (t, slot) in input.tools.iter_mut().enumerate() {
            let phase = f64::from(k) * 2e-3 + t as f64;
            let tilt = math::exp_rotation(&Vec3::new(
                0.4 * libm::sin(phase),
                0.3 * libm::cos(1.3 * phase),
                0.1,
            ));
            let tip = Vec3::new(
                2e-3 * libm::sin(3.0 * phase),
                2e-3 * libm::cos(phase),
                -2e-3 * libm::sin(phase),
            );
            let pose = Pose::new(tip + tilt * Vec3::new(0.0, 0.0, 0.09025), tilt);
            *slot = ToolInput {
                pose: RawPose::from(&pose),
                present: k % 1000 > 20,
                ..ToolInput::ABSENT
            };
            if k % 700 == 0 {
                slot.pose.position[1] = f32::NAN;
            }
        }
        let out = tick(&scene, &mut state, &mut ws, &input, &mut NoProbe);
        touched += u32::from(out.tools[0].active > 0);
    }
    let after = COUNT.with(Cell::get);
    assert!(
        touched > 1000,
        "the test must be in contact, it was in {touched} ticks"
    );
    assert_eq!(after - before, 0, "calls of the allocator");
}

/// The plate as a gingiva whose tooth stands along z beside it; its near half is the floor of the pocket.
fn soft(mut plate: Object) -> Object {
    let axis = Vec3::z();
    let place = |node: &Node| Place {
        away: Vec3::x(),
        height: node.centre.x,
        floor: node.centre.x < 0.0,
    };
    plate.tissue = TissueModel::Gingiva(Box::new(Gingiva {
        params: GingivaParams::default(),
        tooth: ToothFrame {
            origin: Vec3::zeros(),
            axis,
            mesial: Vec3::x(),
            buccal: Vec3::y(),
        },
        margin: vec![1e-3; 16],
        places: plate.tree.nodes().iter().map(place).collect(),
        level: 7,
    }));
    plate
}

#[test]
fn two_tools_in_gingiva_beside_a_tooth_allocate_nothing() {
    let scene = Scene {
        name: "pocket".into(),
        source_hash: String::new(),
        params: Params::default(),
        tools: vec![rod(0.0), rod(0.002)],
        objects: vec![soft(bumpy_plate()), bumpy_plate()],
    };
    scene.validate().expect("valid");
    let (mut state, mut ws) = (State::new(&scene), Workspace::new(&scene));
    let (mut touched, mut read) = (0, 0);
    let before = COUNT.with(Cell::get);
    for k in 0..3000 {
        let mut input = TickInput::IDLE;
        for (t, slot) in input.tools.iter_mut().enumerate() {
            let phase = f64::from(k) * 2e-3 + t as f64;
            let tip = Vec3::new(
                2e-3 * libm::sin(3.0 * phase),
                2e-3 * libm::cos(phase),
                -2e-3 * libm::sin(phase),
            );
            let pose = Pose::new(tip + Vec3::new(0.0, 0.0, 0.09025), Quat::identity());
            *slot = ToolInput {
                pose: RawPose::from(&pose),
                present: k % 1000 > 20,
                ..ToolInput::ABSENT
            };
        }
        let out = tick(&scene, &mut state, &mut ws, &input, &mut NoProbe);
        touched += u32::from(out.tools[0].active > 0);
        read += u32::from(out.tools[0].pocket.is_some());
    }
    let after = COUNT.with(Cell::get);
    assert!(touched > 500, "in contact in {touched} ticks");
    assert!(read > 100, "read a depth in {read} ticks");
    assert_eq!(after - before, 0, "calls of the allocator");
}

//! A tick allocates nothing: test with a counting allocator.

mod counting;

use counting::calls;
use sulcus_core::tissue::TissueModel;
use sulcus_core::tissue::gingiva::{Gingiva, GingivaParams, Place, Prescribed, ToothFrame};
use sulcus_core::tissue::printed::{PrintedGingiva, PrintedSkeleton};
use sulcus_core::tissue::skeleton::{
    Skeleton, SkeletonLevel, SkeletonParams, Skin, Spring, StretchLaw,
};
use sulcus_core::*;

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

/// Returns three plates: a skeleton of springs and a gingiva, both by the equations as printed, and the gingiva's
/// tooth.
fn printed() -> Vec<Object> {
    let (mut tongue, mut gingiva) = (bumpy_plate(), bumpy_plate());
    let nodes: Vec<(u32, Vec3)> = tongue
        .tree
        .shape_at(2)
        .map(|(id, node)| (id, node.centre))
        .collect();
    let mut springs = Vec::new();
    for (at, (i, a)) in nodes.iter().enumerate() {
        let near = nodes[at + 1..]
            .iter()
            .filter(|(_, b)| math::norm(&(a - b)) < 3e-3);
        springs.extend(near.map(|(j, _)| [*i, *j]));
    }
    let held = nodes.iter().filter(|(_, centre)| centre.x < -3e-3);
    let mut model = PrintedSkeleton::new(2, springs, held.map(|(id, _)| *id).collect());
    model.penalty_n_per_m = 1.0;
    tongue.tissue = TissueModel::PrintedSkeleton(model);
    let inward = gingiva.tree.shape_at(7).map(|_| -Vec3::z()).collect();
    gingiva.tissue = TissueModel::PrintedGingiva(PrintedGingiva::new(7, 2, inward, Vec3::z()));
    vec![tongue, gingiva, bumpy_plate()]
}

#[test]
fn five_thousand_ticks_in_contact_allocate_nothing() {
    allocates_nothing(vec![bumpy_plate(), blended(bumpy_plate())]);
}

#[test]
fn nor_do_they_with_tissue_as_printed() {
    allocates_nothing(printed());
}

fn allocates_nothing(objects: Vec<Object>) {
    let scene = Scene {
        name: "plate".into(),
        source_hash: String::new(),
        params: Params::default(),
        tools: vec![rod(0.0), rod(0.002)],
        objects,
    };
    scene.validate().expect("a scene that may run");
    let (mut state, mut ws) = (State::new(&scene), Workspace::new(&scene));
    let mut touched = 0;
    let before = calls();
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
    let after = calls();
    assert!(
        touched > 1000,
        "the test must be in contact, it was in {touched} ticks"
    );
    assert_eq!(after - before, 0, "calls of the allocator");
}

/// Makes the plate a gingiva whose tooth stands along z beside it. Its near half is the floor of the pocket.
fn soft(mut plate: Object) -> Object {
    let axis = Vec3::z();
    let place = |node: &Node| Place {
        away: Vec3::x(),
        on_surface: node.centre,
        spread: 2e-4,
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
        proximal: 50f64.to_radians(),
        sites: [Prescribed::default(); 6],
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
    let before = calls();
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
    let after = calls();
    assert!(touched > 500, "in contact in {touched} ticks");
    assert!(read > 100, "read a depth in {read} ticks");
    assert_eq!(after - before, 0, "calls of the allocator");
}

/// Returns a skeleton on every `every`-th sphere of the plate, with springs within 3 mm and a fixed rim.
fn skeleton_of(tree: &SphereTree, every: usize) -> SkeletonLevel {
    let leaves: Vec<u32> = tree.shape_at(7).map(|(k, _)| k).collect();
    let nodes: Vec<u32> = leaves.iter().copied().step_by(every).collect();
    let centre = |k: u32| tree.nodes()[k as usize].centre;
    let mut springs = Vec::new();
    for a in 0..nodes.len() {
        for b in 0..a {
            if math::norm(&(centre(nodes[a]) - centre(nodes[b]))) < 3e-3 {
                springs.push(Spring {
                    a: a as u16,
                    b: b as u16,
                    stiffness: [40.0, 30.0, 20.0],
                    coupling: [0.0; 3],
                });
            }
        }
    }
    let skin = |node: &Node| {
        let mut near: Vec<usize> = (0..nodes.len()).collect();
        let away = |k: &usize| math::norm(&(centre(nodes[*k]) - node.centre));
        near.sort_by(|a, b| away(a).total_cmp(&away(b)));
        Skin {
            nodes: std::array::from_fn(|k| near[k] as u16),
            weights: [0.4, 0.3, 0.2, 0.1],
        }
    };
    SkeletonLevel {
        fixed: nodes
            .iter()
            .map(|&k| math::norm(&centre(k)) > 4.5e-3)
            .collect(),
        springs,
        params: SkeletonParams {
            mass: 1e-4,
            damping: 0.05,
            law: StretchLaw {
                limit: 2.0,
                half: 0.5,
            },
        },
        skin: tree.nodes().iter().map(skin).collect(),
        nodes,
    }
}

#[test]
fn ticks_on_a_skeleton_allocate_nothing_at_any_level_of_detail() {
    let mut soft = bumpy_plate();
    soft.tissue = TissueModel::Skeleton(Box::new(Skeleton {
        coarse: skeleton_of(&soft.tree, 23),
        fine: Some(skeleton_of(&soft.tree, 11)),
    }));
    let scene = Scene {
        name: "soft plate".into(),
        source_hash: String::new(),
        params: Params::default(),
        tools: vec![rod(0.0), rod(0.002)],
        objects: vec![soft],
    };
    scene.validate().expect("valid");
    let (mut state, mut ws) = (State::new(&scene), Workspace::new(&scene));
    let mut touched = [0; 3];
    let before = calls();
    for k in 0..4000 {
        let mut input = TickInput::IDLE;
        input.detail = u8::from(k % 900 > 500);
        for (t, slot) in input.tools.iter_mut().enumerate() {
            let phase = f64::from(k) * 2e-3 + 2.0 * t as f64;
            let tip = Vec3::new(
                1e-3 * libm::sin(2.0 * phase) + 1.5e-3 * (t as f64 - 0.5),
                1e-3 * libm::cos(phase),
                -1.5e-3 * libm::sin(phase),
            );
            *slot = ToolInput {
                pose: RawPose::from(&Pose::new(
                    tip + Vec3::new(0.0, 0.0, 0.09025),
                    Quat::identity(),
                )),
                present: k % 1000 > 20,
                ..ToolInput::ABSENT
            };
        }
        let out = tick(&scene, &mut state, &mut ws, &input, &mut NoProbe);
        if out.tools[0].active > 0 {
            let share = state.tissue[state.tissue.len() - 1];
            touched[if share == 0.0 {
                0
            } else if share < 1.0 {
                1
            } else {
                2
            }] += 1;
        }
    }
    let after = calls();
    assert!(
        touched.iter().all(|&ticks| ticks > 200),
        "in contact with the coarse, both, the fine level: {touched:?} ticks"
    );
    assert_eq!(after - before, 0, "calls of the allocator");
}

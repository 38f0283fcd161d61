//! Tests of the gingiva as printed.

use super::*;
use crate::tissue::SiteLoad;

/// Wall of 12 by 12 spheres, radius 0.8 mm, in the plane at `y` (metres). Its lowest rows are below the pocket bottom.
///
/// The tests use a gingiva at y = 0.9 mm. Its tooth would be a wall at y = -0.9 mm, which is not built. The gap between
/// the two surfaces is 0.2 mm, less than the rod's diameter of 0.5 mm.
fn wall(y: f64) -> SphereTree {
    let spheres: Vec<Sphere> = (0..12)
        .flat_map(|i| (0..12).map(move |k| (i, k)))
        .map(|(i, k)| Sphere {
            centre: Vec3::new(
                f64::from(i) * 4e-4 - 2.2e-3,
                y,
                f64::from(k) * 4e-4 - 4.4e-3,
            ),
            radius: 8e-4,
        })
        .collect();
    SphereTree::over_leaves(&spheres).expect("valid")
}

/// Height z of the pocket's bottom, metres.
const FLOOR: f64 = -3.5e-3;

fn gingiva(tree: &SphereTree) -> PrintedGingiva {
    let inward = tree
        .shape_at(7)
        .map(|(_, n)| {
            if n.centre.z > FLOOR {
                Vec3::y()
            } else {
                Vec3::zeros()
            }
        })
        .collect();
    PrintedGingiva::new(7, 1, inward, Vec3::z())
}

/// Runs a free step of a gingiva. Returns rest centre and displacement of each sphere, metres.
fn displaced(
    model: &PrintedGingiva,
    tree: &SphereTree,
    hybrid: bool,
    (haptic, graphic): (Pose, Pose),
) -> Vec<(Vec3, Vec3)> {
    let mut ready = ReadyGingiva::new(model, tree, 7);
    let (tool, loads) = (rod(), [Wrench::ZERO; 2]);
    let mut state = vec![0.0; ready.shape_len() + MAX_TOOLS];
    state[ready.shape_len()] = f64::from(u8::from(hybrid));
    let mut shape = vec![0.0; ready.shape_len()];
    let mut free = shape.clone();
    ready.free_step(
        &state,
        &hands(&tool, haptic, graphic, &loads),
        &mut shape,
        &mut free,
    );
    let ids: Vec<u32> = tree.shape_at(7).map(|(id, _)| id).collect();
    let mut centres = vec![Vec3::zeros(); ids.len()];
    ready.centres(&shape, &ids, &mut centres);
    ids.iter()
        .zip(centres)
        .map(|(id, centre)| {
            let rest = tree.nodes()[*id as usize].centre;
            (rest, centre - rest)
        })
        .collect()
}

/// Whether a sphere at `centre` is a fringe sphere: above the pocket's bottom, and overlapped by the graphic rod grown
/// by the prediction distance.
fn is_fringe(model: &PrintedGingiva, centre: &Vec3, graphic: &Pose) -> bool {
    let tool = rod();
    centre.z > FLOOR
        && tool.tree.shape_at(tool.level).any(|(_, sphere)| {
            norm(&(graphic.transform(&sphere.centre) - centre))
                < sphere.contact_radius + 8e-4 + model.contact_distance_m
        })
}

#[test]
fn fringe_spheres_follow_hooke_and_neighbours_the_attenuation() {
    let tree = wall(0.9e-3);
    let model = gingiva(&tree);
    model.validate(&tree).expect("fits");
    let graphic = over(Vec3::new(0.0, -0.2e-3, -1.5e-3));
    let haptic = over(Vec3::new(0.05e-3, 0.3e-3, -1.6e-3));
    let moved = displaced(&model, &tree, false, (haptic, graphic));
    // Eq. 11, 12: the component of K_p dp along n, divided by k_d.
    let ds0 = model.penalty_n_per_m * 0.5e-3 / model.stiffness_n_per_m;
    let fringe: Vec<Vec3> = moved
        .iter()
        .filter(|(rest, _)| is_fringe(&model, rest, &graphic))
        .map(|(rest, _)| *rest)
        .collect();
    assert!(fringe.len() > 3 && fringe.len() < 60, "{}", fringe.len());
    for (rest, u) in &moved {
        let nearest = fringe.iter().fold(f64::INFINITY, |least, f| {
            math::fmin(least, norm(&(f - rest)))
        });
        let expected = if rest.z <= FLOOR || nearest > model.neighbourhood_m {
            0.0
        } else {
            libm::pow(model.attenuation_per_mm, nearest * 1e3) * ds0
        };
        assert!(
            norm(&(u - Vec3::y() * expected)) < 1e-12,
            "{rest:?}: {u:?}, {expected}"
        );
    }
    // A displacement away from the gingiva gives no load.
    let back = over(Vec3::new(0.0, -0.4e-3, -1.5e-3));
    let none = displaced(&model, &tree, false, (back, graphic));
    assert!(none.iter().all(|(_, u)| *u == Vec3::zeros()));
}

#[test]
fn the_three_interaction_types_of_a_hybrid_contact() {
    let tree = wall(0.9e-3);
    let model = gingiva(&tree);
    let graphic = over(Vec3::new(0.0, 0.0, -1.5e-3));
    let most = |hybrid, haptic| {
        displaced(&model, &tree, hybrid, (over(haptic), graphic))
            .iter()
            .fold(0.0, |most, (_, u)| math::fmax(most, norm(u)))
    };
    // Type 1: under a press towards the tooth, the gingiva leaves room for the tip.
    let towards_tooth = Vec3::new(0.0, -0.3e-3, -1.5e-3);
    assert!((most(true, towards_tooth) - model.tip_diameter_m).abs() < 1e-12);
    assert_eq!(most(false, towards_tooth), 0.0);
    // Type 2: under a press away from the tooth, the displacement is the same as without hybrid contact.
    let away = Vec3::new(0.0, 0.4e-3, -1.5e-3);
    let hooke = model.penalty_n_per_m / model.stiffness_n_per_m * 0.4e-3;
    assert!((most(true, away) - hooke).abs() < 1e-9);
    assert!((most(false, away) - hooke).abs() < 1e-9);
    // Type 3: the haptic tip is above the gingival margin.
    assert_eq!(most(true, Vec3::new(0.0, -0.3e-3, 2e-3)), 0.0);
    assert_eq!(most(true, Vec3::new(0.0, 0.4e-3, 2e-3)), 0.0);
}

#[test]
fn the_memory_is_last_ticks_load_on_both() {
    let tree = wall(0.9e-3);
    let model = gingiva(&tree);
    let mut ready = ReadyGingiva::new(&model, &tree, 7);
    let tool = rod();
    let load = Wrench {
        force: Vec3::new(0.0, -0.1, 0.0),
        torque: Vec3::zeros(),
    };
    let site = SiteLoad {
        sphere: 80,
        tool: 0,
        force: Vec3::y(),
    };
    let n = ready.shape_len();
    let (shape, pose) = (vec![0.0; n], over(Vec3::zeros()));
    for (loads, sites, hybrid) in [
        ([load, load], vec![site], [1.0, 0.0]),
        ([load, Wrench::ZERO], vec![site], [0.0, 0.0]),
        ([Wrench::ZERO, load], vec![], [0.0, 0.0]),
        ([load, load], vec![SiteLoad { tool: 1, ..site }], [0.0, 0.0]),
    ] {
        let mut state = vec![0.5; n + MAX_TOOLS];
        ready.commit(
            &shape,
            Some(&sites),
            &hands(&tool, pose, pose, &loads),
            &mut state,
        );
        assert_eq!(state[n..], hybrid);
    }
}

#[test]
fn bad_numbers_of_a_gingiva_are_refused_by_name() {
    let tree = wall(0.9e-3);
    let good = gingiva(&tree);
    let refused = |change: fn(&mut PrintedGingiva)| {
        let mut model = good.clone();
        change(&mut model);
        model.validate(&tree).expect_err("broken").field
    };
    assert_eq!(refused(|m| m.stiffness_n_per_m = 0.0), "stiffness_n_per_m");
    assert_eq!(
        refused(|m| m.attenuation_per_mm = 1.0),
        "attenuation_per_mm"
    );
    assert_eq!(
        refused(|m| m.inward.iter_mut().for_each(|n| *n *= 2.0)),
        "inward"
    );
    assert_eq!(refused(|m| m.inward[3].x = f64::NAN), "inward");
    assert_eq!(refused(|m| m.inward.truncate(7)), "inward");
    assert_eq!(refused(|m| m.axis = Vec3::zeros()), "axis");
}

//! Tests of the gingiva: kernel, compliance, behaviour in time, force zones, validation.

mod reading;

use proptest::prelude::*;

use super::pocket::zone_after;
use super::*;
use crate::TICK_S;
use crate::math::{Mat3, fmax, fmin};
use crate::output::ForceZone;
use crate::tissue::{Gram, Hands, Site, Tissue, TissueModel};
use crate::tree::{MAX_LEVEL, Sphere};

const NOBODY: Hands<'static> = Hands {
    tools: [None, None],
    detail: 0,
};

/// Sphere of a test gingiva: centre (metres), direction away from the tooth (radians), height over the floor (metres).
type Spot = ([f64; 3], f64, f64);

/// Returns a gingiva of the spheres `spots` around a tooth along z, its tree, and the nodes of the spheres.
fn gingiva(spots: &[Spot], params: GingivaParams) -> (Gingiva, SphereTree, Vec<u32>) {
    let spheres: Vec<Sphere> = spots
        .iter()
        .map(|(centre, _, _)| Sphere {
            centre: Vec3::from(*centre),
            radius: 3e-4,
        })
        .collect();
    let rest = SphereTree::over_leaves(&spheres).expect("valid");
    let ids: Vec<u32> = rest.shape_at(MAX_LEVEL).map(|(id, _)| id).collect();
    let places = rest.nodes().iter().map(|node| {
        // Inner nodes are not used. Leaves are matched to their spots by position.
        let near = |spot: &Spot| norm(&(Vec3::from(spot.0) - node.centre));
        let spot = spots.iter().fold(
            &spots[0],
            |best, s| if near(s) < near(best) { s } else { best },
        );
        Place {
            away: Vec3::new(libm::cos(spot.1), libm::sin(spot.1), 0.0),
            on_surface: node.centre,
            spread: 0.0,
            height: spot.2,
            floor: spot.2 <= 0.0,
        }
    });
    let model = Gingiva {
        params,
        tooth: ToothFrame {
            origin: Vec3::zeros(),
            axis: Vec3::z(),
            mesial: Vec3::x(),
            buccal: Vec3::y(),
        },
        margin: vec![2e-3; 8],
        proximal: 50f64.to_radians(),
        sites: [Prescribed::default(); 6],
        places: places.collect(),
        level: MAX_LEVEL,
    };
    model.validate(&rest).expect("valid");
    (model, rest, ids)
}

/// Strategy for spheres at arbitrary positions. Some are pairs 0.1 mm apart that face opposite ways, as the two sides
/// of a papilla do.
fn spots() -> impl Strategy<Value = Vec<Spot>> {
    let near = -3e-3..3e-3;
    let spot = ([near.clone(), near.clone(), near], -3.2..3.2, -1e-3..2e-3);
    proptest::collection::vec((spot, any::<bool>()), 1..12).prop_map(|all| {
        let pairs = all.into_iter().flat_map(|(spot, papilla)| {
            let ([x, y, z], away, height): Spot = spot;
            let mut pair = vec![spot];
            if papilla {
                pair.push(([x + 1e-4, y, z - 5e-5], away + std::f64::consts::PI, height));
            }
            pair
        });
        pairs.collect()
    })
}

/// Returns rows along x, y and z at every sphere.
fn everywhere(ids: &[u32]) -> Vec<Site> {
    let axes = [Vec3::x(), Vec3::y(), Vec3::z()];
    let sites = ids
        .iter()
        .flat_map(|&sphere| axes.map(|normal| Site { sphere, normal }));
    sites.collect()
}

fn matrix(tissue: &mut dyn Tissue, sites: &[Site]) -> Vec<f64> {
    let n = sites.len();
    let mut entries = vec![0.0; n * n];
    tissue.add_gram(sites, &mut Gram::new(&mut entries, n, 0));
    entries
}

/// Computes the eigenvalues of a symmetric matrix by Jacobi rotations, independent of the model's code.
fn eigenvalues(mut a: Vec<f64>, n: usize) -> Vec<f64> {
    for _ in 0..60 {
        for p in 0..n {
            for q in p + 1..n {
                let off = a[p * n + q];
                if off == 0.0 {
                    continue;
                }
                let theta = (a[q * n + q] - a[p * n + p]) / (2.0 * off);
                let t = if theta < 0.0 { -1.0 } else { 1.0 }
                    / (theta.abs() + (theta * theta + 1.0).sqrt());
                let c = 1.0 / (t * t + 1.0).sqrt();
                let s = t * c;
                for k in 0..n {
                    let (kp, kq) = (a[k * n + p], a[k * n + q]);
                    a[k * n + p] = c * kp - s * kq;
                    a[k * n + q] = s * kp + c * kq;
                }
                for k in 0..n {
                    let (pk, qk) = (a[p * n + k], a[q * n + k]);
                    a[p * n + k] = c * pk - s * qk;
                    a[q * n + k] = s * pk + c * qk;
                }
            }
        }
    }
    (0..n).map(|k| a[k * n + k]).collect()
}

#[test]
fn the_judge_of_eigenvalues_is_right() {
    // The matrix of a chain of n springs has the eigenvalues 2 - 2 cos(k pi / (n + 1)).
    let n = 12;
    let mut a = vec![0.0; n * n];
    for k in 0..n {
        a[k * n + k] = 2.0;
        if k + 1 < n {
            a[k * n + k + 1] = -1.0;
            a[(k + 1) * n + k] = -1.0;
        }
    }
    let mut found = eigenvalues(a, n);
    found.sort_by(f64::total_cmp);
    for (k, x) in found.iter().enumerate() {
        let angle = std::f64::consts::PI * (k + 1) as f64 / (n + 1) as f64;
        assert!((x - (2.0 - 2.0 * libm::cos(angle))).abs() < 1e-12);
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(48))]
    #[test]
    fn the_kernel_is_never_negative(spots in spots(), spread in 0.0..1e-3) {
        let (mut model, rest, ids) = gingiva(&spots, GingivaParams::default());
        for place in &mut model.places {
            // Mixture of points, stretches and coincident points.
            place.spread = fmax(0.0, spread * place.away.x);
            place.on_surface.x = fmax(0.0, place.on_surface.x);
        }
        let sites = everywhere(&ids);
        let n = sites.len();
        let entries = matrix(&mut Ready::new(&model, &rest, TICK_S), &sites);
        for i in 0..n {
            for j in 0..i {
                prop_assert_eq!(entries[i * n + j], entries[j * n + i]);
            }
        }
        let values = eigenvalues(entries, n);
        let (least, most) = values.iter().fold((f64::INFINITY, 0.0), |(a, b), x| (fmin(a, *x), if *x > b { *x } else { b }));
        prop_assert!(most > 0.0 && least >= -1e-14 * most, "{} of {}", least, most);
    }

    #[test]
    fn what_a_row_says_is_what_a_load_does(spots in spots(), lambda in 0.0..2.0, spread in 0.0..1e-3) {
        let (mut model, rest, ids) = gingiva(&spots, GingivaParams::default());
        // Regression: a diagonal entry computed for a point instead of a stretch left tool and tissue 2 um inside each
        // other.
        model.places.iter_mut().for_each(|place| place.spread = spread);
        let mut ready = Ready::new(&model, &rest, TICK_S);
        let sites = everywhere(&ids);
        let n = sites.len();
        let entries = matrix(&mut ready, &sites);
        let free: Vec<f64> = (0..ready.shape_len()).map(|k| 1e-5 * k as f64).collect();
        let (mut base, mut moved) = (free.clone(), free.clone());
        let mut loads = vec![lambda; n];
        ready.apply(&sites, &loads, &free, &mut base);
        let at = |shape: &[f64], site: &Site| {
            let mut out = [Vec3::zeros()];
            ready.centres(shape, &[site.sphere], &mut out);
            out[0].dot(&site.normal)
        };
        let mut ready_to_apply = Ready::new(&model, &rest, TICK_S);
        for j in 0..n {
            loads[j] += 0.5;
            ready_to_apply.apply(&sites, &loads, &free, &mut moved);
            loads[j] = lambda;
            for (i, site) in sites.iter().enumerate() {
                let slope = (at(&base, site) - at(&moved, site)) / 0.5;
                prop_assert!((slope - entries[i * n + j]).abs() < 1e-12);
            }
        }
    }
}

#[test]
fn clamped_direction_cosines_would_not_do() {
    // The clamped cosine between the directions away from the tooth is the obvious form of Eq. 14. With a dozen places
    // round a thin tooth, near enough for the distance not to matter, its matrix is indefinite.
    let n = 12;
    let cosine = |k: usize| libm::cos(2.0 * std::f64::consts::PI * k as f64 / n as f64);
    let clamped = (0..n * n).map(|k| {
        let cosine = cosine((k / n + n - k % n) % n);
        if cosine > 0.0 { cosine } else { 0.0 }
    });
    let least = eigenvalues(clamped.collect(), n)
        .into_iter()
        .fold(f64::INFINITY, fmin);
    assert!(least < -0.05, "{least}");
}

#[test]
fn in_time_it_is_a_kelvin_voigt_solid() {
    let params = GingivaParams::default();
    let (model, rest, ids) = gingiva(&[([0.0; 3], 0.3, 2e-3)], params);
    let mut ready = Ready::new(&model, &rest, TICK_S);
    let mut state = vec![0.0; model.state_len(&rest)];
    let (mut shape, mut free) = (vec![0.0; 3], vec![0.0; 3]);
    let away = model.places[ids[0] as usize].away;
    let sites = [Site {
        sphere: ids[0],
        normal: -away,
    }];
    assert!(ready.free_step(&state, &NOBODY, &mut shape, &mut free));
    let load = 0.3;
    // Load for 60 ms, then release.
    let mut pressed = 0.0;
    for k in 1..=600 {
        ready.free_step(&state, &NOBODY, &mut shape, &mut free);
        let lambda = if k <= 60 { load } else { 0.0 };
        ready.apply(&sites, &[lambda], &free.clone(), &mut shape);
        ready.commit(&shape, Some(&[]), &NOBODY, &mut state);
        let t = f64::from(k) * TICK_S;
        let way = Vec3::new(shape[0], shape[1], shape[2]).dot(&away);
        let end = load / params.wall_stiffness;
        let exact = if k <= 60 {
            end * (1.0 - libm::exp(-t / params.relaxation))
        } else {
            pressed * libm::exp(-(t - 0.06) / params.relaxation)
        };
        // Implicit Euler with 20 steps per time constant: an error of first order.
        assert!(
            (way - exact).abs() < 0.02 * end,
            "{t}: {way:e}, exact {exact:e}"
        );
        if k == 60 {
            pressed = way;
        }
    }
    // The return to rest is complete and exact.
    assert!(state.iter().all(|x| *x == 0.0), "{state:?}");
    assert!(ready.free_step(&state, &NOBODY, &mut shape, &mut free));
}

#[test]
fn stiffness_is_that_of_the_parameters_in_every_direction() {
    let params = GingivaParams {
        relaxation: 0.0,
        inflammation: 0.4,
        ..GingivaParams::default()
    };
    let spots = [([0.0; 3], 0.0, 2e-3), ([4e-3, 0.0, -1e-3], 0.0, -1e-4)];
    let (model, rest, ids) = gingiva(&spots, params);
    let mut ready = Ready::new(&model, &rest, TICK_S);
    for &id in &ids {
        let entries = matrix(&mut ready, &everywhere(&[id]));
        let compliance = Mat3::from_row_slice(&entries);
        let firm = |stiffness: f64| 1.0 / (0.8 * stiffness);
        let along = if model.places[id as usize].floor {
            params.floor_compliance()
        } else {
            firm(params.shear_stiffness)
        };
        let wanted = Vec3::new(
            firm(params.wall_stiffness),
            firm(params.shear_stiffness),
            along,
        );
        let found = Mat3::from_diagonal(&wanted);
        assert!((compliance - found).norm() < 1e-15, "{compliance}");
    }
}

#[test]
fn a_tip_of_the_size_that_depths_are_read_with_feels_the_floor_of_the_parameters() {
    // Many places of a floor under one disc, evenly loaded.
    let params = GingivaParams {
        relaxation: 0.0,
        ..GingivaParams::default()
    };
    let radius = 0.5 * params.reading_tip;
    let cells = (-6..=6).flat_map(|i| (-6..=6).map(move |j| (i, j)));
    let places = cells.filter(|(i, j)| i * i + j * j <= 36).map(|(i, j)| {
        let at = |k: i32| f64::from(k) / 6.3 * radius;
        ([at(i), at(j), 0.0], 0.0, -1e-4)
    });
    let places: Vec<Spot> = places.collect();
    let (mut model, rest, ids) = gingiva(&places, params);
    // The floor is a line: the position across it does not matter.
    model
        .places
        .iter_mut()
        .for_each(|place| place.on_surface.x = 0.0);
    let mut ready = Ready::new(&model, &rest, TICK_S);
    let up = |&sphere: &u32| Site {
        sphere,
        normal: Vec3::z(),
    };
    let sites: Vec<Site> = ids.iter().map(up).collect();
    let n = sites.len() as f64;
    let (load, free) = (vec![0.3 / n; sites.len()], vec![0.0; ready.shape_len()]);
    let mut shape = free.clone();
    ready.apply(&sites, &load, &free, &mut shape);
    let sunk = -shape.chunks_exact(3).map(|u| u[2]).sum::<f64>() / n;
    let wanted = 0.3 / params.floor_stiffness;
    assert!(
        (sunk / wanted - 1.0).abs() < 0.03,
        "{sunk:e} m, not {wanted:e}"
    );
}

#[test]
fn a_zone_is_entered_once_and_again_only_after_the_hand_was_lighter() {
    let params = GingivaParams::default();
    let forces = [
        0.1, 0.26, 0.24, 0.26, 0.21, 0.26, 0.19, 0.26, 0.55, 0.45, 0.55, 0.39, 0.55, 2.0, 1.6, 2.0,
        0.0,
    ];
    let mut zone = ForceZone::Light;
    let mut entered = Vec::new();
    for (k, force) in forces.iter().enumerate() {
        let after = zone_after(&params, zone, *force);
        if after > zone {
            entered.push((k, after));
        }
        zone = after;
    }
    use ForceZone::{Damage, TooHeavy, Trauma};
    assert_eq!(
        entered,
        [
            (1, TooHeavy),
            (7, TooHeavy),
            (8, Trauma),
            (12, Trauma),
            (13, Damage)
        ]
    );
    assert_eq!(zone, ForceZone::Light);
    // A heavy press without lighter ones before is one event, of the heaviest zone.
    assert_eq!(zone_after(&params, ForceZone::Light, 3.0), Damage);
    // From damage down into trauma.
    assert_eq!(zone_after(&params, Damage, 1.5), Trauma);
    assert_eq!(zone_after(&params, Damage, f64::NAN), ForceZone::Light);
}

#[test]
fn nodes_below_the_level_go_along_and_those_above_stay() {
    let spots: Vec<Spot> = (0..80)
        .map(|k| ([1e-4 * f64::from(k), 0.0, 0.0], 0.0, 1e-3))
        .collect();
    let (mut model, rest, _) = gingiva(&spots, GingivaParams::default());
    model.level = 2;
    model.validate(&rest).expect("valid");
    let ready = Ready::new(&model, &rest, TICK_S);
    assert_eq!(ready.shape_len() + MEMORY, model.state_len(&rest));
    let shape: Vec<f64> = (0..ready.shape_len())
        .map(|k| 1e-6 * (k + 1) as f64)
        .collect();
    for (k, node) in rest.nodes().iter().enumerate() {
        let mut now = [Vec3::zeros()];
        ready.centres(&shape, &[k as u32], &mut now);
        assert_eq!(
            now[0] == node.centre,
            node.level < 2 && !node.is_shape_at(2)
        );
        for child in 0..u32::from(node.children) {
            let (mut moved, at) = ([Vec3::zeros()], node.first_child + child);
            ready.centres(&shape, &[at], &mut moved);
            if node.level >= 2 {
                let (a, b) = (
                    moved[0] - rest.nodes()[at as usize].centre,
                    now[0] - node.centre,
                );
                assert!(norm(&(a - b)) < 1e-18);
            }
        }
    }
}

#[test]
fn what_cannot_stand_is_named() {
    let (good, rest, _) = gingiva(&[([0.0; 3], 0.0, 1e-3)], GingivaParams::default());
    let refused = |change: fn(&mut Gingiva)| {
        let mut bad = good.clone();
        change(&mut bad);
        let error = TissueModel::Gingiva(Box::new(bad)).validate(&rest, TICK_S);
        error.expect_err("refused").to_string()
    };
    assert!(
        refused(|g| g.params.wall_stiffness = f64::NAN)
            .starts_with("wall_stiffness is NaN, expected 10")
    );
    assert!(refused(|g| g.params.damage = 0.1).contains("damage is 0.1, expected trauma to 10 N"));
    assert!(
        refused(|g| g.places.clear()).contains("number of places is 0, expected one for each of 1")
    );
    assert!(refused(|g| g.margin = vec![0.0, f64::NAN, 0.0]).contains("margin is"));
    assert!(refused(|g| g.tooth.axis = Vec3::x()).contains("tooth is"));
    assert!(
        refused(|g| g.places[0].away = Vec3::z()).contains("at 0, expected a unit vector across")
    );
}

#[test]
fn prescriptions_out_of_range_are_refused_by_name() {
    let (model, rest, _) = gingiva(&[([3e-3, 0.0, 0.0], 0.0, 0.0)], GingivaParams::default());
    let told = |change: &dyn Fn(&mut Gingiva)| {
        let mut model = model.clone();
        change(&mut model);
        model.validate(&rest).err().map(|error| error.to_string())
    };
    assert_eq!(told(&|_| ()), None);
    assert_eq!(told(&|m| m.proximal = 80f64.to_radians()), None);
    assert_eq!(told(&|m| m.proximal = 20f64.to_radians()), None);
    assert_eq!(told(&|m| m.sites[3].depth = 20e-3), None);
    type Change = fn(&mut Gingiva);
    let wrong: [(Change, &[&str]); 6] = [
        (
            |m| m.proximal = 81f64.to_radians(),
            &["proximal", "20 to 80 deg"],
        ),
        (|m| m.proximal = f64::NAN, &["proximal", "NaN"]),
        (
            |m| m.sites[2].depth = 0.021,
            &["depth", "21 mm at distobuccal", "0 to 20 mm"],
        ),
        (
            |m| m.sites[0].depth = f64::NAN,
            &["depth", "NaN mm at mesiobuccal"],
        ),
        (
            |m| m.sites[5].recession = -0.011,
            &["recession", "mesiolingual", "-10 to 20 mm"],
        ),
        (
            |m| m.sites[4].recession = f64::INFINITY,
            &["recession", "inf mm at lingual"],
        ),
    ];
    for (change, words) in wrong {
        let told = told(&change).expect("refused");
        assert!(words.iter().all(|word| told.contains(word)), "{told}");
    }
}

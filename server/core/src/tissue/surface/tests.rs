use super::*;
use crate::math::{Mat3, Vec3, fmax};
use crate::tissue::{Gram, Hands, Site, SiteLoad, Tissue, TissueModel};
use crate::tree::{MAX_LEVEL, Sphere, SphereTree};
use crate::{MAX_TOOLS, TICK_S};

const MASTERS: usize = 10;
const N: usize = 3 * MASTERS;

/// Returns a pseudo-random number between -1 and 1.
fn some(k: usize) -> f64 {
    libm::sin(1.0 + 12.9898 * k as f64 + 0.37 * (k * k % 97) as f64)
}

fn tree() -> SphereTree {
    let spheres: Vec<Sphere> = (0..20)
        .map(|k| Sphere {
            centre: Vec3::new(some(k), some(k + 50), some(k + 90)) * 0.03,
            radius: 1e-3,
        })
        .collect();
    SphereTree::over_leaves(&spheres).expect("valid")
}

/// Returns an organ of no particular shape, about 10 mm/N soft, with two cells.
fn organ(tree: &SphereTree, large: f64) -> SurfaceCompliance {
    let young = 1e4;
    let root: Vec<f64> = (0..N * N).map(|k| some(k + 1000)).collect();
    let mut compliance = Vec::new();
    for i in 0..N {
        for j in 0..=i {
            let inner = (0..N).map(|k| root[i * N + k] * root[j * N + k]);
            let own = if i == j { 1.0 } else { 0.0 };
            compliance.push((young * 3e-4 * (inner.sum::<f64>() + own)) as f32);
        }
    }
    let places =
        (0..MASTERS + 3).map(|k| Vec3::new(some(k + 7), some(k + 70), some(k + 700)) * 0.03);
    let masters = Masters {
        places: places.collect(),
        moving: MASTERS as u16,
    };
    let skin = tree.nodes().iter().map(|node| {
        let mut skin = SurfaceSkin::default();
        let weights = masters.weights(&node.centre);
        for (slot, (k, w)) in weights.into_iter().enumerate() {
            if k < MASTERS {
                (skin.masters[slot], skin.weights[slot]) = (k as u16, w);
            }
        }
        skin
    });
    SurfaceCompliance {
        params: SurfaceParams {
            young,
            large,
            ..SurfaceParams::default()
        },
        skin: skin.collect(),
        compliance,
        cells: Cells {
            volumes: vec![2e-6, 3e-6],
            response: (0..18 * N).map(|k| 4e-3 * some(k + 5000) as f32).collect(),
        },
        masters,
    }
}

struct Bench {
    tree: SphereTree,
    ready: Box<dyn Tissue>,
    state: Vec<f64>,
    shape: Vec<f64>,
}

impl Bench {
    fn new(large: f64) -> Self {
        let tree = tree();
        let model = TissueModel::Surface(Box::new(organ(&tree, large)));
        model.validate(&tree, TICK_S).expect("valid");
        Self {
            ready: model.ready(&tree, MAX_LEVEL, TICK_S).expect("yields"),
            state: vec![0.0; model.state_len(&tree)],
            shape: vec![0.0; N],
            tree,
        }
    }

    fn leaves(&self) -> Vec<u32> {
        self.tree.shape_at(MAX_LEVEL).map(|(id, _)| id).collect()
    }

    /// Runs one tick under forces (newtons) on spheres. Returns whether the organ was at rest before the forces.
    fn tick(&mut self, forces: &[(u32, Vec3)]) -> bool {
        let hands = Hands {
            tools: [None; MAX_TOOLS],
            detail: 0,
        };
        let mut free = vec![0.0; N];
        let asleep = self
            .ready
            .free_step(&self.state, &hands, &mut self.shape, &mut free);
        let axes = [Vec3::x(), Vec3::y(), Vec3::z()];
        let (mut sites, mut lambda, mut loads) = (Vec::new(), Vec::new(), Vec::new());
        for &(sphere, force) in forces {
            for normal in axes {
                sites.push(Site { sphere, normal });
                lambda.push(-force.dot(&normal));
            }
            loads.push(SiteLoad {
                sphere,
                tool: 0,
                force,
            });
        }
        self.ready.apply(&sites, &lambda, &free, &mut self.shape);
        self.ready
            .commit(&self.shape, Some(&loads), &hands, &mut self.state);
        asleep
    }

    /// Returns the displacement of a sphere, metres.
    fn moved(&self, sphere: u32) -> Vec3 {
        let mut at = [Vec3::zeros()];
        self.ready.centres(&self.shape, &[sphere], &mut at);
        at[0] - self.tree.nodes()[sphere as usize].centre
    }

    /// Returns the displacements of the spheres in equilibrium under forces on some of them, metres.
    fn settle(&mut self, forces: &[(u32, Vec3)]) -> Vec<Vec3> {
        self.state.fill(0.0);
        for _ in 0..1500 {
            self.tick(forces);
        }
        self.leaves().iter().map(|k| self.moved(*k)).collect()
    }
}

#[test]
fn compliance_seen_by_the_solver_is_that_of_the_step() {
    let mut bench = Bench::new(1.0);
    let leaves = bench.leaves();
    let sites: Vec<Site> = (0..12)
        .map(|k| Site {
            sphere: leaves[k * 7 % leaves.len()],
            normal: Vec3::new(some(k), some(k + 20), some(k + 40)).normalize(),
        })
        .collect();
    let m = sites.len();
    let mut gram = vec![0.0; m * m];
    bench
        .ready
        .add_gram(&sites, &mut Gram::new(&mut gram, m, 0));
    // Start from a loaded configuration, as in a run.
    bench.settle(&[(leaves[3], Vec3::new(0.1, -0.2, 0.3))]);
    let free = bench.shape.clone();
    let largest = gram.iter().fold(0.0, |most, x| fmax(most, x.abs()));
    for j in 0..m {
        let mut lambda = vec![0.0; m];
        lambda[j] = 0.01;
        bench.ready.apply(&sites, &lambda, &free, &mut bench.shape);
        let after: Vec<Vec3> = sites.iter().map(|s| bench.moved(s.sphere)).collect();
        bench.shape.copy_from_slice(&free);
        for i in 0..m {
            let before = bench.moved(sites[i].sphere);
            let found = -sites[i].normal.dot(&(after[i] - before)) / 0.01;
            let entry = gram[i * m + j];
            assert!(
                (found - entry).abs() < 1e-6 * largest,
                "{i} {j}: {found} {entry}"
            );
            assert_eq!(entry, gram[j * m + i]);
        }
    }
    for seed in 0..50 {
        let x: Vec<f64> = (0..m).map(|k| some(31 * seed + k)).collect();
        let of = |i: usize| (0..m).map(|j| x[i] * gram[i * m + j] * x[j]).sum::<f64>();
        assert!((0..m).map(of).sum::<f64>() > -1e-6 * largest);
    }
}

#[test]
fn many_spheres_have_the_compliance_that_few_have() {
    let tree = tree();
    let model = organ(&tree, 1.0);
    let leaves: Vec<u32> = tree.shape_at(MAX_LEVEL).map(|(id, _)| id).collect();
    // Two adjacent rows on each of some spheres.
    let sites: Vec<Site> = (0..14)
        .map(|k| Site {
            sphere: leaves[k / 2 * 3 % leaves.len()],
            normal: Vec3::new(some(k), some(k + 20), some(k + 40)).normalize(),
        })
        .collect();
    let m = sites.len();
    let gram = |mut ready: Ready| {
        let mut gram = vec![0.0; m * m];
        ready.add_gram(&sites, &mut Gram::new(&mut gram, m, 0));
        gram
    };
    let ready = || Ready::new(&model, &tree, MAX_LEVEL, TICK_S);
    let (few, many) = (gram(ready()), gram(ready().without_blocks()));
    let largest = few.iter().fold(0.0, |most, x| fmax(most, x.abs()));
    for (a, b) in few.iter().zip(&many) {
        assert!((a - b).abs() < 1e-6 * largest, "{a} {b}");
    }
}

#[test]
fn comes_to_rest_where_the_compliance_says_and_all_the_way_back() {
    let mut bench = Bench::new(0.0);
    let model = organ(&bench.tree, 0.0);
    let leaf = bench.leaves()[5];
    let force = Vec3::new(0.3, -0.1, 0.2);
    bench.settle(&[(leaf, force)]);
    let skin = &model.skin[leaf as usize];
    for i in 0..N {
        let mut wanted = 0.0;
        for (master, weight) in skin.masters.iter().zip(skin.weights) {
            for axis in 0..3 {
                let entry = model.entry(i, 3 * usize::from(*master) + axis);
                wanted += entry * weight * force[axis] / model.params.young;
            }
        }
        assert!(
            (bench.shape[i] - wanted).abs() < 1e-6 * (1e-3 + wanted.abs()),
            "{i}"
        );
    }
    // After release the displacement shrinks in every tick and reaches the rest.
    let mut before = f64::INFINITY;
    for k in 0..2000 {
        let asleep = bench.tick(&[]);
        let most = bench.shape.iter().fold(0.0, |most, x| fmax(most, x.abs()));
        assert!(
            most < before || most == 0.0,
            "tick {k}: {most} after {before}"
        );
        before = most;
        if asleep {
            assert!(bench.state.iter().all(|x| *x == 0.0));
            return;
        }
    }
    panic!("still {before} m from rest");
}

#[test]
fn the_large_displacement_term_is_quadratic_and_keeps_the_compliance_symmetric() {
    let mut bench = Bench::new(1.0);
    let model = organ(&bench.tree, 1.0);
    let leaves = bench.leaves();
    let (a, b) = (leaves[2], leaves[11]);
    let force = Vec3::new(0.02, 0.05, -0.04);
    // Even part in the load, against the formula.
    bench.settle(&[(a, force)]);
    let there = bench.shape.clone();
    bench.settle(&[(a, -force)]);
    let even: Vec<f64> = there
        .iter()
        .zip(&bench.shape)
        .map(|(x, y)| 0.5 * (x + y))
        .collect();
    let mut on_masters = [0.0; N];
    let skin = &model.skin[a as usize];
    for (master, weight) in skin.masters.iter().zip(skin.weights) {
        for axis in 0..3 {
            on_masters[3 * usize::from(*master) + axis] += weight * force[axis];
        }
    }
    let response =
        |cell: usize, k: usize, i: usize| f64::from(model.cells.response[(9 * cell + k) * N + i]);
    let mut wanted = vec![0.0; N];
    for cell in 0..2 {
        let gradient = Mat3::from_fn(|i, j| {
            let read = (0..N).map(|n| response(cell, 3 * i + j, n) * on_masters[n]);
            read.sum::<f64>() / (model.cells.volumes[cell] * model.params.young)
        });
        assert!(gradient.norm() < 0.2, "small enough: {}", gradient.norm());
        let stress = quadratic_stress(&gradient, model.params.poisson);
        for (n, wanted) in wanted.iter_mut().enumerate() {
            for k in 0..9 {
                *wanted -= response(cell, k, n) * stress[(k / 3, k % 3)];
            }
        }
    }
    let most = wanted.iter().fold(0.0, |most, x| fmax(most, x.abs()));
    assert!(most > 1e-6, "{most}");
    for (n, (found, wanted)) in even.iter().zip(&wanted).enumerate() {
        // The bound at large gradients reduces the term slightly.
        assert!(
            (found - wanted).abs() < 0.01 * most,
            "{n}: {found:e} {wanted:e}"
        );
    }
    // The term is the derivative of an energy, so the response is symmetric. A load at `a` moves `b` as much as the
    // reverse, also under a further load.
    let held = [(leaves[7], Vec3::new(0.1, -0.1, 0.05))];
    let (u, v) = (Vec3::new(0.6, 0.0, 0.8), Vec3::new(0.0, -1.0, 0.0));
    let mut felt = |by: u32, along: Vec3, at: u32, read: Vec3| {
        let [plus, minus] = [1e-3, -1e-3].map(|size| {
            bench.settle(&[held[0], (by, along * size)]);
            bench.moved(at).dot(&read)
        });
        (plus - minus) / 2e-3
    };
    let (one, other) = (felt(a, u, b, v), felt(b, v, a, u));
    assert!(
        (one - other).abs() < 1e-4 * fmax(one.abs(), 1e-3),
        "{one} {other}"
    );
}

#[test]
fn a_load_beyond_all_sense_stays_finite_and_within_bounds() {
    let mut bench = Bench::new(1.0);
    let leaves = bench.leaves();
    for size in [1.0, 1e3, 1e6] {
        let moved = bench.settle(&[(leaves[0], Vec3::new(1.0, 2.0, -1.0) * size)]);
        assert!(moved.iter().flatten().all(|x| x.is_finite()));
        bench.settle(&[(leaves[0], Vec3::new(1.0, 2.0, -1.0) * size)]);
        let linear = Bench::new(0.0).settle(&[(leaves[0], Vec3::new(1.0, 2.0, -1.0) * size)]);
        let apart = moved.iter().zip(&linear).map(|(a, b)| (a - b).norm());
        // The term is bounded at any load.
        assert!(apart.fold(0.0, fmax) < 1.0, "{size}");
    }
}

#[test]
fn what_cannot_stand_is_named() {
    let tree = tree();
    let said = |change: &dyn Fn(&mut SurfaceCompliance)| {
        let mut model = organ(&tree, 1.0);
        change(&mut model);
        match model.validate(&tree, TICK_S) {
            Err(error) => error.to_string(),
            Ok(()) => panic!("stands"),
        }
    };
    assert!(said(&|m| m.params.young = f64::NAN).contains("young is NaN"));
    assert!(said(&|m| m.params.relaxation = 1e-3).contains("0.002 to 1 s"));
    assert!(said(&|m| m.masters.moving = 300).contains("number of masters"));
    assert!(said(&|m| m.masters.places.truncate(4)).contains("masters"));
    assert!(said(&|m| m.masters.places[2].x = f64::NAN).contains("finite"));
    assert!(said(&|m| m.compliance.truncate(9)).contains("entries of the compliance is 9"));
    assert!(said(&|m| m.compliance[5] = f32::NAN).contains("compliance"));
    assert!(said(&|m| m.compliance[2] = -1.0).contains("positive semi-definite"));
    assert!(said(&|m| m.cells.volumes[1] = 0.0).contains("volume of a cell"));
    assert!(said(&|m| m.cells.response.truncate(1)).contains("entries of the cells is 1"));
    assert!(said(&|m| m.cells.response[3] = f32::INFINITY).contains("response"));
    assert!(said(&|m| m.skin.truncate(1)).contains("skin of the surface is 1"));
    assert!(said(&|m| m.skin[4].weights[0] = 1.5).contains("skin weights"));
    assert!(said(&|m| m.skin[4].masters[0] = 99).contains("master 99"));
}

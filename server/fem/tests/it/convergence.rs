//! Convergence of the error with refinement of the mesh, at a Poisson's ratio of 0.49.

use crate::common::{SOFT, block, pull};
use sulcus_core::Vec3;
use sulcus_fem::{Factored, TetMesh};

/// Work of a load on its own displacements, J.
fn work(mesh: &TetMesh, load: Vec<Vec3>) -> f64 {
    let factored = Factored::new(mesh, &SOFT).expect("held");
    let moved = factored.solve(std::slice::from_ref(&load)).expect("finite");
    load.iter().zip(&moved[0]).map(|(f, u)| f.dot(u)).sum()
}

/// A thick L, held at its foot and pushed sideways at its end. `cells` counts the cells over the breadth of a leg.
///
/// The L is a square without one quarter, so its inner corner is sharp.
fn bracket(cells: usize) -> f64 {
    let leg = 0.01;
    let whole = block(
        [2 * cells, cells, 2 * cells],
        Vec3::new(2.0 * leg, leg, 2.0 * leg),
    );
    let middle = |tet: &[u32; 10]| {
        let corners = tet[..4].iter().map(|&n| whole.nodes[n as usize]);
        corners.sum::<Vec3>() / 4.0
    };
    let kept = whole.tets.iter().filter(|tet| {
        let x = middle(tet);
        x.x < leg || x.z > leg
    });
    let corners: Vec<[u32; 4]> = kept.map(|tet| [tet[0], tet[1], tet[2], tet[3]]).collect();
    // Only the remaining nodes.
    let mut new = vec![u32::MAX; whole.nodes.len()];
    let mut nodes = Vec::new();
    let corners: Vec<[u32; 4]> = corners
        .into_iter()
        .map(|tet| {
            tet.map(|node| {
                let new = &mut new[node as usize];
                if *new == u32::MAX {
                    *new = nodes.len() as u32;
                    nodes.push(whole.nodes[node as usize]);
                }
                *new
            })
        })
        .collect();
    let mut mesh = TetMesh::from_corners(nodes, &corners);
    assert!((mesh.volume() / (3.0 * leg * leg * leg) - 1.0).abs() < 1e-12);
    for (held, x) in mesh.held.iter_mut().zip(&mesh.nodes) {
        *held = [x.z == 0.0; 3];
    }
    let load = pull(&mesh, 2.0 * leg, Vec3::new(0.0, 100.0, -300.0));
    work(&mesh, load)
}

#[test]
fn a_thick_bracket_gives_way_more_and_ever_less_so() {
    // Each mesh contains the one before. By Galerkin's principle it can only become softer.
    let work = [1, 2, 4, 8].map(bracket);
    let gained: Vec<f64> = work.windows(2).map(|w| w[1] - w[0]).collect();
    assert!(gained.iter().all(|gain| *gain > 0.0), "{work:?}");
    let orders: Vec<f64> = gained.windows(2).map(|g| libm::log2(g[0] / g[1])).collect();
    let exact = work[3] + gained[2] / (gained[1] / gained[2] - 1.0);
    let off = work.map(|work| (1.0 - work / exact) * 100.0);
    println!("bracket: {off:.3?} % short of the extrapolated work, orders {orders:.2?}");
    // Stress has no bound at the inner corner and at the rim of the foot, so the order stays near 1.
    assert!(
        orders.iter().all(|order| (0.8..2.5).contains(order)),
        "{orders:?}"
    );
    assert!(off.windows(2).all(|off| off[1] < 0.6 * off[0]), "{off:?}");
    assert!(off[2] < 4.0 && off[3] < 1.5, "{off:?}");
}

/// Points and weights of Gauss between 0 and 1, exact to degree 7.
fn gauss() -> [(f64, f64); 4] {
    let root = (6.0_f64 / 5.0).sqrt();
    let [near, far] = [-1.0, 1.0].map(|way| (3.0 / 7.0 + way * 2.0 / 7.0 * root).sqrt());
    let [more, less] = [1.0, -1.0].map(|way| (18.0 + way * 30.0_f64.sqrt()) / 36.0);
    [(-near, more), (near, more), (-far, less), (far, less)].map(|(x, w)| (0.5 + 0.5 * x, 0.5 * w))
}

/// Points of a tetrahedron in volume coordinates, with the share of the volume of each. The rule is a collapsed cube.
fn points() -> Vec<([f64; 4], f64)> {
    let mut all = Vec::new();
    for (a, p) in gauss() {
        for (b, q) in gauss() {
            for (c, r) in gauss() {
                let (x, y, z) = (a, b * (1.0 - a), c * (1.0 - a) * (1.0 - b));
                let share = 6.0 * p * q * r * (1.0 - a) * (1.0 - a) * (1.0 - b);
                all.push(([1.0 - x - y - z, x, y, z], share));
            }
        }
    }
    let sum: f64 = all.iter().map(|(_, share)| share).sum();
    assert!((sum - 1.0).abs() < 1e-13);
    all
}

/// Shape functions, written independently of the crate.
fn shape(l: &[f64; 4]) -> [f64; 10] {
    let corner = |k: usize| l[k] * (2.0 * l[k] - 1.0);
    let middle = |i: usize, j: usize| 4.0 * l[i] * l[j];
    [
        corner(0),
        corner(1),
        corner(2),
        corner(3),
        middle(0, 1),
        middle(1, 2),
        middle(0, 2),
        middle(0, 3),
        middle(1, 3),
        middle(2, 3),
    ]
}

const SIDE: f64 = 0.02;

/// Amplitudes by axis of a displacement that is zero on the faces of a cube, and its second derivatives.
///
/// The displacement is `a sin sin sin` of `pi x / SIDE`.
const AMPLITUDE: [f64; 3] = [1e-4, -2e-4, 1.5e-4];

fn exact(x: &Vec3) -> Vec3 {
    let sines = x.map(|x| libm::sin(std::f64::consts::PI * x / SIDE));
    Vec3::from(AMPLITUDE) * (sines.x * sines.y * sines.z)
}

/// Force per volume (N/m3) in equilibrium with it: `-(lambda + mu) grad div u - mu laplace u`.
fn body_force(x: &Vec3) -> Vec3 {
    let wave = std::f64::consts::PI / SIDE;
    let s = x.map(|x| libm::sin(wave * x));
    let c = x.map(|x| libm::cos(wave * x));
    let mu = SOFT.young / (2.0 * (1.0 + SOFT.poisson));
    let lambda = 2.0 * mu * SOFT.poisson / (1.0 - 2.0 * SOFT.poisson);
    let [a, b, d] = AMPLITUDE;
    // Second derivatives of sin sin sin: twice by one axis, or by two axes.
    let twice = -s.x * s.y * s.z;
    let (xy, xz, yz) = (c.x * c.y * s.z, c.x * s.y * c.z, s.x * c.y * c.z);
    let grad_div = Vec3::new(
        a * twice + b * xy + d * xz,
        a * xy + b * twice + d * yz,
        a * xz + b * yz + d * twice,
    );
    let laplace = Vec3::from(AMPLITUDE) * (3.0 * twice);
    -(grad_div * (lambda + mu) + laplace * mu) * (wave * wave)
}

/// Root of the mean square of the error of displacement over that of the displacement.
fn error(cells: usize) -> f64 {
    let mut mesh = block([cells; 3], Vec3::repeat(SIDE));
    for (held, x) in mesh.held.iter_mut().zip(&mesh.nodes) {
        *held = [x.iter().any(|x| *x == 0.0 || *x == SIDE); 3];
    }
    let points = points();
    let place = |tet: &[u32; 10], l: &[f64; 4]| -> Vec3 {
        (0..4).map(|k| mesh.nodes[tet[k] as usize] * l[k]).sum()
    };
    // All tetrahedra of the block have the same volume.
    let volume = mesh.volume() / mesh.tets.len() as f64;
    let mut load = vec![Vec3::zeros(); mesh.nodes.len()];
    for tet in &mesh.tets {
        for (l, share) in &points {
            let force = body_force(&place(tet, l)) * (volume * share);
            for (node, shape) in tet.iter().zip(shape(l)) {
                load[*node as usize] += force * shape;
            }
        }
    }
    let factored = Factored::new(&mesh, &SOFT).expect("held");
    let moved = &factored.solve(&[load]).expect("finite")[0];
    let (mut off, mut all) = (0.0, 0.0);
    for tet in &mesh.tets {
        for (l, share) in &points {
            let exact = exact(&place(tet, l));
            let terms = tet.iter().zip(shape(l));
            let found: Vec3 = terms
                .map(|(node, shape)| moved[*node as usize] * shape)
                .sum();
            off += (found - exact).norm_squared() * share;
            all += exact.norm_squared() * share;
        }
    }
    (off / all).sqrt()
}

#[test]
fn a_smooth_displacement_is_met_to_third_order() {
    let errors = [3, 6, 12].map(error);
    let orders: Vec<f64> = errors.windows(2).map(|e| libm::log2(e[0] / e[1])).collect();
    println!("smooth displacement in a cube: {errors:.6?} off, orders {orders:.2?}");
    // The order is 3 in the limit (Hughes 2000, section 4.1). A Poisson's ratio of 0.49 delays it.
    assert!(orders.iter().all(|order| *order > 2.4), "{orders:?}");
    assert!(errors[2] < 5e-3, "{errors:?}");
}

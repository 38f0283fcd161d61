//! Comparison with answers that are known without finite elements.

use crate::common::{SOFT, block, nodes, pull};
use sulcus_core::Vec3;
use sulcus_core::math::Mat3;
use sulcus_fem::{Elastic, Factored, FemError, TetMesh, internal_forces};

#[test]
fn a_uniform_strain_is_exact_on_a_crooked_mesh() {
    let mut mesh = block([3, 3, 2], Vec3::new(0.03, 0.02, 0.025));
    let inside = |x: &Vec3| {
        [(x.x, 0.03), (x.y, 0.02), (x.z, 0.025)]
            .iter()
            .all(|(x, end)| (1e-9..end - 1e-9).contains(x))
    };
    // Corners inside are moved; midside nodes stay in the middle.
    let old = mesh.clone();
    let corners: Vec<usize> = old
        .tets
        .iter()
        .flat_map(|t| t[..4].iter().map(|n| *n as usize))
        .collect();
    for &k in &corners {
        let x = old.nodes[k];
        if inside(&x) {
            let t = k as f64;
            mesh.nodes[k] = x + Vec3::new(libm(t), libm(2.0 * t), libm(3.0 * t)) * 1.5e-3;
        }
    }
    for tet in &old.tets {
        for (edge, [i, j]) in [[0, 1], [1, 2], [0, 2], [0, 3], [1, 3], [2, 3]]
            .iter()
            .enumerate()
        {
            let ends = [tet[*i], tet[*j]].map(|n| mesh.nodes[n as usize]);
            mesh.nodes[tet[4 + edge] as usize] = (ends[0] + ends[1]) * 0.5;
        }
    }
    mesh.validate().expect("not inside out");
    assert!((mesh.volume() - 0.03 * 0.02 * 0.025).abs() < 1e-16);
    let slope = Mat3::new(1e-3, 2e-3, -5e-4, 3e-4, -2e-3, 1e-3, 7e-4, -1e-4, 4e-3);
    let moved: Vec<Vec3> = mesh.nodes.iter().map(|x| slope * x).collect();
    let forces = internal_forces(&mesh, &SOFT, &moved);
    let most = forces.iter().map(Vec3::norm).fold(0.0, f64::max);
    let within = nodes(&mesh, inside);
    assert!(within.len() > 20 && most > 1e-4);
    for k in within {
        assert!(
            forces[k].norm() < 1e-12 * most.max(1.0),
            "{k}: {}",
            forces[k]
        );
    }
    // Rigid motions need no force.
    let spin = Mat3::new(0.0, -1.0, 2.0, 1.0, 0.0, -3.0, -2.0, 3.0, 0.0);
    let rigid: Vec<Vec3> = mesh
        .nodes
        .iter()
        .map(|x| spin * x + Vec3::new(1.0, 2.0, 3.0))
        .collect();
    let idle = internal_forces(&mesh, &SOFT, &rigid);
    assert!(idle.iter().all(|f| f.norm() < 1e-9), "{:?}", idle[0]);
}

/// A number between -1 and 1.
fn libm(t: f64) -> f64 {
    let x = t * 0.754_877_666;
    2.0 * (x - x.floor()) - 1.0
}

#[test]
fn a_block_under_a_uniform_pull_stretches_as_hooke_says() {
    let size = Vec3::new(0.04, 0.02, 0.01);
    let mut mesh = block([4, 2, 2], size);
    for (held, x) in mesh.held.iter_mut().zip(&mesh.nodes) {
        *held = [x.x == 0.0, x.y == 0.0, x.z == 0.0];
    }
    let factored = Factored::new(&mesh, &SOFT).expect("held");
    let pressure = 500.0;
    let load = pull(&mesh, size.x, Vec3::x() * pressure);
    let total: f64 = load.iter().map(|f| f.x).sum();
    assert!((total - pressure * 2e-4).abs() < 1e-12);
    let half = load.iter().map(|f| f * -0.5).collect();
    let answers = factored.solve(&[load, half]).expect("finite");
    let strain = pressure / SOFT.young;
    for (x, (u, v)) in mesh.nodes.iter().zip(answers[0].iter().zip(&answers[1])) {
        let exact = Vec3::new(x.x, -SOFT.poisson * x.y, -SOFT.poisson * x.z) * strain;
        assert!((u - exact).norm() < 1e-11, "{x}: {u}, exactly {exact}");
        assert!((v + exact * 0.5).norm() < 1e-11);
    }
}

/// Displacement of the tip of a cantilever (metres), with `cells` cells over its height.
fn tip(cells: usize, load: f64) -> f64 {
    let size = Vec3::new(0.1, 0.01, 0.01);
    let mut mesh = block([10 * cells, cells, cells], size);
    for (held, x) in mesh.held.iter_mut().zip(&mesh.nodes) {
        *held = [x.x == 0.0; 3];
    }
    let steel_like = Elastic {
        young: 1e6,
        poisson: 0.3,
    };
    let factored = Factored::new(&mesh, &steel_like).expect("held");
    let forces = pull(&mesh, size.x, Vec3::z() * (load / 1e-4));
    let moved = factored.solve(&[forces]).expect("finite");
    let end = nodes(&mesh, |x| x.x == size.x);
    end.iter().map(|&k| moved[0][k].z).sum::<f64>() / end.len() as f64
}

#[test]
fn a_cantilever_bends_as_timoshenko_says_and_better_with_finer_cells() {
    let load = 1e-3;
    let (length, area, inertia) = (0.1_f64, 1e-4, 1e-8 / 12.0);
    let shear = 1e6 / 2.6;
    let exact =
        load * length.powi(3) / (3.0 * 1e6 * inertia) + load * length / (5.0 / 6.0 * shear * area);
    let found = [1, 2].map(|cells| tip(cells, load) / exact - 1.0);
    println!("tip of a cantilever: {found:?} off");
    // The clamp prevents the cross section from changing its shape, unlike in beam theory: one per cent stiffer.
    assert!(found[0].abs() < 0.03 && found[1].abs() < 0.015, "{found:?}");
    let finer = tip(3, load) / exact - 1.0;
    assert!(
        (finer - found[1]).abs() < 0.5 * (found[1] - found[0]).abs(),
        "{found:?} {finer}"
    );
}

#[test]
fn what_cannot_be_solved_is_said() {
    let mesh = block([1, 1, 1], Vec3::new(0.01, 0.01, 0.01));
    let said = |mesh: &TetMesh, material: &Elastic| match Factored::new(mesh, material) {
        Err(error) => error.to_string(),
        Ok(_) => panic!("factored"),
    };
    assert!(said(&mesh, &SOFT).contains("0 of 6 rigid motions"));
    // A body that is held everywhere does not move.
    let mut whole = mesh.clone();
    whole.held.fill([true; 3]);
    let load = vec![Vec3::x(); whole.nodes.len()];
    let still = Factored::new(&whole, &SOFT).expect("held").solve(&[load]);
    assert!(
        still.expect("finite")[0]
            .iter()
            .all(|u| *u == Vec3::zeros())
    );
    // A door on its hinge: five motions are held.
    let mut door = mesh.clone();
    for (held, x) in door.held.iter_mut().zip(&mesh.nodes) {
        *held = [x.x == 0.0 && x.y == 0.0; 3];
    }
    assert!(said(&door, &SOFT).contains("5 of 6 rigid motions"));
    // Two blocks, of which one is loose.
    let mut two = mesh.clone();
    two.held.fill([true; 3]);
    let first = two.nodes.len() as u32;
    two.nodes.extend(mesh.nodes.iter().map(|x| x + Vec3::x()));
    two.tets
        .extend(mesh.tets.iter().map(|tet| tet.map(|node| node + first)));
    two.held.extend(&mesh.held);
    assert!(said(&two, &SOFT).contains(&format!("node {first}")));
    let mut held = mesh.clone();
    for (held, x) in held.held.iter_mut().zip(&mesh.nodes) {
        *held = [x.x == 0.0; 3];
    }
    assert!(
        said(
            &held,
            &Elastic {
                poisson: 0.5,
                ..SOFT
            }
        )
        .contains("poisson is 0.5")
    );
    assert!(
        said(
            &held,
            &Elastic {
                young: f64::NAN,
                ..SOFT
            }
        )
        .contains("young is NaN")
    );
    let mut turned = held.clone();
    turned.tets[2].swap(0, 1);
    assert!(said(&turned, &SOFT).contains("inside out (2)"));
    let mut unknown = held.clone();
    unknown.tets[1][7] = 4000;
    assert!(said(&unknown, &SOFT).contains("node is 4000"));
    let factored = Factored::new(&held, &SOFT).expect("held");
    let few = factored.solve(&[vec![Vec3::zeros(); 3]]);
    assert!(matches!(few, Err(FemError::Field { .. })));
    let mut bad = vec![Vec3::zeros(); mesh.nodes.len()];
    bad[5].y = f64::INFINITY;
    assert!(
        factored
            .solve(&[bad])
            .expect_err("infinite")
            .to_string()
            .contains("on node 5")
    );
}

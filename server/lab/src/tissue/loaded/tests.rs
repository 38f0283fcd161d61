use sulcus_core::math::Mat3;
use sulcus_core::tissue::skeleton::{Skeleton, SkeletonLevel, Spring, StretchLaw};
use sulcus_scene::mesh::turned::turned;
use sulcus_scene::organ::skeleton::SkeletonOptions;

use super::*;
use crate::tissue::cases::cases;
use crate::tissue::fit::{Example, Fit, Freedom};
use crate::tissue::organ::Organ;

fn organ() -> Option<Organ> {
    let folder = sulcus_support::data("fem")?;
    Some(Organ::read(&folder, &|_, _| ()).expect("an organ"))
}

/// A skeleton whose springs couple the axes, of about the stiffness that the reference has.
fn coupled(organ: &Organ) -> Skeleton {
    let mut skeleton = organ
        .skeleton(&SkeletonOptions::default())
        .expect("a skeleton");
    skeleton.fine = None;
    skeleton.coarse.params.law = StretchLaw::LINEAR;
    for (k, spring) in skeleton.coarse.springs.iter_mut().enumerate() {
        let turn = |of: f64| (of * (k as f64 + 1.0)).sin();
        spring.stiffness = [300.0, 250.0 + 50.0 * turn(1.0), 350.0];
        spring.coupling = [90.0 * turn(2.0), 80.0 * turn(3.0), 70.0 * turn(4.0)];
    }
    skeleton
}

/// Displacements of the skeleton's nodes by `K u = f`: Jacobi's iteration with conjugate directions, spring by spring.
fn statics(level: &SkeletonLevel, load: &[Vec3]) -> Vec<Vec3> {
    let stiffness = |s: &Spring| {
        let ([x, y, z], [yz, zx, xy]) = (s.stiffness, s.coupling);
        Mat3::new(x, xy, zx, xy, y, yz, zx, yz, z)
    };
    let times = |u: &[Vec3]| {
        let mut f = vec![Vec3::zeros(); u.len()];
        for s in &level.springs {
            let (a, b) = (usize::from(s.a), usize::from(s.b));
            let force = stiffness(s) * (u[a] - u[b]);
            f[a] += force;
            f[b] -= force;
        }
        f.iter_mut()
            .zip(&level.fixed)
            .filter(|(_, fixed)| **fixed)
            .for_each(|(f, _)| *f = Vec3::zeros());
        f
    };
    let dot = |a: &[Vec3], b: &[Vec3]| a.iter().zip(b).map(|(a, b)| a.dot(b)).sum::<f64>();
    let mut rest: Vec<Vec3> = load.to_vec();
    rest.iter_mut()
        .zip(&level.fixed)
        .filter(|(_, fixed)| **fixed)
        .for_each(|(f, _)| *f = Vec3::zeros());
    let mut u = vec![Vec3::zeros(); load.len()];
    let mut way = rest.clone();
    let begin = dot(&rest, &rest);
    for _ in 0..20_000 {
        let now = dot(&rest, &rest);
        if now <= 1e-26 * begin {
            break;
        }
        let force = times(&way);
        let step = now / dot(&way, &force);
        for k in 0..u.len() {
            u[k] += way[k] * step;
            rest[k] -= force[k] * step;
        }
        let next = dot(&rest, &rest) / now;
        way.iter_mut()
            .zip(&rest)
            .for_each(|(way, rest)| *way = rest + *way * next);
    }
    u
}

#[test]
fn ticks_come_to_rest_where_the_statics_are_and_a_fit_finds_its_own_springs() {
    let Some(organ) = organ() else { return };
    let skeleton = coupled(&organ);
    let level = skeleton.coarse.clone();
    let mut model =
        Loaded::new(&organ, TissueModel::Skeleton(Box::new(skeleton.clone()))).expect("stands");
    let mut examples = Vec::new();
    for k in 0..40_usize {
        let v = organ.free[k * 97 % organ.free.len()];
        let mut forces = vec![Vec3::zeros(); organ.nodes.len()];
        forces[v] = [Vec3::x(), Vec3::y(), Vec3::z()][k % 3];
        let moved = model.rest_under(&forces).expect("rests");
        if k < 6 {
            let mut loads = vec![Vec3::zeros(); organ.tree.nodes().len()];
            organ.skin.loads(&forces, &mut loads);
            let mut on_nodes = vec![Vec3::zeros(); level.nodes.len()];
            for (skin, load) in level.skin.iter().zip(&loads) {
                for (node, w) in skin.nodes.iter().zip(skin.weights) {
                    on_nodes[usize::from(*node)] += load * w;
                }
            }
            let u = statics(&level, &on_nodes);
            let spheres: Vec<Vec3> = level
                .skin
                .iter()
                .map(|skin| {
                    skin.nodes
                        .iter()
                        .zip(skin.weights)
                        .map(|(n, w)| u[usize::from(*n)] * w)
                        .sum()
                })
                .collect();
            let mut wanted = vec![Vec3::zeros(); moved.len()];
            organ.skin.displacements(&spheres, &mut wanted);
            let most = wanted.iter().map(Vec3::norm).fold(0.0, f64::max);
            let off = wanted
                .iter()
                .zip(&moved)
                .map(|(a, b)| (a - b).norm())
                .fold(0.0, f64::max);
            assert!(off < 1e-4 * most, "{off:e} of {most:e} m");
            // What the force does at the vertex is what the springs store, twice.
            let work: f64 = forces.iter().zip(&wanted).map(|(f, u)| f.dot(u)).sum();
            let stored: f64 = on_nodes.iter().zip(&u).map(|(f, u)| f.dot(u)).sum();
            assert!((work / stored - 1.0).abs() < 1e-9, "{work} {stored}");
        }
        examples.push(Example { forces, moved });
    }
    // From springs all alike to the ones that made the examples, or ones that move the same.
    let mut start = level.clone();
    for spring in &mut start.springs {
        (spring.stiffness, spring.coupling) = ([300.0; 3], [0.0; 3]);
    }
    let run = |freedom| {
        Fit::new(&organ, &start, &examples, freedom)
            .run(120, &|_, _| ())
            .expect("fits")
            .1
    };
    let [one, axes, tensor] = [Freedom::One, Freedom::Axes, Freedom::Tensor].map(run);
    println!("one factor leaves {one:.4}, axes {axes:.4}, tensors {tensor:.4} of the displacement");
    assert!(tensor < 0.25 * axes && axes <= one, "{one} {axes} {tensor}");
}

#[test]
fn the_skin_has_no_turned_triangle_when_the_tongue_is_pushed_15_mm() {
    let Some(organ) = organ() else { return };
    let Some(folder) = sulcus_support::data("fem") else {
        return;
    };
    let mut skeleton = coupled(&organ);
    for spring in &mut skeleton.coarse.springs {
        spring.coupling = [0.0; 3];
    }
    let mut model = Loaded::new(&organ, TissueModel::Skeleton(Box::new(skeleton))).expect("stands");
    for case in cases(&folder, &organ)
        .expect("cases")
        .iter()
        .filter(|case| case.name.ends_with("lin_1N") || case.name.ends_with("lin_2.5N"))
    {
        // As strong as makes it 15 mm: the springs are linear.
        let first = model.rest_under(&case.forces).expect("rests");
        let most = first.iter().map(Vec3::norm).fold(0.0, f64::max);
        let moved: Vec<Vec3> = first.iter().map(|u| u * (15e-3 / most)).collect();
        let (turned, least) = turned(&organ.surface, &moved);
        println!(
            "{}: {turned} turned, least area {least:.3} of that at rest",
            case.name
        );
        assert_eq!(turned, 0, "{}", case.name);
    }
}

use sulcus_core::Vec3;

use super::turned::OVERLAP_MM;
use super::*;
use crate::mesh::check::check;
use crate::mesh::distance::MeshDistance;
use crate::mesh::repair::join_equal;

/// Largest number of triangles of an instrument.
const TRIANGLES: usize = 9_000;

fn probes() -> Vec<Probe> {
    let of = |marking| Probe {
        marking,
        ..Probe::default()
    };
    Marking::ALL.map(of).to_vec()
}

/// The surface with both sides of each crease joined. Creases lie above a height of the tool frame, metres.
fn welded(drawn: &DrawnTool, above: f64) -> TriMesh {
    let mut mesh = drawn.mesh.clone();
    let vertices = mesh.vertices.clone();
    let first = |v: &Vec3| {
        let near = |other: &Vec3| (other - v).norm() < 1.01e-3 * OVERLAP_MM;
        vertices.iter().position(near).expect("itself")
    };
    for v in mesh.vertices.iter_mut().filter(|v| v.z > above - 1e-4) {
        *v = vertices[first(v)];
    }
    join_equal(&mut mesh);
    mesh
}

/// Largest distance between two surfaces at their vertices below a height of the tool frame, metres.
fn apart(a: &TriMesh, b: &TriMesh, below: f64) -> f64 {
    let of = |a: &TriMesh, b: &TriMesh| {
        let distance = MeshDistance::new(b.clone());
        let vertices = a.vertices.iter().filter(|v| v.z < below);
        vertices
            .map(|v| distance.signed(v).abs())
            .fold(0.0, f64::max)
    };
    of(a, b).max(of(b, a))
}

#[test]
fn a_drawn_probe_is_the_compiled_one_where_it_touches() {
    for probe in probes() {
        let drawn = probe.drawn();
        assert!(drawn.mesh.triangles.len() <= TRIANGLES);
        assert_eq!(drawn.steel.len(), drawn.mesh.vertices.len());
        let mesh = welded(&drawn, probe.line()(probe.bent()).point.z * 1e-3);
        assert_eq!(check(&mesh, "probe").expect("a solid").genus, 0);
        let below = probe.line()(probe.touching_mm).point.z * 1e-3;
        let off = apart(&mesh, &probe.display_mesh(), below);
        assert!(off < 1e-9, "{off}");
    }
}

#[test]
fn a_drawn_mirror_is_the_compiled_one_where_it_touches() {
    for number in [4, 5] {
        let mirror = Mirror {
            number,
            ..Mirror::default()
        };
        let drawn = mirror.drawn();
        let n = drawn.mesh.triangles.len();
        assert!(n <= TRIANGLES, "{n}");
        let mesh = welded(&drawn, mirror.line()(mirror.bent() + 12.0).point.z * 1e-3);
        assert_eq!(check(&mesh, "mirror").expect("a solid").genus, 0);
        let end = mirror.touching_mm - mirror.radius();
        let below = mirror.line()(end).point.z * 1e-3;
        let off = apart(&mesh, &mirror.display_mesh(), below);
        assert!(off < 1e-9, "{off}");
        // A rim of 0.5 to 0.8 mm round the glass.
        let rim = mirror.radius() - drawn.glass_radius.expect("a glass") * 1e3;
        assert!((0.5..=0.8).contains(&rim), "{rim}");
        let centre = mirror.working_point() + mirror.face_normal() * 1e-3;
        for (v, steel) in drawn.mesh.vertices.iter().zip(&drawn.steel) {
            let off = v - centre;
            let height = off.dot(&mirror.face_normal());
            let away = (off - mirror.face_normal() * height).norm() * 1e3;
            let on_rim = (mirror.radius() - rim..=mirror.radius() + 1e-6).contains(&away);
            if height > -1e-4 && on_rim && away > mirror.radius() - 0.99 * rim {
                assert_eq!(*steel, Steel::Rim, "{away}");
            }
        }
    }
}

#[test]
fn every_black_stretch_has_its_own_rings() {
    for probe in probes() {
        let drawn = probe.drawn();
        let (tip, along) = (probe.tip(), -probe.tip_axis());
        let place = |v: &Vec3| (v - tip).dot(&along) * 1e3;
        let lower = drawn.mesh.vertices.iter().zip(&drawn.steel);
        let marked: Vec<(f64, bool)> = lower
            .map(|(v, steel)| (place(v), *steel == Steel::Black))
            .filter(|(s, _)| *s < 15.8)
            .collect();
        for border in probe.black().into_iter().flatten() {
            // Beside a border the nearest vertices on both sides differ, and lie 0.05 mm apart at most.
            let side = |sign: f64| {
                let near = marked.iter().filter(|(s, _)| (s - border) * sign > 0.0);
                let nearest =
                    near.min_by(|a, b| (a.0 - border).abs().total_cmp(&(b.0 - border).abs()));
                *nearest.expect("a vertex")
            };
            let (below, above) = (side(-1.0), side(1.0));
            assert_ne!(below.1, above.1, "{border}");
            assert!(above.0 - below.0 <= 0.05, "{border}: {below:?} {above:?}");
        }
        let is_marked = |s: f64| {
            let mut black = probe.black().into_iter();
            black.any(|[from, to]| s > from - 0.05 && s < to + 0.05)
        };
        assert!(marked.iter().all(|(s, black)| !black || is_marked(*s)));
    }
}

#[test]
fn both_grips_have_ridges_a_millimetre_apart() {
    for drawn in [Probe::default().drawn(), Mirror::default().drawn()] {
        let rows = |steel: Steel| {
            let all = drawn.mesh.vertices.iter().zip(&drawn.steel);
            let mut rows: Vec<f64> = all
                .filter(|(_, of)| **of == steel)
                .map(|(v, _)| (v.z * 1e6).round() * 1e-3)
                .collect();
            rows.sort_by(f64::total_cmp);
            rows.dedup();
            rows
        };
        let grooves = rows(Steel::Groove);
        assert!(grooves.len() >= 24, "{}", grooves.len());
        let gaps = grooves.windows(2).map(|pair| pair[1] - pair[0]);
        let (close, far): (Vec<f64>, Vec<f64>) = gaps.partition(|gap| *gap < 1.5);
        let apart = close.iter().filter(|gap| **gap > 2.0 * OVERLAP_MM);
        for gap in apart {
            assert!((gap - 1.0).abs() < 2.0 * OVERLAP_MM, "{gap}");
        }
        assert_eq!(far.len(), 1, "two zones");
    }
}

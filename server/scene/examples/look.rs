//! Throw-away: views of the teeth. look OUT.png fdi... [--views]
use std::io::Write;
use sulcus_core::Vec3;
use sulcus_scene::parametric::Tooth;
fn main() {
    let args: Vec<String> = std::env::args().collect();
    let out = &args[1];
    let scale: f64 = args[2].parse().unwrap();
    let views: Vec<char> = args[3].chars().collect();
    let teeth: Vec<u8> = args[4..].iter().map(|a| a.parse().unwrap()).collect();
    let (cw, ch) = (
        (13.0 * scale) as usize,
        (if views.iter().all(|v| *v == 'o') {
            13.0
        } else {
            29.0
        } * scale) as usize,
    );
    let (w, h) = (cw * views.len(), ch * teeth.len());
    let mut image = vec![[30u8, 34, 40]; w * h];
    for (row, fdi) in teeth.iter().enumerate() {
        let tooth = Tooth::lower(*fdi).unwrap();
        let t0 = std::time::Instant::now();
        let mesh = tooth.mesh();
        let report = sulcus_scene::check::check(&mesh, "t");
        let (lo, hi) = mesh.bounds();
        eprintln!(
            "{fdi}: {:?} lo {:?} hi {:?} {:.2?}",
            report
                .as_ref()
                .map(|r| (r.triangles, r.genus, r.size_mm, r.volume_mm3)),
            (lo * 1e3).as_slice(),
            (hi * 1e3).as_slice(),
            t0.elapsed()
        );
        eprintln!(
            "   contacts {:?} furc {:?}",
            tooth.contacts().map(|c| [c.x, c.y, c.z]),
            tooth.furcations()
        );
        for (n, c) in tooth.contacts().iter().enumerate() {
            let rec: Vec<f64> = [-2.0, -1.5, -1.0, 1.0, 1.5, 2.0]
                .iter()
                .map(|dy| {
                    let (y, w) = (c.y + dy, c.x.signum());
                    let (mut a, mut b) = (0.0, 7.0);
                    for _ in 0..40 {
                        let m = 0.5 * (a + b);
                        if tooth.distance(&Vec3::new(w * m, y, c.z)) < 0.0 {
                            a = m
                        } else {
                            b = m
                        }
                    }
                    ((c.x.abs() - a) * 1000.0).round() / 1000.0
                })
                .collect();
            let mut best = vec![];
            for side in [1.0, -1.0] {
                for deg in [10.0_f64, 15.0, 20.0] {
                    let mut z = c.z;
                    while z > -6.0 {
                        let ok = (0..100).all(|k| {
                            let t = 0.3 + 0.1 * k as f64;
                            let p = Vec3::new(
                                c.x,
                                side * t * deg.to_radians().sin(),
                                z + t * deg.to_radians().cos(),
                            );
                            tooth.distance(&p) > 0.29
                        });
                        if ok {
                            break;
                        }
                        z -= 0.05;
                    }
                    best.push((z * 100.).round() / 100.);
                }
            }
            eprintln!(
                "   side {n} recede {rec:?} reach under {best:?}  above cej {:.2}",
                tooth.cej(if n == 0 { 0.0 } else { 3.14159 })
            );
        }
        let mut normals = vec![Vec3::zeros(); mesh.vertices.len()];
        for (v, n) in normals.iter_mut().enumerate() {
            let p = mesh.vertices[v] * 1e3;
            let e = 0.01;
            *n = Vec3::from_fn(|a, _| {
                let mut s = Vec3::zeros();
                s[a] = e;
                tooth.distance(&(p + s)) - tooth.distance(&(p - s))
            })
            .normalize();
        }
        for (col, view) in views.iter().enumerate() {
            // right, up, towards eye
            let (r, u, e) = match view {
                'b' => (-Vec3::x(), Vec3::z(), Vec3::y()),
                'l' => (Vec3::x(), Vec3::z(), -Vec3::y()),
                'm' => (Vec3::y(), Vec3::z(), Vec3::x()),
                'd' => (-Vec3::y(), Vec3::z(), -Vec3::x()),
                'o' => (-Vec3::x(), Vec3::y() * -1.0, Vec3::z()),
                _ => {
                    let e = Vec3::new(0.35, -0.6, 0.75).normalize();
                    let r = Vec3::z().cross(&e).normalize();
                    (r, e.cross(&r), e)
                }
            };
            let (r, u) = if *view == 'o' {
                (Vec3::x(), Vec3::y())
            } else {
                (r, u)
            };
            let cy = if *view == 'o' {
                0.0
            } else if *view == 'q' {
                0.0
            } else {
                -2.5
            };
            let ss = 2;
            let (W, H) = (cw * ss, ch * ss);
            let mut z = vec![f64::NEG_INFINITY; W * H];
            let mut c = vec![None; W * H];
            for t in &mesh.triangles {
                let q = t.map(|v| {
                    let p = mesh.vertices[v as usize] * 1e3;
                    [
                        W as f64 / 2.0 + p.dot(&r) * scale * ss as f64,
                        H as f64 / 2.0 - (p.dot(&u) - cy) * scale * ss as f64,
                        p.dot(&e),
                    ]
                });
                let area = (q[1][0] - q[0][0]) * (q[2][1] - q[0][1])
                    - (q[1][1] - q[0][1]) * (q[2][0] - q[0][0]);
                if area >= 0.0 {
                    continue;
                }
                let minx = q.iter().map(|p| p[0]).fold(1e9, f64::min).max(0.0) as usize;
                let maxx = (q.iter().map(|p| p[0]).fold(0.0, f64::max) as usize).min(W - 1);
                let miny = q.iter().map(|p| p[1]).fold(1e9, f64::min).max(0.0) as usize;
                let maxy = (q.iter().map(|p| p[1]).fold(0.0, f64::max) as usize).min(H - 1);
                for y in miny..=maxy {
                    for x in minx..=maxx {
                        let (px, py) = (x as f64 + 0.5, y as f64 + 0.5);
                        let w0 = ((q[1][0] - px) * (q[2][1] - py)
                            - (q[1][1] - py) * (q[2][0] - px))
                            / area;
                        let w1 = ((q[2][0] - px) * (q[0][1] - py)
                            - (q[2][1] - py) * (q[0][0] - px))
                            / area;
                        let w2 = 1.0 - w0 - w1;
                        if w0 < 0.0 || w1 < 0.0 || w2 < 0.0 {
                            continue;
                        }
                        let d = w0 * q[0][2] + w1 * q[1][2] + w2 * q[2][2];
                        if d > z[y * W + x] {
                            z[y * W + x] = d;
                            let n = (normals[t[0] as usize] * w0
                                + normals[t[1] as usize] * w1
                                + normals[t[2] as usize] * w2)
                                .normalize();
                            let p = (mesh.vertices[t[0] as usize] * w0
                                + mesh.vertices[t[1] as usize] * w1
                                + mesh.vertices[t[2] as usize] * w2)
                                * 1e3;
                            c[y * W + x] = Some((n, p));
                        }
                    }
                }
            }
            let light = if *view == 'o' {
                (u * 0.5 - r * 0.5 + e * 1.0).normalize()
            } else {
                (u * 0.65 - r * 0.55 + e * 0.55).normalize()
            };
            let fill = (r * 0.8 + e * 0.3 - u * 0.1).normalize();
            for y in 0..ch {
                for x in 0..cw {
                    let mut s = Vec3::zeros();
                    for j in 0..ss {
                        for i in 0..ss {
                            s += match &c[(y * ss + j) * W + x * ss + i] {
                                None => Vec3::new(30., 34., 40.),
                                Some((n, p)) => {
                                    let enamel = p.z > tooth.cej(p.y.atan2(p.x));
                                    let base = if enamel {
                                        Vec3::new(240., 235., 222.)
                                    } else {
                                        Vec3::new(222., 198., 150.)
                                    };
                                    let k = 0.16
                                        + 0.75 * n.dot(&light).max(0.0)
                                        + 0.18 * n.dot(&fill).max(0.0);
                                    let hv = (light + e).normalize();
                                    let sp = n.dot(&hv).max(0.0).powi(40) * 40.0;
                                    base * k.min(1.05) + Vec3::repeat(sp)
                                }
                            };
                        }
                    }
                    s /= (ss * ss) as f64;
                    image[(row * ch + y) * w + col * cw + x] = [
                        s.x.min(255.) as u8,
                        s.y.min(255.) as u8,
                        s.z.min(255.) as u8,
                    ];
                }
            }
        }
    }
    let mut f = std::fs::File::create(out).unwrap();
    write!(f, "P6\n{w} {h}\n255\n").unwrap();
    f.write_all(image.as_flattened()).unwrap();
}

//! Events on paths that are laid out by hand, in a scene of two round teeth: what is told, when, and nothing else.
#![allow(clippy::unwrap_used)]

use sulcus_core::output::{ForceZone, PocketReading, status};
use sulcus_core::scene::Band;
use sulcus_core::tissue::TissueModel;
use sulcus_core::tissue::gingiva::{Gingiva, GingivaParams, Place, Prescribed, Site, ToothFrame};
use sulcus_core::tissue::printed::PrintedSkeleton;
use sulcus_core::{
    DisplayMesh, MAX_TOOLS, Object, Params, Pose, Quat, Scene, Sphere, SphereTree, TickOutput,
    Tool, ToolOutput, Vec3, Wrench,
};
use sulcus_sessions::events::call::Call;
use sulcus_sessions::exercise::{Exercise, Target};
use sulcus_sessions::{Events, Occurrence};

/// Height of the margin over the tooth's origin, radius of a tooth, and how far apart two are, metres.
const MARGIN: f64 = 1e-3;
const RADIUS: f64 = 4e-3;
const APART: f64 = 9e-3;

fn object(name: &str, fdi: u8, spheres: &[Sphere], tissue: TissueModel) -> Object {
    Object {
        name: name.into(),
        fdi,
        tree: SphereTree::over_leaves(spheres).unwrap(),
        level: 3,
        tissue,
        mesh: DisplayMesh::default(),
        carriers: Vec::new(),
    }
}

fn ball(x: f64, y: f64, z: f64, radius: f64) -> Sphere {
    Sphere {
        centre: Vec3::new(x, y, z),
        radius,
    }
}

/// A column, dense enough to be nearly round.
fn tooth(fdi: u8, x: f64) -> Object {
    let column: Vec<Sphere> = (-40..=40)
        .map(|k| ball(x, 0.0, f64::from(k) * 2e-4, RADIUS))
        .collect();
    object("tooth", fdi, &column, TissueModel::Rigid)
}

fn gingiva(fdi: u8, x: f64) -> Object {
    let spheres = [
        ball(x + 6e-3, 0.0, 0.0, 1e-3),
        ball(x - 6e-3, 0.0, 0.0, 1e-3),
    ];
    let mut object = object("gingiva", fdi, &spheres, TissueModel::Rigid);
    let place = Place {
        away: Vec3::x(),
        on_surface: Vec3::zeros(),
        spread: 0.0,
        height: 0.0,
        floor: false,
    };
    let mut sites = [3.0, 2.0, 4.0, 5.0, 2.5, 3.5].map(|mm| Prescribed {
        depth: mm * 1e-3,
        recession: 0.0,
        bleeds: false,
    });
    sites[Site::DistoBuccal as usize].bleeds = true;
    object.tissue = TissueModel::Gingiva(Box::new(Gingiva {
        params: GingivaParams::default(),
        tooth: ToothFrame {
            origin: Vec3::new(x, 0.0, 0.0),
            axis: Vec3::z(),
            mesial: Vec3::x(),
            buccal: Vec3::y(),
        },
        margin: vec![MARGIN; 8],
        proximal: 50f64.to_radians(),
        sites,
        places: vec![place; object.tree.nodes().len()],
        level: 3,
    }));
    object
}

fn tool(name: &str, bands: usize, spheres: &[Sphere]) -> Tool {
    let band = Band {
        from: 0.0,
        to: 1e-3,
        dark: true,
    };
    Tool {
        name: name.into(),
        tree: SphereTree::over_leaves(spheres).unwrap(),
        level: 3,
        working_point: Vec3::zeros(),
        tip: Vec3::zeros(),
        tip_axis: -Vec3::z(),
        stiffness_n_per_m: 500.0,
        stiffness_nm_per_rad: 0.5,
        park: Pose::identity(),
        bands: vec![band; bands],
        mesh: DisplayMesh::default(),
    }
}

/// Teeth 36 (at the origin, its mesial side along x) and 35, their gingivae, a tongue of one sphere; a probe, a mirror.
fn scene() -> Scene {
    let tongue = TissueModel::PrintedSkeleton(PrintedSkeleton::new(0, Vec::new(), Vec::new()));
    Scene {
        name: "two teeth".into(),
        source_hash: String::new(),
        params: Params::default(),
        tools: vec![
            tool("probe", 3, &[ball(0.0, 0.0, 0.0, 1e-4)]),
            tool("mirror", 0, &[ball(0.0, 0.0, 0.0, 10e-3)]),
        ],
        objects: vec![
            tooth(36, 0.0),
            gingiva(36, 0.0),
            tooth(35, APART),
            gingiva(35, APART),
            object("tongue", 0, &[ball(0.0, -0.03, 0.0, 10e-3)], tongue),
        ],
    }
}

/// Where the probe is in a tick.
#[derive(Clone, Copy, Debug)]
struct At {
    /// Degrees from mesial over buccal, about tooth 36.
    around: f64,
    /// Below the margin, mm; negative above.
    depth: f64,
    /// On the floor, N.
    force: f64,
    /// Tilt of the tip into the col along the tooth's surface, degrees: mesially on the mesial half.
    mesially: f64,
}

/// A tool that nobody holds.
fn absent() -> ToolOutput {
    ToolOutput {
        wrench: Wrench::ZERO,
        raw_wrench: Wrench::ZERO,
        graphic: Pose::identity(),
        haptic: Pose::identity(),
        status: status::ABSENT,
        substeps: 0,
        rows: 0,
        active: 0,
        min_gap: f64::INFINITY,
        converged: true,
        pocket: None,
    }
}

fn zone(force: f64) -> ForceZone {
    let heavier = [
        (1.96, ForceZone::Damage),
        (0.5, ForceZone::Trauma),
        (0.25, ForceZone::TooHeavy),
    ];
    heavier
        .iter()
        .find(|(from, _)| force >= *from)
        .map_or(ForceZone::Light, |(_, zone)| *zone)
}

/// What the core would put out with the probe there; `object` is whose pocket is read.
fn output(tick: u64, at: Option<At>, object: u16) -> TickOutput {
    let mut tools = [absent(); MAX_TOOLS];
    if let Some(at) = at {
        let around = at.around.to_radians();
        let r = RADIUS + 2e-4;
        let tip = Vec3::new(r * around.cos(), r * around.sin(), MARGIN - at.depth * 1e-3);
        // Turned about the buccal axis the tip, which points down, goes mesially.
        let turn = -at.mesially.to_radians();
        let orientation = Quat::from_axis_angle(&Vec3::y_axis(), turn);
        tools[0] = ToolOutput {
            status: 0,
            graphic: Pose::new(tip, orientation),
            pocket: (at.depth > 0.0).then_some(PocketReading {
                object,
                around,
                depth: at.depth * 1e-3,
                floor_force: at.force,
                zone: zone(at.force),
                entered_zone: false,
            }),
            ..absent()
        };
    }
    TickOutput {
        tick,
        hash: 0,
        tools,
    }
}

const UPRIGHT: At = At {
    around: 90.0,
    depth: 2.0,
    force: 0.0,
    mesially: 0.0,
};

fn exercise() -> Exercise {
    Exercise::free("test", 1.0)
}

/// All that is told of a path from tick 1 on, in the pocket of 36.
fn told(path: impl IntoIterator<Item = At>) -> Vec<Occurrence> {
    let scene = scene();
    let mut events = Events::new(&scene, &exercise());
    run(&mut events, &scene, 1, path)
}

fn run(
    events: &mut Events,
    scene: &Scene,
    from: u64,
    path: impl IntoIterator<Item = At>,
) -> Vec<Occurrence> {
    let mut all = Vec::new();
    for (tick, at) in (from..).zip(path) {
        all.extend(events.take(scene, &output(tick, Some(at), 1), None));
    }
    all
}

/// From one place to another in so many ticks, the last included.
fn to(from: At, until: At, ticks: u64) -> impl Iterator<Item = At> {
    (1..=ticks).map(move |k| {
        let s = k as f64 / ticks as f64;
        let mix = |a: f64, b: f64| a + s * (b - a);
        At {
            around: mix(from.around, until.around),
            depth: mix(from.depth, until.depth),
            force: mix(from.force, until.force),
            mesially: mix(from.mesially, until.mesially),
        }
    })
}

/// Kind and site, or the pair of a withdrawal.
fn short(all: &[Occurrence]) -> Vec<String> {
    let text = |one: &Occurrence, key: &str| one.data[key].as_str().unwrap_or("").to_owned();
    all.iter()
        .map(|one| format!("{} {}{}", one.kind, text(one, "site"), text(one, "from")))
        .collect()
}

#[test]
fn a_walk_through_three_zones_is_told_in_order() {
    let start = At {
        around: 160.0,
        depth: -2.0,
        ..UPRIGHT
    };
    let down = At {
        depth: 2.0,
        ..start
    };
    let pressed = At {
        depth: 3.9,
        force: 0.23,
        ..start
    };
    let up = At {
        depth: 1.5,
        ..start
    };
    let on = At { around: 90.0, ..up };
    let pressed_there = At {
        around: 90.0,
        ..pressed
    };
    let path: Vec<At> = to(start, down, 100)
        .chain(to(down, pressed, 100))
        .chain(to(pressed, up, 50))
        .chain(to(up, on, 700))
        .chain(to(on, pressed_there, 100))
        .chain(to(
            pressed_there,
            At {
                depth: -2.0,
                force: 0.0,
                ..on
            },
            100,
        ))
        .collect();
    let all = told(path.clone());
    assert_eq!(
        short(&all),
        [
            "site_reached distobuccal",
            "floor_felt distobuccal",
            "left_site distobuccal",
            "site_reached buccal",
            "bleeding distobuccal",
            "floor_felt buccal",
            "left_site buccal",
        ]
    );
    for one in &all {
        assert_eq!(
            (one.data["tooth"].as_u64(), one.data["tool"].as_u64()),
            (Some(36), Some(0))
        );
        let at = path[one.tick as usize - 1];
        if let Some(mm) = one.data["depth_mm"].as_f64() {
            assert!((mm - at.depth).abs() < 1e-9, "{one}");
        }
        match one.kind.as_str() {
            // Below the margin for the first time; 2 degrees past 130.
            "site_reached" if one.data["site"] == "distobuccal" => {
                assert!(at.depth > 0.0 && path[one.tick as usize - 2].depth <= 0.0);
            }
            "site_reached" => assert!((127.8..=128.1).contains(&at.around), "{at:?}"),
            "floor_felt" => {
                assert!(at.force >= 0.2 && path[one.tick as usize - 2].force < 0.2);
                assert_eq!(one.data["force_n"].as_f64(), Some(at.force));
            }
            "left_site" => {
                let deepest = one.data["deepest_mm"].as_f64().unwrap();
                assert!((deepest - 3.9).abs() < 1e-9);
                assert!((one.data["max_force_n"].as_f64().unwrap() - 0.23).abs() < 1e-12);
            }
            "bleeding" => assert_eq!(one.data["cause"], "inflammation"),
            _ => panic!("{one}"),
        }
    }
    // Time in the first zone, by the ticks' numbers.
    let ticks = all[2].tick - all[0].tick;
    assert!((all[2].data["seconds"].as_f64().unwrap() - ticks as f64 * 1e-3).abs() < 1e-12);
}

#[test]
fn only_a_reading_at_correct_force_is_deepest() {
    let deep = |force| {
        let press = |depth| At {
            depth,
            force,
            ..UPRIGHT
        };
        let all = told(vec![
            press(2.5),
            press(2.75),
            press(2.5),
            At {
                depth: -2.0,
                ..UPRIGHT
            },
        ]);
        all.last().unwrap().data["deepest_mm"].as_f64()
    };
    let is = |mm: Option<f64>, expected: f64| (mm.unwrap() - expected).abs() < 1e-9;
    assert_eq!((deep(0.19), deep(0.26), deep(0.0)), (None, None, None));
    assert!(is(deep(0.2), 2.75) && is(deep(0.25), 2.75));
}

#[test]
fn out_of_the_pocket_between_two_sites_is_withdrawal() {
    let withdrawn = |from: f64, until: f64, height: f64| {
        let (a, b) = (
            At {
                around: from,
                ..UPRIGHT
            },
            At {
                around: until,
                ..UPRIGHT
            },
        );
        let over = |at: At| At {
            depth: height,
            ..at
        };
        let path = [a]
            .into_iter()
            .chain(to(a, over(a), 50))
            .chain(to(over(a), over(b), 200));
        let all = told(path.chain(to(over(b), b, 50)));
        let kinds = all.iter().filter(|one| one.kind == "withdrawn");
        kinds
            .map(|one| format!("{} {}", one.data["from"], one.data["to"]))
            .collect::<Vec<_>>()
    };
    assert_eq!(withdrawn(150.0, 90.0, -2.0), ["\"distobuccal\" \"buccal\""]);
    assert_eq!(
        withdrawn(-150.0, -30.0, -2.0),
        ["\"distolingual\" \"mesiolingual\""]
    );
    // Walking, and a bob that only just comes out.
    assert_eq!(withdrawn(150.0, 90.0, 0.5), [""; 0]);
    assert_eq!(withdrawn(150.0, 90.0, -0.4), [""; 0]);
    // As high as a bob for longer than one, and for a moment.
    assert_eq!(withdrawn(150.0, 90.0, -1.0).len(), 1);
    let bob = |k: u64| At {
        depth: -1.4 * (k as f64 * 0.03).sin(),
        around: 150.0 - k as f64 * 0.1,
        ..UPRIGHT
    };
    let all = told((0..600).map(bob));
    assert_eq!(
        short(&all),
        [
            "site_reached distobuccal",
            "left_site distobuccal",
            "site_reached buccal"
        ]
    );
    // To the same site, and round to the other side, where there is no way through.
    assert_eq!(withdrawn(100.0, 80.0, -2.0), [""; 0]);
    assert_eq!(withdrawn(90.0, -90.0, -2.0), [""; 0]);
}

#[test]
fn a_tremor_at_a_border_or_at_the_margin_is_no_event() {
    let shake = |k: u64| if k.is_multiple_of(2) { 1.9 } else { -1.9 };
    let at_border = (0..500).map(|k| At {
        around: 130.0 + shake(k),
        ..UPRIGHT
    });
    assert_eq!(told(at_border).len(), 1);
    let at_margin = (0..500).map(|k| At {
        depth: 0.2 * shake(k),
        ..UPRIGHT
    });
    assert_eq!(told(at_margin).len(), 1);
    // More than that is one.
    let wide = (0..500).map(|k| At {
        around: 130.0 + 1.2 * shake(k),
        ..UPRIGHT
    });
    assert!(told(wide).len() > 100);
}

#[test]
fn a_wrong_tilt_is_told_at_readings_that_last() {
    let read = At {
        force: 0.22,
        ..UPRIGHT
    };
    let hold = |at: At, n: usize| std::iter::repeat_n(at, n);
    let angles = |path: Vec<At>| -> Vec<(u64, bool)> {
        let all = told(path);
        let of = all.iter().filter(|one| one.kind == "angle");
        of.map(|one| (one.tick, one.data["right"] == true))
            .collect()
    };
    // Upright in the middle: right. Beside a neighbour: wrong after a quarter of a second, right when tilted.
    assert_eq!(angles(hold(read, 2000).collect()), []);
    let proximal = At {
        around: 20.0,
        ..read
    };
    assert_eq!(angles(hold(proximal, 2000).collect()), [(251, false)]);
    let tilted = At {
        mesially: 15.0,
        ..proximal
    };
    assert_eq!(angles(hold(tilted, 2000).collect()), []);
    assert_eq!(
        angles(hold(proximal, 500).chain(hold(tilted, 500)).collect()),
        [(251, false), (751, true)]
    );
    // Out of the col instead, and too much in the middle.
    assert_eq!(
        angles(
            hold(
                At {
                    mesially: -16.0,
                    ..proximal
                },
                400
            )
            .collect()
        )
        .len(),
        1
    );
    assert_eq!(
        angles(
            hold(
                At {
                    mesially: 16.0,
                    ..read
                },
                400
            )
            .collect()
        )
        .len(),
        1
    );
    // A hand that only touches reads nothing.
    assert_eq!(
        angles(
            hold(
                At {
                    force: 0.15,
                    ..proximal
                },
                2000
            )
            .collect()
        ),
        []
    );
    let all = told(hold(
        At {
            mesially: 30.0,
            ..proximal
        },
        400,
    ));
    let wrong = all.iter().find(|one| one.kind == "angle").unwrap();
    assert!((wrong.data["mesiodistal_deg"].as_f64().unwrap() - 30.0).abs() < 1e-9);
    assert!((wrong.data["into_col_deg"].as_f64().unwrap() - 30.0).abs() < 1e-9);
    assert!(wrong.data["buccolingual_deg"].as_f64().unwrap().abs() < 1e-9);
}

#[test]
fn sites_bleed_once_for_each_cause() {
    let out = At {
        depth: -2.0,
        ..UPRIGHT
    };
    let stab = |around: f64, force: f64| {
        [
            At {
                around,
                force,
                ..UPRIGHT
            },
            At { around, ..out },
        ]
    };
    let causes = |stabs: &[(f64, f64)]| -> Vec<String> {
        let all = told(
            stabs
                .iter()
                .flat_map(|(around, force)| stab(*around, *force)),
        );
        let of = all.iter().filter(|one| one.kind == "bleeding");
        of.map(|one| one.data["cause"].as_str().unwrap().to_owned())
            .collect()
    };
    assert_eq!(causes(&[(150.0, 0.2), (150.0, 0.2)]), ["inflammation"]);
    assert_eq!(causes(&[(150.0, 0.01)]), [""; 0]);
    assert_eq!(causes(&[(90.0, 0.3), (90.0, 0.6), (90.0, 0.6)]), ["trauma"]);
    assert_eq!(
        causes(&[(150.0, 0.2), (150.0, 0.6)]),
        ["inflammation", "trauma"]
    );
}

#[test]
fn between_two_teeth_the_nearer_one_is_probed_though_the_readings_flip() {
    let scene = scene();
    let mut events = Events::new(&scene, &exercise());
    let mut all = Vec::new();
    for tick in 1..=400 {
        let at = At {
            around: 3.0,
            ..UPRIGHT
        };
        let object = if tick % 2 == 0 { 3 } else { 1 };
        all.extend(events.take(&scene, &output(tick, Some(at), object), None));
    }
    assert_eq!(short(&all), ["site_reached mesiobuccal"]);
    assert_eq!(all[0].data["tooth"], 36);
}

#[test]
fn neither_a_mirror_nor_a_probe_far_from_a_tooth_probes() {
    let scene = scene();
    let mut events = Events::new(&scene, &exercise());
    for tick in 1..50 {
        let mut mirror = output(tick, Some(UPRIGHT), 1);
        mirror.tools.swap(0, 1);
        assert_eq!(events.take(&scene, &mirror, None).count(), 0);
        let mut far = output(tick, Some(UPRIGHT), 1);
        far.tools[0].graphic.position.y += 3e-3;
        assert_eq!(events.take(&scene, &far, None).count(), 0);
    }
}

/// A path that does a bit of everything.
fn busy() -> Vec<At> {
    (0..6000u32)
        .map(|k| {
            let t = f64::from(k) * 1e-3;
            At {
                around: 170.0 * (0.9 * t).sin(),
                depth: 1.5 + 2.5 * (5.3 * t).sin(),
                force: 0.35 * (3.1 * t).sin().max(0.0) + 0.2 * (1.1 * t).sin().max(0.0),
                mesially: 30.0 * (0.7 * t).sin(),
            }
        })
        .collect()
}

#[test]
fn the_same_ticks_give_the_same_events_also_from_the_middle_on() {
    let scene = scene();
    let mut first = Events::new(&scene, &exercise());
    let whole = run(&mut first, &scene, 1, busy());
    let kinds: Vec<&str> = whole.iter().map(|one| one.kind.as_str()).collect();
    for kind in [
        "site_reached",
        "floor_felt",
        "angle",
        "left_site",
        "withdrawn",
        "bleeding",
    ] {
        assert!(kinds.contains(&kind), "{kind} must happen: {kinds:?}");
        assert_eq!(
            first.tally().of(kind),
            kinds.iter().filter(|k| **k == kind).count() as u64
        );
    }
    assert_eq!(
        run(&mut Events::new(&scene, &exercise()), &scene, 1, busy()),
        whole
    );
    // From a copy taken at any tick.
    for cut in [1, 777, 3000, 5999] {
        let mut events = Events::new(&scene, &exercise());
        let mut again = run(&mut events, &scene, 1, busy()[..cut].to_vec());
        let mut copy = events.clone();
        again.extend(run(
            &mut copy,
            &scene,
            cut as u64 + 1,
            busy()[cut..].to_vec(),
        ));
        assert_eq!(again, whole, "{cut}");
    }
}

#[test]
fn what_is_not_finite_is_nowhere() {
    let scene = scene();
    let mut events = Events::new(&scene, &exercise());
    for bad in [f64::NAN, f64::INFINITY, 1e300] {
        let path = [
            UPRIGHT,
            At {
                around: bad,
                ..UPRIGHT
            },
            At {
                depth: bad,
                ..UPRIGHT
            },
            At {
                force: bad,
                ..UPRIGHT
            },
            At {
                mesially: bad,
                ..UPRIGHT
            },
        ];
        run(&mut events, &scene, 1, path);
    }
}

/// An exercise whose target is the tongue's side of 36, looked at from the tongue's side.
fn looking() -> Exercise {
    Exercise {
        target: Some(Target {
            tooth: 36,
            eye_mm: [0.0, -200.0, 100.0],
            visible: 0.7,
        }),
        ..exercise()
    }
}

#[test]
fn the_target_is_seen_past_the_tongue_and_told_apart_past_the_mirror() {
    let scene = scene();
    let mut events = Events::new(&scene, &looking());
    assert!(events.missing().is_empty(), "{:?}", events.missing());
    assert_eq!(events.look().len(), 1);
    let hiding = Vec3::new(0.0, -16e-3, 7e-3);
    let away = Vec3::new(0.0, -16e-3, -40e-3);
    let mut all = Vec::new();
    for tick in 1..=1000u64 {
        let mut out = output(tick, None, 1);
        // The mirror comes between from 800 on.
        out.tools[1].status = 0;
        out.tools[1].graphic.position = if tick >= 800 { hiding } else { away };
        let due = events.look().is_due(tick);
        assert_eq!(due, tick % 50 == 0);
        let centre = [if (400..700).contains(&tick) {
            away
        } else {
            hiding
        }];
        let look = due.then_some(centre.as_slice());
        let told: Vec<Occurrence> = events.take(&scene, &out, look).collect();
        assert!(due || told.is_empty());
        all.extend(told);
    }
    let found: Vec<(u64, &str, f64, f64)> = all
        .iter()
        .map(|one| {
            let share = |key: &str| one.data[key].as_f64().unwrap();
            (
                one.tick,
                one.kind.as_str(),
                share("free"),
                share("free_past_mirror"),
            )
        })
        .collect();
    assert_eq!(
        found,
        [
            (50, "target_hidden", 0.0, 0.0),
            (400, "target_visible", 1.0, 1.0),
            (700, "target_hidden", 0.0, 0.0),
        ]
    );
    let tally = events.tally();
    assert_eq!((tally.looks, tally.visible), (20, 6));
    assert_eq!(tally.mean_free(), Some((0.3, 0.3)));
    // The mirror alone hides it for the eye, not past the tongue.
    let mut out = output(1050, None, 1);
    out.tools[1].status = 0;
    out.tools[1].graphic.position = hiding;
    let told: Vec<Occurrence> = events.take(&scene, &out, Some(&[away])).collect();
    assert_eq!(told[0].kind, "target_visible");
    assert_eq!(
        (
            told[0].data["free"].as_f64(),
            told[0].data["free_past_mirror"].as_f64()
        ),
        (Some(1.0), Some(0.0))
    );
}

#[test]
fn what_the_scene_lacks_is_named() {
    let scene = scene();
    let mut exercise = looking();
    exercise.target.as_mut().unwrap().tooth = 37;
    assert_eq!(
        Events::new(&scene, &exercise).missing(),
        ["a tooth 37 with its gingiva, to be seen"]
    );
    // From the cheek's side none of the tongue's side is seen.
    exercise = looking();
    exercise.target.as_mut().unwrap().eye_mm = [0.0, 200.0, 50.0];
    let events = Events::new(&scene, &exercise);
    assert_eq!(
        events.missing(),
        ["a place of tooth 36 that can be seen from the eye"]
    );
    assert!(!events.look().is_due(50));
    let walk = Exercise::parse(include_str!("../exercises/bimanual.toml")).unwrap();
    assert!(
        Events::new(&scene, &walk)
            .missing()
            .contains(&"a pocket at tooth 37".to_owned())
    );
}

#[test]
fn a_call_is_read_with_suspicion() {
    let scene = scene();
    let call = Call {
        tooth: 36,
        site: Site::DistoLingual,
        depth_mm: 5,
    };
    let logged = Occurrence::parse(&call.at(77).to_string()).unwrap();
    assert_eq!(
        (logged.tick, Call::read(&logged.data, &scene)),
        (77, Ok(call))
    );
    assert_eq!(call.truth(&scene), Some(5e-3));
    let read = |text: &str| Call::read(&serde_json::from_str(text).unwrap(), &scene);
    for (text, words) in [
        ("null", ["tooth is null", "FDI"]),
        ("[36]", ["tooth is null", "FDI"]),
        (
            r#"{"tooth":46,"site":"buccal","depth_mm":3}"#,
            ["tooth is 46", "gingiva here"],
        ),
        (
            r#"{"tooth":0,"site":"buccal","depth_mm":3}"#,
            ["tooth is 0", "FDI"],
        ),
        (
            r#"{"tooth":292,"site":"buccal","depth_mm":3}"#,
            ["tooth is 292", "FDI"],
        ),
        (
            r#"{"tooth":36,"site":"labial","depth_mm":3}"#,
            ["site is \"labial\"", "mesiobuccal"],
        ),
        (
            r#"{"tooth":36,"site":3,"depth_mm":3}"#,
            ["site is 3", "one of"],
        ),
        (
            r#"{"tooth":36,"site":"buccal","depth_mm":21}"#,
            ["depth_mm is 21", "0 to 20"],
        ),
        (
            r#"{"tooth":36,"site":"buccal","depth_mm":2.5}"#,
            ["depth_mm is 2.5", "whole"],
        ),
        (
            r#"{"tooth":36,"site":"buccal","depth_mm":-1}"#,
            ["depth_mm is -1", "whole"],
        ),
    ] {
        let told = read(text).unwrap_err().to_string();
        assert!(
            words.iter().all(|word| told.contains(word)),
            "{text}: {told}"
        );
    }
}

proptest::proptest! {
    #[test]
    fn whatever_a_client_says_a_call_or_nothing_comes_of_it(text in ".{0,200}") {
        if let Some(said) = Occurrence::parse(&format!("reading_called at tick 1: {text}")) {
            let _ = Call::read(&said.data, &scene());
        }
    }
}

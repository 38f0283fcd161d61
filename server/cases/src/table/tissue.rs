//! Hard cases of tissue: pockets, a soft tongue, two tools on one tissue, soft next to hard.

use sulcus_core::{Pose, Scene, Vec3};
use sulcus_operator::Script;
use sulcus_operator::pocket_path::{Manner, PocketPath};
use sulcus_operator::retraction::{Retraction, RetractionParams};
use sulcus_operator::script::{OneTool, TwoTools, smoothstep};

use super::{Bounds, Case, Driver, LINKED_ENERGY, SLOW_FORCE_STEP, margin, undisturbed};
use crate::tissue_scenes::{bar, organ, pocket, stiff, tongue, twice};

/// Angle of the probed place, radians from mesial over buccal: the middle of the buccal side.
const BUCCAL: f64 = std::f64::consts::FRAC_PI_2;
/// Depth of the target tip inside the tooth's surface, metres.
const HUG: f64 = 1e-4;
/// Depth of the pockets, metres.
const DEEP: f64 = 4e-3;
/// Ten degrees, radians.
const TURN: f64 = 0.1745;

fn path(scene: &Scene) -> PocketPath {
    PocketPath::new(scene, None, HUG, Manner::Taught).expect("a tooth with gingiva")
}

/// Script of a hand 20 mm away, then in one tick at the target, held, and in one tick back. `pose` gives the device
/// pose by the distance, metres.
fn jump_in_and_out(pose: impl Fn(f64) -> Pose + Send + 'static) -> Box<dyn Script + Send> {
    let pose = move |t: f64| pose(if (0.3..1.5).contains(&t) { 0.0 } else { 20e-3 });
    Box::new(OneTool {
        pose,
        duration_s: 4.0,
    })
}

/// Script of a probe down to the floor of the pocket, turned to and fro by 10 degrees in the plane through the tooth's
/// axis, and out.
fn insert_and_turn(scene: &Scene) -> Box<dyn Script + Send> {
    let path = path(scene);
    let pose = move |t: f64| {
        let down = smoothstep((t - 0.2) / 1.6) - smoothstep((t - 6.2) / 1.6);
        let turning = smoothstep((t - 2.0) / 0.2) - smoothstep((t - 6.0) / 0.2);
        let tilt = TURN * libm::sin(std::f64::consts::PI * (t - 2.0)) * turning;
        path.pose(BUCCAL, -2e-3 + (DEEP + 2.1e-3) * down, tilt, Vec3::zeros())
    };
    Box::new(OneTool {
        pose,
        duration_s: 9.0,
    })
}

/// Script of a mirror that presses `press` metres into the back of the tongue, as drawn, slides along it at 8 mm/s and
/// lets go.
fn press_and_slide(scene: &Scene, press: f64) -> Box<dyn Script + Send> {
    let params = RetractionParams {
        duration: 12.0,
        flank: 0.0,
        press,
        most_force: 100.0,
        aside: 0.0,
        hold: 0.5,
        times: 1,
        ..RetractionParams::default()
    };
    Box::new(Retraction::new(scene, params).expect("a tongue and a mirror"))
}

/// Script of a mirror at the angle `flank` on the tongue, for its poses. Negative: the other flank.
pub(crate) fn mirror(scene: &Scene, flank: f64) -> Retraction {
    let params = RetractionParams {
        flank,
        ..RetractionParams::default()
    };
    Retraction::new(scene, params).expect("a tongue and a mirror")
}

/// The scene with a rigid bar under one half of the mirror's disc.
fn beside_a_bar(mut scene: Scene) -> Scene {
    let touch = mirror(&scene, 0.0).touch();
    scene.objects.push(bar(touch + Vec3::new(0.0, 8e-3, -4e-3)));
    scene
}

pub(super) const TONGUE: Case = Case {
    name: "tongue-10-k0.5",
    about: "a mirror 10 mm in the soft tongue, coupled with 0.5 N/mm, then slid at 8 mm/s and let go: no buzz",
    scene: || tongue(0.5),
    driver: Driver::Kinematic(|scene| press_and_slide(scene, 10e-3)),
    disturb: undisturbed,
    margin: margin::none,
    seed: 1,
    bounds: Bounds {
        residual: 1e-6,
        exhausted_residual: 2e-5,
        // A hand that is moved may receive the energy that it put in, not more.
        energy: 1e-3,
        linked_energy: LINKED_ENERGY,
        exhausted_share: 0.001,
        jump: 3.5e-4,
        force_step: 0.05,
        slow_force_step: SLOW_FORCE_STEP,
        sent_step: 0.5 + 1e-9,
        // The coupling of a mirror in rotation is six times as stiff as that of a probe.
        torque_step: 3e-3,
        buzz: 3e-3,
        coupling_error: 0.01,
        imbalance: 1e-6,
        flips: 0,
        rebound: 0.01,
        unrest: 1e-6,
        drift: 1e-6,
        margin: None,
        contact_ticks: 2000,
    },
};

const POCKET: Case = Case {
    name: "pocket-0.4",
    about: "a pocket of 0.4 mm around a tip of 0.5 mm: down to the floor, turned to and fro by 10 degrees, out",
    scene: || pocket("0.4"),
    driver: Driver::Kinematic(insert_and_turn),
    bounds: Bounds {
        torque_step: 1e-3,
        ..TONGUE.bounds
    },
    ..TONGUE
};

const TWO_MIRRORS: Case = Case {
    name: "two-mirrors",
    about: "two mirrors on the two flanks of one tongue, pressed at the same time: one problem of 12 unknowns",
    scene: || twice(tongue(0.5)),
    driver: Driver::Kinematic(|scene| {
        let both = [mirror(scene, 0.46), mirror(scene, -0.46)];
        let poses = move |t: f64| {
            let deep = -5e-3 + 12e-3 * (smoothstep(t / 1.5) - smoothstep((t - 3.0) / 0.5));
            let along = 3e-3 * libm::sin(4.0 * t);
            [0, 1].map(|k| Some(both[k].pose(deep, 0.0, along)))
        };
        Box::new(TwoTools {
            poses,
            duration_s: 6.0,
        })
    }),
    bounds: Bounds {
        contact_ticks: 1500,
        ..TONGUE.bounds
    },
    ..TONGUE
};

const SOFT_NEXT_TO_HARD: Case = Case {
    name: "soft-next-to-hard",
    about: "the mirror's disc half on the tongue, half on a rigid bar 3 mm lower: both bear",
    scene: || beside_a_bar(tongue(0.5)),
    driver: Driver::Kinematic(|scene| {
        let mirror = mirror(scene, 0.0);
        let pose = move |t: f64| {
            let deep = -4e-3 + 12e-3 * (smoothstep(t / 1.5) - smoothstep((t - 4.0) / 0.5));
            mirror.pose(deep, 0.0, 3e-3 * libm::sin(3.0 * t))
        };
        Box::new(OneTool {
            pose,
            duration_s: 7.0,
        })
    }),
    ..TONGUE
};

const TONGUE_TELEPORT: Case = Case {
    name: "tongue-teleport",
    about: "20 mm in one tick into the tongue, as after lost packets, held, and out again",
    driver: Driver::Kinematic(|scene| {
        let mirror = mirror(scene, 0.0);
        let pose = move |t: f64| {
            let deep = if (0.3..1.5).contains(&t) {
                15e-3
            } else {
                -5e-3
            };
            mirror.pose(deep, 0.0, 0.0)
        };
        Box::new(OneTool {
            pose,
            duration_s: 5.0,
        })
    }),
    bounds: Bounds {
        // The tongue comes to rest within a quarter of a second, then creeps on.
        drift: 2e-6,
        ..TELEPORT
    },
    ..TONGUE
};

pub(super) const TONGUE_STIFF: Case = Case {
    name: "tongue-stiff",
    about: "a tongue a thousand times as stiff as is sensible: as good as rigid, never a wild number",
    scene: || stiff(tongue(0.5)),
    driver: Driver::Kinematic(|scene| {
        let mirror = mirror(scene, 0.0);
        let pose = move |t: f64| {
            let deep = -4e-3 + 8e-3 * (smoothstep(t / 1.0) - smoothstep((t - 3.0) / 0.5));
            mirror.pose(deep, 0.0, 3e-3 * libm::sin(3.0 * t))
        };
        Box::new(OneTool {
            pose,
            duration_s: 5.0,
        })
    }),
    bounds: Bounds {
        contact_ticks: 1000,
        ..TONGUE.bounds
    },
    ..TONGUE
};

const TONGUE_REST: Case = Case {
    name: "tongue-rest",
    about: "a minute at rest, 7 mm in the tongue: nothing drifts",
    driver: Driver::Kinematic(|scene| {
        let mirror = mirror(scene, 0.0);
        let pose = move |t: f64| mirror.pose(-4e-3 + 11e-3 * smoothstep(t), 0.0, 0.0);
        Box::new(OneTool {
            pose,
            duration_s: 60.0,
        })
    }),
    bounds: Bounds {
        // The mirror is still held at the end.
        unrest: 12e-3,
        contact_ticks: 50_000,
        ..TONGUE.bounds
    },
    ..TONGUE
};

/// Cases of tissue.
pub(super) const CASES: &[Case] = &[
    POCKET,
    Case {
        name: "pocket-0.5",
        about: "the same in a pocket as wide as the tip",
        scene: || pocket("0.5"),
        ..POCKET
    },
    Case {
        name: "pocket-0.65",
        about: "the same in a pocket of 0.65 mm",
        scene: || pocket("0.65"),
        ..POCKET
    },
    Case {
        name: "pocket-0.8",
        about: "the same in a pocket of 0.8 mm",
        scene: || pocket("0.8"),
        ..POCKET
    },
    TONGUE,
    Case {
        name: "tongue-10-k2",
        about: "the same coupled with 2 N/mm",
        scene: || tongue(2.0),
        ..TONGUE
    },
    Case {
        name: "tongue-10-k5",
        about: "the same coupled with 5 N/mm",
        scene: || tongue(5.0),
        ..TONGUE
    },
    Case {
        name: "tongue-15-k0.5",
        about: "a mirror 15 mm in the soft tongue, coupled with 0.5 N/mm: no normal flips",
        driver: Driver::Kinematic(|scene| press_and_slide(scene, 15e-3)),
        ..TONGUE
    },
    Case {
        name: "tongue-15-k2",
        about: "the same coupled with 2 N/mm",
        scene: || tongue(2.0),
        driver: Driver::Kinematic(|scene| press_and_slide(scene, 15e-3)),
        ..TONGUE
    },
    Case {
        name: "tongue-15-k5",
        about: "the same coupled with 5 N/mm",
        scene: || tongue(5.0),
        driver: Driver::Kinematic(|scene| press_and_slide(scene, 15e-3)),
        ..TONGUE
    },
    TWO_MIRRORS,
    Case {
        name: "two-probes",
        about: "two probes in one pocket, 30 degrees apart, one going down while the other turns: 12 unknowns",
        scene: || twice(pocket("0.4")),
        driver: Driver::Kinematic(|scene| {
            let path = path(scene);
            let poses = move |t: f64| {
                let pose = |site: f64, late: f64| {
                    let t = t - late;
                    let down = smoothstep(t / 1.5) - smoothstep((t - 4.0) / 1.5);
                    let tilt = TURN
                        * libm::sin(3.0 * t)
                        * smoothstep((t - 1.5) / 0.2)
                        * (1.0 - smoothstep((t - 3.5) / 0.2));
                    let bearing = site.to_radians();
                    Some(path.pose(bearing, -2e-3 + 6e-3 * down, tilt, Vec3::zeros()))
                };
                [pose(75.0, 0.2), pose(105.0, 0.8)]
            };
            Box::new(TwoTools {
                poses,
                duration_s: 8.0,
            })
        }),
        ..POCKET
    },
    SOFT_NEXT_TO_HARD,
    TONGUE_TELEPORT,
    Case {
        name: "pocket-teleport",
        about: "20 mm in one tick from above the pocket to beyond its floor, held, and out again",
        driver: Driver::Kinematic(|scene| {
            let path = path(scene);
            let up = path.place(BUCCAL, 6e-3, 0.0).up;
            jump_in_and_out(move |away| path.pose(BUCCAL, 6e-3, 0.0, up * away))
        }),
        bounds: TELEPORT,
        ..POCKET
    },
    Case {
        name: "pit-teleport",
        about: "the same from over the crown, turning on the way: the tip ends in the pit between the cusps, 5 N deep",
        driver: Driver::Kinematic(|scene| {
            let path = path(scene);
            jump_in_and_out(move |away| path.pose(BUCCAL, 6e-3 - away, 0.0, Vec3::zeros()))
        }),
        bounds: TELEPORT,
        ..POCKET
    },
    TONGUE_STIFF,
    Case {
        name: "pocket-stiff",
        about: "the narrow pocket a thousand times as stiff as is sensible: the tip jams, and nothing else",
        scene: || stiff(pocket("0.4")),
        bounds: Bounds {
            // The tip is wedged between nearly rigid walls.
            residual: 1e-5,
            ..POCKET.bounds
        },
        ..POCKET
    },
    Case {
        name: "pocket-flicker",
        about: "the hand from wall to wall of the pocket and back in every tick: contacts come and go, nothing grows",
        driver: Driver::Kinematic(|scene| {
            let (path, tick_s) = (path(scene), scene.tick_s());
            let pose = move |t: f64| {
                let down = smoothstep((t - 0.2) / 1.0) - smoothstep((t - 3.0) / 1.0);
                let odd = (t / tick_s).round() as u64 % 2 == 1;
                let off = if odd { 3e-4 } else { -3e-4 } * down;
                let out = Vec3::new(0.0, 1.0, 0.0);
                path.pose(BUCCAL, -2e-3 + 5.5e-3 * down, 0.0, out * off)
            };
            Box::new(OneTool {
                pose,
                duration_s: 5.5,
            })
        }),
        bounds: Bounds {
            // The force belongs to another place in every tick. A wrench that is held over a tick does work on a hand
            // that moves to and fro without regard to it.
            buzz: 0.7,
            energy: f64::INFINITY,
            torque_step: f64::INFINITY,
            rebound: 0.01,
            ..POCKET.bounds
        },
        ..POCKET
    },
    TONGUE_REST,
    Case {
        name: "pocket-rest",
        about: "a minute at rest on the floor of the pocket: nothing drifts",
        driver: Driver::Kinematic(|scene| {
            let path = path(scene);
            let pose = move |t: f64| {
                let depth = -2e-3 + (DEEP + 2.2e-3) * smoothstep(t);
                path.pose(BUCCAL, depth, 0.0, Vec3::zeros())
            };
            Box::new(OneTool {
                pose,
                duration_s: 60.0,
            })
        }),
        bounds: Bounds {
            unrest: 2e-3,
            contact_ticks: 50_000,
            ..POCKET.bounds
        },
        ..POCKET
    },
    Case {
        name: "organ-10-k0.5",
        about: "the mirror 10 mm in the tongue of finite elements, coupled with 0.5 N/mm, slid and let go: no buzz",
        scene: || organ(0.5),
        ..TONGUE
    },
    Case {
        name: "organ-10-k2",
        about: "the same coupled with 2 N/mm",
        scene: || organ(2.0),
        ..TONGUE
    },
    Case {
        name: "organ-10-k5",
        about: "the same coupled with 5 N/mm",
        scene: || organ(5.0),
        ..TONGUE
    },
    Case {
        name: "organ-15-k0.5",
        about: "the mirror 15 mm in the tongue of finite elements, coupled with 0.5 N/mm: no normal flips",
        scene: || organ(0.5),
        driver: Driver::Kinematic(|scene| press_and_slide(scene, 15e-3)),
        ..TONGUE
    },
    Case {
        name: "organ-15-k2",
        about: "the same coupled with 2 N/mm",
        scene: || organ(2.0),
        driver: Driver::Kinematic(|scene| press_and_slide(scene, 15e-3)),
        ..TONGUE
    },
    Case {
        name: "organ-15-k5",
        about: "the same coupled with 5 N/mm",
        scene: || organ(5.0),
        driver: Driver::Kinematic(|scene| press_and_slide(scene, 15e-3)),
        ..TONGUE
    },
    Case {
        name: "organ-two-mirrors",
        about: "two mirrors on the two flanks of a tongue of finite elements",
        scene: || twice(organ(0.5)),
        ..TWO_MIRRORS
    },
    Case {
        name: "organ-next-to-hard",
        about: "the mirror's disc half on the tongue of finite elements, half on a rigid bar: both bear",
        scene: || beside_a_bar(organ(0.5)),
        ..SOFT_NEXT_TO_HARD
    },
    Case {
        name: "organ-teleport",
        about: "20 mm in one tick into the tongue of finite elements, held, and out again",
        scene: || organ(0.5),
        ..TONGUE_TELEPORT
    },
    Case {
        name: "organ-stiff",
        about: "a tongue of finite elements a thousand times as stiff as is sensible",
        scene: || stiff(organ(0.5)),
        ..TONGUE_STIFF
    },
    Case {
        name: "organ-rest",
        about: "a minute at rest, 7 mm in the tongue of finite elements: nothing drifts",
        scene: || organ(0.5),
        ..TONGUE_REST
    },
];

/// Bounds for a hand that leaps in one tick. The tool follows by at most 8 substeps of half a millimetre in each tick,
/// and the whole raw force comes at its arrival.
const TELEPORT: Bounds = Bounds {
    energy: f64::INFINITY,
    exhausted_share: 0.01,
    jump: 5e-3,
    force_step: 10.0,
    torque_step: f64::INFINITY,
    buzz: 0.05,
    contact_ticks: 1000,
    ..TONGUE.bounds
};

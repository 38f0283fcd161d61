//! What is told of a probe on its way through pockets.

use sulcus_sessions::Events;

use super::two_teeth::{At, UPRIGHT, exercise, output, run, scene, short, to, told};

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
        let path = stay(a)
            .chain(to(a, over(a), 50))
            .chain(to(over(a), over(b), 200));
        let all = told(path.chain(to(over(b), b, 50)).chain(stay(b)));
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

/// Long enough to have stayed.
fn stay(at: At) -> impl Iterator<Item = At> {
    std::iter::repeat_n(at, 210)
}

/// What is told of withdrawals on a way through `steps`: an angle, and for how many ticks the tip is 3 mm deep there; it comes out between
/// two unless the next is `slid` to.
fn withdrawals(steps: &[(f64, usize, bool)]) -> Vec<String> {
    let at = |around| At { around, ..UPRIGHT };
    let out = |around| At {
        depth: -2.0,
        ..at(around)
    };
    let mut path = vec![out(steps[0].0)];
    for (k, (around, ticks, slid)) in steps.iter().enumerate() {
        let before = steps[k.saturating_sub(1)].0;
        if *slid {
            path.extend(to(at(before), at(*around), 40));
        } else {
            path.extend(to(at(before), out(before), 20));
            path.extend(to(out(before), out(*around), 50));
            path.extend(to(out(*around), at(*around), 20));
        }
        path.extend(std::iter::repeat_n(at(*around), *ticks));
    }
    let all = told(path);
    let kinds = all.iter().filter(|one| one.kind == "withdrawn");
    kinds
        .map(|one| {
            format!(
                "{} {}",
                one.data["from"].as_str().unwrap(),
                one.data["to"].as_str().unwrap()
            )
        })
        .collect()
}

#[test]
fn a_tip_that_slips_over_the_next_zone_on_its_way_out_was_withdrawn_all_the_same() {
    // 190 ms in the middle, then out, and in there.
    assert_eq!(
        withdrawals(&[(150.0, 300, false), (90.0, 120, true), (90.0, 300, false)]),
        ["distobuccal buccal"]
    );
    // Round to the other side on its way out.
    assert_eq!(
        withdrawals(&[(150.0, 300, false), (-150.0, 60, true), (90.0, 300, false)]),
        ["distobuccal buccal"]
    );
    // In again where it came out, and on from there: it walks.
    assert_eq!(
        withdrawals(&[(150.0, 300, false), (150.0, 300, false), (90.0, 300, true)]),
        [""; 0]
    );
    // In passing only.
    assert_eq!(
        withdrawals(&[(150.0, 300, false), (90.0, 60, false), (150.0, 300, false)]),
        [""; 0]
    );
}

#[test]
fn probing_both_sides_in_turn_hides_no_withdrawal() {
    assert_eq!(
        withdrawals(&[
            (150.0, 300, false),
            (-150.0, 300, false),
            (90.0, 300, false),
            (-90.0, 300, false),
        ]),
        ["distobuccal buccal", "distolingual lingual"]
    );
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
        let found = kinds.iter().filter(|k| **k == kind).count() as u64;
        let mut counts = first.tally().counts();
        assert!(counts.any(|count| count == (kind, found)), "{kind}");
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

//! Tests of both hands.

use super::*;
use crate::camera::{Camera, Vector};
use crate::hand::limits::Limits;
use crate::hand::pose::Turn;

fn hands() -> Hands {
    let hand = |y: f64| {
        let home = HandPose {
            position: Vector::new(0.0, y, 0.0),
            orientation: Turn::identity(),
        };
        Some(Hand::new(
            home,
            Vector::zeros(),
            Limits::around([home.position], 90.0),
        ))
    };
    let mut hands = Hands::new([hand(0.0), hand(30.0)], Scales::default());
    hands.set_open(false);
    hands
}

fn places(hands: &Hands) -> [Vector; 2] {
    [0, 1].map(|slot| hands.pose(slot).expect("a tool").position)
}

fn run(hands: &mut Hands) {
    for _ in 0..1000 {
        hands.advance(1e-3);
    }
}

#[test]
fn counts_move_the_chosen_hand_in_the_axes_of_the_picture() {
    let mut hands = hands();
    let eye = Vector::new(0.0, -400.0, 0.0);
    hands.look(Frame::of(&Camera::looking(
        eye,
        Vector::zeros(),
        Vector::z(),
        20.0,
        1.0,
    )));
    hands.apply(&Motion::shift(100.0, 40.0, 20.0));
    run(&mut hands);
    // The eye looks along y: right is x, towards the eye is -y.
    let expected = [Vector::new(2.5, -0.5, 1.0), Vector::new(0.0, 30.0, 0.0)];
    assert!((places(&hands)[0] - expected[0]).norm() < 1e-9);
    assert_eq!(places(&hands)[1], expected[1]);
    hands.choose_next();
    hands.apply(&Motion::shift(0.0, 100.0, 0.0));
    run(&mut hands);
    assert!((places(&hands)[0] - expected[0]).norm() < 1e-9);
    assert!((places(&hands)[1] - Vector::new(0.0, 30.0, 2.5)).norm() < 1e-9);
}

#[test]
fn precision_is_a_quarter_for_mouse_and_keys() {
    let length = |precise: bool| {
        let mut hands = hands();
        hands.set_precise(precise);
        hands.apply(&Motion::shift(80.0, 0.0, 0.0));
        hands.deflect(Steady::Keys, &Motion::shift(1.0, 0.0, 0.0));
        run(&mut hands);
        places(&hands)[0].norm()
    };
    // 80 counts are 2 mm, and a key held for a second is 20 mm.
    assert!((length(false) - 22.0).abs() < 1e-6, "{}", length(false));
    assert!((length(true) - 5.5).abs() < 1e-6);
}

#[test]
fn an_open_clutch_moves_nothing_and_stops_at_once() {
    let mut hands = hands();
    hands.apply(&Motion::shift(400.0, 0.0, 0.0));
    hands.advance(1e-3);
    let before = places(&hands);
    hands.set_open(true);
    hands.apply(&Motion::shift(400.0, 0.0, 0.0));
    hands.deflect(Steady::Cap, &Motion::shift(1.0, 0.0, 0.0));
    hands.go_home();
    run(&mut hands);
    assert_eq!(places(&hands), before);
    hands.set_open(false);
    hands.advance(1e-3);
    assert_ne!(places(&hands), before, "the cap is still deflected");
    hands.let_go();
    hands.set_open(false);
    let before = places(&hands);
    run(&mut hands);
    assert_eq!(places(&hands), before);
}

#[test]
fn a_tool_that_is_laid_down_stays_and_a_wrong_deflection_is_none() {
    let mut hands = hands();
    hands.take_or_lay();
    assert!(!hands.is_held(0) && hands.is_held(1) && !hands.is_held(2));
    hands.apply(&Motion::shift(100.0, 0.0, 0.0));
    hands.deflect(Steady::Sticks, &Motion::shift(1.0, 0.0, 0.0));
    run(&mut hands);
    assert_eq!(places(&hands)[0], Vector::zeros());
    hands.take_or_lay();
    hands.deflect(Steady::Sticks, &Motion::shift(f64::NAN, 1.0, 0.0));
    run(&mut hands);
    assert_eq!(places(&hands)[0], Vector::zeros());
    hands.deflect(Steady::Sticks, &Motion::shift(0.0, 7.0, 0.0));
    run(&mut hands);
    assert!(
        (places(&hands)[0].z - 60.0).abs() < 1e-6,
        "a full deflection at most"
    );
}

#[test]
fn one_tool_alone_stays_chosen() {
    let first = hands().hands[0];
    let mut one = Hands::new([None, first], Scales::default());
    assert_eq!(one.chosen(), 1);
    one.choose_next();
    assert_eq!(one.chosen(), 1);
    assert!(one.pose(0).is_none() && !one.is_held(0));
}

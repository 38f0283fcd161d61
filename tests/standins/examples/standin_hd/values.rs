//! Values of the parameters.

use crate::scheduler;
use crate::state::Open;
use std::sync::atomic::Ordering;
use sulcus_standins::board::{State, Traits};
use sulcus_standins::pose::{M3, scale};

/// A value in the type that the vendor gives it. Numbers of f64 come with their count.
pub enum Value {
    F64([f64; 16], usize),
    F32(f32),
    I32(i32),
    Long([i64; 6]),
    Bool(bool),
    Text(usize),
}

fn three(v: [f64; 3]) -> Value {
    let mut out = [0.0; 16];
    out[..3].copy_from_slice(&v);
    Value::F64(out, 3)
}

fn one(v: f64) -> Value {
    let mut out = [0.0; 16];
    out[0] = v;
    Value::F64(out, 1)
}

fn box_mm(v: [f64; 6]) -> Value {
    let mut out = [0.0; 16];
    for (to, from) in out.iter_mut().zip(v) {
        *to = from * 1e3;
    }
    Value::F64(out, 6)
}

/// The transform, columns first, with the translation in mm. The rotation part deviates from an orthonormal matrix.
fn transform(state: &State, shear: f64) -> Value {
    let r: M3 = state.rotation;
    let mut out = [0.0; 16];
    for column in 0..3 {
        for row in 0..3 {
            out[4 * column + row] = r[row][column];
        }
    }
    for row in 0..3 {
        out[row] *= 1.0 + shear;
        out[4 + row] += shear * r[row][0];
        out[12 + row] = state.position[row] * 1e3;
    }
    out[15] = 1.0;
    Value::F64(out, 16)
}

/// Value of a parameter; none for an unknown parameter.
pub fn value(open: &Open, parameter: u32) -> Option<Value> {
    match parameter {
        0x2200..0x2400 => of_state(&open.before.load(), &open.traits.load(), parameter - 0x200),
        0x2000..0x2200 => of_state(&open.now.load(), &open.traits.load(), parameter),
        0x2500..0x2506 => Some(Value::Text(match parameter {
            0x2500 => 5,
            0x2501 => 0,
            0x2502 => 3,
            0x2503 => 4,
            0x2504 => 1,
            _ => 2,
        })),
        0x2700 => Some(three(open.set_from(0))),
        0x2701 => Some(three(open.set_from(3))),
        0x2800 => {
            Some(three([0, 1, 2].map(|i| {
                f64::from_bits(open.last_force[i].load(Ordering::Relaxed))
            })))
        }
        _ => of_model(open, parameter),
    }
}

fn of_state(state: &State, traits: &Traits, parameter: u32) -> Option<Value> {
    Some(match parameter {
        0x2000 => Value::I32(state.buttons as i32),
        0x2001 => Value::Bool(false),
        0x2002 => Value::Bool(state.inkwell != 0),
        0x2010 => Value::Long(state.encoders),
        0x2050 => three(scale(state.position, 1e3)),
        0x2051 => three(scale(state.velocity, 1e3)),
        0x2052 => transform(state, traits.shear),
        0x2053 => three(state.angular),
        0x2100 => three(state.joints),
        0x2150 => three(state.gimbal),
        _ => return None,
    })
}

fn of_model(open: &Open, parameter: u32) -> Option<Value> {
    let traits = open.traits.load();
    Some(match parameter {
        0x2550 => box_mm(traits.reach),
        0x2551 => box_mm(traits.workspace),
        0x2552 => Value::F32((traits.tabletop * 1e3) as f32),
        0x2553 => Value::I32(traits.input_dof as i32),
        0x2554 => Value::I32(traits.output_dof as i32),
        0x2555 => Value::I32(traits.calibration_style as i32),
        0x2600 => Value::I32(scheduler::rate() as i32),
        0x2601 => Value::I32(scheduler::instantaneous_rate() as i32),
        0x2602 => one(traits.max_stiffness * 1e-3),
        0x2603 => one(traits.max_force),
        0x2604 => one(traits.continuous_force),
        0x2605 => temperature(open, &traits),
        0x2606 => one(traits.speed_limit * 1e3),
        0x2607 => one(traits.max_force),
        0x2608 => one(f64::from_bits(open.ramp.load(Ordering::Relaxed))),
        0x2609 => one(traits.max_damping * 1e-3),
        0x2620 | 0x2621 => one(traits.max_torque * 1e3),
        0x2622 => one(traits.max_torque * 1e3),
        0x2623 => one(traits.continuous_torque * 1e3),
        _ => return None,
    })
}

/// Temperatures of three motors, or of six for a device with torque.
fn temperature(open: &Open, traits: &Traits) -> Value {
    let count = if traits.output_dof >= 6.0 { 6 } else { 3 };
    let mut out = [0.0; 16];
    out[..count].fill(open.now.load().temperature);
    Value::F64(out, count)
}

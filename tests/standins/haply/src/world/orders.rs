//! Commands of a client, carried out.

use serde_json::{Value, json};

use super::World;
use crate::device::{Claim, GripArray};
use crate::log::{Command, IdleCause, Violation, What};
use crate::message::Order;

/// Array of the arms.
const ARMS: &str = "inverse3";

impl World {
    /// Carries the commands of one message out. An arm without a command in the message is released.
    pub(super) fn carry_out(&mut self, number: u64, orders: &[Order], now_ns: u64) -> Vec<Command> {
        let mut claims: Vec<Option<Claim>> = vec![None; self.arms.len()];
        let mut commands = Vec::with_capacity(orders.len());
        for order in orders {
            let mut command = Command {
                device: order.device.clone(),
                name: order.name.clone(),
                field: None,
                force: None,
                done: false,
                displayed: None,
            };
            if order.array == ARMS {
                self.arm_order(number, order, now_ns, &mut command, &mut claims);
            } else {
                command.done = self.grip_order(number, order);
            }
            commands.push(command);
        }
        self.settle(number, claims, now_ns);
        for command in &mut commands {
            let arm = self.arms.iter().find(|arm| arm.id == command.device);
            command.displayed = arm.map(|arm| arm.force(self.forces));
        }
        commands
    }

    fn settle(&mut self, number: u64, claims: Vec<Option<Claim>>, now_ns: u64) {
        for (arm, claim) in self.arms.iter_mut().zip(claims) {
            let device = arm.id.clone();
            match claim {
                Some(claim) => {
                    if arm.claim(claim) {
                        self.log.add(
                            now_ns,
                            What::Active {
                                device,
                                connection: number,
                            },
                        );
                    }
                }
                None => {
                    if arm.release(number) {
                        let last_command_ns = arm.last_command_ns();
                        let cause = IdleCause::NotCommanded;
                        self.log.add(
                            now_ns,
                            What::Idle {
                                device,
                                cause,
                                last_command_ns,
                            },
                        );
                    }
                }
            }
        }
    }

    fn arm_order(
        &mut self,
        number: u64,
        order: &Order,
        now_ns: u64,
        command: &mut Command,
        claims: &mut [Option<Claim>],
    ) {
        let Some(index) = self.arms.iter().position(|arm| arm.id == order.device) else {
            return self.violation(number, Violation::UnknownDevice, &order.device);
        };
        if !self.arms[index].connected {
            return self.violation(number, Violation::AbsentDevice, &order.device);
        }
        let mut claim = Claim {
            connection: number,
            force: [0.0; 3],
            position: false,
            at_ns: now_ns,
        };
        match order.name.as_str() {
            "set_cursor_force" => {
                let Some(force) =
                    self.vector_of(number, order, self.version.force_field(), command)
                else {
                    return;
                };
                claim.force = force;
            }
            "set_cursor_position" => {
                let field = self.version.position_field();
                if self.vector_of(number, order, field, command).is_none() {
                    return;
                }
                command.force = None;
                claim.position = true;
            }
            "set_angular_position" => claim.position = true,
            "set_angular_torques" => {}
            "set_transform" => {
                let value = order.fields.get("transform").cloned();
                self.arms[index].transform = Some(
                    value
                        .unwrap_or_else(|| Value::Object(order.fields.clone()))
                        .to_string(),
                );
                command.done = true;
                return;
            }
            "probe_position" | "probe_cursor_position" | "probe_angular_position" => {
                command.done = true;
                return;
            }
            _ => return self.unknown_command(number, order),
        }
        if order.execute() {
            command.done = true;
            claims[index] = Some(claim);
        }
    }

    /// Vector of a command in the field that this version understands; the other field does nothing but an event.
    fn vector_of(
        &mut self,
        number: u64,
        order: &Order,
        field: &str,
        command: &mut Command,
    ) -> Option<[f64; 3]> {
        let others = ["vector", "values", "position"];
        for other in others
            .into_iter()
            .filter(|other| *other != field && order.fields.contains_key(*other))
        {
            command.field = Some(other.into());
            command.force = order.vector(other);
            self.violation(number, Violation::WrongField, other);
            let name = if other == "values" {
                "command-deprecated"
            } else {
                "invalid-value"
            };
            self.event(
                name,
                "warning",
                &order.device,
                json!({ "command": order.name, "field": other }),
            );
        }
        if !order.fields.contains_key(field) {
            if command.field.is_none() {
                self.bad_vector(number, order, field);
            }
            return None;
        }
        command.field = Some(field.into());
        command.force = order.vector(field);
        if command.force.is_none() {
            self.bad_vector(number, order, field);
        }
        command.force
    }

    fn bad_vector(&mut self, number: u64, order: &Order, field: &str) {
        self.violation(number, Violation::BadVector, field);
        self.event(
            "invalid-value",
            "error",
            &order.device,
            json!({ "command": order.name, "field": field }),
        );
    }

    fn grip_order(&mut self, number: u64, order: &Order) -> bool {
        let array = GripArray::ALL
            .into_iter()
            .find(|array| array.name() == order.array);
        let grip = self.grips.iter().find(|grip| {
            grip.id == order.device && array.is_some_and(|array| grip.arrays.contains(&array))
        });
        let Some(grip) = grip else {
            if !self.unknown_arrays.contains(&order.array) {
                self.violation(number, Violation::UnknownDevice, &order.device);
            }
            return false;
        };
        if !grip.connected {
            self.violation(number, Violation::AbsentDevice, &order.device);
            return false;
        }
        if order.name == "probe_orientation" {
            return true;
        }
        self.unknown_command(number, order);
        false
    }

    fn unknown_command(&mut self, number: u64, order: &Order) {
        self.violation(number, Violation::UnknownCommand, &order.name);
        self.event(
            "invalid-value",
            "error",
            &order.device,
            json!({ "command": order.name }),
        );
    }
}

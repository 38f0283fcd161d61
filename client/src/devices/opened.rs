//! Devices of a session: opened, described to the server, put behind doors.

use std::path::Path;
use std::sync::mpsc::Sender;
use std::time::Duration;

use anyhow::{Context, bail};
use sulcus_connection::threaded::{DeviceHands, Part};
use sulcus_core::{Pose, Vec3};
use sulcus_devices::handle::Handle;
use sulcus_devices::{Backend, Found, backends};
use sulcus_haptics::device::{Device, HandInfo};
use sulcus_haptics::door::Guard;
use sulcus_haptics::freshness::Silence;
use sulcus_haptics::hands::drawn;
use sulcus_haptics::model::{LOOP_DELAY_S, shipped_for};
use sulcus_haptics::{DeviceModel, DoorRules, Limits, Mapping, SlewLimits};
use sulcus_program::PathText;
use sulcus_proto::control::{DeviceCoupling, DeviceInfo, ServerHello, ToolInfo};

use super::choose::{Chosen, Named, choose};
use super::settings::{DeviceSettings, Hand, Settings};

/// Devices of a session before its link is connected.
pub struct Opened {
    groups: Vec<Group>,
}

/// Devices of one back-end.
struct Group {
    device: Box<dyn Device>,
    hands: Vec<OpenedHand>,
}

/// Hand of an opened device.
#[derive(Clone, Debug)]
pub struct OpenedHand {
    /// Slot of the tool.
    pub slot: usize,
    /// Description by the back-end.
    pub info: HandInfo,
    /// Figures of the device.
    pub model: DeviceModel,
    /// BLAKE3 of the model's text, hexadecimal.
    model_hash: String,
    /// Settings of the person.
    pub settings: DeviceSettings,
    handle: Option<Handle>,
}

/// Finds the devices of all back-ends, with the stored hands.
pub fn found(settings: &Settings) -> Vec<Found> {
    found_by(&backends(), settings)
}

/// Finds the devices of some back-ends, with the stored hands.
fn found_by(backends: &[Box<dyn Backend>], settings: &Settings) -> Vec<Found> {
    let mut all: Vec<Found> = backends.iter().flat_map(|backend| backend.list()).collect();
    for found in &mut all {
        let hand = settings.of(found.library, &found.serial).hand;
        found.hand = hand.map_or("", Hand::name).to_owned();
    }
    all
}

/// Opens the named devices. `probe` is the hand that holds the tool of the first slot.
///
/// # Errors
/// A name fits no usable device, a device cannot be opened, or a model or handle file is invalid.
pub fn open(named: &[Named], settings: &Settings, probe: Hand) -> anyhow::Result<Opened> {
    open_by(&backends(), named, settings, probe)
}

/// Opens the named devices of some back-ends.
///
/// # Errors
/// The errors of [`open`].
pub fn open_by(
    backends: &[Box<dyn Backend>],
    named: &[Named],
    settings: &Settings,
    probe: Hand,
) -> anyhow::Result<Opened> {
    let mut chosen = choose(named, &found_by(backends, settings), settings)?;
    assign(&mut chosen, probe)?;
    let mut groups = Vec::new();
    for backend in backends {
        let of_backend: Vec<&Chosen> = chosen
            .iter()
            .filter(|one| one.library == backend.name())
            .collect();
        if !of_backend.is_empty() {
            groups.push(group(&**backend, &of_backend, settings, probe)?);
        }
    }
    Ok(Opened { groups })
}

/// Opens one device alone, for a measurement.
///
/// # Errors
/// The errors of [`open`].
pub fn alone(named: &Named, settings: &Settings) -> anyhow::Result<(Box<dyn Device>, OpenedHand)> {
    let mut opened = open(std::slice::from_ref(named), settings, Hand::Right)?;
    let group = opened.groups.pop().context("no device was opened")?;
    let hand = group
        .hands
        .into_iter()
        .next()
        .context("the device has no hand")?;
    Ok((group.device, hand))
}

/// Gives a hand to each device. A single device without a hand is that of the probe.
fn assign(chosen: &mut [Chosen], probe: Hand) -> anyhow::Result<()> {
    match chosen {
        [one] => one.hand = Some(probe),
        [a, b] if a.hand.is_none() || b.hand.is_none() => bail!(
            "the hands of {}:{} and {}:{} are not known; name them once, as in --device {}=left, or run `sulcus-client \
             devices hands`, which asks for a button of the left device",
            a.library,
            a.serial,
            b.library,
            b.serial,
            a.serial
        ),
        _ => {}
    }
    Ok(())
}

fn group(
    backend: &dyn Backend,
    chosen: &[&Chosen],
    settings: &Settings,
    probe: Hand,
) -> anyhow::Result<Group> {
    let serials: Vec<String> = chosen.iter().map(|one| one.serial.clone()).collect();
    let device = backend.open(&serials)?;
    let mut hands = Vec::new();
    for (one, info) in chosen.iter().zip(device.info()) {
        let settings = settings.of(one.library, &one.serial);
        let model = model(&settings, info)?;
        let text = model.to_toml()?;
        hands.push(OpenedHand {
            slot: usize::from(one.hand != Some(probe)),
            info: info.clone(),
            model_hash: blake3::hash(text.as_bytes()).to_hex().to_string(),
            handle: settings.handle.as_deref().map(handle).transpose()?,
            model,
            settings,
        });
    }
    Ok(Group { device, hands })
}

/// Model of a device: the file of the settings, else the shipped one, with the limits that the driver reports.
fn model(settings: &DeviceSettings, info: &HandInfo) -> anyhow::Result<DeviceModel> {
    let mut model = match &settings.model {
        Some(file) => DeviceModel::from_toml(&read(file)?)
            .with_context(|| format!("model file {}", file.shown()))?,
        None => shipped_for(info.library, &info.model).with_context(|| {
            format!(
                "no model of `{}` of {} is known; measure the device with `sulcus-client devices measure`, or write a \
                 model file and name it in {}",
                info.model,
                info.library,
                Settings::file().map_or_else(|| "devices.toml".into(), |file| file.shown().to_string())
            )
        })?,
    };
    let smaller = |mine: &mut f64, reported: Option<f64>| {
        if let Some(reported) = reported.filter(|x| x.is_finite() && *x > 0.0) {
            *mine = mine.min(reported);
        }
    };
    smaller(&mut model.peak_force_n.value, info.reported.peak_n);
    smaller(
        &mut model.continuous_force_n.value,
        info.reported.continuous_n,
    );
    smaller(
        &mut model.stiffness_n_per_mm.value,
        info.reported.stiffness_n_per_m.map(|k| k * 1e-3),
    );
    Ok(model)
}

fn handle(file: &Path) -> anyhow::Result<Handle> {
    Handle::from_toml(&read(file)?).with_context(|| format!("handle file {}", file.shown()))
}

fn read(file: &Path) -> anyhow::Result<String> {
    std::fs::read_to_string(file).with_context(|| format!("{}: cannot read", file.shown()))
}

impl Opened {
    /// Hands of all devices.
    pub fn hands(&self) -> impl Iterator<Item = &OpenedHand> {
        self.groups.iter().flat_map(|group| &group.hands)
    }

    /// Descriptions for the server, in the order of the slots. `tick_s` is the period of the server's tick, as far as
    /// it is known before the connection.
    pub fn describe(&self, tick_s: f64) -> Vec<DeviceInfo> {
        let slots = self.hands().map(|hand| hand.slot + 1).max().unwrap_or(0);
        let mut devices = vec![DeviceInfo::default(); slots];
        for hand in self.hands() {
            devices[hand.slot] = hand.describe(tick_s);
        }
        devices
    }

    /// Name of the devices for the server's log.
    pub fn name(&self) -> String {
        let names: Vec<String> = self.hands().map(|hand| hand.model.name.clone()).collect();
        names.join(" and ")
    }

    /// Starts the devices for the session of `hello`. `lines` takes a line for the person at each change of a stage.
    ///
    /// # Errors
    /// The scene has no tool for a hand, or the system has no thread.
    pub fn begin(
        self,
        hello: &ServerHello,
        lines: Option<Sender<String>>,
    ) -> anyhow::Result<DeviceHands> {
        let name = self.name();
        let mut parts = Vec::new();
        for group in self.groups {
            let mut hands = Vec::new();
            for hand in &group.hands {
                let tool = hello.tools.get(hand.slot).with_context(|| {
                    format!(
                        "the scene `{}` has {} tool, expected two for two devices",
                        hello.scene,
                        hello.tools.len()
                    )
                })?;
                hands.push((hand.slot, hand.rules(hello, tool)));
            }
            parts.push(Part {
                device: group.device,
                hands,
            });
        }
        Ok(DeviceHands::begin(name, parts, lines)?)
    }
}

impl OpenedHand {
    fn describe(&self, tick_s: f64) -> DeviceInfo {
        let model = &self.model;
        let coupling = model.coupling(tick_s, LOOP_DELAY_S, self.settings.scale);
        DeviceInfo {
            name: model.name.clone(),
            library: self.info.library.into(),
            serial: self.info.serial.clone(),
            model_hash: self.model_hash.clone(),
            figures: model.trust().name().into(),
            period_ns: self.info.period_ns,
            delay_us: (model.latency_ms.value * 1e3) as u32,
            workspace_scale: self.settings.scale as f32,
            max_force_n: self.force_n() as f32,
            max_torque_nm: self.torque_nm() as f32,
            friction_n: model.friction_n.value as f32,
            motion_axes: model.motion_dof.min(6),
            force_axes: model.force_axes,
            torque_axes: model.torque_axes,
            coupling: Some(DeviceCoupling {
                n_per_m: coupling.n_per_m.clamp(1.0, 1e5) as f32,
                // 0 stands for a device without torque, which limits no rotation.
                nm_per_rad: if model.has_torque() {
                    coupling.nm_per_rad.clamp(1e-4, 1e3) as f32
                } else {
                    0.0
                },
            }),
        }
    }

    /// Largest force of device and person, newtons.
    fn force_n(&self) -> f64 {
        let limit = self.settings.force_limit_n.unwrap_or(f64::INFINITY);
        self.model.peak_force_n.value.min(limit)
    }

    /// Largest torque of the device, newton-metres.
    fn torque_nm(&self) -> f64 {
        let peak = self.model.peak_torque_mnm.as_ref();
        if self.model.has_torque() {
            peak.map_or(0.0, |peak| peak.value * 1e-3)
        } else {
            0.0
        }
    }

    /// Rules of the door: the smallest limit of device, model file, person and scene.
    fn rules(&self, hello: &ServerHello, tool: &ToolInfo) -> DoorRules {
        let limits = Limits {
            force_n: f64::from(hello.max_force_n).min(self.force_n()),
            torque_nm: f64::from(hello.max_torque_nm).min(self.torque_nm()),
        };
        let slew = SlewLimits {
            force_n_per_ms: f64::from(hello.max_force_step_n),
            torque_nm_per_ms: f64::from(hello.max_torque_step_nm),
        };
        let device = Duration::from_nanos(self.info.period_ns);
        let link = Duration::from_nanos(hello.tick_ns);
        let passivity = self
            .model
            .passivity(device.as_secs_f64(), link.as_secs_f64());
        let guard = Guard {
            mapping: self.mapping(tool),
            has_torque: self.model.has_torque(),
            silence: Silence::DEVICE,
            blend_ns: Guard::blend(device, link),
            force: self.model.force_limit(),
            torque: self.model.torque_limit(),
            clutch: self
                .settings
                .clutch_button
                .map_or(0, |button| 1_u16 << (button - 1).min(15)),
        };
        DoorRules::guarded(limits, slew, passivity, guard)
    }

    /// Mapping between the device and the world of `tool`.
    fn mapping(&self, tool: &ToolInfo) -> Mapping {
        let tip = Vec3::from(tool.tip.map(f64::from));
        let gimbal_from_tool = match &self.handle {
            // The handle of a tool runs down its z axis to the tip.
            Some(handle) => handle.gimbal_from_tool(&tip, &-Vec3::z()),
            None => Pose::identity(),
        };
        let world_from_base = Mapping::seat(self.settings.seat_hour);
        let park = drawn(&sulcus_core::RawPose {
            position: tool.park.position,
            orientation: tool.park.orientation,
        })
        .unwrap_or_else(Pose::identity);
        let origin = self
            .settings
            .origin_mm
            .map_or(park.position, |mm| Vec3::from(mm) * 1e-3);
        // A device without rotation holds its tool as the scene parks it.
        let turned = if self.info.motion_dof < 6 {
            Pose::new(
                gimbal_from_tool.position,
                world_from_base.inverse() * park.orientation,
            )
        } else {
            gimbal_from_tool
        };
        Mapping {
            world_from_base,
            origin,
            scale: self.settings.scale,
            gimbal_from_tool: turned,
        }
    }

    /// Remarks for the person before the session: what the device cannot display.
    pub fn remarks(&self, force_n: Option<f64>) -> Vec<String> {
        let model = &self.model;
        let mut remarks: Vec<String> = force_n
            .and_then(|n| model.friction_remark(n))
            .into_iter()
            .collect();
        if !model.has_torque() {
            remarks.push(format!(
                "{} displays no torque: the turning of the tool is felt as a force at the handle alone, and the lost \
                 torque is recorded",
                model.name
            ));
        }
        if model.trust() == sulcus_haptics::model::Source::Guess {
            remarks.push(format!(
                "figures of {} are guesses; `sulcus-client devices measure` measures them",
                model.name
            ));
        }
        remarks
    }
}

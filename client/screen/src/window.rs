//! Window of the student. Only this file names `winit`.
//!
//! The window runs on the main thread of the program, as macOS demands. It takes the newest state and never waits for
//! another thread. The end of the window is not the end of the session.

use std::sync::Arc;
use std::time::{Duration, Instant};

use sulcus_proto::display::SceneHash;
use winit::application::ApplicationHandler;
use winit::event::{
    DeviceEvent, DeviceId, ElementState, MouseButton, MouseScrollDelta, WindowEvent,
};
use winit::event_loop::{ActiveEventLoop, ControlFlow, EventLoop};
use winit::keyboard::{Key as WindowKey, ModifiersState, NamedKey};
use winit::window::{CursorGrabMode, Fullscreen, Window, WindowId};

use crate::depth::millimetres;
use crate::error::ScreenError;
use crate::eye::Eye;
use crate::ghost::Ghost;
use crate::gpu::{Drawing, Screen};
use crate::hand::keys::Control;
use crate::hand::pad::PadEvent;
use crate::handed::Handed;
use crate::input::{
    HandsInput, PadsInput, PedalInput, of_button, of_key, switch_of_button, switch_of_code,
    switch_of_key,
};
use crate::material::Glass;
use crate::panel::{Detail, layout};
use crate::pointer::pointer;
use crate::quality::{Governor, Quality};
use crate::readings::{Foot, Key, Place, Switch};
use crate::show::{Act, Show};
use crate::stage::Stage;
use crate::strings::ENGLISH;
use crate::times::FrameTimes;
use crate::views::View;

/// Settings of a window.
#[derive(Clone, Debug)]
pub struct Settings {
    /// Title.
    pub title: String,
    /// First view.
    pub view: View,
    /// Quality; `None` for the governor's choice.
    pub quality: Option<Quality>,
    /// Whether the haptic thread has real-time priority. Without it a software adapter draws 30 frames a second.
    pub has_real_time: bool,
    /// Whether the output is flipped left to right, for a screen that is seen in a half mirror.
    pub mirrored: bool,
    /// Glass of the mirror.
    pub glass: Glass,
    /// Hand of the probe and of the mouse.
    pub hand: Handed,
    /// Pedal of the readings; `None` without one.
    pub pedal: Option<Foot>,
}

/// Report of a window.
#[derive(Clone, Debug)]
pub struct Report {
    /// Name of the graphics adapter; empty if none was opened.
    pub adapter: String,
    /// Quality at the end.
    pub quality: Quality,
    /// Times of the frames.
    pub times: FrameTimes,
    /// Reason of an early end; `None` when the session ended or the person closed the window.
    pub failed: Option<String>,
}

/// Frames of a second without a known refresh rate, and the most of a software adapter without real-time priority.
const USUAL_HZ: f64 = 60.0;
const CAPPED_HZ: f64 = 30.0;
/// Step of the lamp's patch, and its largest distance from the middle of the picture, mm.
const LAMP_MM: f64 = 8.0;
const LAMP_FAR_MM: f64 = 80.0;
/// Age of a state that no longer counts as live, seconds.
const STALE_S: f64 = 1.0;
/// Keys of the views, in the order of [`View::ALL`].
const VIEW_KEYS: [NamedKey; 6] = [
    NamedKey::F1,
    NamedKey::F2,
    NamedKey::F3,
    NamedKey::F4,
    NamedKey::F5,
    NamedKey::F6,
];

/// Sets the act after a loss of the display's server, whose library would end the process. The act runs once, on the
/// thread that met the loss. The act may end the process; otherwise this thread stays where it is. Only the X Window
/// System has such a loss.
pub fn on_loss(last: impl FnOnce() + Send + 'static) {
    #[cfg(target_os = "linux")]
    crate::gone::on_loss(Box::new(last));
    #[cfg(not(target_os = "linux"))]
    drop(last);
}

/// Runs a window until the session ends or the person closes it. Must be called on the main thread, once in a process.
///
/// # Errors
/// No display, or no window on it.
pub fn run(show: Box<dyn Show>, settings: Settings) -> Result<Report, ScreenError> {
    let no_display = |error: &dyn std::fmt::Display| ScreenError::NoDisplay(error.to_string());
    let event_loop = EventLoop::new().map_err(|error| no_display(&error))?;
    // Software adapters draw on threads that inherit this. The haptic threads have their own priority.
    #[cfg(target_os = "linux")]
    let _ = rustix::process::nice(5);
    let mut eye = Eye::new(settings.view);
    (eye.mirrored, eye.hand) = (settings.mirrored, settings.hand);
    let hands = show.hands().map(HandsInput::new);
    let mut application = Application {
        pads: PadsInput::new(hands.is_some(), settings.pedal.as_ref()),
        hands,
        pedal: settings.pedal.clone().map(PedalInput::new),
        modifiers: ModifiersState::empty(),
        report: Report {
            adapter: String::new(),
            quality: Quality::Full,
            times: FrameTimes::default(),
            failed: None,
        },
        show,
        settings,
        eye,
        opened: None,
        drawn: None,
        has_panel: true,
        is_grabbed: false,
        lamp_mm: [0.0; 2],
        drag: None,
        cursor: [0.0; 2],
        next: Instant::now(),
        last: Instant::now(),
        has_drawn: false,
    };
    let ran = event_loop.run_app(&mut application);
    ran.map_err(|error| no_display(&error))?;
    Ok(application.report)
}

/// Window with its drawer.
struct Opened {
    window: Arc<Window>,
    screen: Screen,
    governor: Governor,
    period: Duration,
}

struct Application {
    show: Box<dyn Show>,
    settings: Settings,
    report: Report,
    eye: Eye,
    opened: Option<Opened>,
    hands: Option<HandsInput>,
    pedal: Option<PedalInput>,
    pads: PadsInput,
    modifiers: ModifiersState,
    /// Scene that is drawn.
    drawn: Option<SceneHash>,
    has_panel: bool,
    /// Place of the lamp's patch in the picture, to the right and upwards, mm.
    lamp_mm: [f64; 2],
    /// Whether the mouse moves a tool.
    is_grabbed: bool,
    /// Place of the cursor at the begin of a drag, pixels.
    drag: Option<[f64; 2]>,
    cursor: [f64; 2],
    next: Instant,
    last: Instant,
    /// Whether a picture was drawn since the last turn of the loop.
    has_drawn: bool,
}

impl ApplicationHandler for Application {
    fn resumed(&mut self, event_loop: &ActiveEventLoop) {
        if self.opened.is_none() {
            match self.open(event_loop) {
                Ok(opened) => self.opened = Some(opened),
                Err(error) => self.fail(event_loop, error.to_string()),
            }
        }
    }

    fn window_event(&mut self, event_loop: &ActiveEventLoop, _: WindowId, event: WindowEvent) {
        match event {
            WindowEvent::CloseRequested | WindowEvent::Destroyed => event_loop.exit(),
            WindowEvent::Resized(size) => {
                if let Some(opened) = &mut self.opened {
                    opened.screen.resize([size.width, size.height]);
                }
            }
            WindowEvent::RedrawRequested => {
                // All events that came before are taken.
                self.poll();
                self.redraw(event_loop);
                self.has_drawn = true;
            }
            WindowEvent::KeyboardInput { event, .. } => {
                let is_pressed = event.state == ElementState::Pressed;
                // A keyboard's layout has other names for the keys from F13 on.
                let switches = [
                    switch_of_key(&event.logical_key),
                    switch_of_code(event.physical_key),
                ];
                if switches
                    .into_iter()
                    .any(|switch| self.stepped_on(switch, is_pressed))
                {
                    return;
                }
                let is_hands = of_key(event.physical_key, self.settings.hand)
                    .is_some_and(|key| self.control(key, is_pressed));
                // The space bar is the clutch: it never confirms a finding by accident.
                let is_clutch =
                    self.hands.is_some() && event.logical_key == WindowKey::Named(NamedKey::Space);
                if is_pressed && event.logical_key == WindowKey::Named(NamedKey::F10) {
                    if !event.repeat && self.show.leaves() {
                        event_loop.exit();
                    }
                } else if is_pressed && !is_hands && !is_clutch {
                    self.key(&event.logical_key, event.repeat);
                }
            }
            WindowEvent::ModifiersChanged(modifiers) => self.modifiers = modifiers.state(),
            WindowEvent::Focused(false) => {
                if let Some(pedal) = &mut self.pedal {
                    pedal.let_go();
                }
                if let Some(hands) = &mut self.hands {
                    hands.let_go();
                }
                self.grab();
            }
            WindowEvent::MouseInput { state, button, .. } => {
                let is_pressed = state == ElementState::Pressed;
                if self.stepped_on(switch_of_button(button), is_pressed) {
                    return;
                }
                if of_button(button).is_some_and(|button| self.control(button, is_pressed)) {
                    return;
                }
                let ended = self.drag.take().is_some();
                if button != MouseButton::Left {
                } else if state == ElementState::Pressed {
                    self.drag = Some(self.cursor);
                } else if ended {
                    self.came_to_rest();
                }
            }
            WindowEvent::CursorMoved { position, .. } => {
                let [x, y] = self.cursor;
                self.cursor = [position.x, position.y];
                if self.drag.is_some() {
                    self.eye.drag(position.x - x, position.y - y);
                }
            }
            WindowEvent::MouseWheel { delta, .. } => {
                let notches = match delta {
                    MouseScrollDelta::LineDelta(_, lines) => f64::from(lines),
                    MouseScrollDelta::PixelDelta(pixels) => pixels.y / 40.0,
                };
                if !self
                    .hands
                    .as_ref()
                    .is_some_and(|hands| hands.wheel(notches))
                {
                    self.eye.magnify(notches);
                    self.came_to_rest();
                }
            }
            _ => {}
        }
    }

    fn device_event(&mut self, _: &ActiveEventLoop, _: DeviceId, event: DeviceEvent) {
        if let (DeviceEvent::MouseMotion { delta: (x, y) }, Some(hands)) = (event, &self.hands)
            && self.is_grabbed
        {
            hands.mouse(x, y);
        }
    }

    fn about_to_wait(&mut self, event_loop: &ActiveEventLoop) {
        if self.show.is_over() {
            return event_loop.exit();
        }
        if self.hands.is_some() && self.show.hands_are_done() {
            self.hands = None;
            self.grab();
        }
        // Events that came during a picture are still to be taken: the next turn of the loop does so before it polls.
        if !std::mem::take(&mut self.has_drawn) {
            self.poll();
        }
        if let Some(opened) = self.opened.as_ref().filter(|_| Instant::now() >= self.next) {
            self.next = Instant::now() + opened.period;
            opened.window.request_redraw();
        }
        event_loop.set_control_flow(ControlFlow::WaitUntil(self.next));
    }
}

impl Application {
    fn open(&self, event_loop: &ActiveEventLoop) -> Result<Opened, ScreenError> {
        let attributes = Window::default_attributes()
            .with_title(self.settings.title.clone())
            .with_inner_size(winit::dpi::PhysicalSize::new(1280, 720));
        let window = event_loop
            .create_window(attributes)
            .map_err(|error| ScreenError::NoDisplay(error.to_string()))?;
        let window = Arc::new(window);
        let size = window.inner_size();
        let display = Box::new(event_loop.owned_display_handle());
        let screen = Screen::open(display, window.clone(), [size.width, size.height])?;
        let is_software = screen.graphics().is_software();
        let monitor = window.current_monitor();
        let refresh = monitor.and_then(|monitor| monitor.refresh_rate_millihertz());
        let mut hz = refresh
            .map_or(USUAL_HZ, |rate| f64::from(rate) / 1e3)
            .clamp(10.0, 240.0);
        if is_software && !self.settings.has_real_time {
            hz = hz.min(CAPPED_HZ);
            tracing::warn!(
                "no real-time priority and no graphics processor: {CAPPED_HZ} frames a second"
            );
        }
        tracing::info!("graphics adapter: {}", screen.graphics().name());
        Ok(Opened {
            window,
            screen,
            governor: Governor::new(is_software, self.settings.quality),
            period: Duration::from_secs_f64(1.0 / hz),
        })
    }

    fn fail(&mut self, event_loop: &ActiveEventLoop, why: String) {
        self.report.failed = Some(why);
        event_loop.exit();
    }

    fn redraw(&mut self, event_loop: &ActiveEventLoop) {
        let Some(opened) = &mut self.opened else {
            return;
        };
        let Some((hash, scene)) = self.show.scene() else {
            return;
        };
        if let Some(wanted) = self.show.wanted_view() {
            self.eye.tooth = wanted.tooth;
            self.eye.choose(wanted.view);
            self.eye.zoom = wanted.zoom;
        }
        let level = opened.governor.level();
        if self.drawn != Some(hash) || !opened.screen.is_ready(level) {
            let stage = Stage::new(&scene, level.looks().thinned_um);
            opened.screen.prepare(stage, level);
            self.drawn = Some(hash);
        }
        let begin = Instant::now();
        let target = match opened.screen.acquire() {
            Ok(Some(target)) => target,
            Ok(None) => return,
            Err(error) => return self.fail(event_loop, error.to_string()),
        };
        // As late as possible: after the wait for the surface.
        let Some((moment, age_s)) = self.show.moment() else {
            return;
        };
        let [width, height] = opened.screen.size();
        let aspect = f64::from(width) / f64::from(height);
        let elapsed_s = self.last.elapsed().as_secs_f64();
        self.last = Instant::now();
        let camera = self.eye.camera(&scene, &moment, aspect, elapsed_s);
        if let Some(hands) = &mut self.hands {
            hands.look(&camera);
        }
        let state = self.show.panel(detail(level));
        let scale = opened.window.scale_factor() as f32;
        let overlay = self.show.overlay([width, height], scale);
        let mut list = Vec::new();
        if let Some(overlay) = overlay {
            list = overlay;
        } else if self.has_panel {
            let stop = state.tour.as_ref().and_then(|tour| tour.stop);
            let site = stop.and_then(|stop| Place::of(stop, &scene));
            let site = site.map(|place| millimetres(place.at));
            if let Some(place) = self.show.mark().or(site) {
                list = pointer(&camera.pass(), &place, [width, height], scale);
            }
            list.extend(layout(&state, [width, height], scale, &ENGLISH).list);
        }
        let ghosts = self.show.ghosts();
        for (tool, at) in scene.tools.iter().zip(&ghosts) {
            if let Some(at) = at {
                let ghost = Ghost::of(tool);
                list.splice(0..0, ghost.draw(&camera.pass(), at, [width, height], scale));
            }
        }
        let mut drawing = Drawing::through(camera);
        (drawing.fog, drawing.scratches) = self.settings.glass.looks();
        let [right, up, _] = camera.axes();
        drawing.lamp = drawing
            .lamp
            .aimed(&(right * self.lamp_mm[0] + up * self.lamp_mm[1]));
        opened.screen.draw(&drawing, &moment, &list, &target);
        opened.window.pre_present_notify();
        opened.screen.present(target);
        let took = begin.elapsed();
        // Before its first and after its last pass a session has no new state.
        if age_s < STALE_S {
            let times = &mut self.report.times;
            times.frame(age_s + took.as_secs_f64(), took.as_secs_f64());
        }
        if self.report.adapter.is_empty() {
            self.report.adapter = opened.screen.graphics().name();
        }
        let budget = opened.period.as_secs_f64();
        if let Some(level) = opened.governor.frame(took.as_secs_f64(), budget) {
            tracing::info!("pictures take too long: quality {}", level.name());
        }
        self.report.quality = opened.governor.level();
        if let Err(error) = opened.screen.graphics().check() {
            self.fail(event_loop, error.to_string());
        }
    }

    /// Takes events of gamepads, and a group of presses of the pedal that has ended.
    fn poll(&mut self) {
        for event in self.pads.events() {
            let is_pedal = match event {
                PadEvent::Button(button, is_down) => {
                    self.stepped_on(Some(Switch::Pad(button)), is_down)
                }
                PadEvent::Sticks(_) => false,
            };
            if let Some(hands) = self.hands.as_mut().filter(|_| !is_pedal) {
                hands.pad(&event);
                self.grab();
            }
        }
        let keys = self.pedal.as_mut().map(PedalInput::wait);
        for key in keys.unwrap_or_default() {
            self.show.act(Act::Reading(key));
        }
    }

    /// Takes a press or a release for the pedal. Returns whether it was the pedal's.
    fn stepped_on(&mut self, switch: Option<Switch>, is_down: bool) -> bool {
        let pedal = self.pedal.as_mut().zip(switch);
        pedal.is_some_and(|(pedal, switch)| pedal.change(&switch, is_down))
    }

    /// Takes a press or a release for the hands. Returns whether it was theirs.
    fn control(&mut self, control: Control, is_pressed: bool) -> bool {
        let Some(hands) = &mut self.hands else {
            return false;
        };
        let is_theirs = hands.control(control, is_pressed);
        self.grab();
        is_theirs
    }

    /// Holds the cursor while the mouse moves a tool: the edge of a screen must not stop a hand.
    fn grab(&mut self) {
        let wanted = self.hands.as_ref().is_some_and(|hands| !hands.is_open());
        let Some(opened) = self.opened.as_ref().filter(|_| wanted != self.is_grabbed) else {
            return;
        };
        let window = &opened.window;
        let held = if wanted {
            // Some systems know one kind only.
            let locked = window.set_cursor_grab(CursorGrabMode::Locked);
            locked.or_else(|_| window.set_cursor_grab(CursorGrabMode::Confined))
        } else {
            window.set_cursor_grab(CursorGrabMode::None)
        };
        if let Err(error) = held {
            tracing::warn!("the cursor cannot be held: {error}");
        }
        window.set_cursor_visible(!wanted);
        self.is_grabbed = wanted;
    }

    fn key(&mut self, key: &WindowKey, is_repeat: bool) {
        if is_repeat {
            return;
        }
        match key {
            WindowKey::Named(NamedKey::F11) => {
                if let Some(opened) = &self.opened {
                    let full = opened.window.fullscreen().is_none();
                    opened
                        .window
                        .set_fullscreen(full.then_some(Fullscreen::Borderless(None)));
                }
            }
            WindowKey::Named(NamedKey::F7) => {
                self.has_panel = !self.has_panel;
                self.show.act(Act::Panel(self.has_panel));
            }
            WindowKey::Named(NamedKey::F8) => self.show.act(Act::StartForce),
            WindowKey::Named(NamedKey::Escape) => self.show.act(Act::Pause),
            WindowKey::Named(NamedKey::Home) => {
                self.eye.choose(self.eye.view);
                self.came_to_rest();
            }
            WindowKey::Named(named) => {
                if let Some([left, up]) = head_step(*named).filter(|_| self.modifiers.shift_key()) {
                    self.eye.head = self.eye.head.stepped(left, up);
                    self.show.act(Act::Head(self.eye.head));
                } else if let Some(step) = lamp_step(*named) {
                    for (at, step) in self.lamp_mm.iter_mut().zip(step) {
                        *at = (*at + step * LAMP_MM).clamp(-LAMP_FAR_MM, LAMP_FAR_MM);
                    }
                } else if let Some(at) = VIEW_KEYS.iter().position(|one| one == named) {
                    self.eye.choose(View::ALL[at]);
                    self.show.act(Act::View(View::ALL[at]));
                } else if let Some(key) = named_key(*named) {
                    self.show.act(Act::Reading(key));
                }
            }
            WindowKey::Character(text) => match text.as_str() {
                "w" => self.show.act(Act::Wipe),
                text => {
                    let key = text.chars().next().and_then(Key::from_char);
                    if let Some(key) = key {
                        self.show.act(Act::Reading(key));
                    }
                }
            },
            _ => {}
        }
    }

    fn came_to_rest(&mut self) {
        let Eye {
            turn, tilt, zoom, ..
        } = self.eye;
        self.show.act(Act::Camera { turn, tilt, zoom });
    }
}

/// Step of the lamp's patch to the right and upwards; `None` for another key.
fn lamp_step(key: NamedKey) -> Option<[f64; 2]> {
    Some(match key {
        NamedKey::ArrowLeft => [-1.0, 0.0],
        NamedKey::ArrowRight => [1.0, 0.0],
        NamedKey::ArrowUp => [0.0, 1.0],
        NamedKey::ArrowDown => [0.0, -1.0],
        _ => return None,
    })
}

/// Step of the patient's head with Shift: towards the patient's left, which is at the right of the picture, and with
/// the chin upwards; `None` for another key.
fn head_step(key: NamedKey) -> Option<[i16; 2]> {
    lamp_step(key).map(|step| step.map(|step| step as i16))
}

/// Key of a finding that has a name, not a letter.
fn named_key(key: NamedKey) -> Option<Key> {
    match key {
        NamedKey::Enter => Key::from_char('\n'),
        NamedKey::Space => Key::from_char(' '),
        NamedKey::Backspace => Key::from_char('\u{8}'),
        _ => None,
    }
}

fn detail(level: Quality) -> Detail {
    match level {
        Quality::Full => Detail::Full,
        Quality::Plain => Detail::Plain,
        Quality::Low => Detail::Low,
        Quality::Lowest => Detail::Lowest,
    }
}

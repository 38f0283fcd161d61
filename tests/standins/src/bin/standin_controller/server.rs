//! The controller's loop.

use crate::clients::Clients;
use crate::device::Device;
use crate::journal::Journal;
use std::io::{BufRead, Error, Result, Write};
use std::path::Path;
use std::rc::Rc;
use std::sync::atomic::Ordering;
use std::sync::mpsc::{Receiver, Sender, TryRecvError, channel};
use sulcus_standins::board::{Board, DEVICES, Message, NO_DEVICE, Packet};
use sulcus_standins::clock::{self, US};
use sulcus_standins::log::Event;
use sulcus_standins::setup::Setup;
use sulcus_standins::{Request, Response};

/// Period of the loop in ns.
const PERIOD: u64 = 250 * US;

/// Real-time priority of the loop, above the client's own loops.
const PRIORITY: i32 = 80;

/// A request and the way back.
type Asked = (Request, Sender<Response>);

/// Serves requests until the input ends.
pub fn run(board: &Path, log: &Path) -> Result<()> {
    let board = Board::create(board).map_err(Error::other)?;
    let journal = Rc::new(Journal::create(log)?);
    let requests = listen();
    let Ok((Request::Start(setup), answer)) = requests.recv() else {
        return Err(Error::other("the first request must be `Start`"));
    };
    if setup.devices.is_empty() || setup.devices.len() > DEVICES {
        return Err(Error::other("a controller has one to four devices"));
    }
    prepare(board, &setup);
    let realtime = setup.realtime && clock::make_realtime(PRIORITY);
    let now = clock::now_ns();
    journal.add(now, None, Event::Started(realtime));
    let devices = setup
        .devices
        .iter()
        .zip(&board.slots)
        .enumerate()
        .map(|(i, (device, slot))| Device::new(i, device.clone(), slot, Rc::clone(&journal), now))
        .collect();
    let _ = answer.send(Response::Done);
    let mut server = Server {
        board,
        journal,
        devices,
        clients: Clients::new(board),
        packets: Vec::with_capacity(1024),
    };
    server.serve(&requests);
    let (done, written) = channel();
    server.journal.sync(done);
    written.recv().map_err(Error::other)
}

/// Reads requests on a thread of its own and writes their answers.
fn listen() -> Receiver<Asked> {
    let (to, from) = channel();
    std::thread::spawn(move || {
        for line in std::io::stdin().lock().lines().map_while(Result::ok) {
            let response = match serde_json::from_str::<Request>(&line) {
                Ok(request) => {
                    let (answer, answered) = channel();
                    if to.send((request, answer)).is_err() {
                        return;
                    }
                    answered
                        .recv()
                        .unwrap_or_else(|_| Response::Refused("the controller ended".into()))
                }
                Err(error) => Response::Refused(format!("the request cannot be read: {error}")),
            };
            let mut out = std::io::stdout().lock();
            let written = serde_json::to_writer(&mut out, &response)
                .map_err(Error::from)
                .and_then(|()| out.write_all(b"\n"))
                .and_then(|()| out.flush());
            if written.is_err() {
                return;
            }
        }
    });
    from
}

fn prepare(board: &Board, setup: &Setup) {
    let driver = &board.driver;
    for (to, rate) in driver.rates.iter().zip(&setup.driver.rates) {
        to.store(*rate, Ordering::Relaxed);
    }
    driver
        .real_rate
        .store(setup.driver.real_rate, Ordering::Relaxed);
    driver
        .jitter
        .store(setup.driver.jitter_us, Ordering::Relaxed);
    let crash = u32::from(setup.driver.crash_on_disable);
    driver.crash_on_disable.store(crash, Ordering::Relaxed);
    driver
        .realtime
        .store(u32::from(setup.realtime), Ordering::Relaxed);
    for (to, number) in driver.dhd_version.iter().zip(setup.driver.dhd_version) {
        to.store(number, Ordering::Relaxed);
    }
    driver.hd_version.set(&setup.driver.hd_version);
}

struct Server {
    board: &'static Board,
    journal: Rc<Journal>,
    devices: Vec<Device>,
    clients: Clients,
    packets: Vec<Packet>,
}

impl Server {
    fn serve(&mut self, requests: &Receiver<Asked>) {
        let mut next = clock::now_ns();
        for turn in 0u64.. {
            next = (next + PERIOD).max(clock::now_ns().saturating_sub(PERIOD));
            clock::sleep_until(next);
            if turn.is_multiple_of(4) {
                self.bury();
            }
            self.run_to_now();
            loop {
                match requests.try_recv() {
                    Ok((request, answer)) => self.answer(request, answer),
                    Err(TryRecvError::Empty) => break,
                    Err(TryRecvError::Disconnected) => return,
                }
            }
        }
    }

    /// Handles every message up to now and runs every device up to now.
    fn run_to_now(&mut self) {
        self.packets.clear();
        self.clients.collect(&mut self.packets);
        let now = clock::now_ns();
        for packet in &self.packets {
            if packet.device == NO_DEVICE {
                note_library(&self.journal, packet);
            } else if let Some(device) = self.devices.get_mut(packet.device as usize) {
                device.advance(packet.sent.min(now));
                device.t = device.t.max(packet.sent.min(now));
                device.handle_message(packet);
            }
        }
        for device in &mut self.devices {
            device.advance(now);
            device.publish();
        }
        let lost = self.clients.newly_lost();
        if lost > 0 {
            self.journal.add(now, None, Event::Lost(lost));
        }
    }

    /// Ends what dead processes left open, after their last messages.
    fn bury(&mut self) {
        let dead = self.clients.dead();
        if dead.is_empty() {
            return;
        }
        self.run_to_now();
        for (ring, pid) in dead {
            for device in &mut self.devices {
                if device.slot.owner.load(Ordering::Acquire) == pid {
                    device.owner_died(pid);
                }
            }
            self.clients.free(ring);
        }
    }

    fn answer(&mut self, request: Request, answer: Sender<Response>) {
        self.run_to_now();
        let now = clock::now_ns();
        let count = self.devices.len();
        let mut with = |index: usize, act: &mut dyn FnMut(&mut Device) -> Response| match self
            .devices
            .get_mut(index)
        {
            Some(device) => {
                device.advance(now);
                act(device)
            }
            None => Response::Refused(format!("device {index} is not one of the {count} devices")),
        };
        let response = match request {
            Request::Start(_) => Response::Refused("the controller runs already".into()),
            Request::Fault(index, fault) => with(index, &mut |device| {
                device.fault(self.board, fault.clone());
                Response::Done
            }),
            Request::Hand(index, hand) => with(index, &mut |device| {
                device.note(Event::Hand);
                device.handle.take(*hand.clone());
                Response::Done
            }),
            Request::Snapshot(index) => {
                with(index, &mut |device| Response::Snapshot(device.snapshot()))
            }
            Request::Sync => {
                let (done, written) = channel();
                self.journal.sync(done);
                std::thread::spawn(move || {
                    let _ = written.recv();
                    let _ = answer.send(Response::Done);
                });
                return;
            }
        };
        let _ = answer.send(response);
    }
}

/// Notes a message that concerns the whole library.
fn note_library(journal: &Journal, packet: &Packet) {
    let pid = packet.pid;
    let event = match packet.message {
        Message::Refused(code) => Event::Refused { pid, code },
        Message::Error(code) => Event::Error { code, pid },
        Message::Call(call, value) => Event::Call { call, value, pid },
        _ => return,
    };
    journal.add(packet.sent, None, event);
}

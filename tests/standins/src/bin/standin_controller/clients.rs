//! Processes that loaded a driver library: their messages and their deaths.

use rustix::event::{PollFd, PollFlags, Timespec, poll};
use rustix::fd::OwnedFd;
use rustix::process::{Pid, PidfdFlags, pidfd_open};
use std::sync::atomic::Ordering;
use sulcus_standins::board::{Board, Packet, RINGS};

struct Client {
    pid: u32,
    /// None for a process that was gone when the controller saw it first.
    life: Option<OwnedFd>,
}

/// Processes by their ring.
pub struct Clients {
    board: &'static Board,
    known: [Option<Client>; RINGS],
    lost: [u64; RINGS],
}

impl Clients {
    /// The processes at the board.
    pub fn new(board: &'static Board) -> Self {
        Self {
            board,
            known: Default::default(),
            lost: [0; RINGS],
        }
    }

    /// Takes the messages of all rings, in the order of their sending.
    pub fn collect(&mut self, into: &mut Vec<Packet>) {
        for ring in &self.board.rings {
            if ring.owner.load(Ordering::Acquire) != 0 {
                into.extend(
                    std::iter::from_fn(|| ring.pop()).filter_map(|words| Packet::read(&words)),
                );
            }
        }
        into.sort_by_key(|packet| packet.sent);
    }

    /// Messages that full rings lost since the last call.
    pub fn newly_lost(&mut self) -> u64 {
        let mut sum = 0;
        for (ring, before) in self.board.rings.iter().zip(&mut self.lost) {
            let lost = ring.lost.load(Ordering::Relaxed);
            sum += lost.saturating_sub(*before);
            *before = lost;
        }
        sum
    }

    /// Processes that died since the last call. Their rings still hold their last messages.
    pub fn dead(&mut self) -> Vec<(usize, u32)> {
        let mut dead = Vec::new();
        for (i, ring) in self.board.rings.iter().enumerate() {
            let pid = ring.owner.load(Ordering::Acquire);
            if pid == 0 {
                continue;
            }
            if self.known[i]
                .as_ref()
                .is_none_or(|client| client.pid != pid)
            {
                let life = Pid::from_raw(pid as i32)
                    .and_then(|pid| pidfd_open(pid, PidfdFlags::empty()).ok());
                self.known[i] = Some(Client { pid, life });
            }
            let alive = self.known[i].as_ref().is_some_and(alive);
            if !alive {
                dead.push((i, pid));
            }
        }
        dead
    }

    /// Frees the ring of a dead process.
    pub fn free(&mut self, i: usize) {
        self.known[i] = None;
        self.lost[i] = 0;
        self.board.rings[i].reset();
    }
}

/// True while the process runs. A process that waits for its parent counts as dead.
fn alive(client: &Client) -> bool {
    let Some(life) = &client.life else {
        return false;
    };
    let mut fds = [PollFd::new(life, PollFlags::IN)];
    let at_once = Timespec {
        tv_sec: 0,
        tv_nsec: 0,
    };
    matches!(poll(&mut fds, Some(&at_once)), Ok(0))
}

//! A server with a console, tickets, and students with simulated hands.

use std::process::{Child, Stdio};

use sulcus_tests::{Place, Program, Serving};

/// Station with exercise, ticks a second, and habit of the student.
pub type Seat = (&'static str, &'static str, u16, Option<&'static str>);

/// Stations with exercise, ticks a second, and habit of the student. Three are slow: four sessions of unoptimised programs
/// at the full rate are more than two cores carry.
pub const STATIONS: [Seat; 4] = [
    ("chair-1", "crown", 250, None),
    ("chair-2", "crown", 1000, None),
    ("chair-3", "probing", 250, Some("heavy-hand")),
    ("chair-4", "crown", 250, None),
];

/// Options of the server.
const SERVES: [&str; 5] = [
    "--config",
    "stations.toml",
    "--console",
    "127.0.0.1:0",
    // A measured cost refuses stations on a busy machine.
    "--no-admission",
];

/// A running server with its folder and tickets.
pub struct Class {
    pub place: Place,
    pub server: Serving,
    pub console: String,
    pub instructor: String,
    seats: &'static [Seat],
    tickets: Vec<String>,
}

impl Class {
    pub fn new() -> Self {
        Self::of(&STATIONS)
    }

    /// A class with these stations.
    pub fn of(seats: &'static [Seat]) -> Self {
        let place = Place::new();
        let ticket = |name: &str, arguments: &[&str]| {
            let out = format!("{name}.ticket");
            let add = [&["token", "add", "--out", &out], arguments].concat();
            place.run(Program::Server, &add).ok();
            let text = std::fs::read_to_string(place.path(&out)).expect("a ticket");
            text.trim().to_owned()
        };
        let mut stations = String::from("[defaults]\nresume_within_s = 60\n");
        for (name, exercise, rate, _) in seats {
            stations += &format!(
                "[[station]]\nname = \"{name}\"\nplan = {{ exercise = \"{exercise}\", rate_hz = {rate} }}\n"
            );
        }
        std::fs::write(place.path("stations.toml"), stations).expect("stations");
        let instructor = ticket("instructor", &["--role", "instructor"]);
        let student = |seat: &Seat| {
            let name = seat.0;
            ticket(name, &["--role", "student", "--station", name])
        };
        let tickets: Vec<String> = seats.iter().map(student).collect();
        let server = place.serve(&SERVES);
        let console = server.console.clone().expect("a console");
        Self {
            place,
            server,
            console,
            instructor,
            seats,
            tickets,
        }
    }

    /// Starts the student of a station, for a session of this length unless it is ended before.
    pub fn student(&self, k: usize, seconds: &str) -> Child {
        let (_, exercise, rate, habit) = self.seats[k];
        let mut command = self.place.command(Program::Client.path());
        command
            .env("SULCUS_TICKET", &self.tickets[k])
            .args([
                "run",
                "--server",
                &self.server.address,
                "--exercise",
                exercise,
            ])
            .args([
                "--duration",
                seconds,
                "--json",
                "--learner",
                &format!("s-{}", k + 1),
            ])
            // On a busy machine the choice of a client would be a matter of chance.
            .args(["--rate-hz", &rate.to_string(), "--tick", "server"])
            .stdout(Stdio::piped())
            .stderr(Stdio::piped());
        if let Some(habit) = habit {
            command.args(["--habit", habit]);
        }
        command.spawn().expect("the client starts")
    }

    /// Ends the session of a student as Ctrl-C does. The station is free afterwards.
    pub fn interrupt(mut student: Child) {
        // A student whose session has ended is gone already.
        let process = rustix::process::Pid::from_child(&student);
        let _ = rustix::process::kill_process(process, rustix::process::Signal::INT);
        student.wait().expect("the client ends");
    }

    /// Ends the server and starts another one with the same folders. The console has another address then.
    pub fn restart(&mut self) {
        self.server.stop();
        self.server = self.place.serve(&SERVES);
        self.console = self.server.console.clone().expect("a console");
    }

    /// Ticket of the student of a station.
    pub fn ticket(&self, k: usize) -> &str {
        &self.tickets[k]
    }
}

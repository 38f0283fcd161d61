//! Stand-in of the Haply Inverse service as a program.
//!
//! `standin-haply FILE` reads its options as JSON from a file, `standin-haply -` from the first line of its input,
//! and `standin-haply` alone takes the usual ones. The first line of output is `ready` and the ports as JSON.
//! Each further line of input is a request as JSON; the answer is `ok TIME` or `error TEXT`.
//! Examples are `{"fault":"drop_connections"}`, `{"fault":{"stall":{"ms":50}}}`, `"now"` and `"quit"`.
//! The program ends with its input.

use std::error::Error;
use std::io::{BufRead, Write};
use std::process::ExitCode;

use sulcus_standin_haply::{Options, Request, Service, now_ns};

fn main() -> ExitCode {
    match run() {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            println!("error {error}");
            ExitCode::FAILURE
        }
    }
}

fn run() -> Result<(), Box<dyn Error>> {
    let mut input = std::io::stdin().lock();
    let options = options(&mut input)?;
    let service = Service::start(options)?;
    // The folder of the log goes with the service: a log that is to stay has a file of its own in the options.
    let mut output = std::io::stdout().lock();
    writeln!(output, "ready {}", serde_json::to_string(service.ready())?)?;
    output.flush()?;
    let mut line = String::new();
    loop {
        line.clear();
        if input.read_line(&mut line)? == 0 {
            break;
        }
        if line.trim().is_empty() {
            continue;
        }
        let request: Result<Request, _> = serde_json::from_str(&line);
        let quit = matches!(request, Ok(Request::Quit));
        let done = request.map_err(|error| error.to_string());
        let done =
            done.and_then(|request| service.apply(&request).map_err(|error| error.to_string()));
        match done {
            Ok(()) => writeln!(output, "ok {}", now_ns())?,
            Err(text) => writeln!(output, "error {text}")?,
        }
        output.flush()?;
        if quit {
            break;
        }
    }
    service.stop()?;
    Ok(())
}

fn options(input: &mut impl BufRead) -> Result<Options, Box<dyn Error>> {
    match std::env::args().nth(1).as_deref() {
        None => Ok(Options::default()),
        Some("-") => {
            let mut line = String::new();
            input.read_line(&mut line)?;
            Ok(serde_json::from_str(&line)?)
        }
        Some(path) => Ok(serde_json::from_str(&std::fs::read_to_string(path)?)?),
    }
}

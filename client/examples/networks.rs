//! Sessions through every named network, with ticks of the server and with ticks at the hand:
//! `cargo run --release -p sulcus-client --example networks -- [EXERCISE [SECONDS]] [--json FILE]`.
//!
//! Output: the round trip of plain UDP over the loopback interface, then a line for each session. The session without a
//! network, with ticks of the server, comes first. The file goes
//! to `sulcus-server report --networks`.

use std::net::UdpSocket;
use std::time::Duration;

use anyhow::Context;
use clap::Parser;
use serde_json::json;
use sulcus_connection::link::now_ns;
use sulcus_connection::progress::Steps;
use sulcus_demo::args::{DemoArgs, Ticks};
use sulcus_demo::exercise::{self, Asked};
use sulcus_demo::live;
use sulcus_link::Times;
use sulcus_link::clock::sleep_until;
use sulcus_proto::{Percentiles, PoseDatagram};
use sulcus_relay::Network;

/// Measure sessions through every named network
#[derive(Parser)]
struct Arguments {
    /// Exercise
    #[arg(default_value = "probing")]
    exercise: String,
    /// Length of each session, seconds
    #[arg(default_value_t = 15.0)]
    seconds: f64,
    /// File for the figures
    #[arg(long, value_name = "FILE")]
    json: Option<std::path::PathBuf>,
}

/// Round trips of plain UDP over the loopback interface between two threads, at 1 kHz, with datagrams of the length of a
/// pose, milliseconds.
fn plain_udp(seconds: f64) -> anyhow::Result<Percentiles> {
    let (near, far) = (
        UdpSocket::bind("127.0.0.1:0")?,
        UdpSocket::bind("127.0.0.1:0")?,
    );
    near.connect(far.local_addr()?)?;
    near.set_read_timeout(Some(Duration::from_secs(1)))?;
    let count = (seconds * 1e3) as u64;
    let echo = std::thread::spawn(move || -> std::io::Result<()> {
        let mut bytes = [0; PoseDatagram::BYTES];
        for _ in 0..count {
            let (length, from) = far.recv_from(&mut bytes)?;
            far.send_to(&bytes[..length], from)?;
        }
        Ok(())
    });
    let mut times = Times::up_to(1);
    let mut bytes = [0; PoseDatagram::BYTES];
    let begin = now_ns();
    for k in 1..=count {
        sleep_until(begin + k * 1_000_000);
        let sent = now_ns();
        near.send(&bytes)?;
        near.recv(&mut bytes).context("plain UDP: no answer")?;
        times.record(now_ns() - sent);
    }
    echo.join()
        .map_err(|_| anyhow::anyhow!("the echo of plain UDP ended"))??;
    let us = times.percentiles();
    Ok(Percentiles {
        p50: us.p50 / 1e3,
        p99: us.p99 / 1e3,
        p999: us.p999 / 1e3,
        max: us.max / 1e3,
    })
}

fn main() -> anyhow::Result<()> {
    let arguments = Arguments::parse();
    let folder = tempfile::tempdir()?;
    let networks = std::iter::once(None).chain(Network::ALL.map(Some));
    let mut rows = Vec::new();
    // No session of Sulcus is faster than its packets.
    let udp = plain_udp(arguments.seconds)?;
    let row = json!({ "network": "plain UDP", "tick": "none", "pose_age_ms": udp });
    println!("{row}");
    rows.push(row);
    for network in networks {
        for tick in [Ticks::Server, Ticks::Hand] {
            let asked = Asked {
                duration_s: Some(arguments.seconds),
                ..Asked::of(&arguments.exercise)
            };
            let prepared = exercise::prepare(&asked, &Steps)?;
            let args = DemoArgs {
                network,
                tick,
                recordings: folder.path().to_owned(),
                json: true,
                ..DemoArgs::default()
            };
            let summary = live::run(&args, prepared, None, &Steps)?;
            let mut row = serde_json::to_value(&summary.way)?;
            row["grade"] = json!(summary.grade.as_ref().and_then(|grade| grade.score));
            row["identical"] = json!(summary.identical);
            println!("{row}");
            rows.push(row);
        }
    }
    let file = json!({
        "exercise": arguments.exercise,
        "seconds": arguments.seconds,
        "cores": std::thread::available_parallelism()?.get(),
        "networks": rows,
    });
    if let Some(path) = &arguments.json {
        std::fs::write(path, serde_json::to_string_pretty(&file)?)
            .with_context(|| format!("{}: cannot write it", path.display()))?;
    }
    Ok(())
}

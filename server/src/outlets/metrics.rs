//! Metrics of all stations as Prometheus text, over HTTP on a port of its own. The labels are station names only.
//!
//! The reader asks `GET /metrics`. Each connection serves one request of at most 8 KiB within 2 s, and then closes. The
//! console brings a web server; until then these few lines avoid one.

use std::fmt::Write as _;
use std::net::SocketAddr;
use std::sync::Arc;
use std::time::Duration;

use sulcus_proto::station::{Phase, StationStatus};
use tokio::io::{AsyncReadExt, AsyncWriteExt};
use tokio::net::{TcpListener, TcpStream};
use tokio::sync::Semaphore;

use crate::station::door::Door;

/// Largest request, bytes.
const REQUEST: usize = 8 * 1024;
/// Timeout of a request and of its answer.
const TIMEOUT: Duration = Duration::from_secs(2);
/// Requests served at once; further readers wait.
const AT_ONCE: usize = 8;

/// Serves metrics until the task is dropped.
pub(crate) async fn serve(listener: TcpListener, doors: Vec<Door>) {
    let places = Arc::new(Semaphore::new(AT_ONCE));
    let doors = Arc::new(doors);
    loop {
        let Ok(place) = places.clone().acquire_owned().await else {
            return;
        };
        match listener.accept().await {
            Ok((stream, from)) => {
                let doors = doors.clone();
                tokio::spawn(async move {
                    if tokio::time::timeout(TIMEOUT, answer(stream, &doors))
                        .await
                        .is_err()
                    {
                        tracing::debug!("metrics: {from} took longer than {} s", TIMEOUT.as_secs());
                    }
                    drop(place);
                });
            }
            Err(error) => {
                tracing::warn!("metrics: cannot accept a connection: {error}");
                tokio::time::sleep(TIMEOUT).await;
            }
        }
    }
}

async fn answer(mut stream: TcpStream, doors: &[Door]) -> std::io::Result<()> {
    let mut request = Vec::new();
    let mut part = [0; 1024];
    while !request.windows(4).any(|end| end == b"\r\n\r\n") {
        let read = stream.read(&mut part).await?;
        request.extend_from_slice(&part[..read]);
        if read == 0 || request.len() > REQUEST {
            return Ok(());
        }
    }
    let (status, body) = if asks_for_metrics(&request) {
        let statuses: Vec<StationStatus> = doors.iter().map(Door::status).collect();
        ("200 OK", text(&statuses))
    } else {
        ("404 Not Found", "only GET /metrics is served\n".to_owned())
    };
    let head = format!(
        "HTTP/1.1 {status}\r\nContent-Type: text/plain; version=0.0.4; charset=utf-8\r\n\
         Content-Length: {}\r\nConnection: close\r\nX-Content-Type-Options: nosniff\r\n\r\n",
        body.len()
    );
    stream.write_all(head.as_bytes()).await?;
    stream.write_all(body.as_bytes()).await?;
    stream.shutdown().await
}

fn asks_for_metrics(request: &[u8]) -> bool {
    let line = request
        .split(|byte| *byte == b'\r')
        .next()
        .unwrap_or_default();
    line.starts_with(b"GET /metrics ") || line.starts_with(b"GET /metrics?")
}

/// Binds the address of the metrics.
///
/// # Errors
/// Another program uses the port, or the address is not of this machine.
pub(crate) fn bind(address: SocketAddr) -> std::io::Result<std::net::TcpListener> {
    let listener = std::net::TcpListener::bind(address)?;
    listener.set_nonblocking(true)?;
    Ok(listener)
}

/// A metric: name, help, type, value of a station.
type Metric = (
    &'static str,
    &'static str,
    &'static str,
    fn(&StationStatus) -> f64,
);

const METRICS: [Metric; 15] = [
    (
        "sulcus_session_running",
        "Whether a session runs, with or without its student",
        "gauge",
        |s| f64::from(u8::from(matches!(s.phase, Phase::Running | Phase::Waiting))),
    ),
    (
        "sulcus_student_attached",
        "Whether a student is attached",
        "gauge",
        |s| f64::from(u8::from(matches!(s.phase, Phase::Ready | Phase::Running))),
    ),
    (
        "sulcus_session_seconds",
        "Time of the session without gaps",
        "gauge",
        |s| s.elapsed_ms as f64 / 1e3,
    ),
    ("sulcus_tick", "Newest tick of the session", "gauge", |s| {
        s.tick as f64
    }),
    (
        "sulcus_tick_p99_seconds",
        "CPU time of a tick, 99th percentile of 0.2 s",
        "gauge",
        |s| f64::from(s.tick_p99_us) / 1e6,
    ),
    (
        "sulcus_deadline_misses",
        "Late and skipped ticks of the session",
        "gauge",
        |s| s.deadline_misses as f64,
    ),
    (
        "sulcus_exhausted",
        "Tool-ticks of the session that reached the limit of work",
        "gauge",
        |s| s.exhausted as f64,
    ),
    (
        "sulcus_rows_dropped",
        "Rows of the session that the recorder's queue dropped",
        "gauge",
        |s| s.rows_dropped as f64,
    ),
    (
        "sulcus_frames_dropped",
        "Display frames of the session that a full queue dropped",
        "gauge",
        |s| s.frames_dropped as f64,
    ),
    (
        "sulcus_poses_lost",
        "Pose datagrams of the session that the network lost",
        "gauge",
        |s| s.poses_lost as f64,
    ),
    (
        "sulcus_gaps",
        "Gaps of the session without its student",
        "gauge",
        |s| f64::from(s.gaps),
    ),
    (
        "sulcus_paused",
        "Whether the station's side has paused",
        "gauge",
        |s| f64::from(u8::from(s.paused)),
    ),
    (
        "sulcus_force_newtons",
        "Largest force sent to either hand since the last status",
        "gauge",
        |s| {
            let peaks = s.tools.iter().map(|tool| f64::from(tool.peak_force_n));
            peaks.fold(0.0, f64::max)
        },
    ),
    (
        "sulcus_pose_age_seconds",
        "Age of the older pose of the hands",
        "gauge",
        |s| {
            let ages = s.tools.iter().filter(|tool| tool.present);
            ages.map(|tool| f64::from(tool.pose_age_ms) / 1e3)
                .fold(0.0, f64::max)
        },
    ),
    (
        "sulcus_disk_free_bytes",
        "Free space for recordings: of the disk, or of the quota where that is less",
        "gauge",
        |s| s.disk_free_mib as f64 * f64::from(1 << 20),
    ),
];

/// Metrics in the text format of Prometheus, version 0.0.4.
pub(crate) fn text(statuses: &[StationStatus]) -> String {
    let mut text = String::new();
    for (name, help, kind, value) in METRICS {
        let _ = writeln!(text, "# HELP {name} {help}\n# TYPE {name} {kind}");
        for status in statuses {
            let station = escaped(&status.station);
            let _ = writeln!(text, "{name}{{station=\"{station}\"}} {}", value(status));
        }
    }
    text
}

/// Value of a label: backslash, quote and newline are escaped.
fn escaped(value: &str) -> String {
    value
        .replace('\\', "\\\\")
        .replace('"', "\\\"")
        .replace('\n', "\\n")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_text_has_stations_as_labels_and_no_learner() {
        let mut status = StationStatus {
            station: "chair \"1\"".into(),
            learner: "a7f3".into(),
            phase: Phase::Waiting,
            tick_p99_us: 142.0,
            ..StationStatus::default()
        };
        status.tools[1].peak_force_n = 0.5;
        let text = text(&[status]);
        assert!(
            text.contains("sulcus_session_running{station=\"chair \\\"1\\\"\"} 1\n"),
            "{text}"
        );
        assert!(text.contains("sulcus_student_attached{station=\"chair \\\"1\\\"\"} 0\n"));
        assert!(text.contains("sulcus_force_newtons{station=\"chair \\\"1\\\"\"} 0.5\n"));
        assert!(!text.contains("a7f3"));
        for line in text.lines().filter(|line| !line.starts_with('#')) {
            let (_, value) = line.rsplit_once(' ').expect("a value");
            assert!(value.parse::<f64>().is_ok(), "{line}");
        }
    }

    #[test]
    fn only_the_metrics_are_served_and_a_silent_reader_holds_nobody() {
        let runtime = tokio::runtime::Builder::new_current_thread()
            .enable_all()
            .build()
            .expect("runtime");
        runtime.block_on(async {
            let (door, _behind) = Door::new("a");
            let listener = bind(([127, 0, 0, 1], 0).into()).expect("bound");
            let address = listener.local_addr().expect("address");
            let listener = TcpListener::from_std(listener).expect("listener");
            let serving = tokio::spawn(serve(listener, vec![door]));
            let _silent = TcpStream::connect(address).await.expect("connects");
            let ask = async |request: &str| {
                let mut stream = TcpStream::connect(address).await.expect("connects");
                stream.write_all(request.as_bytes()).await.expect("sent");
                let mut answer = String::new();
                stream.read_to_string(&mut answer).await.expect("read");
                answer
            };
            let answer = ask("GET /metrics HTTP/1.1\r\nHost: x\r\n\r\n").await;
            assert!(answer.starts_with("HTTP/1.1 200 OK"), "{answer}");
            assert!(answer.contains("sulcus_tick{station=\"a\"} 0"), "{answer}");
            for other in [
                "GET / HTTP/1.1\r\n\r\n",
                "POST /metrics HTTP/1.1\r\n\r\n",
                "x\r\n\r\n",
            ] {
                assert!(ask(other).await.starts_with("HTTP/1.1 404"), "{other}");
            }
            serving.abort();
        });
    }
}

//! Wake-up of a network thread by a real-time thread.
//!
//! On Linux a ring is one system call, which never blocks. Elsewhere a ring wakes the task through tokio and can wait
//! for a lock that the listener holds for an instant.

#[cfg(target_os = "linux")]
mod linux;
#[cfg(any(test, not(target_os = "linux")))]
mod portable;

#[cfg(target_os = "linux")]
pub use linux::{Bell, Listening};
#[cfg(not(target_os = "linux"))]
pub use portable::{Bell, Listening};

#[cfg(test)]
mod tests {
    use std::time::Duration;

    use tokio::time::timeout;

    macro_rules! rings {
        ($name:ident, $bell:ty) => {
            #[tokio::test]
            async fn $name() {
                let bell = <$bell>::new().expect("a bell");
                let mut listening = bell.listen().expect("registered");
                let soon = Duration::from_millis(20);
                assert!(timeout(soon, listening.rung()).await.is_err(), "silent");
                // Rings before the listener waits count once.
                bell.ring();
                bell.ring();
                assert!(timeout(soon, listening.rung()).await.is_ok());
                assert!(timeout(soon, listening.rung()).await.is_err(), "silent");
                let other = bell.clone();
                let ringing = std::thread::spawn(move || {
                    std::thread::sleep(Duration::from_millis(5));
                    other.ring();
                });
                assert!(
                    timeout(Duration::from_secs(5), listening.rung())
                        .await
                        .is_ok()
                );
                ringing.join().expect("rung");
            }
        };
    }

    #[cfg(target_os = "linux")]
    rings!(a_ring_wakes_once_on_linux, super::linux::Bell);
    rings!(a_ring_wakes_once_elsewhere, super::portable::Bell);
}

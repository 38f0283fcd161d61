//! 3D mouse by USB HID, read without waiting, for systems without the daemon. Only this file names `hidapi`.
//!
//! On Linux the device file `/dev/hidraw*` must be readable for the person at the screen, by a rule of udev.

use super::record::Event;
use super::report::Reports;

/// Vendor number of 3Dconnexion.
const CONNEXION: u16 = 0x256f;
/// Vendor number of Logitech, and the product numbers of the 3D mice under it (spacenavd, `dev.c`).
const LOGITECH: u16 = 0x046d;
const OLDER: [u16; 11] = [
    0xc603, 0xc605, 0xc606, 0xc621, 0xc623, 0xc625, 0xc626, 0xc627, 0xc628, 0xc629, 0xc62b,
];
/// Largest report, bytes, and most reports of one reading. A mouse sends 125 a second and more.
const LONGEST: usize = 64;
const MOST: usize = 64;

/// Whether a USB device is a 3D mouse, by its vendor and product number.
pub fn is_mouse(vendor: u16, product: u16) -> bool {
    vendor == CONNEXION || vendor == LOGITECH && OLDER.contains(&product)
}

/// 3D mouse.
pub struct Hid {
    device: hidapi::HidDevice,
    reports: Reports,
}

impl Hid {
    /// Opens the first 3D mouse of the system; `None` without one that can be read.
    pub fn open() -> Option<Self> {
        let api = hidapi::HidApi::new().ok()?;
        let mut mice = api
            .device_list()
            .filter(|found| is_mouse(found.vendor_id(), found.product_id()));
        let device = mice.find_map(|found| match found.open_device(&api) {
            Ok(device) => Some(device),
            Err(error) => {
                tracing::warn!("a 3D mouse cannot be opened: {error}");
                None
            }
        })?;
        device.set_blocking_mode(false).ok()?;
        let reports = Reports::new();
        Some(Self { device, reports })
    }

    /// Events since the previous call of this function. The call never waits.
    ///
    /// # Errors
    /// The mouse is gone. The caller must then release the cap: the last deflection would hold for ever.
    pub fn events(&mut self) -> Result<Vec<Event>, String> {
        let device = &self.device;
        let read = |report: &mut [u8]| device.read(report).map_err(|error| error.to_string());
        drain(&mut self.reports, read)
    }
}

/// Events of all reports that wait. `read` fills a buffer with a report and returns its length, 0 without one.
fn drain(
    reports: &mut Reports,
    mut read: impl FnMut(&mut [u8]) -> Result<usize, String>,
) -> Result<Vec<Event>, String> {
    let (mut events, mut report) = (Vec::new(), [0; LONGEST]);
    for _ in 0..MOST {
        let length = read(&mut report)?;
        let Some(report) = report.get(..length).filter(|report| !report.is_empty()) else {
            break;
        };
        reports.feed(report, &mut events);
    }
    Ok(events)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::camera::Vector;
    use crate::hand::pose::Turn;
    use crate::hand::spacenav::CapRule;
    use crate::hand::{Board, Hand, HandPose, Hands, Limits, Scales};

    #[test]
    fn the_tool_follows_reports_and_rests_when_they_end() {
        let home = HandPose {
            position: Vector::zeros(),
            orientation: Turn::identity(),
        };
        let limits = Limits::around([Vector::zeros()], 90.0);
        let hand = Hand::new(home, Vector::zeros(), limits);
        let mut hands = Hands::new([Some(hand), None], Scales::default());
        let (mut board, mut reports) = (Board::new(), Reports::new());
        // Reports of a SpaceNavigator: buttons, then x = 350, then the turns.
        let mut waiting = vec![
            vec![3, 1],
            vec![1, 0x5e, 0x01, 0, 0, 0, 0],
            vec![2, 0, 0, 0, 0, 0, 0],
        ]
        .into_iter();
        let read = |buffer: &mut [u8]| {
            let report: Vec<u8> = waiting.next().unwrap_or_default();
            buffer[..report.len()].copy_from_slice(&report);
            Ok(report.len())
        };
        let events = drain(&mut reports, read).expect("a mouse");
        for event in &events {
            CapRule::default().act(event, &mut board, &mut hands);
        }
        for _ in 0..500 {
            hands.advance(1e-3);
        }
        let moved = hands.pose(0).expect("a tool").position;
        assert!(
            (moved - Vector::new(0.0, 30.0, 0.0)).norm() < 1e-6,
            "{moved}"
        );
        assert_eq!(drain(&mut reports, |_| Ok(0)), Ok(vec![]));
        assert!(drain(&mut reports, |_| Err("gone".into())).is_err());
    }

    #[test]
    fn a_flood_of_reports_ends() {
        let mut read = 0;
        let flood = |buffer: &mut [u8]| {
            read += 1;
            buffer[..7].copy_from_slice(&[1, 1, 0, 0, 0, 0, 0]);
            Ok(7)
        };
        let events = drain(&mut Reports::new(), flood).expect("a mouse");
        assert_eq!((events.len(), read), (MOST, MOST));
    }

    #[test]
    fn mice_are_known_by_their_numbers() {
        // SpaceMouse Compact, SpaceNavigator, and a plain mouse of Logitech.
        assert!(is_mouse(0x256f, 0xc635) && is_mouse(0x046d, 0xc626));
        assert!(!is_mouse(0x046d, 0xc077) && !is_mouse(0, 0xc626));
    }
}

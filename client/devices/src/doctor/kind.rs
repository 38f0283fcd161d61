//! Known devices by the USB numbers of their vendor and product.

/// Device node through which a library reaches a device.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Node {
    /// Serial line: `/dev/ttyACM*`.
    Serial,
    /// Raw human interface device: `/dev/hidraw*`.
    HidRaw,
    /// The device on its bus: `/dev/bus/usb/BUS/NUMBER`.
    Bus,
    /// Serial line or raw device if there is one, else the device on its bus: a product that is not known.
    Any,
}

/// Kind of a known device.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Kind {
    /// Name for people.
    pub label: &'static str,
    /// Back-end; `None` for a device without force.
    pub library: Option<&'static str>,
    /// Node that must be readable and writable.
    pub node: Node,
    /// Whether a udev rule may name the vendor alone: the vendor makes nothing but force devices.
    pub whole_vendor: bool,
}

const SYSTEMS_3D: u16 = 0x2988;
const FORCE_DIMENSION: u16 = 0x1451;
/// 3D mice with six axes under the number of 3Dconnexion, receivers included.
const CONNEXION: [u16; 10] = [
    0xc62e, 0xc62f, 0xc631, 0xc632, 0xc633, 0xc635, 0xc636, 0xc638, 0xc63a, 0xc652,
];
/// 3D mice with six axes under the number of Logitech.
const LOGITECH: [u16; 11] = [
    0xc603, 0xc605, 0xc606, 0xc621, 0xc623, 0xc625, 0xc626, 0xc627, 0xc628, 0xc629, 0xc62b,
];

/// Kind of a device; `None` for a device that is none of ours. The number of a Haply device is not known.
pub fn kind(vendor: u16, product: u16) -> Option<Kind> {
    let touch = |label, node, whole_vendor| Kind {
        label,
        library: Some("openhaptics"),
        node,
        whole_vendor,
    };
    let force = |label, whole_vendor| Kind {
        label,
        library: Some("forcedimension"),
        node: Node::Bus,
        whole_vendor,
    };
    let mouse = Kind {
        label: "3D mouse",
        library: None,
        node: Node::HidRaw,
        whole_vendor: false,
    };
    match (vendor, product) {
        (SYSTEMS_3D, 0x0302) => Some(touch("Touch USB", Node::Serial, true)),
        (SYSTEMS_3D, 0x0304) => Some(touch("Touch HID", Node::HidRaw, true)),
        (SYSTEMS_3D, _) => Some(touch("3D Systems device", Node::Any, true)),
        // Touch devices of 2016 report vendor and product the other way round (jhu-saw/sawSensablePhantom, README).
        (0x0301, SYSTEMS_3D) => Some(touch("Touch USB of 2016", Node::Serial, false)),
        (FORCE_DIMENSION, _) => Some(force("Force Dimension device", true)),
        (0x0403, 0xcb48) => Some(force("Novint Falcon", false)),
        (0x256f, product) if CONNEXION.contains(&product) => Some(mouse),
        (0x046d, product) if LOGITECH.contains(&product) => Some(mouse),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn known_numbers_have_a_back_end_and_a_node() {
        let of = |vendor, product| kind(vendor, product).map(|kind| (kind.library, kind.node));
        assert_eq!(
            of(0x2988, 0x0302),
            Some((Some("openhaptics"), Node::Serial))
        );
        assert_eq!(
            of(0x0301, 0x2988),
            Some((Some("openhaptics"), Node::Serial))
        );
        assert_eq!(
            of(0x2988, 0x0304),
            Some((Some("openhaptics"), Node::HidRaw))
        );
        assert_eq!(of(0x2988, 0x0999), Some((Some("openhaptics"), Node::Any)));
        assert_eq!(
            of(0x1451, 0x0402),
            Some((Some("forcedimension"), Node::Bus))
        );
        assert_eq!(
            of(0x0403, 0xcb48),
            Some((Some("forcedimension"), Node::Bus))
        );
        assert_eq!(of(0x256f, 0xc635), Some((None, Node::HidRaw)));
        assert_eq!(of(0x046d, 0xc62b), Some((None, Node::HidRaw)));
    }

    #[test]
    fn a_keyboard_of_the_same_vendor_is_no_device() {
        assert_eq!(kind(0x046d, 0xc31c), None);
        assert_eq!(kind(0x256f, 0xc650), None);
        assert_eq!(kind(0x0403, 0x6001), None);
    }

    #[test]
    fn a_rule_names_a_vendor_alone_only_where_all_its_products_are_force_devices() {
        for (vendor, product, whole) in [
            (0x2988, 0x0302, true),
            (0x1451, 0x0402, true),
            (0x0403, 0xcb48, false),
            (0x046d, 0xc62b, false),
        ] {
            assert_eq!(
                kind(vendor, product).map(|kind| kind.whole_vendor),
                Some(whole)
            );
        }
    }
}

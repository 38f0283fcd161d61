//! Couplings of a session: for each tool the smaller stiffness of the scene's coupling and the device's.
//!
//! A device displays only a limited stiffness without a buzz. A softer coupling gives way more and stays quiet. The
//! couplings are chosen once, when the session begins, because every later replay needs them.

use sulcus_core::math::fmax;
use sulcus_core::{Coupling, Scene};
use sulcus_proto::control::DeviceInfo;

/// Couplings of a session in `scene`, in the order of its tools. `devices` are those of the slots; a slot without a
/// device, and a device with unknown coupling, leave the scene's.
pub(crate) fn in_force(scene: &Scene, devices: &[DeviceInfo]) -> Vec<Coupling> {
    let of = |(slot, tool)| {
        let own = Coupling::of(tool);
        match devices.get(slot).and_then(displayed) {
            Some(most) => own.softer(most),
            None => own,
        }
    };
    scene.tools.iter().enumerate().map(of).collect()
}

/// Reason why the devices cannot display couplings that are in force; `None` if they can. One sentence.
pub(crate) fn too_stiff(
    scene: &Scene,
    in_force: &[Coupling],
    devices: &[DeviceInfo],
) -> Option<String> {
    let mut tools = scene.tools.iter().zip(in_force).zip(devices);
    tools.find_map(|((tool, coupling), device)| {
        let most = displayed(device)?;
        let (found, expected, unit) = if coupling.n_per_m > most.n_per_m {
            (coupling.n_per_m, most.n_per_m, "N/m")
        } else if coupling.nm_per_rad > most.nm_per_rad {
            (coupling.nm_per_rad, most.nm_per_rad, "N m/rad")
        } else {
            return None;
        };
        Some(format!(
            "the running session has a coupling of {found} {unit} for the {}, and device `{}` displays at most \
             {expected} {unit}; return with the device of the session's beginning",
            tool.name,
            crate::net::hello::clean(&device.name)
        ))
    })
}

/// Stiffest coupling that a device displays; infinite where a device without force or torque limits none.
fn displayed(device: &DeviceInfo) -> Option<Coupling> {
    let coupling = device.coupling?;
    let of = |limit: f32, [least, _]: [f64; 2]| match limit {
        0.0 => f64::INFINITY,
        // The least f32 may be below the least f64 of a scene.
        limit => fmax(f64::from(limit), least),
    };
    Some(Coupling {
        n_per_m: of(coupling.n_per_m, Coupling::N_PER_M),
        nm_per_rad: of(coupling.nm_per_rad, Coupling::NM_PER_RAD),
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::session::simulation::tests::scene;
    use sulcus_proto::control::DeviceCoupling;

    fn device(n_per_m: f32, nm_per_rad: f32) -> DeviceInfo {
        DeviceInfo {
            coupling: Some(DeviceCoupling {
                n_per_m,
                nm_per_rad,
            }),
            ..DeviceInfo::named("stylus")
        }
    }

    #[test]
    fn the_softer_of_scene_and_device_is_in_force_on_each_kind_of_axis() {
        let scene = scene();
        let own = Coupling::of(&scene.tools[0]);
        for (devices, expected) in [
            (vec![], own),
            (vec![DeviceInfo::named("unknown")], own),
            (vec![device(1e5, 1e3)], own),
            (
                vec![device(250.0, 0.0)],
                Coupling {
                    n_per_m: 250.0,
                    ..own
                },
            ),
            (
                vec![device(0.0, 0.125)],
                Coupling {
                    nm_per_rad: 0.125,
                    ..own
                },
            ),
            // A device of a slot without a tool has no effect.
            (vec![DeviceInfo::default(), device(1.0, 1e-4)], own),
        ] {
            let found = in_force(&scene, &devices);
            assert_eq!(found[0], expected, "{devices:?}");
            assert!(scene.with_couplings(&found).is_ok());
            assert_eq!(too_stiff(&scene, &found, &devices), None);
        }
        // The least values of a device are valid couplings of a scene.
        let least = device(DeviceCoupling::N_PER_M[0], DeviceCoupling::NM_PER_RAD[0]);
        let found = in_force(&scene, std::slice::from_ref(&least));
        assert!(scene.with_couplings(&found).is_ok(), "{found:?}");
        assert_eq!(too_stiff(&scene, &found, &[least]), None);
    }

    #[test]
    fn a_weaker_device_cannot_return_to_a_stiffer_session() {
        let scene = scene();
        let found = in_force(&scene, &[device(400.0, 0.25)]);
        assert_eq!(too_stiff(&scene, &found, &[device(401.0, 0.0)]), None);
        assert_eq!(too_stiff(&scene, &found, &[DeviceInfo::named("old")]), None);
        let said = too_stiff(&scene, &found, &[device(399.0, 0.25)]).expect("too stiff");
        assert!(
            said.contains("400 N/m") && said.contains("at most 399 N/m"),
            "{said}"
        );
        let said = too_stiff(&scene, &found, &[device(400.0, 0.125)]).expect("too stiff");
        assert!(said.contains("0.25 N m/rad"), "{said}");
    }
}

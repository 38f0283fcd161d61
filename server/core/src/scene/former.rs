//! Former layout of a compiled scene, version 7, and its migration.
//!
//! Recordings contain their scenes and must replay bit for bit. A parameter that version 7 lacks therefore gets the
//! value of the former behaviour, not the present default. All other parts have the present layout.

use serde::Deserialize;

use super::{Object, Tool};
use crate::optimise::SolverKind;
use crate::scene::params::Params as Present;

/// Version of this layout.
pub(super) const VERSION: u16 = 7;

/// Scene of version 7, in the order of its fields.
#[derive(Deserialize)]
#[cfg_attr(test, derive(serde::Serialize))]
pub(super) struct Scene {
    name: String,
    source_hash: String,
    params: Params,
    tools: Vec<Tool>,
    objects: Vec<Object>,
}

/// Parameters of version 7, in the order of their fields; see [`Present`].
#[derive(Deserialize)]
#[cfg_attr(test, derive(serde::Serialize))]
struct Params {
    rate_hz: u16,
    predict_min: f64,
    predict_max: f64,
    predict_gain: f64,
    predict_bias: f64,
    trust: f64,
    max_substeps: u8,
    converged_step: f64,
    converged_gap: f64,
    contact_compliance: f64,
    solver: SolverKind,
    max_iterations: u16,
    max_contacts: u16,
    blend: bool,
    max_hand_speed: f64,
    max_hand_spin: f64,
    max_force: f64,
    max_torque: f64,
    max_force_step: f64,
    max_torque_step: f64,
    max_settle_step: f64,
    ramp_up_ms: u16,
    ramp_down_ms: u16,
}

impl From<Scene> for super::Scene {
    fn from(scene: Scene) -> Self {
        let Scene {
            name,
            source_hash,
            params,
            tools,
            objects,
        } = scene;
        Self {
            name,
            source_hash,
            params: params.into(),
            tools,
            objects,
        }
    }
}

impl From<Params> for Present {
    fn from(params: Params) -> Self {
        // Every field is named: a new parameter does not compile until its former behaviour is decided here.
        Self {
            rate_hz: params.rate_hz,
            predict_min: params.predict_min,
            predict_max: params.predict_max,
            predict_gain: params.predict_gain,
            predict_bias: params.predict_bias,
            trust: params.trust,
            max_substeps: params.max_substeps,
            converged_step: params.converged_step,
            converged_gap: params.converged_gap,
            contact_compliance: params.contact_compliance,
            solver: params.solver,
            max_iterations: params.max_iterations,
            max_contacts: params.max_contacts,
            blend: params.blend,
            max_hand_speed: params.max_hand_speed,
            max_hand_spin: params.max_hand_spin,
            max_force: params.max_force,
            max_torque: params.max_torque,
            max_force_step: params.max_force_step,
            max_torque_step: params.max_torque_step,
            max_settle_step: params.max_settle_step,
            ramp_up_ms: params.ramp_up_ms,
            ramp_down_ms: params.ramp_down_ms,
            max_arrival_step: 0.0,
            max_work: 0,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::{MAGIC, Scene as PresentScene, SceneError};
    use super::*;
    use xxhash_rust::xxh3::xxh3_64;

    /// Returns the scene as version 7 wrote it.
    fn written(scene: &PresentScene, version: u16) -> Vec<u8> {
        let p = &scene.params;
        let former = Scene {
            name: scene.name.clone(),
            source_hash: scene.source_hash.clone(),
            params: Params {
                rate_hz: p.rate_hz,
                predict_min: p.predict_min,
                predict_max: p.predict_max,
                predict_gain: p.predict_gain,
                predict_bias: p.predict_bias,
                trust: p.trust,
                max_substeps: p.max_substeps,
                converged_step: p.converged_step,
                converged_gap: p.converged_gap,
                contact_compliance: p.contact_compliance,
                solver: p.solver,
                max_iterations: p.max_iterations,
                max_contacts: p.max_contacts,
                blend: p.blend,
                max_hand_speed: p.max_hand_speed,
                max_hand_spin: p.max_hand_spin,
                max_force: p.max_force,
                max_torque: p.max_torque,
                max_force_step: p.max_force_step,
                max_torque_step: p.max_torque_step,
                max_settle_step: p.max_settle_step,
                ramp_up_ms: p.ramp_up_ms,
                ramp_down_ms: p.ramp_down_ms,
            },
            tools: scene.tools.clone(),
            objects: scene.objects.clone(),
        };
        let body = bincode::serde::encode_to_vec(&former, bincode::config::standard());
        let body = body.expect("encodes");
        let mut bytes = MAGIC.to_vec();
        bytes.extend_from_slice(&version.to_le_bytes());
        bytes.extend_from_slice(&xxh3_64(&body).to_le_bytes());
        bytes.extend_from_slice(&body);
        bytes
    }

    #[test]
    fn a_scene_of_version_7_keeps_its_ramp_and_has_no_bound() {
        let mut scene = crate::tick::tests::scene_of_a_ball();
        scene.params.ramp_up_ms = 123;
        let read = PresentScene::from_bytes(&written(&scene, VERSION)).expect("read");
        let mut expected = scene.clone();
        expected.params.max_arrival_step = 0.0;
        expected.params.max_work = 0;
        assert_eq!(read, expected);
        // Written anew, the scene has the present version and the same content.
        let anew = read.to_bytes().expect("small");
        assert_eq!(PresentScene::from_bytes(&anew), Ok(read));
    }

    #[test]
    fn the_layouts_are_not_mistaken_for_one_another() {
        let scene = crate::tick::tests::scene_of_a_ball();
        let as_present = written(&scene, super::super::SCENE_VERSION);
        assert!(PresentScene::from_bytes(&as_present).is_err());
        for unknown in [0, 6, super::super::SCENE_VERSION + 1] {
            assert_eq!(
                PresentScene::from_bytes(&written(&scene, unknown)),
                Err(SceneError::Version { found: unknown })
            );
        }
    }
}

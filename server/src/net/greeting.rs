//! Hello of a server to a student: plan, scene, limits and tools.

use sulcus_core::Coupling;
use sulcus_proto::control::{PlanInfo, ServerHello, ToolInfo, capability};
use sulcus_proto::datagram::WirePose;

use crate::station::config::SessionPlan;

/// Hello to a student whose connection has an epoch and may continue a running session, with the couplings in force.
/// The pair is the station's name and the hash of the machine's tick self-test.
pub(crate) fn server_hello(
    plan: &SessionPlan,
    couplings: &[Coupling],
    (station, self_test): (&str, u64),
    (epoch, resumed, at_hand): (u32, bool, Result<bool, &str>),
) -> ServerHello {
    let scene = &plan.scene;
    let tools = scene.tools.iter().zip(couplings).map(|(tool, coupling)| {
        let (p, q) = (&tool.park.position, &tool.park.orientation);
        ToolInfo {
            name: tool.name.clone(),
            park: WirePose {
                position: [p.x as f32, p.y as f32, p.z as f32],
                orientation: [q.w as f32, q.i as f32, q.j as f32, q.k as f32],
            },
            tip: [tool.tip.x as f32, tool.tip.y as f32, tool.tip.z as f32],
            stiffness_n_per_m: coupling.n_per_m,
            stiffness_nm_per_rad: coupling.nm_per_rad,
        }
    });
    let limit_s = plan.max_session.map_or(0, |limit| limit.as_secs());
    ServerHello {
        program: env!("CARGO_PKG_VERSION").to_owned(),
        station: station.to_owned(),
        epoch,
        resumed,
        plan: PlanInfo {
            revision: plan.revision,
            mode: plan.mode.name().to_owned(),
            time_limit_s: u32::try_from(limit_s).unwrap_or(u32::MAX),
            resume_within_ms: u32::try_from(plan.resume_within.as_millis()).unwrap_or(u32::MAX),
            clock_in_gap: plan.clock_in_gap,
            tick_at_hand: at_hand == Ok(true),
            tick_remark: at_hand.err().unwrap_or_default().to_owned(),
        },
        capabilities: capability::TICK_AT_HAND,
        self_test,
        tick_ns: scene.params.tick_ns(),
        scene: scene.name.clone(),
        scene_hash: *blake3::hash(&plan.scene_bytes).as_bytes(),
        exercise: plan.exercise.name.clone(),
        exercise_text: plan.exercise.text.clone(),
        max_force_n: scene.params.max_force as f32,
        max_torque_nm: scene.params.max_torque as f32,
        max_force_step_n: scene.params.max_force_step as f32,
        max_torque_step_nm: scene.params.max_torque_step as f32,
        tools: tools.collect(),
    }
}

//! Tick as numbers and as a picture.

use std::collections::BTreeMap;

use crate::review::{Arrow, FramePicture, Numbers, PartKind, Standing, ToolStanding};
use sulcus_core::math::norm;
use sulcus_core::output::{ForceZone, status};
use sulcus_core::tissue::TissueModel;
use sulcus_core::{Pose, Scene, TickInput, TickOutput, ToolOutput, Vec3, Workspace};

use super::follow::{ALONG, Follow};
use super::picture::{kind_of, outward, probe_of};
use super::units::{millimetres, plain};
use sulcus_sessions::record::channels::FRAMES_HZ;

/// Least load of a contact that is drawn, N.
const LEAST_N: f64 = 0.005;
/// Least distance between the hand's tip or grip and the instrument's at which the hand is drawn, metres.
const APART: f64 = 1e-4;

/// Data that turn ticks into numbers and pictures.
pub(super) struct Eyes {
    probe: usize,
    kinds: Vec<PartKind>,
    follow: Follow,
    /// Longest tick since the message before, microseconds, by tick.
    times: BTreeMap<u64, f64>,
    /// Ticks within which the message for a tick follows, if none was dropped, with a margin for skipped ticks.
    message_ticks: u64,
}

impl Eyes {
    pub fn new(scene: &Scene, times: BTreeMap<u64, f64>) -> Self {
        let probe = probe_of(scene);
        let park = &scene.tools[probe].park;
        let away = outward(scene, &park.transform(&scene.tools[probe].tip));
        Self {
            probe,
            kinds: scene.objects.iter().map(kind_of).collect(),
            follow: Follow::new(libm::atan2(away.y, away.x)),
            times,
            message_ticks: scene.params.ticks_in(2.0 / FRAMES_HZ),
        }
    }

    /// Moves the close-up's frame, `step_s` after the last time.
    pub fn follow(&mut self, scene: &Scene, output: &TickOutput, step_s: f64) {
        let (tool, out) = (&scene.tools[self.probe], &output.tools[self.probe]);
        let tip = out.graphic.transform(&tool.tip);
        let towards = out.pocket.as_ref().and_then(|reading| {
            let object = scene.objects.get(usize::from(reading.object))?;
            let TissueModel::Gingiva(gingiva) = &object.tissue else {
                return None;
            };
            let (sin, cos) = (libm::sin(reading.around), libm::cos(reading.around));
            let side = if sin < 0.0 { -1.0 } else { 1.0 };
            let towards = gingiva.tooth.buccal * side + gingiva.tooth.mesial * (ALONG * cos);
            Some(libm::atan2(towards.y, towards.x))
        });
        self.follow.step(tip, towards, step_s);
    }

    /// Zone of the probe's force, while the tip is in a pocket.
    pub fn zone(&self, output: &TickOutput) -> Option<ForceZone> {
        output.tools[self.probe].pocket.map(|reading| reading.zone)
    }

    /// Pocket of the tip: the gingiva's object, and whether the tip is on the buccal side.
    pub fn side(&self, scene: &Scene, output: &TickOutput) -> Option<(u16, bool)> {
        let reading = output.tools[self.probe].pocket.as_ref()?;
        match &scene.objects.get(usize::from(reading.object))?.tissue {
            TissueModel::Gingiva(gingiva) => {
                let site = gingiva.site_at(reading.around);
                Some((reading.object, site.is_buccal()))
            }
            _ => None,
        }
    }

    /// Numbers of a tick.
    pub fn numbers(&self, scene: &Scene, input: &TickInput, output: &TickOutput) -> Numbers {
        let tools = || held(scene, input, output);
        let size = |of: fn(&ToolOutput) -> Vec3, scale: f64| {
            tools()
                .map(|tool| tool.map_or(0.0, |tool| norm(&of(tool)) * scale))
                .collect()
        };
        let reading = output.tools[self.probe].pocket;
        let prescribed = reading.as_ref().and_then(|reading| {
            match &scene.objects.get(usize::from(reading.object))?.tissue {
                TissueModel::Gingiva(gingiva) => {
                    Some(gingiva.prescribed(gingiva.site_at(reading.around)).depth)
                }
                _ => None,
            }
        });
        let mm = |metres: Option<f64>| metres.map_or(f64::NAN, |metres| metres * 1e3);
        let sum = |of: fn(&ToolOutput) -> f64| tools().flatten().map(of).sum::<f64>();
        Numbers {
            force_n: size(|tool| tool.wrench.force, 1.0),
            torque_nmm: size(|tool| tool.wrench.torque, 1e3),
            depth_mm: mm(reading.map(|reading| reading.depth)),
            prescribed_mm: mm(prescribed),
            floor_n: reading.map_or(0.0, |reading| reading.floor_force),
            work: vec![
                sum(|tool| f64::from(tool.substeps)),
                sum(|tool| f64::from(tool.rows)),
                // The message for this tick; none if messages for viewers were dropped.
                self.times
                    .range(output.tick..=output.tick + self.message_ticks)
                    .next()
                    .map_or(f64::NAN, |(_, longest)| *longest),
            ],
        }
    }

    /// Picture of a tick.
    pub fn frame(
        &self,
        scene: &Scene,
        input: &TickInput,
        output: &TickOutput,
        ws: &Workspace,
    ) -> FramePicture {
        let mut contacts = vec![Vec::new(); scene.tools.len()];
        // Sums for each tool: of the forces, and of the places weighted by load.
        let mut sums = vec![(Vec3::zeros(), Vec3::zeros(), 0.0); scene.tools.len()];
        for (contact, load) in ws.contacts() {
            let slot = usize::from(contact.tool);
            let (Some(tool), Some(sum)) = (scene.tools.get(slot), sums.get_mut(slot)) else {
                continue;
            };
            let Some(node) = tool.tree.nodes().get(contact.tool_sphere as usize) else {
                continue;
            };
            let sphere = node.sphere();
            let centre = output.tools[slot].graphic.transform(&sphere.centre);
            let at = centre - contact.normal * sphere.radius;
            let force = contact.normal * load;
            sum.0 += force;
            sum.1 += at * load;
            sum.2 += load;
            let kind = self.kinds.get(usize::from(contact.object));
            if load >= LEAST_N {
                contacts[slot].push(Arrow {
                    at: millimetres(&at),
                    force_n: plain(&force),
                    by: kind.copied().unwrap_or(PartKind::Other),
                });
            }
        }
        let tools = held(scene, input, output).enumerate().map(|(k, out)| {
            let (out, tool) = (out?, &scene.tools[k]);
            let tips = [&out.graphic, &out.haptic].map(|pose| pose.transform(&tool.tip));
            let grips = norm(&(out.haptic.position - out.graphic.position));
            let apart = norm(&(tips[1] - tips[0])) > APART || grips > APART;
            let (force, places, load) = sums[k];
            Some(ToolStanding {
                graphic: standing(&out.graphic),
                haptic: apart.then(|| standing(&out.haptic)),
                tips: tips.map(|tip| millimetres(&tip)),
                push: (norm(&force) >= LEAST_N && load > 0.0).then(|| Arrow {
                    at: millimetres(&(places / load)),
                    force_n: plain(&force),
                    by: PartKind::Other,
                }),
            })
        });
        FramePicture {
            tools: tools.collect(),
            contacts,
            close_up: self.follow.standing(),
        }
    }
}

/// Output of each of the scene's tools; `None` for a tool that no hand holds.
fn held<'a>(
    scene: &Scene,
    input: &TickInput,
    output: &'a TickOutput,
) -> impl Iterator<Item = Option<&'a ToolOutput>> {
    let tools = input.tools.iter().zip(&output.tools);
    let tools = tools
        .map(|(asked, said)| (asked.present && said.status & status::ABSENT == 0).then_some(said));
    tools
        .take(scene.tools.len())
        .collect::<Vec<_>>()
        .into_iter()
}

fn standing(pose: &Pose) -> Standing {
    let q = pose.orientation.coords;
    Standing {
        at: millimetres(&pose.position),
        turned: [q.x, q.y, q.z, q.w].map(|x| x as f32),
    }
}

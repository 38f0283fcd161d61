//! Our tick as an engine.

use std::rc::Rc;

use sulcus_cases::Observer;
use sulcus_core::{
    DisplaySkin, NoProbe, Pose, Scene, State, TickInput, TickOutput, Vec3, Workspace, tick,
};
use sulcus_operator::present;

use crate::engine::{Engine, Residual, Shown};

/// A scene with one tool and one object, and what has been asked of it.
pub struct Ours {
    scene: Rc<Scene>,
    state: State,
    ws: Workspace,
    input: TickInput,
    out: Option<TickOutput>,
    observer: Observer,
    skin: Rc<Skin>,
}

/// Points of the surface, and who carries them.
#[derive(Default)]
pub struct Skin {
    points: Vec<Vec3>,
    carried: DisplaySkin,
}

impl Skin {
    /// Of these points of the scene's object.
    pub fn new(scene: &Scene, points: &[Vec3]) -> Self {
        let object = &scene.objects[0];
        let (tree, tissue) = (&object.tree, &object.tissue);
        Self {
            points: points.to_vec(),
            carried: DisplaySkin::of_tissue(tree, object.level, tissue, points),
        }
    }
}

impl Ours {
    /// At the first tick. The observer looks at every tick that it is shown.
    pub fn new(scene: &Rc<Scene>, skin: &Rc<Skin>) -> Self {
        Self {
            state: State::new(scene),
            ws: Workspace::new(scene),
            input: TickInput::IDLE,
            out: None,
            observer: Observer::new(scene),
            scene: Rc::clone(scene),
            skin: Rc::clone(skin),
        }
    }
}

impl Engine for Ours {
    fn aim(&mut self, hand: &Pose) {
        self.input.tools[0] = present(hand);
    }

    fn step(&mut self) {
        let (state, ws) = (&mut self.state, &mut self.ws);
        self.out = Some(tick(&self.scene, state, ws, &self.input, &mut NoProbe));
    }

    fn shown(&self) -> Shown {
        let tool = &self.out.as_ref().expect("a tick was made").tools[0];
        // The raw force: what is sent is limited to what a device can do.
        Shown {
            pose: tool.graphic,
            force: tool.raw_wrench.force,
        }
    }

    fn surface(&self, points: &mut Vec<Vec3>) {
        points.clone_from(&self.skin.points);
        if points.is_empty() {
            return;
        }
        let mut moved = vec![Vec3::zeros(); points.len()];
        let carriers = self.ws.carriers_moved(&self.scene, 0);
        self.skin.carried.displacements(&carriers, &mut moved);
        for (point, moved) in points.iter_mut().zip(&moved) {
            *point += moved;
        }
    }

    fn observe(&mut self) {
        let out = self.out.as_ref().expect("a tick was made");
        self.observer
            .observe(&self.scene, &self.input, out, &self.ws);
    }

    fn residual(&self) -> Option<Residual> {
        let measures = self.observer.measures();
        Some(Residual {
            converged: measures.residual,
            exhausted: measures.exhausted_residual,
            exhausted_ticks: measures.exhausted,
        })
    }
}

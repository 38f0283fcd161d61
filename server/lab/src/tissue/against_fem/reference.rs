//! What finite elements say of the program's own tongue: the reference that its models are held against.

use std::sync::Mutex;
use std::sync::mpsc::{Sender, channel};

use anyhow::{Context, anyhow};
use sulcus_core::tissue::TissueModel;
use sulcus_core::{Object, Vec3};
use sulcus_fem::{Elastic, Factored, NewtonOptions, NewtonProgress, solve_neo_hookean};
use sulcus_program::PathText;
use sulcus_scene::file::{ObjectEntry, ObjectKind, parse};
use sulcus_scene::mesh::distance::MeshDistance;
use sulcus_scene::organ::{SurfaceOptions, elements};
use sulcus_scene::{BuildOptions, BuiltIn, compile_built_in};

use super::pushes::PUSHES;
use crate::tissue::organ::{LEVEL, Organ};

/// Edge of the reference's lattice, as a share of that of the elements which the shipped tongue is condensed from: finer, and
/// cut by the surface at other places, so that what the shipped elements get wrong shows. On the same lattice the surface
/// compliance misses less, by 0.3 to 2.8 % of the displacement. Much finer takes minutes.
const FINER: f64 = 0.9;
/// The load comes on in steps of at most so many newtons.
const STEP: f64 = 0.2;
/// Share of the load that may be out of balance: a hundredth of what the best model misses, or less.
const LEFT: f64 = 1e-4;
/// Solutions at a time: each takes some hundred megabytes.
const AT_ONCE: usize = 2;

/// The law by which the reference answers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Law {
    /// Small displacements.
    Linear,
    /// A solid that large ones stretch and turn.
    NeoHookean,
}

/// The tongue of the built-in scenes, with the elements of its reference.
pub(crate) struct Tongue {
    /// The elements, the free vertices of their surface, and the tree that both models stand on.
    pub(crate) organ: Organ,
    /// As `organ.toml` has it.
    pub(crate) surface: TissueModel,
    /// As `tongue.toml` has it.
    pub(crate) skeleton: TissueModel,
    /// What the shipped elements are of, and the reference's.
    pub(super) material: Elastic,
}

/// One load and what the reference says to it.
pub(crate) struct Reference {
    /// What pushes, for people.
    pub(crate) push: &'static str,
    /// By which law.
    pub(crate) law: Law,
    /// All of it, newtons.
    pub(crate) force: f64,
    /// Forces on the vertices of the surface, newtons.
    pub(crate) forces: Vec<Vec3>,
    /// Displacements of the vertices of the surface, metres.
    pub(crate) moved: Vec<Vec3>,
}

impl Tongue {
    /// The tongue of the built-in scenes.
    ///
    /// # Errors
    /// Only if the program was built from a broken source.
    pub(crate) fn built_in(progress: &dyn Fn(&str, f64)) -> anyhow::Result<Self> {
        let [(entry, of_organ), (_, of_tongue)] = [
            shipped(BuiltIn::Organ, &|what, share| progress(what, 0.6 * share))?,
            shipped(BuiltIn::Tongue, &|what, share| {
                progress(what, 0.6 + 0.2 * share);
            })?,
        ];
        if of_organ.tree != of_tongue.tree || of_organ.level != LEVEL || of_tongue.level != LEVEL {
            return Err(anyhow!(
                "organ.toml and tongue.toml have different trees or levels, expected the same tongue at level {LEVEL}"
            ));
        }
        let shipped: SurfaceOptions = entry.surface.unwrap_or_default();
        let fine = SurfaceOptions {
            element_mm: shipped.element_mm * FINER,
            ..shipped.clone()
        };
        let surface = MeshDistance::new(entry.tongue.unwrap_or_default().mesh());
        let elements = elements(&surface, &fine, "".as_ref(), &|what, share| {
            progress(what, 0.8 + 0.2 * share);
        })?;
        Ok(Self {
            organ: Organ::of(elements, "reference of the tongue", |_| Ok(of_organ.tree))?,
            surface: of_organ.tissue,
            skeleton: of_tongue.tissue,
            material: Elastic {
                young: shipped.young_kpa * 1e3,
                poisson: shipped.poisson,
            },
        })
    }

    /// The loads with what the reference says to them: all, or with `quick` the first push, moderate, neo-Hookean.
    ///
    /// # Errors
    /// If an equilibrium is not found.
    pub(crate) fn references(
        &self,
        quick: bool,
        progress: &dyn Fn(&str, f64),
    ) -> anyhow::Result<Vec<Reference>> {
        let (pushes, sizes) = if quick {
            (&PUSHES[..1], 1)
        } else {
            (&PUSHES[..], usize::MAX)
        };
        let mut all = Vec::new();
        for push in pushes {
            let (on_nodes, on_vertices) = push.one_newton(&self.organ)?;
            let asked = |law, force: f64| Asked {
                reference: Reference {
                    push: push.name,
                    law,
                    force,
                    forces: on_vertices.iter().map(|f| f * force).collect(),
                    moved: Vec::new(),
                },
                load: on_nodes.iter().map(|f| f * force).collect(),
            };
            if !quick {
                all.push(asked(Law::Linear, push.forces[0]));
            }
            let forces = push.forces.iter().take(sizes);
            all.extend(forces.map(|force| asked(Law::NeoHookean, *force)));
        }
        self.answer(&mut all, progress)?;
        Ok(all.into_iter().map(|asked| asked.reference).collect())
    }

    /// Answers all, two at a time: each takes seconds of one processor.
    fn answer(&self, all: &mut [Asked], progress: &dyn Fn(&str, f64)) -> anyhow::Result<()> {
        let count = all.len() as f64;
        let mut open: Vec<&mut Asked> = all.iter_mut().collect();
        // Those that take longest first.
        open.sort_by(|a, b| a.weight().total_cmp(&b.weight()));
        let open = Mutex::new(open);
        let next = || open.lock().ok().and_then(|mut open| open.pop());
        let work = |said: Sender<f64>| {
            while let Some(asked) = next() {
                let of = asked.reference.push;
                self.solve(asked, &said)
                    .with_context(|| format!("reference of `{of}`"))?;
            }
            anyhow::Ok(())
        };
        let (said, heard) = channel();
        std::thread::scope(|scope| {
            let workers: Vec<_> = (0..AT_ONCE)
                .map(|_| {
                    let (work, said) = (&work, said.clone());
                    scope.spawn(move || work(said))
                })
                .collect();
            drop(said);
            let mut done = 0.0;
            for share in heard {
                done += share / count;
                progress("finite elements as a reference", done);
            }
            workers.into_iter().try_for_each(|worker| {
                worker
                    .join()
                    .map_err(|_| anyhow!("a solution of the finite elements broke off"))?
            })
        })
    }

    /// Answers one; says how much more of it is done.
    fn solve(&self, asked: &mut Asked, said: &Sender<f64>) -> anyhow::Result<()> {
        let elements = &self.organ.elements;
        let mut reached = 0.0;
        // (The other end hears until all have ended.)
        let mut tell = |load: f64| {
            let _ = said.send((load - reached).max(0.0));
            reached = load.max(reached);
        };
        let moved = match asked.reference.law {
            Law::Linear => {
                let factored = Factored::new(elements, &self.material)?;
                let mut moved = factored.solve(std::slice::from_ref(&asked.load))?;
                moved.pop().unwrap_or_default()
            }
            Law::NeoHookean => {
                let options = NewtonOptions {
                    steps: (asked.reference.force / STEP).ceil().max(1.0) as u32,
                    tolerance: LEFT,
                    ..NewtonOptions::default()
                };
                let mut tell = |at: &NewtonProgress| tell(at.load);
                solve_neo_hookean(elements, &self.material, &asked.load, &options, &mut tell)?
            }
        };
        tell(1.0);
        asked.reference.moved = self.on_surface(&moved);
        Ok(())
    }

    /// Of what belongs to nodes of the elements what belongs to vertices of their surface.
    pub(super) fn on_surface(&self, nodes: &[Vec3]) -> Vec<Vec3> {
        let of = |node: &u32| nodes[*node as usize];
        self.organ.nodes.iter().map(of).collect()
    }
}

impl Reference {
    /// What it is, for people.
    pub(crate) fn name(&self) -> String {
        let law = match self.law {
            Law::Linear => "linear",
            Law::NeoHookean => "neo-Hookean",
        };
        format!("{}, {law}, {} N", self.push, self.force)
    }
}

/// A load to be solved.
struct Asked {
    reference: Reference,
    /// Consistent forces on the nodes of the elements, newtons.
    load: Vec<Vec3>,
}

impl Asked {
    /// How long it takes, roughly.
    fn weight(&self) -> f64 {
        match self.reference.law {
            Law::Linear => 0.0,
            Law::NeoHookean => self.reference.force,
        }
    }
}

/// The object that a built-in scene calls a tongue: as its file says, and as it is made.
fn shipped(which: BuiltIn, progress: &dyn Fn(&str, f64)) -> anyhow::Result<(ObjectEntry, Object)> {
    let file = parse(which.text(), which.file_name())?;
    let is_tongue = |entry: &ObjectEntry| entry.kind == Some(ObjectKind::Tongue);
    let made = compile_built_in(which, &BuildOptions::cached(), progress)?;
    let both = file.objects.into_iter().zip(made.scene.objects);
    let mut both = both.filter(|(entry, _)| is_tongue(entry));
    both.next()
        .with_context(|| format!("{}: has no tongue", which.file_name().shown()))
}

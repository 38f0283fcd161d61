//! Content of a student's screen: a scene without hidden truth, and frames of its moving shapes.
//!
//! - [`Display`] makes the `DisplayScene` of a compiled scene, once for each session's plan.
//! - [`Frames`] makes a `DisplayFrame` 62.5 times a second from the outputs of ticks and the places of spheres.
//!
//! Teeth and built-in instruments have meshes, colours and finishes of their own (`dress`), made from their shapes.
//!
//! # Hidden truth
//! A compiled scene holds prescribed depths, bleeding, furcations and the floors of pockets. Its spheres lie where the
//! depths put them, and their number depends on the depths. Therefore nothing of a gingiva is sent as compiled:
//! - Its mesh is a part of one sheet of soft tissue, made anew from teeth, visible margins and inflammation
//!   ([`fn@sulcus_scene::anatomy::mouth::sheet`]). Jaw and healed ridges show the rest of the sheet.
//! - Its mesh follows *handles*, places on that mesh. The displacement of a handle is interpolated from the spheres
//!   here, at the server.
//! - A place bleeds in a frame after the event `bleeding`, which the probe has caused.
//!
//! Inflammation is visible: colour, gloss and swelling show it, as in a mouth. Tissue that an inflammation softens
//! gives way more, so its frames differ, too.
//!
//! Two patients who differ only in hidden values have the same scene, byte for byte. Their frames are the same bytes
//! until a tool meets tissue that differs. A difference in bleeding alone shows when the probe has left the site.
//!
//! Tissue differs from tooth to tooth, not from site to site. The spheres round a tooth depend on all six depths of
//! this tooth, and beside a neighbour on the neighbour's depths.
//!
//! # Limits
//! The drawn margin has the angles of a pocket of usual depth. It lies within 0.1 mm of the simulated one in pockets of
//! up to 4 mm, and within 0.3 mm in deeper ones. The papillae rise above it between the charted sites.
//!
//! A gingiva that is a mesh of a scene file has no visible margin apart from its mesh. Wall and floor of its pocket are
//! cut away. The rest of its mesh is sent as the file has it.

mod clipped;
mod display;
mod dress;
mod frames;
mod glass;
mod handles;
mod spots;
mod surface;

pub use display::Display;
pub use frames::Frames;

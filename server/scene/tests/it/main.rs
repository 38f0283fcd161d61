//! Meshes, trees, scene files and the parametric mouth.

mod broken_meshes;
mod gingiva;
mod hand_written;
mod mesh_files;
mod meshes;
mod mouth;
mod printed;
mod repairs;
mod scene_files;
mod scenes;
mod soups;
mod sulcus;
mod tetrahedra;
mod tongue;
mod trees;

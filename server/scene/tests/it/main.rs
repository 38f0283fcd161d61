//! Meshes, trees, scene files and the parametric mouth.

mod broken_meshes;
mod gingiva;
mod hand_written;
mod long;
mod mesh_files;
mod meshes;
mod mouth;
mod ngons;
mod printed;
mod repairs;
mod scans;
mod scene_files;
mod scenes;
mod sizes;
mod soups;
mod strange_obj;
mod strange_ply;
mod strange_stl;
mod sulcus;
mod tetrahedra;
mod tongue;
mod trees;

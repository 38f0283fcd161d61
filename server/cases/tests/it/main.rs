//! The hard cases, and the measures that judge them.

mod crown;
mod device_loop;
mod hard_cases;
mod long;
mod one_dof;
mod passivity;
mod pocket;
mod printed;
mod random_poses;
mod rates;
mod ripple;
mod shapes;
mod slips;
mod tissue;
mod tongue;
mod tour;

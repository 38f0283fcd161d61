//! Proofs of minutes: see the table of long proofs in `sulcus-support`.

mod device_loop;
mod hard_cases;
mod passivity;
mod printed;
mod random_poses;
mod rates;
mod real_arch;
mod real_tongue;
mod real_tooth;
mod tour;
mod turning;
mod wall;

//! Installation and life of a server as the manuals describe them: packages on bare machines, the image, files of a
//! service, disks that are full or read-only, a clock that goes wrong.
//!
//! Most tests need root, `mmdebstrap`, `buildah`, `faketime` and the packages of Debian, and are skipped elsewhere. The
//! programs are those of the tests; `SULCUS_PROGRAMS` names a folder with others for the packages, such as those of a release.

mod clock;
mod disk;
mod files;
mod image;
mod machine;
mod manual;
mod packages;
mod snapshot;

//! Write errors of a full disk, a quota or a file-size limit.

use std::io::{Error, ErrorKind};

/// Whether a write failed for lack of space.
///
/// The disk is full (`ENOSPC`), the user's quota is exhausted (`EDQUOT`), or the file has reached its size limit
/// (`EFBIG`).
pub fn is_full(error: &Error) -> bool {
    matches!(
        error.kind(),
        ErrorKind::StorageFull | ErrorKind::QuotaExceeded | ErrorKind::FileTooLarge
    )
}

/// Advice to append to the message of a failed write; empty unless [`is_full`].
pub fn advice(error: &Error) -> &'static str {
    if is_full(error) {
        "; free space on the disk, or raise the quota or the limit on file sizes (ulimit -f)"
    } else {
        ""
    }
}

#[cfg(all(test, unix))]
mod tests {
    use super::*;

    #[test]
    fn a_full_disk_a_quota_and_a_limit_on_files_are_alike() {
        for code in [libc::ENOSPC, libc::EDQUOT, libc::EFBIG] {
            let error = Error::from_raw_os_error(code);
            assert!(is_full(&error), "{error}");
            assert!(advice(&error).contains("ulimit"), "{error}");
        }
        let other = Error::from_raw_os_error(libc::EACCES);
        assert!(!is_full(&other) && advice(&other).is_empty());
    }
}

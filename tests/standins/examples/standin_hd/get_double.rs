//! Reading of doubles. The file is separate so that a library without this function exists.

use crate::get::read;
use crate::values::Value;

/// Reads doubles.
///
/// # Safety
/// `out` has room for the parameter.
#[unsafe(no_mangle)]
pub unsafe extern "system" fn hdGetDoublev(parameter: u32, out: *mut f64) {
    read(parameter, out.is_null(), |_, value| match value {
        Value::F64(numbers, count) => {
            for (i, number) in numbers.iter().take(count).enumerate() {
                // SAFETY: the caller's promise; `out` is not null.
                unsafe { out.add(i).write(*number) };
            }
            true
        }
        _ => false,
    });
}

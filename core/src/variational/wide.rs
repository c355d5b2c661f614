//! Rows with the widest registers there are.

/// Declares a function that does another's work with the widest registers there are; all give the same. The other has to be
/// `#[inline(always)]`.
macro_rules! widest {
    ($(#[$meta:meta])* fn $name:ident($($arg:ident: $type:ty),* $(,)?) = $work:ident) => {
        $(#[$meta])*
        fn $name($($arg: $type),*) {
            #[cfg(target_arch = "x86_64")]
            {
                #[target_feature(enable = "avx512f")]
                fn avx512($($arg: $type),*) {
                    $work($($arg),*);
                }
                #[target_feature(enable = "avx2")]
                fn avx2($($arg: $type),*) {
                    $work($($arg),*);
                }
                if is_x86_feature_detected!("avx512f") {
                    // SAFETY: the processor has AVX-512.
                    return unsafe { avx512($($arg),*) };
                }
                if is_x86_feature_detected!("avx2") {
                    // SAFETY: the processor has AVX2.
                    return unsafe { avx2($($arg),*) };
                }
            }
            $work($($arg),*);
        }
    };
}
pub(super) use widest;

/// Pixels that are worked out at once.
pub const LANES: usize = 16;

/// The pixels of a row from `start` on, so many that the compiler makes vector instructions of a loop over them.
#[inline(always)]
pub fn lane(row: &[f32], start: usize) -> Option<&[f32; LANES]> {
    row.get(start..)?.first_chunk()
}

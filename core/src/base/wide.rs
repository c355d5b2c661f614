//! Work with wide registers, where the processor has them. All give the same: products and sums are never fused.

/// Declares a function that does the work of another, which has to be `#[inline(always)]`, with the registers of AVX2 where
/// there are some. The work is named and not a closure: a closure is compiled for narrow ones where it is not inlined.
macro_rules! wide {
    ($(#[$doc:meta])* $vis:vis fn $name:ident($($arg:ident: $type:ty),* $(,)?) $(-> $out:ty)? = $work:path) => {
        $(#[$doc])*
        $vis fn $name($($arg: $type),*) $(-> $out)? {
            crate::base::wide::with!("avx2", ($($arg: $type),*), ($($out)?), $work);
            $work($($arg),*)
        }
    };
}
pub(crate) use wide;

/// The same with the registers of AVX-512 where there are some, for long rows.
macro_rules! widest {
    ($(#[$doc:meta])* $vis:vis fn $name:ident($($arg:ident: $type:ty),* $(,)?) $(-> $out:ty)? = $work:path) => {
        $(#[$doc])*
        $vis fn $name($($arg: $type),*) $(-> $out)? {
            crate::base::wide::with!("avx512f", ($($arg: $type),*), ($($out)?), $work);
            crate::base::wide::with!("avx2", ($($arg: $type),*), ($($out)?), $work);
            $work($($arg),*)
        }
    };
}
pub(crate) use widest;

/// Returns from a function what `work` gives with what the processor has, if it has it.
macro_rules! with {
    ($feature:tt, ($($arg:ident: $type:ty),*), ($($out:ty)?), $work:path) => {
        #[cfg(target_arch = "x86_64")]
        if is_x86_feature_detected!($feature) {
            #[target_feature(enable = $feature)]
            fn work($($arg: $type),*) $(-> $out)? {
                $work($($arg),*)
            }
            // SAFETY: the processor has the feature.
            return unsafe { work($($arg),*) };
        }
    };
}
pub(crate) use with;

/// Pixels that are worked out at once.
pub const LANES: usize = 16;

/// The pixels of a row from `start` on, so many that the compiler makes vector instructions of a loop over them.
#[inline(always)]
pub fn lane(row: &[f32], start: usize) -> Option<&[f32; LANES]> {
    row.get(start..)?.first_chunk()
}

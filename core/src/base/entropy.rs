//! Bits of numbers that are sent one by one: zero-order entropy.

use std::collections::BTreeMap;

/// Bits of all displacements, each as one symbol.
pub(crate) fn vector_bits(vectors: impl Iterator<Item = [f32; 2]>) -> f64 {
    // Displacements are multiples of a quarter of a pixel, or finer by a fit: a hundredth tells them apart.
    bits(vectors.map(|vector| vector.map(|c| (c * 100.0).round() as i32)))
}

/// Bits of all symbols at −log₂ p each, with p the relative frequency of a symbol.
pub(crate) fn bits<T: Ord>(symbols: impl Iterator<Item = T>) -> f64 {
    let mut counts = BTreeMap::new();
    for symbol in symbols {
        *counts.entry(symbol).or_insert(0u64) += 1;
    }
    let all = counts.values().sum::<u64>() as f64;
    counts.values().map(|&count| count as f64 * (all / count as f64).log2()).sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bits_are_those_of_the_textbook() {
        assert_eq!(bits([7; 9].into_iter()), 0.0);
        assert_eq!(bits(0..8), 24.0);
        // Half, a quarter, and two eighths: 1.75 bits a symbol.
        assert_eq!(bits([1, 1, 1, 1, 2, 2, 3, 4].into_iter()), 14.0);
    }
}

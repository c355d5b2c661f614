//! The χ² distribution, which squared Mahalanobis distances of a consistent filter follow.

/// Returns the cumulative distribution at `x` for an even number of degrees of freedom: 1 − e^(−x/2) Σ (x/2)ⁱ / i!, i < dof / 2.
///
/// # Panics
/// If the number of degrees of freedom is odd or 0.
pub fn share(x: f64, dof: usize) -> f64 {
    assert!(dof > 0 && dof.is_multiple_of(2), "{dof} degrees of freedom");
    let half = 0.5 * x.max(0.0);
    // In logarithms: for many degrees of freedom the powers would overflow.
    let mut log_term = -half;
    let mut beyond = log_term.exp();
    for i in 1..dof / 2 {
        log_term += (half / i as f64).ln();
        beyond += log_term.exp();
    }
    1.0 - beyond
}

/// Returns the quantile of probability `p`, 0 to 1, for an even number of degrees of freedom.
///
/// # Panics
/// If the number of degrees of freedom is odd or 0.
pub fn quantile(p: f64, dof: usize) -> f64 {
    let p = p.clamp(0.0, 1.0 - 1e-12);
    let [mut low, mut high] = [0.0, dof as f64];
    while share(high, dof) < p {
        high *= 2.0;
    }
    // Bisection down to adjacent numbers.
    loop {
        let middle = 0.5 * (low + high);
        if middle <= low || middle >= high {
            return middle;
        }
        if share(middle, dof) < p { low = middle } else { high = middle }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn quantiles_are_those_of_the_tables() {
        // scipy 1.17.1, scipy.stats.chi2.ppf.
        for (p, dof, value) in [
            (0.95, 2, 5.991464547107979),
            (0.99, 2, 9.21034037197618),
            (0.025, 2, 0.05063561596857975),
            (0.975, 4, 11.143286781877796),
            (0.5, 10, 9.34181776559197),
            (0.025, 400, 346.48176536291464),
            (0.975, 400, 457.305481966065),
        ] {
            let found = quantile(p, dof);
            assert!((found / value - 1.0).abs() < 1e-9, "χ²({p}, {dof}) = {found}, not {value}");
        }
    }
}

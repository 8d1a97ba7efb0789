//! Numbers behind the plots.

/// The exact interval of a share, by Clopper and Pearson: from `successes` of `trials` the share is in it with at least this confidence.
pub(crate) fn clopper_pearson(successes: usize, trials: usize, confidence: f64) -> (f64, f64) {
    if trials == 0 {
        return (0.0, 1.0);
    }
    let (k, n) = (successes as f64, trials as f64);
    let beyond = 0.5 * (1.0 - confidence);
    let low = if successes == 0 { 0.0 } else { beta_quantile(beyond, k, n - k + 1.0) };
    let high = if successes >= trials { 1.0 } else { beta_quantile(1.0 - beyond, k + 1.0, n - k) };
    (low, high)
}

/// Where the distribution function of a beta distribution has a value, by halving.
fn beta_quantile(value: f64, a: f64, b: f64) -> f64 {
    let (mut low, mut high) = (0.0, 1.0);
    // Enough for all digits that a double has between 0 and 1.
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        if beta(middle, a, b) < value { low = middle } else { high = middle }
    }
    0.5 * (low + high)
}

/// The regularised incomplete beta function.
fn beta(x: f64, a: f64, b: f64) -> f64 {
    if x <= 0.0 {
        return 0.0;
    }
    if x >= 1.0 {
        return 1.0;
    }
    let front = (ln_gamma(a + b) - ln_gamma(a) - ln_gamma(b) + a * x.ln() + b * (1.0 - x).ln()).exp();
    // The fraction converges fast on this side of the mean.
    if x < (a + 1.0) / (a + b + 2.0) {
        front * fraction(x, a, b) / a
    } else {
        1.0 - front * fraction(1.0 - x, b, a) / b
    }
}

/// The continued fraction of the incomplete beta function, by the method of Lentz.
fn fraction(x: f64, a: f64, b: f64) -> f64 {
    const SMALL: f64 = 1e-300;
    let kept = |value: f64| if value.abs() < SMALL { SMALL } else { value };
    let (mut c, mut d) = (1.0, 1.0 / kept(1.0 - (a + b) * x / (a + 1.0)));
    let mut value = d;
    for m in 1..=500 {
        let m = f64::from(m);
        let even = m * (b - m) * x / ((a + 2.0 * m - 1.0) * (a + 2.0 * m));
        let odd = -(a + m) * (a + b + m) * x / ((a + 2.0 * m) * (a + 2.0 * m + 1.0));
        for term in [even, odd] {
            d = 1.0 / kept(1.0 + term * d);
            c = kept(1.0 + term / c);
            value *= d * c;
        }
        if (d * c - 1.0).abs() < 1e-15 {
            break;
        }
    }
    value
}

/// The logarithm of the gamma function of a positive number, by the series of Stirling.
fn ln_gamma(x: f64) -> f64 {
    // The series is exact to all digits from 10 on.
    let (mut shifted, mut below) = (x, 0.0);
    while shifted < 10.0 {
        below += shifted.ln();
        shifted += 1.0;
    }
    let square = 1.0 / (shifted * shifted);
    let series = (1.0 / 12.0
        - square * (1.0 / 360.0 - square * (1.0 / 1260.0 - square * (1.0 / 1680.0 - square / 1188.0))))
        / shifted;
    (shifted - 0.5) * shifted.ln() - shifted + 0.5 * std::f64::consts::TAU.ln() + series - below
}

#[cfg(test)]
mod tests {
    use super::{clopper_pearson, ln_gamma};

    #[test]
    fn intervals_are_those_of_the_tables() {
        let close = |a: f64, b: f64| (a - b).abs() < 1e-6;
        // None of n: the upper end is 1 - (α/2)^(1/n).
        let (low, high) = clopper_pearson(0, 20, 0.95);
        assert!(low == 0.0 && close(high, 1.0 - 0.025_f64.powf(1.0 / 20.0)), "{high}");
        let (low, high) = clopper_pearson(20, 20, 0.95);
        assert!(close(low, 0.025_f64.powf(1.0 / 20.0)) && high == 1.0, "{low}");
        // Tables of Clopper and Pearson: 5 of 10 and 10 of 20 at 95 %.
        let (low, high) = clopper_pearson(5, 10, 0.95);
        assert!((low - 0.187_086).abs() < 1e-5 && (high - 0.812_914).abs() < 1e-5, "{low} {high}");
        let (low, high) = clopper_pearson(10, 20, 0.95);
        assert!((low - 0.271_96).abs() < 1e-5 && (high - 0.728_04).abs() < 1e-5, "{low} {high}");
        let (low, high) = clopper_pearson(9000, 10_000, 0.95);
        assert!((0.893..0.895).contains(&low) && (0.905..0.907).contains(&high), "{low} {high}");
        assert_eq!(clopper_pearson(0, 0, 0.95), (0.0, 1.0));
    }

    #[test]
    fn gamma_is_the_factorial() {
        let mut factorial = 1.0_f64;
        for n in 1..30 {
            assert!((ln_gamma(f64::from(n)) - factorial.ln()).abs() < 1e-11 * factorial.ln().max(1.0), "{n}");
            factorial *= f64::from(n);
        }
        assert!((ln_gamma(0.5) - 0.5 * std::f64::consts::PI.ln()).abs() < 1e-12);
    }
}

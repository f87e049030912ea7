//! Random numbers for tests: the same at every run.

use nalgebra::{Matrix3, Rotation3, Vector3};

use super::Path;

/// A stream of numbers without order (SplitMix64), the same for the same seed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Numbers(u64);

impl Numbers {
    /// A stream of its own for every seed.
    #[must_use]
    pub fn new(seed: u64) -> Self {
        Self(seed)
    }

    /// 64 bits.
    pub fn bits(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    /// Between 0 and 1, never 1.
    pub fn unit(&mut self) -> f64 {
        (self.bits() >> 11) as f64 / (1_u64 << 53) as f64
    }

    /// Between -1 and 1.
    pub fn signed(&mut self) -> f64 {
        2.0 * self.unit() - 1.0
    }

    /// Between two bounds.
    pub fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.unit()
    }

    /// Between two positive bounds, every order of magnitude as often as any other.
    pub fn log_between(&mut self, low: f64, high: f64) -> f64 {
        (low.ln() + (high / low).ln() * self.unit()).exp()
    }

    /// One of `count`, from 0.
    pub fn index(&mut self, count: usize) -> usize {
        (self.bits() % count.max(1) as u64) as usize
    }

    /// Whether, with a probability.
    pub fn chance(&mut self, probability: f64) -> bool {
        self.unit() < probability
    }

    /// Entries between `-size` and `size`.
    pub fn matrix(&mut self, size: f64) -> Matrix3<f64> {
        Matrix3::from_fn(|_, _| size * self.signed())
    }

    /// A rotation by up to half a turn about any axis.
    pub fn rotation(&mut self) -> Matrix3<f64> {
        let axis = Vector3::from_fn(|_, _| self.signed());
        let angle = std::f64::consts::PI * self.unit();
        let turn = axis.try_normalize(1e-3).map(|axis| axis * angle).unwrap_or_default();
        Rotation3::from_scaled_axis(turn).into_inner()
    }

    /// A path of `steps` displacement gradients of about `size`: it wanders, and turns back every third step.
    pub fn path(&mut self, steps: usize, size: f64) -> Path {
        let mut at = Matrix3::zeros();
        let gradients = (0..steps).map(|step| {
            let change = self.matrix(0.5 * size);
            at = if step % 3 == 2 { at * 0.6 - change } else { at * 0.8 + change };
            at
        });
        Path::new(gradients.collect())
    }
}

#[cfg(test)]
mod tests {
    use super::Numbers;

    /// The numbers of the reference implementation (Vigna, prng.di.unimi.it) for this seed.
    #[test]
    fn bits_are_those_of_splitmix64() {
        let mut numbers = Numbers::new(1_234_567);
        let expected = [6_457_827_717_110_365_317, 3_203_168_211_198_807_973, 9_817_491_932_198_370_423];
        assert_eq!(expected.map(|_| numbers.bits()), expected);
    }

    #[test]
    fn numbers_fill_their_range() {
        let mut numbers = Numbers::new(1);
        let mean = (0..10_000).map(|_| numbers.signed()).sum::<f64>() / 10_000.0;
        assert!(mean.abs() < 0.03, "{mean}");
        assert!((0..1000).all(|_| (2.0..3.0).contains(&numbers.between(2.0, 3.0))));
        assert!((0..1000).all(|_| (0.1..10.0).contains(&numbers.log_between(0.1, 10.0)) && numbers.index(3) < 3));
        let turn = numbers.rotation();
        assert!((turn.determinant() - 1.0).abs() < 1e-14);
        assert_eq!(Numbers::new(7).path(4, 0.1), Numbers::new(7).path(4, 0.1));
    }
}

//! Reproducible normal noise, the sum of twelve uniforms.

/// Generator with its state.
pub(crate) struct Noise(pub(crate) u64);

impl Noise {
    fn step(&mut self) -> u64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        self.0
    }

    /// Returns a uniform number from 0 to 1.
    pub(crate) fn uniform(&mut self) -> f64 {
        (self.step() >> 11) as f64 / (1u64 << 53) as f64
    }

    /// Returns a number below `count`.
    pub(crate) fn index(&mut self, count: usize) -> usize {
        (self.step() >> 33) as usize % count
    }

    /// Returns a normal number with mean 0 and standard deviation 1.
    pub(crate) fn normal(&mut self) -> f64 {
        (0..12).map(|_| self.uniform()).sum::<f64>() - 6.0
    }
}

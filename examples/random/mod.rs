//! Random numbers and artificial records of the examples.

use std::f64::consts::TAU;

/// Pseudo-random numbers from 0 to 1 (SplitMix64, Steele, Lea and Flood 2014).
pub struct Random(pub u64);

impl Random {
    pub fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut bits = self.0;
        bits = (bits ^ (bits >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        bits = (bits ^ (bits >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((bits ^ (bits >> 31)) >> 11) as f64 / (1_u64 << 53) as f64
    }

    pub fn within(&mut self, from: f64, to: f64) -> f64 {
        from + (to - from) * self.next()
    }

    pub fn one_of<T: Copy>(&mut self, values: &[T]) -> T {
        values[(self.next() * values.len() as f64) as usize]
    }

    /// Returns the samples of a record with a peak of 1: forty sine waves of 0.3 to 8 Hz that swell for 1.5 s and fade from 5 s on.
    pub fn record(&mut self) -> Vec<(f64, f64)> {
        let wave = |random: &mut Self| {
            (
                0.3 * (8.0_f64 / 0.3).powf(random.next()),
                TAU * random.next(),
            )
        };
        let waves: Vec<(f64, f64)> = (0..40).map(|_| wave(self)).collect();
        let sample = |index: u32| {
            let time_s = 0.01 * f64::from(index);
            let swell = (time_s / 1.5).min(1.0).powi(2);
            let fade = (-0.9 * (time_s - 5.0).max(0.0)).exp() * (2.0 * (9.0 - time_s)).min(1.0);
            let sum = waves.iter().map(|(hz, phase)| {
                (hz / (1.0 + (hz / 4.0).powi(2))).sqrt() * (TAU * hz * time_s + phase).sin()
            });
            (time_s, swell * fade * sum.sum::<f64>())
        };
        let samples: Vec<(f64, f64)> = (0..=900).map(sample).collect();
        let peak = samples
            .iter()
            .fold(0.0_f64, |peak, (_, value)| peak.max(value.abs()));
        samples
            .into_iter()
            .map(|(time_s, value)| (time_s, value / peak))
            .collect()
    }
}

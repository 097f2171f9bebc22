//! The frames of an animation: a history thinned to a limited number of samples.

use crate::Sample;
use crate::output::Thinned;

/// The frames: every sample, or every second, fourth, eighth and so on, up to a given number; and the last sample.
#[derive(Clone, Debug)]
pub(super) struct Animation {
    thinned: Thinned<Sample>,
    last: Option<Sample>,
}

impl Animation {
    /// Makes an empty animation with at most this number of frames plus the last one.
    pub(super) const fn new(most: usize) -> Self {
        Self {
            thinned: Thinned::new(most),
            last: None,
        }
    }

    /// Adds a sample. Samples come in the order of time.
    pub(super) fn push(&mut self, sample: &Sample) {
        if self.thinned.next(|_, _| ()).is_none() {
            self.thinned.columns.push(sample.clone());
        }
        self.last = Some(sample.clone());
    }

    /// Frames in order of time.
    pub(super) fn frames(&self) -> Vec<&Sample> {
        let kept = &self.thinned.columns;
        let is_kept = |last: &&Sample| kept.last().is_some_and(|kept| kept.time_s >= last.time_s);
        let last = self.last.as_ref().filter(|last| !is_kept(last));
        kept.iter().chain(last).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn frames_are_evenly_spaced_and_end_with_the_last_sample() {
        for count in [1, 7, 8, 9, 100, 1023, 1024] {
            let mut animation = Animation::new(8);
            for i in 0..count {
                animation.push(&Sample {
                    time_s: f64::from(i),
                    ..Sample::default()
                });
            }
            let times_s: Vec<f64> = animation
                .frames()
                .iter()
                .map(|frame| frame.time_s)
                .collect();
            assert!(
                times_s.len() <= 9 && (count < 9 || times_s.len() > 4),
                "{times_s:?}"
            );
            assert_eq!(times_s.last(), Some(&f64::from(count - 1)));
            let even = times_s.len() - 1;
            let steps = times_s[..even].windows(2).map(|pair| pair[1] - pair[0]);
            assert!(
                steps
                    .collect::<Vec<_>>()
                    .windows(2)
                    .all(|pair| pair[0] == pair[1])
            );
        }
    }
}

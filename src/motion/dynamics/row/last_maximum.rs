//! The last time at which a row could still return, from its height.

/// Last maximum of the height before the final descent.
pub struct LastMaximum {
    pub time: f64,
    highest: f64,
    /// Lowest height since then.
    lowest: f64,
}

impl LastMaximum {
    pub const fn new(height: f64, time: f64) -> Self {
        Self {
            time,
            highest: height,
            lowest: height,
        }
    }

    /// Updates the maximum by a height at a time. A rise by `least` above the lowest height since the maximum is a return; `returns` is true if the row
    /// returns by another criterion.
    pub fn record_height(&mut self, (height, time): (f64, f64), least: f64, returns: bool) {
        self.lowest = self.lowest.min(height);
        let rises = height >= self.lowest + least || height >= self.highest;
        if rises || returns {
            *self = Self::new(height, time);
        }
    }
}

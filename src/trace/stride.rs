//! Coarser traces: every k-th point of a fine one.

use super::Trace;

impl Trace {
    /// The trace through points 0, `k`, 2 `k` and so on, and through the last point: fewer steps, which are longer. O(points).
    ///
    /// It goes straight where the trace went round things. What lies between is passed on the other side then, or, if it is a
    /// wall, crossed, which [`settle`](super::settle) finds.
    ///
    /// ```
    /// use tautline::trace::Trace;
    /// let trace = Trace { id: 7, points: (0..6).map(|i| [f64::from(i), 0.0].into()).collect() };
    /// let along: Vec<f64> = trace.strided(2).points.iter().map(|p| p.x).collect();
    /// assert_eq!(along, [0.0, 2.0, 4.0, 5.0]);
    /// ```
    ///
    /// # Panics
    ///
    /// If `k` is 0.
    #[must_use]
    pub fn strided(mut self, k: usize) -> Trace {
        assert!(k > 0, "a stride is at least 1");
        let count = self.points.len();
        if k > 1 && count > 1 {
            let whole = (count - 1) / k;
            for i in 1..=whole {
                self.points[i] = self.points[i * k];
            }
            self.points[whole + usize::from((count - 1) % k > 0)] = self.points[count - 1];
            self.points.truncate((count - 1).div_ceil(k) + 1);
        }
        self
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_stride_keeps_every_kth_point_and_the_last() {
        for count in 0..20u32 {
            let trace = Trace { id: 3, points: (0..count).map(|i| [f64::from(i), 0.5].into()).collect() };
            assert_eq!(trace.clone().strided(1), trace);
            for k in 1..25 {
                let kept: Vec<u32> = (0..count).filter(|i| i % k == 0 || i + 1 == count).collect();
                let strided = trace.clone().strided(k as usize);
                assert_eq!(strided.points.iter().map(|p| p.x as u32).collect::<Vec<_>>(), kept, "{count} by {k}");
                assert_eq!(strided.id, 3);
            }
        }
    }
}

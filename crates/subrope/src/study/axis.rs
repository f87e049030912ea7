//! A logarithmic axis.

/// Values from `low` to `high`, both 1, 2 or 5 times a power of ten, drawn from `from` to `to`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct LogAxis {
    low: f64,
    high: f64,
    from: f64,
    to: f64,
}

/// A line of the grid.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Tick {
    pub value: f64,
    /// Where it is drawn.
    pub at: f64,
    /// Whether it is a power of ten.
    pub major: bool,
    /// Whether its value is written.
    pub labelled: bool,
}

/// Room left beside the outermost values.
const MARGIN: f64 = 1.2;

impl LogAxis {
    /// An axis that shows all values, of which there must be one above 0.
    pub fn around(values: impl Iterator<Item = f64>, from: f64, to: f64) -> Option<Self> {
        let shown = values.filter(|v| *v > 0.0 && v.is_finite());
        let (low, high) = shown.fold((f64::INFINITY, 0.0_f64), |(l, h), v| (l.min(v), h.max(v)));
        (high > 0.0).then(|| Self { low: below(low / MARGIN), high: 1.0 / below(1.0 / (high * MARGIN)), from, to })
    }

    /// Where a value is drawn; outside values at the nearest end.
    pub fn at(&self, value: f64) -> f64 {
        let value = value.clamp(self.low, self.high);
        self.from + (self.to - self.from) * (value / self.low).ln() / (self.high / self.low).ln()
    }

    /// Lines at 1 to 9 times the powers of ten; values are written at powers of ten, and at 2 and 5 when there are few.
    pub fn ticks(&self) -> Vec<Tick> {
        let (first, last) = (self.low.log10().floor() as i32, self.high.log10().ceil() as i32);
        let inside = |v: f64| v >= self.low * 0.999 && v <= self.high * 1.001;
        let few = (first..=last).filter(|&e| inside(10_f64.powi(e))).count() < 3;
        let all = (first..=last).flat_map(|e| (1..10).map(move |m| (e, m)));
        let tick = |(e, m): (i32, i32)| {
            let value = f64::from(m) * 10_f64.powi(e);
            let labelled = m == 1 || (few && (m == 2 || m == 5));
            inside(value).then(|| Tick { value, at: self.at(value), major: m == 1, labelled })
        };
        all.filter_map(tick).collect()
    }
}

/// The largest of 1, 2 and 5 times a power of ten that is not above a value.
fn below(value: f64) -> f64 {
    let decade = 10_f64.powf(value.log10().floor());
    let steps = [10.0, 5.0, 2.0, 1.0].map(|m| m * decade);
    steps.into_iter().find(|s| *s <= value * 1.000_001).unwrap_or(decade)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ends_are_round_and_hold_all() {
        let axis = LogAxis::around([0.013, 4.1, 0.0].into_iter(), 0.0, 100.0).unwrap();
        assert!((axis.low - 0.01).abs() < 1e-12 && (axis.high - 5.0).abs() < 1e-9, "{axis:?}");
        assert_eq!(axis.at(0.001), 0.0);
        assert!((axis.at(axis.high) - 100.0).abs() < 1e-9);
        let labels: Vec<_> = axis.ticks().into_iter().filter(|t| t.labelled).map(|t| t.value).collect();
        assert_eq!(labels.len(), 3, "{labels:?}");
        assert!(LogAxis::around([0.0, -1.0].into_iter(), 0.0, 1.0).is_none());
    }

    #[test]
    fn a_single_value_has_an_axis_around_it() {
        let axis = LogAxis::around([1.0].into_iter(), 0.0, 100.0).unwrap();
        assert!(axis.low < 1.0 && axis.high > 1.0);
        assert!(axis.at(1.0) > 10.0 && axis.at(1.0) < 90.0);
        assert!(axis.ticks().iter().filter(|t| t.labelled).count() >= 2, "{:?}", axis.ticks());
    }
}

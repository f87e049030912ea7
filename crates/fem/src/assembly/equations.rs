//! Numbering of the free coordinates.

/// Marks a prescribed coordinate.
pub const PRESCRIBED: u32 = u32::MAX;

/// Which coordinates are unknown, and their equation numbers.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Equations {
    equation: Vec<u32>,
    coordinate: Vec<u32>,
}

impl Equations {
    /// Numbers the coordinates that are not prescribed, in order.
    #[must_use]
    pub fn new(prescribed: &[bool]) -> Self {
        let mut coordinate = Vec::with_capacity(prescribed.len());
        let equation = prescribed
            .iter()
            .enumerate()
            .map(|(c, &held)| {
                if held {
                    PRESCRIBED
                } else {
                    coordinate.push(c as u32);
                    coordinate.len() as u32 - 1
                }
            })
            .collect();
        Self { equation, coordinate }
    }

    /// Number of unknowns.
    #[must_use]
    pub fn len(&self) -> usize {
        self.coordinate.len()
    }

    /// Whether nothing is unknown.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.coordinate.is_empty()
    }

    /// Equation of a coordinate, [`None`] when it is prescribed.
    #[must_use]
    pub fn of(&self, coordinate: usize) -> Option<u32> {
        Some(self.equation[coordinate]).filter(|&e| e != PRESCRIBED)
    }

    /// Coordinate of every equation.
    #[must_use]
    pub fn coordinates(&self) -> &[u32] {
        &self.coordinate
    }

    /// Entries of a coordinate vector that are unknown.
    pub fn gather(&self, coordinates: &[f64], out: &mut [f64]) {
        for (o, &c) in out.iter_mut().zip(&self.coordinate) {
            *o = coordinates[c as usize];
        }
    }

    /// Adds `scale` times a vector of unknowns to the coordinates.
    pub fn scatter_add(&self, scale: f64, unknowns: &[f64], coordinates: &mut [f64]) {
        for (&value, &c) in unknowns.iter().zip(&self.coordinate) {
            coordinates[c as usize] += scale * value;
        }
    }
}

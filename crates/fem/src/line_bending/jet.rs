//! A number with its first and second derivatives by five variables.

use std::ops::{Add, Mul, Sub};

use nalgebra::{Matrix5, Vector5};

/// Value, gradient and Hessian of a function of five variables.
#[derive(Clone, Copy, Debug)]
pub struct Jet {
    /// Value.
    pub value: f64,
    /// First derivatives.
    pub gradient: Vector5<f64>,
    /// Second derivatives.
    pub hessian: Matrix5<f64>,
}

impl Jet {
    /// A number that depends on nothing.
    pub fn constant(value: f64) -> Self {
        Self { value, gradient: Vector5::zeros(), hessian: Matrix5::zeros() }
    }

    /// The variables at their values.
    pub fn variables(values: [f64; 5]) -> [Self; 5] {
        std::array::from_fn(|i| Self { gradient: Vector5::ith(i, 1.0), ..Self::constant(values[i]) })
    }

    /// `1/sqrt(self)`.
    pub fn inverse_root(self) -> Self {
        let value = self.value.sqrt().recip();
        let (first, second) = (-0.5 * value / self.value, 0.75 * value / (self.value * self.value));
        Self {
            value,
            gradient: first * self.gradient,
            hessian: first * self.hessian + second * self.gradient * self.gradient.transpose(),
        }
    }
}

impl Add for Jet {
    type Output = Self;

    fn add(self, other: Self) -> Self {
        Self {
            value: self.value + other.value,
            gradient: self.gradient + other.gradient,
            hessian: self.hessian + other.hessian,
        }
    }
}

impl Sub for Jet {
    type Output = Self;

    fn sub(self, other: Self) -> Self {
        self + -1.0 * other
    }
}

impl Mul for Jet {
    type Output = Self;

    fn mul(self, other: Self) -> Self {
        let mixed = self.gradient * other.gradient.transpose();
        Self {
            value: self.value * other.value,
            gradient: self.value * other.gradient + other.value * self.gradient,
            hessian: self.value * other.hessian + other.value * self.hessian + mixed + mixed.transpose(),
        }
    }
}

impl Mul<Jet> for f64 {
    type Output = Jet;

    fn mul(self, jet: Jet) -> Jet {
        Jet { value: self * jet.value, gradient: self * jet.gradient, hessian: self * jet.hessian }
    }
}

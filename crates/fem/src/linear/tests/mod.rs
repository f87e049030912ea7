//! Tests of the sparse direct solvers.

mod fixtures;
mod structure;
mod symmetric;
mod unsymmetric;

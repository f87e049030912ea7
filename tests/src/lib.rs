//! Whole-scene tests live in `tests/tests`.

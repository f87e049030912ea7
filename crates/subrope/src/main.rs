//! The `subrope` command.
fn main() {}

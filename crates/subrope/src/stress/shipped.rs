//! The lists that come with the program.

use super::{StressError, StressList};

/// Their texts, in the order of the table.
const TEXTS: [(&str, &str); 4] = [
    ("stress/law.toml", include_str!("../../stress/law.toml")),
    ("stress/mesh.toml", include_str!("../../stress/mesh.toml")),
    ("stress/loads.toml", include_str!("../../stress/loads.toml")),
    ("stress/contact.toml", include_str!("../../stress/contact.toml")),
];

/// The lists.
///
/// # Errors
/// [`StressError::Invalid`], which a test excludes.
pub fn shipped() -> Result<Vec<StressList>, StressError> {
    TEXTS.iter().map(|(name, text)| StressList::from_toml(name, text)).collect()
}

#[cfg(test)]
mod tests {
    use super::shipped;
    use crate::stress::members;

    #[test]
    fn all_lists_are_right() {
        let lists = shipped().unwrap_or_else(|e| panic!("{e:?}"));
        let mut names = Vec::new();
        for list in &lists {
            for family in &list.family {
                let members = members::expand(list, family).unwrap_or_else(|e| panic!("{e}"));
                assert!(!members.is_empty());
                names.push(family.name.clone());
            }
        }
        let count = names.len();
        names.sort();
        names.dedup();
        assert_eq!(names.len(), count, "two families of one name");
    }
}

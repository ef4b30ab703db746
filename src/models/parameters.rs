//! Parameter sets: the numbers that make a model one actuator type's model.

/// The parameters of both models of one actuator type, validated, with their hash.
#[derive(Debug, Clone)]
pub struct ParameterSet {
    name: String,
    hash: String,
}

impl ParameterSet {
    /// The built-in reference actuator.
    #[must_use]
    pub fn reference() -> Self {
        Self { name: "reference".into(), hash: String::new() }
    }

    /// The set's name.
    #[must_use]
    pub fn name(&self) -> &str {
        &self.name
    }

    /// SHA-256 of the set's values, in hexadecimal: it tells two sets of one name apart.
    #[must_use]
    pub fn hash(&self) -> &str {
        &self.hash
    }
}

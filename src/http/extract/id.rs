//! Ids in paths.

use axum::extract::{FromRequestParts, Path};
use axum::http::request::Parts;

use crate::http::error::ApiError;
use crate::store::records::Id;

/// The `{id}` of a path, as it was given: what it names is for the handler to say.
#[derive(Debug, Clone)]
pub struct PathId(String);

impl PathId {
    /// What the path says.
    #[must_use]
    pub fn text(&self) -> &str {
        &self.0
    }

    /// The id of a `what`.
    ///
    /// # Errors
    /// [`ApiError::NotFound`] for what is no id in its one spelling: lower case, with hyphens.
    pub fn of(&self, what: &'static str) -> Result<Id, ApiError> {
        let id: Option<Id> = self.0.parse().ok();
        id.filter(|id| id.to_string() == self.0).ok_or_else(|| ApiError::not_found(what, &self.0))
    }
}

impl<S: Send + Sync> FromRequestParts<S> for PathId {
    type Rejection = ApiError;

    async fn from_request_parts(parts: &mut Parts, state: &S) -> Result<Self, ApiError> {
        let id: Path<String> = Path::from_request_parts(parts, state).await.map_err(|_| ApiError::UnknownPath)?;
        Ok(Self(id.0))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_the_one_spelling_of_an_id_is_an_id() {
        let id = Id::now().to_string();
        assert!(PathId(id.clone()).of("job").is_ok());
        for wrong in [id.to_uppercase(), id.replace('-', ""), format!("{{{id}}}"), "7".into(), String::new()] {
            assert!(matches!(PathId(wrong).of("job"), Err(ApiError::NotFound { what: "job", .. })));
        }
    }
}

//! Reads the contact of a wall or collider with the material.

use super::choices::CONTACTS;
use super::read::Reader;
use crate::error::SceneError;
use lahar::Contact;

/// Reads a contact that is a word, or a table with a word and friction; `None` if the key is absent.
pub(super) fn opt_contact(table: &Reader<'_>, key: &str) -> Result<Option<Contact>, SceneError> {
    if table.opt_text(key).is_some() {
        return table.choice(key, &CONTACTS).map(Some);
    }
    let inner = table.opt_table(key);
    inner.map(|inner| contact_with_friction(&inner)).transpose()
}

/// Reads the keys `contact` and `friction` of a wall or a collider.
pub(super) fn contact_with_friction(table: &Reader<'_>) -> Result<Contact, SceneError> {
    let mut contact = table.choice("contact", &CONTACTS)?;
    if let Some(given) = table.opt_number("friction") {
        match &mut contact {
            Contact::Slip { friction } | Contact::Separate { friction } => *friction = given,
            Contact::Sticky | Contact::Open => {
                return Err(table
                    .error_at_key("friction", "friction is for \"slip\" and \"separate\" only"));
            }
        }
    }
    Ok(contact)
}

//! Variables of SPICE's text kernels by name; a later kernel may add to or replace what an earlier one set.

use std::collections::BTreeMap;

use crate::error::{Error, Location, Problem, Result};

/// Values of a variable.
#[derive(Debug, Clone, PartialEq)]
pub enum Values {
    /// Numbers; dates are s since 2000-01-01 12:00 by a calendar without leap seconds.
    Numbers(Vec<f64>),
    /// Texts.
    Texts(Vec<String>),
}

/// A variable.
#[derive(Debug, Clone, PartialEq)]
pub struct Variable {
    /// Its values.
    pub values: Values,
    /// Where it was last assigned to.
    pub at: Location,
}

/// All variables.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Pool {
    variables: BTreeMap<String, Variable>,
}

impl Pool {
    /// Whether there is no variable.
    pub fn is_empty(&self) -> bool {
        self.variables.is_empty()
    }

    /// Whether there is a variable of this name.
    pub fn has(&self, name: &str) -> bool {
        self.variables.contains_key(name)
    }

    /// Names of all variables, and the variables.
    pub fn iter(&self) -> impl Iterator<Item = (&str, &Variable)> {
        self.variables.iter().map(|(name, variable)| (name.as_str(), variable))
    }

    /// Sets a variable.
    pub fn assign(&mut self, name: &str, values: Values, at: Location) {
        self.variables.insert(name.to_owned(), Variable { values, at });
    }

    /// Adds values to a variable, behind those that it has.
    ///
    /// # Errors
    /// [`Error::Invalid`] for numbers behind texts, and texts behind numbers.
    pub fn append(&mut self, name: &str, values: Values, at: Location) -> Result<()> {
        let Some(variable) = self.variables.get_mut(name) else {
            self.assign(name, values, at);
            return Ok(());
        };
        match (&mut variable.values, values) {
            (Values::Numbers(there), Values::Numbers(more)) => there.extend(more),
            (Values::Texts(there), Values::Texts(more)) => there.extend(more),
            _ => return Err(Error::invalid(at, format!("{name}: += cannot mix numbers and strings"))),
        }
        variable.at = at;
        Ok(())
    }

    /// The numbers of a variable; `None` if there is no such variable.
    ///
    /// # Errors
    /// [`Error::Invalid`] if it has texts.
    pub fn numbers(&self, name: &str) -> Result<Option<&[f64]>> {
        match self.variables.get(name) {
            None => Ok(None),
            Some(Variable { values: Values::Numbers(numbers), .. }) => Ok(Some(numbers)),
            Some(_) => Err(self.wrong(name, "has texts where numbers are needed")),
        }
    }

    /// The texts of a variable; `None` if there is no such variable.
    ///
    /// # Errors
    /// [`Error::Invalid`] if it has numbers.
    pub fn texts(&self, name: &str) -> Result<Option<&[String]>> {
        match self.variables.get(name) {
            None => Ok(None),
            Some(Variable { values: Values::Texts(texts), .. }) => Ok(Some(texts)),
            Some(_) => Err(self.wrong(name, "has numbers where texts are needed: put them between '")),
        }
    }

    /// The first number of a variable.
    ///
    /// # Errors
    /// As [`numbers`](Pool::numbers).
    pub fn number(&self, name: &str) -> Result<Option<f64>> {
        Ok(self.numbers(name)?.and_then(|numbers| numbers.first().copied()))
    }

    /// The first number of a variable, as the whole number that it should be.
    ///
    /// # Errors
    /// As [`numbers`](Pool::numbers), and for fractions.
    pub fn integer(&self, name: &str) -> Result<Option<i32>> {
        self.number(name)?.map(|v| whole(v).ok_or_else(|| self.wrong(name, "is not a whole number"))).transpose()
    }

    /// The first text of a variable, without blanks about it.
    ///
    /// # Errors
    /// As [`texts`](Pool::texts).
    pub fn text(&self, name: &str) -> Result<Option<&str>> {
        Ok(self.texts(name)?.and_then(|texts| texts.first()).map(|text| text.trim()))
    }

    /// Where a variable was last assigned to, named as an item.
    pub fn at(&self, name: &str) -> Location {
        let at = self.variables.get(name).map(|variable| variable.at.clone()).unwrap_or_default();
        at.with_item(name)
    }

    /// An error about a variable.
    pub fn wrong(&self, name: &str, message: &str) -> Error {
        Error::Invalid(vec![Problem::new(self.at(name), message)])
    }
}

/// The whole number that an f64 is.
pub(crate) fn whole(value: f64) -> Option<i32> {
    #[allow(clippy::cast_possible_truncation, reason = "compared with what it came from")]
    let whole = value as i32;
    (f64::from(whole) == value).then_some(whole)
}

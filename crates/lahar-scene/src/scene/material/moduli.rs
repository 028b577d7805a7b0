//! The moduli of elastic solids: three pairs of keys, of which a material gives one.

use crate::error::SceneError;
use crate::scene::key::WhenAbsent::Words;
use crate::scene::key::{Bound, Key, Kind, key};
use crate::scene::read::Reader;
use lahar::material::lame;

/// Two keys that give the moduli of an elastic solid together.
struct Pair {
    keys: [&'static str; 2],
    /// Lamé's parameters (λ, μ) \[Pa\] from the values of the keys, in d dimensions.
    lame: fn(f64, f64, f64) -> (f64, f64),
}

const PAIRS: [Pair; 3] = [
    Pair {
        keys: ["youngs_modulus", "poisson_ratio"],
        lame: |youngs_modulus, poisson_ratio, _| lame(youngs_modulus, poisson_ratio),
    },
    Pair {
        keys: ["bulk_modulus", "shear_modulus"],
        lame: |bulk, shear, d| (bulk - 2.0 * shear / d, shear),
    },
    Pair {
        keys: ["lame_lambda", "lame_mu"],
        lame: |lambda, mu, _| (lambda, mu),
    },
];

/// The keys of all pairs.
pub(crate) fn moduli() -> impl Iterator<Item = &'static str> {
    PAIRS.iter().flat_map(|pair| pair.keys)
}

/// The keys of every elastic model.
pub(crate) static ELASTIC: &[Key] = &[
    key(
        "youngs_modulus",
        Kind::Number(Bound::Positive),
        "Pa",
        Words("one of the three pairs is required"),
        "Young's modulus, together with `poisson_ratio`.",
    ),
    key(
        "poisson_ratio",
        Kind::Number(Bound::Poisson),
        "",
        Words("with `youngs_modulus`"),
        "Poisson's ratio; λ and μ follow as in plane strain in 2D.",
    ),
    key(
        "bulk_modulus",
        Kind::Number(Bound::Positive),
        "Pa",
        Words("with `shear_modulus`"),
        "K = λ + 2μ/d in d dimensions.",
    ),
    key(
        "shear_modulus",
        Kind::Number(Bound::NotNegative),
        "Pa",
        Words("with `bulk_modulus`"),
        "Shear modulus G = μ.",
    ),
    key(
        "lame_lambda",
        Kind::Number(Bound::Any),
        "Pa",
        Words("with `lame_mu`"),
        "Lamé's first parameter λ; λ + 2μ/d must be positive.",
    ),
    key(
        "lame_mu",
        Kind::Number(Bound::NotNegative),
        "Pa",
        Words("with `lame_lambda`"),
        "Lamé's second parameter μ.",
    ),
];

/// Reads Lamé's parameters (λ, μ) \[Pa\] from the pair of keys that the material gives.
pub(super) fn read_moduli(table: &Reader<'_>, dimension: usize) -> Result<(f64, f64), SceneError> {
    let given: Vec<&str> = moduli().filter(|key| table.has(key)).collect();
    let pairs = || {
        PAIRS
            .each_ref()
            .map(|pair| pair.keys.join(" and "))
            .join("; or ")
    };
    let Some(Pair {
        keys: pair,
        lame: convert,
    }) = PAIRS
        .iter()
        .find(|pair| given.first().is_some_and(|key| pair.keys.contains(key)))
    else {
        return Err(table
            .error("this material has no moduli")
            .hint(format!("give {}", pairs())));
    };
    if let Some(other) = given.iter().find(|key| !pair.contains(key)) {
        return Err(table
            .error_at_key(
                other,
                format!("\"{other}\" does not go with \"{}\"", given[0]),
            )
            .hint(format!("give {}", pairs())));
    }
    if let Some(missing) = pair.iter().find(|key| !table.has(key)) {
        return Err(table.error_at_key(
            given[0],
            format!("\"{}\" needs \"{missing}\" beside it", given[0]),
        ));
    }
    let (a, b) = (table.number(pair[0])?, table.number(pair[1])?);
    let d = dimension as f64;
    let (lambda, mu) = convert(a, b, d);
    if lambda + 2.0 * mu / d <= 0.0 {
        return Err(table.error_at(
            pair[0],
            format!(
                "these moduli have a bulk modulus of {:.4e} Pa; it must be above 0",
                lambda + 2.0 * mu / d
            ),
        ));
    }
    Ok((lambda, mu))
}

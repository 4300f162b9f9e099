//! The keys that other programs have and this one has not, because it does not compute what they ask for.

/// What is not computed, and the keys that ask for it, alone or as the first part of a longer key (`yield_stress`).
const BEYOND: [(&str, &[&str]); 7] = [
    ("contact between two bodies", &["master", "slave", "tie", "tied", "self_contact", "bodies"]),
    (
        "plasticity",
        &["yield", "sigma_y", "plastic", "plasticity", "hardening", "hardness", "ultimate"],
    ),
    (
        "a law that is not linear elastic",
        &[
            "hyperelastic",
            "neo_hooke",
            "neohookean",
            "mooney",
            "ogden",
            "viscosity",
            "creep",
            "damage",
        ],
    ),
    (
        "dynamics",
        &[
            "density",
            "rho",
            "mass",
            "damping",
            "velocity",
            "acceleration",
            "dynamic",
            "dynamics",
            "time",
            "dt",
        ],
    ),
    ("axisymmetry", &["axisymmetric", "axisymmetry", "axisym"]),
    ("thermal strain", &["temperature", "thermal", "expansion", "alpha"]),
    (
        "a large displacement or rotation",
        &["nlgeom", "large", "finite", "nonlinear", "increments", "steps"],
    ),
];

/// Says what `word` asks for that is not computed, if it does.
pub(super) fn not_computed(word: &str) -> Option<String> {
    let word = word.to_lowercase().replace(['-', ' '], "_");
    let asks = |key: &&str| {
        word.strip_prefix(*key).is_some_and(|rest| rest.is_empty() || rest.starts_with('_'))
    };
    let (what, _) = BEYOND.iter().find(|(_, keys)| keys.iter().any(|key| asks(&key)))?;
    Some(format!("{what} is not computed by this program"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn keys_that_ask_for_what_is_not_computed_are_told_from_others() {
        for (key, what) in [
            ("Yield-Stress", "plasticity"),
            ("yield", "plasticity"),
            ("density", "dynamics"),
            ("axisymmetric", "axisymmetry"),
            ("master", "contact between two bodies"),
        ] {
            let said = not_computed(key);
            assert_eq!(said, Some(format!("{what} is not computed by this program")), "{key}");
        }
        for key in ["nonsense", "yung", "tolerence", "densities", "timeout"] {
            assert_eq!(not_computed(key), None, "{key}");
        }
    }
}

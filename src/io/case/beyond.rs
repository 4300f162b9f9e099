//! Keys of other programs that this program lacks: their subject is not computed, or has another key here.

/// Subjects that are not computed, and the keys that ask for them, alone or as the first part of a longer key (`yield_stress`).
const BEYOND: [(&str, &[&str]); 6] = [
    ("torsion", &["torsion", "torque", "twist"]),
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
    ("thermal strain", &["temperature", "thermal", "expansion", "alpha"]),
    (
        "a large displacement or rotation",
        &["nlgeom", "large", "finite", "nonlinear", "increments", "steps"],
    ),
];

/// Keys of this program, and the keys that other programs have for the same.
const ELSEWHERE: [(&str, &[&str]); 4] = [
    (
        "two boundaries that touch each other are a [[pair]]",
        &["master", "slave", "tie", "tied", "self_contact", "bodies"],
    ),
    (
        "friction stands in a contact = { friction = { coulomb = 0.3 } }, or in a [[pair]]",
        &["friction", "coulomb", "tresca", "mu_friction", "stick"],
    ),
    ("loads one after the other are [[step]] tables", &["step", "history", "cycle"]),
    (
        "a body of revolution has body.plane = \"axisymmetric\"",
        &["axisymmetric", "axisymmetry", "axisym"],
    ),
];

/// Says that the subject of `word` is not computed, or names the key of this program, if either is known.
pub(super) fn not_here(word: &str) -> Option<String> {
    let word = word.to_lowercase().replace(['-', ' '], "_");
    let asks = |key: &&str| {
        word.strip_prefix(*key).is_some_and(|rest| rest.is_empty() || rest.starts_with('_'))
    };
    let is_asked = |(_, keys): &&(&str, &[&str])| keys.iter().any(asks);
    let beyond = BEYOND.iter().find(is_asked);
    let beyond = beyond.map(|(what, _)| format!("{what} is not computed by this program"));
    beyond.or_else(|| ELSEWHERE.iter().find(is_asked).map(|(remedy, _)| (*remedy).to_owned()))
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
            ("torque", "torsion"),
        ] {
            let said = not_here(key);
            assert_eq!(said, Some(format!("{what} is not computed by this program")), "{key}");
        }
        assert!(not_here("Friction-Coefficient").is_some_and(|said| said.contains("coulomb")));
        assert!(not_here("master").is_some_and(|said| said.ends_with("are a [[pair]]")));
        assert!(not_here("axisymmetric").is_some_and(|said| said.contains("body.plane")));
        for key in ["nonsense", "yung", "tolerence", "densities", "timeout"] {
            assert_eq!(not_here(key), None, "{key}");
        }
    }
}

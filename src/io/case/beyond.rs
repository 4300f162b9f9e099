//! Keys of other programs that this program lacks: their subject is not computed, or has another key here.

/// What is said of a key, and the keys of which it is said, alone or as the first part of a longer key (`yield_stress`).
const ELSEWHERE: [(&str, &str); 10] = [
    ("torsion is not computed by this program", "torsion torque twist"),
    (
        "plasticity is not computed by this program",
        "yield sigma_y plastic plasticity hardening hardness ultimate",
    ),
    (
        "a law that is not linear elastic is not computed by this program",
        "hyperelastic neo_hooke neohookean mooney ogden viscosity creep damage",
    ),
    (
        "dynamics is not computed by this program",
        "density rho mass damping velocity acceleration dynamic dynamics time dt",
    ),
    ("thermal strain is not computed by this program", "temperature thermal expansion alpha"),
    (
        "a large displacement or rotation is not computed by this program",
        "nlgeom large finite nonlinear increments steps",
    ),
    (
        "two boundaries that touch each other are a [[pair]]",
        "master slave tie tied self_contact bodies",
    ),
    (
        "friction stands in a contact = { friction = { coulomb = 0.3 } }, or in a [[pair]]",
        "friction coulomb tresca mu_friction stick",
    ),
    ("loads one after the other are [[step]] tables", "step history cycle"),
    ("a body of revolution has body.plane = \"axisymmetric\"", "axisymmetric axisymmetry axisym"),
];

/// Says that the subject of `word` is not computed, or names the key of this program, if either is known.
pub(super) fn not_here(word: &str) -> Option<String> {
    let word = word.to_lowercase().replace(['-', ' '], "_");
    let asks = |key: &str| {
        word.strip_prefix(key).is_some_and(|rest| rest.is_empty() || rest.starts_with('_'))
    };
    let found = ELSEWHERE.iter().find(|(_, keys)| keys.split(' ').any(asks));
    found.map(|(said, _)| (*said).to_owned())
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

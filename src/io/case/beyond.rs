//! Keys of other programs that this program lacks: their subject is not computed, or has another key here.

/// Messages about keys, and the keys that get each, alone or as the first part of a longer key (`yield_stress`).
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

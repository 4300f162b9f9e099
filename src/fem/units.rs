//! Units that are powers of two times others: multiplying by them rounds nothing.
//!
//! Three units are free: of lengths, l; of moduli, e; and of displacements, d, for (8) is positively homogeneous in loads,
//! gaps and prescribed displacements. The others follow from them:
//!
//! | quantity | unit |
//! | --- | --- |
//! | strain | d / l |
//! | stress, traction, pressure | e d / l |
//! | force per area | e d / l^2 |
//! | force, per unit of thickness | e d |
//! | moment | e d l |
//! | energy | e d^2 |
//! | gamma0 | 1 / e |

/// Units, by their binary logarithms.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Units {
    length: i32,
    modulus: i32,
    displacement: i32,
}

/// x 2^exponent, which is exact where it is a normal number.
pub fn scaled(x: f64, exponent: i32) -> f64 {
    // Four factors within the range of normal numbers.
    let part = |k: i32| f64::from_bits(((1023 + k.clamp(-1022, 1023)) as u64) << 52);
    let quarter = exponent / 4;
    let factor = part(quarter);
    x * factor * factor * factor * part(exponent - 3 * quarter)
}

/// The binary logarithm of |x|, rounded down; `None` of zero and of what is not finite.
pub(super) fn exponent(x: f64) -> Option<i32> {
    let biased = |x: f64| (x.to_bits() >> 52 & 0x7ff) as i32 - 1023;
    let known = x != 0.0 && x.is_finite();
    known.then(|| if x.is_normal() { biased(x) } else { biased(x * 2.0_f64.powi(60)) - 60 })
}

impl Units {
    /// Those with these binary logarithms of the units of lengths, moduli and displacements.
    pub(super) fn new(length: i32, modulus: i32, displacement: i32) -> Units {
        Units { length, modulus, displacement }
    }

    /// Of lengths and places.
    pub fn length(self) -> i32 {
        self.length
    }

    /// Of moduli.
    pub fn modulus(self) -> i32 {
        self.modulus
    }

    /// Of displacements and gaps.
    pub fn displacement(self) -> i32 {
        self.displacement
    }

    /// Of strains.
    pub fn strain(self) -> i32 {
        self.displacement - self.length
    }

    /// Of stresses, tractions and pressures.
    pub fn stress(self) -> i32 {
        self.modulus + self.strain()
    }

    /// Of body forces.
    pub fn force_per_area(self) -> i32 {
        self.stress() - self.length
    }

    /// Of forces, per unit of thickness.
    pub fn force(self) -> i32 {
        self.modulus + self.displacement
    }

    /// Of moments.
    pub fn moment(self) -> i32 {
        self.force() + self.length
    }

    /// Of energies.
    pub fn energy(self) -> i32 {
        self.force() + self.displacement
    }

    /// Of gamma0.
    pub fn gamma0(self) -> i32 {
        -self.modulus
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn scaling_there_and_back_changes_nothing() {
        for x in [1.0, -0.3, 1e-300, 1e300, 0.0] {
            for k in [0, 1, -7, 500, -500, 900, -900] {
                let there = scaled(x, k);
                if x == 0.0 || there.is_normal() {
                    assert_eq!(scaled(there, -k), x, "{x} 2^{k}");
                    assert_eq!(there, x * 2.0_f64.powi(k), "{x} 2^{k}");
                }
            }
        }
        assert_eq!(scaled(2.0_f64.powi(-1000), 2000), 2.0_f64.powi(1000));
        assert_eq!((scaled(1.0, 5000), scaled(1.0, -5000)), (f64::INFINITY, 0.0));
    }

    #[test]
    fn the_exponent_is_that_of_the_largest_power_of_two_below() {
        let found = [1.0, -1.5, 2.0, 0.75, 5e-324, f64::MAX].map(exponent);
        assert_eq!(found, [Some(0), Some(0), Some(1), Some(-1), Some(-1074), Some(1023)]);
        assert_eq!([0.0, f64::NAN, f64::INFINITY].map(exponent), [None; 3]);
    }
}

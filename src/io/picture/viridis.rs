//! The colour map viridis: equal steps of the value look like equal steps of the colour, in print and to the colour-blind.

/// The map at 0, 1/8, ..., 1; in between it is interpolated.
pub const STOPS: [[u8; 3]; 9] = [
    [0x44, 0x01, 0x54],
    [0x47, 0x2d, 0x7b],
    [0x3b, 0x52, 0x8b],
    [0x2c, 0x72, 0x8e],
    [0x21, 0x91, 0x8c],
    [0x28, 0xae, 0x80],
    [0x5e, 0xc9, 0x62],
    [0xad, 0xdc, 0x30],
    [0xfd, 0xe7, 0x25],
];

/// The colour at `t`, as SVG wants it. Below 0 and above 1 it is the colour of the end.
pub fn colour(t: f64) -> String {
    let place = t.clamp(0.0, 1.0) * (STOPS.len() - 1) as f64;
    let below = (place as usize).min(STOPS.len() - 2);
    let part = place - below as f64;
    let mix = |c: usize| {
        let [from, to] = [STOPS[below][c], STOPS[below + 1][c]].map(f64::from);
        (from + part * (to - from)).round() as u8
    };
    format!("#{:02x}{:02x}{:02x}", mix(0), mix(1), mix(2))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_map_passes_through_its_stops_and_stays_at_its_ends() {
        assert_eq!(colour(0.0), "#440154");
        assert_eq!(colour(0.5), "#21918c");
        assert_eq!(colour(1.0), "#fde725");
        assert_eq!(colour(-1.0), colour(0.0));
        assert_eq!(colour(2.0), colour(1.0));
        assert_eq!(colour(1.0 / 16.0), "#461768");
    }

    #[test]
    fn the_map_grows_brighter_from_end_to_end() {
        let brightness =
            |[r, g, b]: [u8; 3]| 299 * u32::from(r) + 587 * u32::from(g) + 114 * u32::from(b);
        assert!(STOPS.map(brightness).is_sorted_by(|a, b| a < b));
    }
}

//! A foot of steel, pressed on a rigid floor by 0.001 mm: a mesh from your own points and triangles (counter-clockwise),
//! whose boundary parts are lists of edges. Units: mm and N.

use std::error::Error;

use signorini::{Condition, Material, Mesh, Method, Plane, Problem, Settings, solve};

fn main() -> Result<(), Box<dyn Error>> {
    let points = vec![[-2.0, 0.0], [0.0, 0.0], [2.0, 0.0], [-3.0, 2.0], [0.0, 2.0], [3.0, 2.0]];
    let triangles = vec![[0, 1, 4], [1, 2, 4], [0, 4, 3], [2, 5, 4]];
    let foot = ("foot".to_owned(), vec![[0, 1], [1, 2]]);
    let head = ("head".to_owned(), vec![[5, 4], [4, 3]]);
    let mesh = Mesh::new(points, triangles, [foot, head])?;
    let problem = Problem::of(mesh, Material::young_poisson(210e3, 0.3, Plane::Strain))
        .with("head", Condition::displacement(|_| 0.0, |_| -1e-3))
        .with("foot", Condition::contact(|_| 0.0));
    let (solution, _) = solve(&problem, &Method::default(), &Settings::default())?;
    for (point, [u_x, u_y]) in solution.nodes.iter().zip(&solution.displacement) {
        println!("at {point:?}: displacement ({u_x:.3e}, {u_y:.3e})");
    }
    println!("contact force {:.1} N per mm", solution.quantities.contact_force);
    Ok(())
}

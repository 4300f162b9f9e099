//! A block pressed on a rigid floor, half of it lifted off: mesh and problem in code, no files.

use std::error::Error;

use signorini::{
    Condition, Diagonal, Material, Method, Plane, Problem, Rectangle, Settings, solve,
};

fn main() -> Result<(), Box<dyn Error>> {
    let (nx, ny, diagonal) = (32, 32, Diagonal::Right);
    let mesh = Rectangle { width: 1.0, height: 1.0, nx, ny, diagonal }.mesh()?;
    let problem = Problem::of(mesh, Material::lame(1.0, 1.0, Plane::Strain))
        .with_body_force(|_| 0.0, |[x, _]| -4.0 + 10.0 * x)
        .with("top", Condition::clamped())
        .with("bottom", Condition::contact(|_| 0.0));
    let (solution, _) = solve(&problem, &Method::default(), &Settings::default())?;
    let quantities = &solution.quantities;
    println!("force {:.4}, length {:.4}", quantities.contact_force, quantities.contact_length);
    Ok(())
}

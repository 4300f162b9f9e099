//! First contact: a tutorial that is a program. Run it with `cargo run --release --example first_contact`.
//!
//! # 1. The problem
//!
//! A wheel of radius 500 mm is pressed 0.01 mm into a block of steel, 20 mm wide and 10 mm high, whose base is clamped. The
//! wheel is rigid here. How hard does it press, over which width, and how large is the peak of the pressure?
//!
//! ```text
//!            .-- wheel, rigid, radius 500 -.
//!             `.                         .'
//!   +-----------`-.___________________.-'-----------+   top: Gamma_C, g = the distance to the wheel
//!   |                                               |
//!   |                 block, elastic                |   left, right: free
//!   |                                               |
//!   +===============================================+   bottom: Gamma_D, u = 0
//! ```
//!
//! Nobody knows in advance which part of the top touches: that is what makes the problem nonlinear. On Gamma_C the paper's
//! conditions (2) hold: u_n <= g (no penetration), sigma_n <= 0 (no glue), sigma_n (u_n - g) = 0 (pressure only where the
//! bodies touch), no shear.
//!
//! # 2. The method
//!
//! The three conditions (2) are one equation, sigma_n = -(1/gamma) [u_n - g - gamma sigma_n]+, for any gamma > 0 (Proposition
//! 2.1). Nitsche's method puts this equation into the weak form: method (8), with displacements for its only unknown. gamma is
//! chosen by the program so that (8) has exactly one solution; the program finds it by Newton's method and proves how near it
//! came.
//!
//! Hertz's theory gives numbers to compare with, if the block is thought of as a half plane: for a force F per millimetre the
//! half width is a = (4 F R / (pi E*))^(1/2), the peak p0 = 2 F / (pi a), with E* = E / (1 - nu^2).

use std::error::Error;
use std::f64::consts::PI;

use signorini::certificates::certify;
use signorini::{
    Condition, Degree, Diagonal, Material, Method, Obstacle, Plane, Problem, Rectangle, Settings,
    Side, solve,
};

fn main() -> Result<(), Box<dyn Error>> {
    // # 3. The program. Lengths in mm, forces in N, stresses so in MPa.
    let (width, height) = (20.0, 10.0);
    let (radius, depth) = (500.0, 0.01);
    let (young, poisson) = (210e3, 0.3);

    // The mesh: cells of 1/8 mm, since contact will be two or three millimetres wide. The sides are named left, right, bottom, top.
    let (nx, ny, diagonal) = (160, 80, Diagonal::Crossed);
    let mesh = Rectangle { width, height, nx, ny, diagonal }.mesh()?;

    // The wheel: a circle that the body lies outside of, its lowest point 0.01 mm below the top of the block.
    let center = [width / 2.0, height + radius - depth];
    let wheel = Obstacle::Circle { center, radius, side: Side::Outside };

    let problem = Problem::of(mesh, Material::young_poisson(young, poisson, Plane::Strain))
        .with("bottom", Condition::clamped())
        .with("top", Condition::obstacle("wheel", wheel));

    // P1 triangles, and all else as the program chooses.
    let method = Method { degree: Degree::One, ..Method::default() };
    let (solution, _) = solve(&problem, &method, &Settings::default())?;

    // # 4. The result.
    let quantities = &solution.quantities;
    let (force, contact_width) = (quantities.contact_force, quantities.contact_length);
    let stiffness = young / (1.0 - poisson * poisson);
    let half_width = (4.0 * force * radius / (PI * stiffness)).sqrt();
    let peak = 2.0 * force / (PI * half_width);
    println!("the wheel presses with   {force:.1} N/mm");
    println!("over a width of          {contact_width:.3} mm   (Hertz: {:.3})", 2.0 * half_width);
    println!(
        "with a peak pressure of  {:.0} MPa      (Hertz: {peak:.0})",
        quantities.peak_pressure
    );

    // How near the computed displacement is to the one solution of the discrete equations, proved, rounding included; how near
    // it is to the true solution, with a proof too, except that the wheel is round and the mesh knows it at its nodes only.
    let relative = solution.enclosure.as_ref().ok().and_then(|enclosure| enclosure.relative);
    match relative {
        Some(relative) => println!("discrete equations       solved to {relative:.0e}, proved"),
        None => println!("discrete equations       not proved"),
    }
    let bound = certify(&problem, &solution)?;
    println!("error of the mesh        at most {:.1} % in the energy norm", 100.0 * bound.relative);

    // # 5. What to try
    //
    // - `Degree::Two`: the same mesh, quadratic displacements; the bound falls.
    // - Half the cells, then twice as many: the bound goes with the cell size.
    // - `depth` four times as large: by Hertz the width doubles. A mesh that is too coarse for the contact shows in the width
    //   first.
    // - `Condition::contact(|[x, _]| (x - 10.0).powi(2) / 1000.0 - 0.01)` in place of the obstacle: a parabola for the circle.
    // - `solution.write(&problem, Path::new("out/first_contact"))`: files for ParaView and spreadsheets.
    Ok(())
}

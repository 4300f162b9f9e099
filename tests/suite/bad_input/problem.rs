//! Mistakes in what is to be solved: materials, loads, boundaries, the method.

use super::*;

const ISOTROPIC: &str = "lambda = 1.0\nmu = 1.0\nplane = \"strain\"";

#[test]
fn materials() {
    compare_cases(
        "materials",
        &[
            (
                ["[material]\nlambda = 1.0\nmu = 1.0\nplane = \"strain\"\n", ""],
                "bad.toml: [material] is missing; expected lambda and mu, young and poisson, stiffness, or orthotropic in it",
            ),
            (
                ["lambda = 1.0\n", ""],
                "bad.toml:4: [material]: found mu; expected lambda and mu, young and poisson, stiffness, or orthotropic",
            ),
            (
                ["lambda = 1.0\nmu = 1.0\n", ""],
                "bad.toml:4: [material]: found none; expected lambda and mu, young and poisson, stiffness, or orthotropic",
            ),
            (
                ["lambda = 1.0", "young = 2.5"],
                "bad.toml:4: [material]: found mu and young; expected lambda and mu, young and poisson, stiffness, or orthotropic",
            ),
            (
                ["lambda = 1.0", "lambda = 1.0\nyoung = 2.5"],
                "bad.toml:4: [material]: found lambda, mu and young; expected lambda and mu, young and poisson, stiffness, or orthotropic",
            ),
            (
                ["mu = 1.0", "mu = -1.0"],
                "bad.toml:6: [material] mu = -1.0; expected a positive number",
            ),
            (["mu = 1.0", "mu = 0"], "bad.toml:6: [material] mu = 0; expected a positive number"),
            (
                ["lambda = 1.0", "lambda = -1"],
                "bad.toml:5: [material] lambda = -1; expected a number above -0.6666666666666666, for 3 lambda + 2 mu > 0",
            ),
            (
                ["lambda = 1.0\nmu = 1.0", "young = 0\npoisson = 0.3"],
                "bad.toml:5: [material] young = 0; expected a positive number",
            ),
            (
                ["lambda = 1.0\nmu = 1.0", "young = 1.0\npoisson = 0.5"],
                "bad.toml:6: [material] poisson = 0.5; expected a number above -1 and below 0.5",
            ),
            (
                ["lambda = 1.0\nmu = 1.0", "young = 1.0\npoisson = -1"],
                "bad.toml:6: [material] poisson = -1; expected a number above -1 and below 0.5",
            ),
            (
                ["lambda = 1.0\nmu = 1.0", "young = 1e308\npoisson = 0.4999999"],
                "bad.toml:4: [material]: found moduli with lambda + 2 mu = inf in the plane; expected a positive finite sum; choose other units",
            ),
            (
                [
                    "lambda = 1.0\nmu = 1.0\nplane = \"strain\"",
                    "lambda = 1e10\nmu = 1e300\nplane = \"stress\"",
                ],
                "bad.toml:4: [material]: found moduli with lambda + 2 mu = inf in the plane; expected a positive finite sum; choose other units",
            ),
            (
                ["plane = \"strain\"", "plane = \"stain\""],
                r#"bad.toml:7: [material] plane = "stain"; expected "strain" or "stress""#,
            ),
            (
                [ISOTROPIC, "stiffness = [1, 2, 0, 1, 0, 1]\nplane = \"stress\""],
                "bad.toml:5: [material] stiffness: the smallest eigenvalue of the stiffness [1, 2, 0, 1, 0, 1] is -1; expected an elliptic law: a positive one, at least 1e-10 of the largest",
            ),
            (
                [ISOTROPIC, "stiffness = [3, 1, 3, 1]\nplane = \"stress\""],
                "bad.toml:5: [material] stiffness = a list of 4; expected a list of six numbers: C11, C12, C16, C22, C26, C66",
            ),
            (
                [ISOTROPIC, "stiffness = [3, 1, 0, 3, 0, 1]"],
                "bad.toml:4: [material]: found stiffness in plane strain without across; expected plane = \"stress\", or across = [a, b, c] with sigma_zz = a sigma_xx + b sigma_yy + c sigma_xy",
            ),
            (
                [
                    ISOTROPIC,
                    "stiffness = [3, 1, 0, 3, 0, 1]\nacross = [0, 0, 0]\nplane = \"stress\"",
                ],
                "bad.toml:4: [material]: found across in plane stress; expected plane strain with it",
            ),
            (
                ["mu = 1.0", "mu = 1.0\nacross = [0, 0, 0]"],
                "bad.toml:4: [material]: found across without stiffness; expected both, or neither",
            ),
            (
                [
                    ISOTROPIC,
                    "orthotropic = { e1 = 12, e2 = 0.6, nu12 = 0.4, g12 = 0.7, angle = 30 }",
                ],
                "bad.toml:5: [material] orthotropic.e3 is missing; expected a number, in plane strain",
            ),
            (
                [
                    ISOTROPIC,
                    "orthotropic = { e1 = 12, e2 = 0.6, nu12 = 0.4, g12 = -0.7 }\nplane = \"stress\"",
                ],
                "bad.toml:5: [material] orthotropic: g12 is -0.7; expected a positive number",
            ),
        ],
    );
}

#[test]
fn loads_and_expressions() {
    compare_cases(
        "loads",
        &[
            (
                ["body = [\"0\", \"-4 + 10*x\"]", "body = [\"0\"]"],
                "bad.toml:9: [load] body = a list of 1; expected a list of two: one for x, one for y",
            ),
            (
                ["body = [\"0\", \"-4 + 10*x\"]", "body = [\"0\", \"0\", \"0\"]"],
                "bad.toml:9: [load] body = a list of 3; expected a list of two: one for x, one for y",
            ),
            (
                ["body = [\"0\", \"-4 + 10*x\"]", "body = \"0\""],
                r#"bad.toml:9: [load] body = "0"; expected a list of two: one for x, one for y"#,
            ),
            (
                ["body = [\"0\", \"-4 + 10*x\"]", "body = [true, -4]"],
                r#"bad.toml:9: [load] body[0] = true; expected a number, or an expression in quotes, such as "2*x""#,
            ),
            (
                ["body =", "bodyforce ="],
                "bad.toml:9: unknown key 'bodyforce' in [load]; expected body",
            ),
            (
                ["-4 + 10*x", "-4 + 10*z"],
                r#"bad.toml:9: [load] body[1] = "-4 + 10*z": column 9: found 'z', expected a number, x, y, pi, a function or '('"#,
            ),
            (
                ["-4 + 10*x", "4 +"],
                r#"bad.toml:9: [load] body[1] = "4 +": column 4: found the end, expected a number, x, y, pi, a function or '('"#,
            ),
            (
                ["-4 + 10*x", "2x"],
                r#"bad.toml:9: [load] body[1] = "2x": column 2: found 'x', expected an operator (+ - * / ^) or the end"#,
            ),
            (
                ["-4 + 10*x", "tan(x)"],
                r#"bad.toml:9: [load] body[1] = "tan(x)": column 1: found 'tan', expected one of the functions sqrt, sin, cos, exp, abs, min, max"#,
            ),
            (
                ["-4 + 10*x", "10*nan"],
                r#"bad.toml:9: [load] body[1] = "10*nan": column 4: found 'nan', expected a number, x, y, pi, a function or '('"#,
            ),
            (
                ["-4 + 10*x", "1/0"],
                r#"bad.toml:9: [load] body[1] = "1/0", which is inf; expected a finite value"#,
            ),
            (
                ["-4 + 10*x", "sqrt(-1)"],
                r#"bad.toml:9: [load] body[1] = "sqrt(-1)", which is NaN; expected a finite value"#,
            ),
            (
                ["-4 + 10*x", "free"],
                r#"bad.toml:9: [load] body[1] = "free": column 1: found 'free', expected a number, x, y, pi, a function or '('"#,
            ),
            (
                ["-4 + 10*x", ""],
                r#"bad.toml:9: [load] body[1] = "": column 1: found the end, expected a number, x, y, pi, a function or '('"#,
            ),
        ],
    );
}

#[test]
fn boundaries() {
    compare_cases(
        "boundaries",
        &[
            (
                ["[boundary.bottom]\ncontact = { gap = \"0\" }\n", ""],
                r#"bad.toml:10: [boundary]: found no contact; expected one boundary with contact, such as [boundary.bottom] contact = { gap = "0" }"#,
            ),
            (
                [
                    "[boundary.top]\ndisplacement = [\"0\", \"free\"]\n[boundary.bottom]\ncontact = { gap = \"0\" }\n",
                    "",
                ],
                r#"bad.toml: [boundary] is missing; expected one boundary with contact, such as [boundary.bottom] contact = { gap = "0" }"#,
            ),
            (
                ["[boundary.bottom]", "[boundary.botom]"],
                "bad.toml:12: [boundary.botom]: no boundary named 'botom'; this mesh has: bottom, left, right, top",
            ),
            (
                ["[boundary.bottom]", "[boundary.\"the floor\"]"],
                r#"bad.toml:12: [boundary."the floor"]: no boundary named 'the floor'; this mesh has: bottom, left, right, top"#,
            ),
            (
                ["[boundary.bottom]", "[boundary.top]"],
                "bad.toml:12: invalid TOML at 'top': duplicate key",
            ),
            (
                ["[boundary.top]\n", "[boundary.top]\ntraction = [\"1\", \"0\"]\n"],
                "bad.toml:11: [boundary.top] traction[0] = \"1\"; expected 0: the displacement is given in this component, so its traction is the reaction ([boundary.top])",
            ),
            (
                ["[boundary.top]\n", "[boundary.top]\ncontact = {}\n"],
                "bad.toml:10: [boundary.top]: found displacement and contact; expected either displacement, traction, pressure, normal, tangential, contact or force",
            ),
            (
                ["displacement = [\"0\", \"free\"]\n", ""],
                "bad.toml:10: [boundary.top]: found none; expected either displacement, traction, pressure, normal, tangential, contact or force",
            ),
            (
                ["[boundary.top]\n", "[boundary.top]\nforce = [0, -1]\n"],
                "bad.toml:10: [boundary.top]: found displacement and force; expected either displacement, traction, pressure, normal, tangential, contact or force",
            ),
            (
                ["displacement = [\"0\", \"free\"]", "force = [0, \"-x\"]"],
                "bad.toml:11: [boundary.top] force[1] = \"-x\"; expected a number",
            ),
            (
                ["[load]", "[body]\nthickness = 0\n[load]"],
                "bad.toml:9: [body] thickness = 0; expected a positive number",
            ),
            (
                ["[output]", "[output]\nstretch = -1"],
                "bad.toml:23: [output] stretch = -1; expected a positive number",
            ),
            (
                ["displacement =", "displacment ="],
                "bad.toml:11: unknown key 'displacment' in [boundary.top]; expected displacement, traction, pressure, normal, tangential, contact or force",
            ),
            (
                ["displacement = [\"0\", \"free\"]", "displacement = [\"0\", \"fixed\"]"],
                r#"bad.toml:11: [boundary.top] displacement[1] = "fixed"; expected an expression, or "free""#,
            ),
            (
                ["displacement = [\"0\", \"free\"]", "displacement = [\"0\", \"x*\"]"],
                r#"bad.toml:11: [boundary.top] displacement[1] = "x*": column 3: found the end, expected a number, x, y, pi, a function or '('"#,
            ),
            (
                ["displacement = [\"0\", \"free\"]", "displacement = \"0\""],
                r#"bad.toml:11: [boundary.top] displacement = "0"; expected a list of two: one for x, one for y"#,
            ),
            (
                ["displacement = [\"0\", \"free\"]", "traction = [\"0\", \"free\"]"],
                r#"bad.toml:11: [boundary.top] traction[1] = "free": column 1: found 'free', expected a number, x, y, pi, a function or '('"#,
            ),
            (
                ["contact = { gap = \"0\" }", "contact = true"],
                r#"bad.toml:13: [boundary.bottom] contact = true; expected a table, such as { gap = "0" } or { obstacle = "floor" }"#,
            ),
            (
                ["contact = { gap = \"0\" }", "contact = { gap = false }"],
                r#"bad.toml:13: [boundary.bottom] contact.gap = false; expected a number, or an expression in quotes, such as "2*x""#,
            ),
            (
                ["contact = { gap = \"0\" }", "contact = { gap = \"x^\" }"],
                r#"bad.toml:13: [boundary.bottom] contact.gap = "x^": column 3: found the end, expected a number, x, y, pi, a function or '('"#,
            ),
            (
                ["contact = { gap = \"0\" }", "contact = { friction = 0.3 }"],
                "bad.toml:13: unknown key 'friction' in [boundary.bottom] contact; expected gap or obstacle",
            ),
            (
                ["[boundary.bottom]\ncontact", "[boundary]\nbottom"],
                "bad.toml:13: unknown key 'gap' in [boundary.bottom]; expected displacement, traction, pressure, normal, tangential, contact or force",
            ),
        ],
    );
}

#[test]
fn methods_solvers_and_outputs() {
    compare_cases(
        "methods",
        &[
            (["degree = 1", "degree = 3"], "bad.toml:15: [method] degree = 3; expected 1 or 2"),
            (["degree = 1", "degree = 1.0"], "bad.toml:15: [method] degree = 1.0; expected 1 or 2"),
            (
                ["degree = 1", "degree = 1\ntheta = 1"],
                "bad.toml:16: unknown key 'theta' in [method]; expected degree, gamma0, kappa, contact_quadrature or allow_noncoercive",
            ),
            (
                ["gamma0 = 0.1", "gamma0 = 0"],
                r#"bad.toml:16: [method] gamma0 = 0; expected a positive number or "auto""#,
            ),
            (
                ["gamma0 = 0.1", "gamma0 = -0.1"],
                r#"bad.toml:16: [method] gamma0 = -0.1; expected a positive number or "auto""#,
            ),
            (
                ["gamma0 = 0.1", "gamma0 = inf"],
                "bad.toml:16: [method] gamma0 = inf; expected a finite number",
            ),
            (
                ["gamma0 = 0.1", "gamma0 = \"automatic\""],
                r#"bad.toml:16: [method] gamma0 = "automatic"; expected a positive number or "auto""#,
            ),
            (
                ["contact_quadrature = \"exact\"", "contact_quadrature = \"gauss\""],
                r#"bad.toml:17: [method] contact_quadrature = "gauss"; expected "exact" or { gauss = points per edge }"#,
            ),
            (
                ["contact_quadrature = \"exact\"", "contact_quadrature = 4"],
                r#"bad.toml:17: [method] contact_quadrature = 4; expected "exact" or { gauss = points per edge }"#,
            ),
            (
                ["contact_quadrature = \"exact\"", "contact_quadrature = { gauss = 0 }"],
                "bad.toml:17: [method] contact_quadrature.gauss = 0; expected a whole number from 1 to 64",
            ),
            (
                ["contact_quadrature = \"exact\"", "contact_quadrature = { gauss = 65 }"],
                "bad.toml:17: [method] contact_quadrature.gauss = 65; expected a whole number from 1 to 64",
            ),
            (
                ["contact_quadrature = \"exact\"", "contact_quadrature = { points = 4 }"],
                "bad.toml:17: unknown key 'points' in [method] contact_quadrature; expected gauss",
            ),
            (
                ["contact_quadrature = \"exact\"", "contact_quadrature = {}"],
                "bad.toml:17: [method] contact_quadrature.gauss is missing; expected a number of points per edge",
            ),
            (
                ["tolerance = 1e-10", "tolerance = 0"],
                "bad.toml:20: [solver] tolerance = 0; expected a number above 0 and below 1",
            ),
            (
                ["tolerance = 1e-10", "tolerance = 1"],
                "bad.toml:20: [solver] tolerance = 1; expected a number above 0 and below 1",
            ),
            (
                ["tolerance = 1e-10", "tolerance = nan"],
                "bad.toml:20: [solver] tolerance = nan; expected a finite number",
            ),
            (
                ["max_iterations = 50", "max_iterations = 0"],
                "bad.toml:21: [solver] max_iterations = 0; expected a whole number from 1 to 1000000",
            ),
            (
                ["[0, 1], [0.5, 0.5]", "[0, 1, 0]"],
                "bad.toml:23: [output] probes[0] = a list of 3; expected a list of two: one for x, one for y",
            ),
            (
                ["[0, 1], [0.5, 0.5]", "[0, 1], [0.5, nan]"],
                "bad.toml:23: [output] probes[1][1] = nan; expected a finite number",
            ),
            (
                ["[[0, 1], [0.5, 0.5]]", "[0, 1]"],
                "bad.toml:23: [output] probes[0] = 0; expected a list of two: one for x, one for y",
            ),
            (
                ["[[0, 1], [0.5, 0.5]]", "\"all\""],
                r#"bad.toml:23: [output] probes = "all"; expected a list"#,
            ),
        ],
    );
}

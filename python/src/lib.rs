//! The Python module `signorini._signorini`: cases and meshes in, raw bytes of native numbers out. What a person sees of it
//! is `signorini/__init__.py`, which makes arrays of them.

use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use pyo3::create_exception;
use pyo3::exceptions::{PyOSError, PyRuntimeError, PyValueError};
use pyo3::prelude::*;
use pyo3::types::{PyBytes, PyDict};
use signorini::fem::Mesh;
use signorini::io::Case;
use signorini::io::outputs::{self, Extra};
use signorini::io::picture::draw;
use signorini::io::result::{Results, result_json};
use signorini::io::summary;
use signorini::io::{Failure, run};
use signorini::kernel::Stress;
use signorini::solve::Solution;

create_exception!(signorini, CaseError, PyValueError, "The case is wrong.");
create_exception!(
    signorini,
    SolveError,
    PyRuntimeError,
    "The case is right, but there is no solution."
);

/// Solves the case in a file, with these settings over it.
#[pyfunction]
fn solve_case(py: Python<'_>, path: PathBuf, settings: Vec<String>) -> PyResult<Solved> {
    py.detach(|| {
        let start = Instant::now();
        let text = Case::text(&path).map_err(wrong)?;
        let case = Case::parse(&path, &text, &settings).map_err(wrong)?;
        solved(case, start)
    })
}

/// Solves a case without a mesh on this one: points as pairs of doubles, triangles, edges and the triangles of surfaces as
/// 64-bit numbers.
#[pyfunction]
fn solve(
    py: Python<'_>,
    text: &str,
    points: &[u8],
    triangles: &[u8],
    boundaries: Vec<(String, Vec<u8>)>,
    surfaces: Vec<(String, Vec<u8>)>,
    named_points: Vec<(String, usize)>,
) -> PyResult<Solved> {
    py.detach(|| {
        let start = Instant::now();
        let boundaries = boundaries
            .iter()
            .map(|(name, edges)| Ok((name.clone(), indices(edges)?)))
            .collect::<PyResult<Vec<_>>>()?;
        let members = |bytes: &[u8]| -> PyResult<Vec<usize>> {
            Ok(indices(bytes)?.into_iter().map(|[t]: [usize; 1]| t).collect())
        };
        let surfaces = surfaces
            .into_iter()
            .map(|(name, bytes)| Ok((name, members(&bytes)?)))
            .collect::<PyResult<_>>()?;
        let pairs = Case::pairs(Path::new("case"), text).map_err(wrong)?;
        let mesh = Mesh::with_pairs(doubles(points), indices(triangles)?, boundaries, &pairs);
        let mesh = mesh.map_err(wrong)?;
        let mesh = mesh.with_names(surfaces, named_points.into_iter().collect());
        let case = Case::on_mesh(Path::new("case"), text, mesh).map_err(wrong)?;
        solved(case, start)
    })
}

fn wrong(error: impl ToString) -> PyErr {
    CaseError::new_err(error.to_string())
}

/// Pairs of doubles.
fn doubles(bytes: &[u8]) -> Vec<[f64; 2]> {
    let (numbers, _) = bytes.as_chunks::<8>();
    let (pairs, _) = numbers.as_chunks::<2>();
    pairs.iter().map(|pair| pair.map(f64::from_ne_bytes)).collect()
}

/// Tuples of numbers of points.
fn indices<const K: usize>(bytes: &[u8]) -> PyResult<Vec<[usize; K]>> {
    let (numbers, _) = bytes.as_chunks::<8>();
    let (tuples, _) = numbers.as_chunks::<K>();
    let index = |bytes: &[u8; 8]| {
        let number = i64::from_ne_bytes(*bytes);
        usize::try_from(number)
            .map_err(|_| wrong(format!("found point number {number}; expected one from 0 on")))
    };
    tuples
        .iter()
        .map(|tuple| {
            let mut indices = [0; K];
            for (i, bytes) in indices.iter_mut().zip(tuple) {
                *i = index(bytes)?;
            }
            Ok(indices)
        })
        .collect()
}

/// A solved case.
#[pyclass(frozen, module = "signorini._signorini")]
struct Solved {
    case: Case,
    solved: run::Solved,
    results: Results,
    read: Duration,
}

#[pymethods]
impl Solved {
    /// The arrays of the solution, and the text of result.json.
    fn arrays<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        raw(py, &self.solved.solution, &result_json(&self.results).map_err(no_results)?)
    }

    /// What the command prints.
    fn summary(&self) -> String {
        summary::solved(&self.results, &[], false)
    }

    /// The text of picture.svg.
    fn picture(&self, py: Python<'_>) -> PyResult<String> {
        py.detach(|| draw(&self.case, &self.solved.solution, &self.results)).map_err(no_results)
    }

    /// Writes the files that the command writes, and returns their paths.
    fn write(&self, py: Python<'_>, folder: PathBuf, report: bool) -> PyResult<Vec<PathBuf>> {
        let extra = Extra { report, ..Extra::default() };
        let written =
            py.detach(|| outputs::write(&folder, &self.case, &self.solved, self.read, extra));
        Ok(written.map_err(|error| PyOSError::new_err(error.to_string()))?.0)
    }
}

fn no_results(error: impl ToString) -> PyErr {
    SolveError::new_err(error.to_string())
}

fn solved(case: Case, start: Instant) -> PyResult<Solved> {
    let read = start.elapsed();
    let (case, solved) = run::solve(case, None, &|_| {}).map_err(|error| unsolved(&error))?;
    let results = outputs::results(&case, &solved, read, Extra::default()).map_err(no_results)?;
    Ok(Solved { case, solved, results, read })
}

fn unsolved(error: &Failure) -> PyErr {
    if error.is_wrong() { wrong(error) } else { SolveError::new_err(error.to_string()) }
}

fn raw<'py>(py: Python<'py>, s: &Solution, results: &str) -> PyResult<Bound<'py, PyDict>> {
    let dict = PyDict::new(py);
    let floats = |name: &str, values: &mut dyn Iterator<Item = f64>| {
        let bytes: Vec<u8> = values.flat_map(f64::to_ne_bytes).collect();
        dict.set_item(name, PyBytes::new(py, &bytes))
    };
    let integers = |name: &str, values: &mut dyn Iterator<Item = usize>| {
        let bytes: Vec<u8> = values.flat_map(|i| (i as i64).to_ne_bytes()).collect();
        dict.set_item(name, PyBytes::new(py, &bytes))
    };
    floats("nodes", &mut s.nodes.iter().flatten().copied())?;
    integers("elements", &mut s.elements.iter().copied())?;
    dict.set_item("nodes_per_triangle", s.nodes_per_triangle)?;
    floats("displacement", &mut s.displacement.iter().flatten().copied())?;
    let stress = |(t, zz): &(Stress<f64>, f64)| {
        let [xx, yy, xy] = t.components();
        [xx, yy, *zz, xy]
    };
    floats("stress", &mut s.stress.iter().flat_map(stress))?;
    floats("von_mises", &mut s.von_mises.iter().copied())?;
    let points = || s.contact.iter().flat_map(|edge| &edge.points);
    floats("arc", &mut points().map(|p| p.arc))?;
    integers("node", &mut points().map(|p| p.node))?;
    floats("u_n", &mut points().map(|p| p.u_n))?;
    floats("gap", &mut points().map(|p| p.gap))?;
    floats("sigma_n", &mut points().map(|p| p.sigma_n))?;
    floats("lambda_h", &mut points().map(|p| p.lambda))?;
    floats("pressure", &mut points().map(|p| p.pressure))?;
    let names = s.contact.iter().flat_map(|edge| edge.points.iter().map(|_| &*edge.boundary));
    dict.set_item("boundary", names.collect::<Vec<&str>>())?;
    dict.set_item("results", results)?;
    Ok(dict)
}

/// The module.
#[pymodule]
fn _signorini(module: &Bound<'_, PyModule>) -> PyResult<()> {
    module.add("__version__", env!("CARGO_PKG_VERSION"))?;
    module.add("CaseError", module.py().get_type::<CaseError>())?;
    module.add("SolveError", module.py().get_type::<SolveError>())?;
    module.add_class::<Solved>()?;
    module.add_function(wrap_pyfunction!(solve_case, module)?)?;
    module.add_function(wrap_pyfunction!(solve, module)?)
}

//! The Python module `signorini._signorini`: cases and meshes in, raw bytes of native numbers out. What a person sees of it
//! is `signorini/__init__.py`, which makes arrays of them.

use std::panic::resume_unwind;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{RecvTimeoutError, channel};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::{Duration, Instant};

use pyo3::create_exception;
use pyo3::exceptions::{PyOSError, PyRuntimeError, PyValueError};
use pyo3::prelude::*;
use pyo3::types::{PyBytes, PyDict};
use signorini::contact::Pair;
use signorini::io::Case;
use signorini::io::outputs::{self, Extra};
use signorini::io::picture::picture_of;
use signorini::io::raw_mesh::{Block, Made, of_blocks};
use signorini::io::result::{Results, result_json};
use signorini::io::summary;
use signorini::io::{Failure, run};
use signorini::kernel::Stress;
use signorini::model::{Function, Mesh, SharedFunction};
use signorini::results::ContactPoint;
use signorini::results::Solution;

create_exception!(signorini, CaseError, PyValueError, "The case is wrong.");
create_exception!(
    signorini,
    SolveError,
    PyRuntimeError,
    "The case is right, but there is no solution."
);

/// Solves the case in a file, with these settings over it.
#[pyfunction]
fn solve_case(
    py: Python<'_>,
    path: PathBuf,
    settings: Vec<String>,
    certificate: bool,
) -> PyResult<Solved> {
    interruptible(py, move |stage| {
        let start = Instant::now();
        let text = Case::text(&path).map_err(wrong)?;
        let case = Case::parse(&path, &text, &settings).map_err(wrong)?;
        solved(case, start, certificate, stage)
    })
}

/// The names of parts of a mesh, with the numbers that each has.
type Members = Vec<(String, Vec<u8>)>;

/// Points as pairs of doubles, triangles as 64-bit numbers, the edges of boundaries and the triangles of surfaces likewise, points by
/// name.
type Arrays<'a> = (&'a [u8], &'a [u8], Members, Members, Vec<(String, i64)>);

/// Solves a case without a mesh on this one; where its text has "@0", these functions stand.
#[pyfunction]
fn solve(
    py: Python<'_>,
    text: String,
    arrays: Arrays,
    functions: Vec<Py<PyAny>>,
    remarks: Vec<String>,
    certificate: bool,
) -> PyResult<Solved> {
    let start = Instant::now();
    let (points, triangles, boundaries, surfaces, named_points) = arrays;
    let edges = |(name, edges): (String, Vec<u8>)| -> PyResult<_> {
        let what = format!("boundary '{name}'");
        Ok((name, indices(&edges, &what)?))
    };
    let boundaries = boundaries.into_iter().map(edges).collect::<PyResult<Vec<_>>>()?;
    let members = |(name, bytes): (String, Vec<u8>)| -> PyResult<_> {
        let what = format!("surface '{name}'");
        let members = indices(&bytes, &what)?.into_iter().map(|[t]: [usize; 1]| t).collect();
        Ok((name, members))
    };
    let surfaces = surfaces.into_iter().map(members).collect::<PyResult<_>>()?;
    let point = |(name, number): (String, i64)| -> PyResult<_> {
        let what = format!("point '{name}'");
        Ok((name, vec![index(number, &what)?]))
    };
    let named_points = named_points.into_iter().map(point).collect::<PyResult<_>>()?;
    let (points, triangles) = (doubles(points), indices(triangles, "triangles")?);
    let failed = Arc::new(Mutex::new(None));
    let functions: Vec<SharedFunction> = functions
        .into_iter()
        .map(|callable| {
            let failed = Arc::clone(&failed);
            Arc::new(Callable { callable, failed }) as SharedFunction
        })
        .collect();
    let result = interruptible(py, move |stage| {
        let pairs = Case::pairs(Path::new("case"), &text, &functions).map_err(wrong)?;
        let mesh = Mesh::with_pairs(points, triangles, boundaries, &pairs).map_err(wrong)?;
        let mesh = mesh.with_names(surfaces, named_points).map_err(wrong)?;
        let mut case = Case::on_mesh(Path::new("case"), &text, mesh, &functions).map_err(wrong)?;
        case.remarks.extend(remarks);
        solved(case, start, certificate, stage)
    });
    // What a function raised says more than that it has no value somewhere.
    let raised = failed.lock().unwrap_or_else(PoisonError::into_inner).take();
    result.map_err(|error| raised.unwrap_or(error))
}

/// A function of x and y of Python.
struct Callable {
    callable: Py<PyAny>,
    /// What it raised first.
    failed: Arc<Mutex<Option<PyErr>>>,
}

impl Function for Callable {
    fn at(&self, [x, y]: [f64; 2]) -> f64 {
        let value = Python::attach(|py| self.callable.call1(py, (x, y))?.extract::<f64>(py));
        value.unwrap_or_else(|error| {
            self.failed.lock().unwrap_or_else(PoisonError::into_inner).get_or_insert(error);
            f64::NAN
        })
    }
}

/// The time between two looks for a signal.
const BETWEEN_LOOKS: Duration = Duration::from_millis(50);

/// Computes in a thread of its own, and looks for signals meanwhile: Ctrl-C raises KeyboardInterrupt at once, and the thread ends at
/// its next stage.
fn interruptible<T: Send + 'static>(
    py: Python<'_>,
    compute: impl FnOnce(&dyn Fn()) -> PyResult<T> + Send + 'static,
) -> PyResult<T> {
    let is_stopped = Arc::new(AtomicBool::new(false));
    let stopped = Arc::clone(&is_stopped);
    let (sender, mut receiver) = channel();
    let work = move || {
        let stage = || {
            if stopped.load(Ordering::Relaxed) {
                // Out of the solver, which knows no other way; nobody waits for the result any more.
                resume_unwind(Box::new(()));
            }
        };
        // Where nobody listens, there is nothing to say.
        let _ = sender.send(compute(&stage));
    };
    let thread = std::thread::Builder::new().name("signorini".to_owned()).stack_size(STACK);
    thread.spawn(work).map_err(|error| PyRuntimeError::new_err(error.to_string()))?;
    loop {
        let result;
        (receiver, result) = py.detach(move || {
            let result = receiver.recv_timeout(BETWEEN_LOOKS);
            (receiver, result)
        });
        match result {
            Ok(result) => return result,
            Err(RecvTimeoutError::Timeout) => {
                if let Err(signal) = py.check_signals() {
                    is_stopped.store(true, Ordering::Relaxed);
                    return Err(signal);
                }
            }
            // A panic, whose message is on standard error.
            Err(RecvTimeoutError::Disconnected) => {
                return Err(PyRuntimeError::new_err(
                    "the solver has ended with a bug; please report it",
                ));
            }
        }
    }
}

/// The stack of that thread, as large as that of a main thread.
const STACK: usize = 8 << 20;

/// The cells of a block of a mesh: Gmsh's number of their kind, their nodes, and on which entity each lies.
type Cells = (i32, Vec<u8>, Vec<u8>);

/// The names of entities by their numbers.
type EntityNames = Vec<(i32, Vec<String>)>;

/// Makes a plane mesh of nodes (three doubles each) and blocks of cells, as another program lists them; returns its arrays, and what
/// was decided. These pairs of boundaries may touch each other.
#[pyfunction]
fn plane_mesh<'py>(
    py: Python<'py>,
    nodes: &[u8],
    blocks: Vec<Cells>,
    names: [EntityNames; 3],
    pairs: Vec<[String; 2]>,
) -> PyResult<Bound<'py, PyDict>> {
    let pairs: Vec<Pair> =
        pairs.into_iter().map(|[first, second]| Pair::new(first, second)).collect();
    let (numbers, _) = nodes.as_chunks::<8>();
    let (places, _) = numbers.as_chunks::<3>();
    let places = places.iter().map(|place| place.map(f64::from_ne_bytes)).collect();
    let block = |(b, (kind, cells, entities)): (usize, Cells)| {
        let nodes = indices::<1>(&cells, &format!("block {b} of cells"))?;
        let entities = entities.as_chunks::<4>().0.iter().copied().map(i32::from_ne_bytes);
        Ok((kind, nodes.into_flattened(), entities.collect()))
    };
    let blocks: PyResult<Vec<Block>> = blocks.into_iter().enumerate().map(block).collect();
    let names = names.map(|of_dimension| of_dimension.into_iter().collect());
    let Made { mesh, remarks } =
        of_blocks(places, &blocks?, names, &pairs).map_err(|error| unsolved(&error))?;
    let dict = PyDict::new(py);
    let points = mesh.vertices().iter().flatten().flat_map(|c| c.to_ne_bytes());
    dict.set_item("points", PyBytes::new(py, &points.collect::<Vec<u8>>()))?;
    let integers = |values: &mut dyn Iterator<Item = usize>| {
        let bytes: Vec<u8> = values.flat_map(|i| (i as i64).to_ne_bytes()).collect();
        PyBytes::new(py, &bytes)
    };
    let triangles = &mut mesh.triangles().iter().flatten().copied();
    dict.set_item("triangles", integers(triangles))?;
    let boundaries = PyDict::new(py);
    for name in mesh.boundary_names() {
        let edges = mesh.edges_of(name).map_err(wrong)?;
        boundaries.set_item(name, integers(&mut edges.iter().flat_map(|&edge| mesh.ends(edge))))?;
    }
    dict.set_item("boundaries", boundaries)?;
    let surfaces = PyDict::new(py);
    for (name, members) in mesh.surfaces() {
        surfaces.set_item(name, integers(&mut members.iter().copied()))?;
    }
    dict.set_item("surfaces", surfaces)?;
    let points = PyDict::new(py);
    for name in mesh.point_names() {
        // Several points of one name are none that could be held.
        if let Ok(vertex) = mesh.point(name) {
            points.set_item(name, vertex)?;
        }
    }
    dict.set_item("named_points", points)?;
    dict.set_item("remarks", remarks)?;
    Ok(dict)
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

/// Tuples of numbers from 0 on, of `what`.
fn indices<const K: usize>(bytes: &[u8], what: &str) -> PyResult<Vec<[usize; K]>> {
    let (numbers, _) = bytes.as_chunks::<8>();
    let (tuples, _) = numbers.as_chunks::<K>();
    let mut all = Vec::with_capacity(tuples.len());
    for tuple in tuples {
        let mut indices = [0; K];
        for (i, bytes) in indices.iter_mut().zip(tuple) {
            *i = index(i64::from_ne_bytes(*bytes), what)?;
        }
        all.push(indices);
    }
    Ok(all)
}

fn index(number: i64, what: &str) -> PyResult<usize> {
    usize::try_from(number)
        .map_err(|_| wrong(format!("{what}: found the number {number}; expected one from 0 on")))
}

/// A solved case.
#[pyclass(frozen, module = "signorini._signorini")]
struct Solved {
    case: Case,
    solved: run::Solved,
    results: Results,
    read: Duration,
    /// A certificate was asked for.
    certificate: bool,
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
        py.detach(|| picture_of(&self.case, &self.solved.solution, &self.results))
            .map_err(no_results)
    }

    /// Writes the files that the command writes, and returns their paths.
    fn write(&self, py: Python<'_>, folder: PathBuf, report: bool) -> PyResult<Vec<PathBuf>> {
        let extra = Extra { report, certificate: self.certificate };
        let written =
            py.detach(|| outputs::write(&folder, &self.case, &self.solved, self.read, extra));
        Ok(written.map_err(|error| PyOSError::new_err(error.to_string()))?.files)
    }
}

fn no_results(error: impl ToString) -> PyErr {
    SolveError::new_err(error.to_string())
}

fn solved(case: Case, start: Instant, certificate: bool, stage: &dyn Fn()) -> PyResult<Solved> {
    let read = start.elapsed();
    stage();
    let (case, mut solved) =
        run::solve(case, None, &|_| stage()).map_err(|error| unsolved(&error))?;
    if certificate {
        stage();
        solved.certify(&case);
    }
    let extra = Extra { certificate, ..Extra::default() };
    let results = outputs::results(&case, &solved, read, extra).map_err(no_results)?;
    Ok(Solved { case, solved, results, read, certificate })
}

fn unsolved(error: &Failure) -> PyErr {
    if error.is_wrong() { wrong(error) } else { SolveError::new_err(error.to_string()) }
}

/// The nodes of a triangle, those in the middle of its edges in the order of VTK: that of the edge from the first to the second vertex
/// first.
fn in_order_of_vtk(nodes: &[usize]) -> Vec<usize> {
    match *nodes {
        [a, b, c, opposite_a, opposite_b, opposite_c] => {
            vec![a, b, c, opposite_c, opposite_a, opposite_b]
        }
        _ => nodes.to_vec(),
    }
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
    integers("elements", &mut s.elements.chunks(s.nodes_per_triangle).flat_map(in_order_of_vtk))?;
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
    // Where a pair of bodies touches is no node.
    let node = |p: &ContactPoint| p.node.map_or(-1, |node| node as i64);
    let nodes: Vec<u8> = points().flat_map(|p| node(p).to_ne_bytes()).collect();
    dict.set_item("node", PyBytes::new(py, &nodes))?;
    floats("place", &mut points().flat_map(|p| p.place))?;
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
    module.add_function(wrap_pyfunction!(plane_mesh, module)?)?;
    module.add_function(wrap_pyfunction!(solve, module)?)
}

//! Checkpoints: the state of a simulation as named arrays.
//!
//! ```text
//! State ──to_checkpoint──▶ Checkpoint ──read_checkpoint, which checks──▶ State
//! ```
//! A checkpoint holds the whole state and nothing that follows from it: no grid and no buffers. Rows keep their order and
//! their blocks, so that a run goes on with the same bits. Reading trusts nothing: an array that is missing, of another
//! length, not finite or out of range is an error that names it.

use super::State;
use super::probes::Readings;
pub use crate::array::{Array, Values};
use crate::boundary::impulse::Impulse;
use crate::instance::Instance;
use crate::math::Lanes;
use crate::math::Vector;
use crate::particles::{
    DRIFT_LIMIT, Escaped, Group, Layout, PerParticle, Run, block_edge, copy_columns, in_range,
};
use crate::setup::check::CheckedSetup;
use crate::setup::{Pointer, PointerAction, Probe, ProbeSample};
use crate::transfer::g2p::LARGEST_MOVE;
use core::fmt;
use std::sync::Arc;

/// The state of a simulation between two frames, as named arrays; made by
/// [`Simulate::checkpoint`](crate::Simulate::checkpoint).
///
/// ```
/// use lahar::{Setup, Simulate, Simulation};
///
/// let jelly = lahar::material::preset("jelly", 0.0).ok_or("unknown")?;
/// let mut simulation = Simulation::<f32, 2>::new(Setup::new(0.02, vec![jelly]), &[])?;
/// let mut checkpoint = simulation.checkpoint();
/// checkpoint.arrays.retain(|array| array.name != "gravity");
/// let error = simulation.resume(checkpoint).err().ok_or("it is damaged")?;
/// assert_eq!(error.to_string(), "array \"gravity\": is missing");
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Checkpoint {
    /// The arrays, each name once.
    pub arrays: Vec<Array>,
}

/// The problem of a checkpoint that a simulation cannot go on from.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct CheckpointError {
    /// The name of the array.
    pub array: String,
    /// The problem with the array.
    pub problem: String,
}

impl fmt::Display for CheckpointError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "array \"{}\": {}", self.array, self.problem)
    }
}

impl core::error::Error for CheckpointError {}

fn wrong<R>(array: &str, problem: impl Into<String>) -> Result<R, CheckpointError> {
    Err(CheckpointError {
        array: array.into(),
        problem: problem.into(),
    })
}

/// Bound on the rounding of sums of steps \[cells\]: with [`DRIFT_LIMIT`] it is less than a tile's margin.
const ROUNDING: f64 = 9e-4;

/// Returns the field of a column of a group, and the number of the component.
fn column_name(column: usize, dimension: usize) -> (&'static str, usize) {
    if column >= Layout::strain(dimension) {
        ("strain", column - Layout::strain(dimension))
    } else if column >= Layout::affine(dimension) {
        ("affine", column - Layout::affine(dimension))
    } else if column >= Layout::velocity(dimension) {
        ("velocity", column - Layout::velocity(dimension))
    } else {
        ("position", column)
    }
}

/// Returns the shape of a single number if all particles share it, else that of an array.
fn shape_of<T>(of: &PerParticle<T>) -> Vec<usize> {
    match of {
        PerParticle::Uniform(_) => Vec::new(),
        PerParticle::Each(values) => vec![values.len()],
    }
}

fn numbers_of<T: Copy>(of: &PerParticle<T>) -> Vec<T> {
    match of {
        PerParticle::Uniform(value) => vec![*value],
        PerParticle::Each(values) => values.clone(),
    }
}

/// The arrays of a checkpoint that is written.
#[derive(Default)]
struct Out(Vec<Array>);

impl Out {
    fn put(&mut self, name: impl Into<String>, shape: &[usize], values: Values) {
        self.0.push(Array {
            name: name.into(),
            shape: shape.to_vec(),
            values,
        });
    }

    fn number(&mut self, name: &str, value: f64) {
        self.put(name, &[], Values::F64(vec![value]));
    }
}

/// Numbers of a pointer: position, radius, softening, kind and numbers of its action.
const POINTER: usize = 9;

fn pointer_numbers(pointer: &Pointer) -> [f64; POINTER] {
    let (kind, [a, b, c]) = match pointer.action {
        PointerAction::Attract(strength) => (0.0, [strength, 0.0, 0.0]),
        PointerAction::Drag(velocity) => (1.0, velocity),
        PointerAction::Push {
            acceleration,
            power,
        } => (2.0, [acceleration, power, 0.0]),
    };
    let [x, y, z] = pointer.position;
    [x, y, z, pointer.radius, pointer.softening, kind, a, b, c]
}

fn pointer_from([x, y, z, radius, softening, kind, a, b, c]: [f64; POINTER]) -> Option<Pointer> {
    let action = match kind {
        0.0 => PointerAction::Attract(a),
        1.0 => PointerAction::Drag([a, b, c]),
        2.0 => PointerAction::Push {
            acceleration: a,
            power: b,
        },
        _ => return None,
    };
    Some(Pointer {
        position: [x, y, z],
        radius,
        softening,
        action,
    })
}

impl<T: Instance<D>, const D: usize> State<T, D> {
    /// Returns the state as arrays.
    pub(crate) fn to_checkpoint(&self, scene: &CheckedSetup<D>) -> Checkpoint {
        // Each field by name, so that a new one asks for its array.
        let Self {
            groups,
            drift,
            time_since_correction,
            boundary_totals,
            readings,
            escaped,
            control,
            next_id,
            gravity,
            pointer,
            starts,
        } = self;
        let mut out = Out::default();
        let (numbers, counts) = control.numbers();
        out.put("step", &[numbers.len()], Values::F64(numbers.to_vec()));
        out.put("counts", &[counts.len()], Values::U64(counts.to_vec()));
        out.number("drift", *drift);
        out.number("uncorrected", *time_since_correction);
        out.put("gravity", &[D], Values::F64(gravity.to_vec()));
        let hand = pointer.as_ref().map(pointer_numbers);
        let hand = hand.map_or_else(Vec::new, |hand| hand.to_vec());
        out.put("pointer", &[hand.len()], Values::F64(hand));
        out.put("next_id", &[], Values::U32(vec![*next_id]));
        out.put("escaped.count", &[], Values::U64(vec![escaped.count]));
        out.number("escaped.mass", escaped.mass);
        let flat = |total: &Impulse<D>| total.impulse.0.into_iter().chain(total.angular);
        out.put(
            "taken",
            &[boundary_totals.len(), D + 3],
            Values::F64(boundary_totals.iter().flat_map(flat).collect()),
        );
        for (index, readings) in readings.iter().enumerate() {
            write_readings(&mut out, scene, index, readings);
        }
        if let Some(starts) = starts {
            let values = Values::F64(starts.as_flattened().to_vec());
            out.put("starts", &[starts.len(), D], values);
        }
        for (index, group) in groups.iter().enumerate() {
            write_group(&mut out, &format!("materials.{index}"), group);
        }
        Checkpoint { arrays: out.0 }
    }

    /// Reads the state in `checkpoint`, which must be of the setup that this state is of.
    ///
    /// # Errors
    /// Names an array that is not of such a state.
    pub(crate) fn read_checkpoint(
        &self,
        scene: &CheckedSetup<D>,
        checkpoint: Checkpoint,
    ) -> Result<Self, CheckpointError> {
        let mut arrays = In(checkpoint.arrays);
        let Some(control) = self
            .control
            .with_numbers(arrays.numbers("step")?, arrays.counts("counts")?)
        else {
            return wrong("step", "with \"counts\" is no state of a time step");
        };
        let next_id = arrays.id("next_id")?;
        // Beyond the limit rows are sorted before anything else is done, and no substep moves them further.
        let drift = arrays.number("drift", 0.0..=DRIFT_LIMIT + LARGEST_MOVE)?;
        let mut state = Self {
            drift,
            time_since_correction: arrays.number("uncorrected", 0.0..=f64::MAX)?,
            boundary_totals: self.read_totals(&mut arrays)?,
            readings: read_readings(&mut arrays, scene)?,
            escaped: Escaped {
                count: arrays.counts::<1>("escaped.count")?[0],
                mass: arrays.number("escaped.mass", 0.0..=f64::MAX)?,
            },
            control,
            next_id,
            gravity: arrays.numbers("gravity")?,
            pointer: arrays.pointer()?,
            groups: Vec::with_capacity(self.groups.len()),
            starts: None,
        };
        for (index, group) in self.groups.iter().enumerate() {
            let of = format!("materials.{index}");
            let group = read_group(&mut arrays, &of, group, (next_id, drift))?;
            state.groups.push(group);
        }
        for (index, group) in state.groups.iter().enumerate() {
            check_places(&format!("materials.{index}.runs.block"), scene, group)?;
        }
        state.check_ids()?;
        if self.starts.is_some() {
            let (shape, values) = arrays.f64s("starts")?;
            if shape != [next_id as usize, D] {
                return wrong("starts", "is not as long as there are ids");
            }
            state.starts = Some(Arc::new(values.as_chunks().0.to_vec()));
        }
        match arrays.0.first() {
            Some(more) => wrong(&more.name, "does not belong to this scene"),
            None => Ok(state),
        }
    }

    /// Checks that no two particles share an id, and that all ids without a particle have left.
    fn check_ids(&self) -> Result<(), CheckpointError> {
        let mut ids: Vec<u32> = Vec::new();
        for group in &self.groups {
            ids.extend(&group.id);
        }
        ids.sort_unstable();
        if let Some(pair) = ids.windows(2).find(|pair| pair[0] == pair[1]) {
            return wrong("id", format!("there are two particles {}", pair[0]));
        }
        let known = self.escaped.count.checked_add(ids.len() as u64);
        if known != Some(u64::from(self.next_id)) {
            return wrong("next_id", "is not the number of particles there and gone");
        }
        Ok(())
    }

    fn read_totals(&self, arrays: &mut In) -> Result<Vec<Impulse<D>>, CheckpointError> {
        let (shape, values) = arrays.f64s("taken")?;
        if shape != [self.boundary_totals.len(), D + 3] {
            return wrong("taken", "is not of this scene's walls and colliders");
        }
        let one = |row: &[f64]| Impulse {
            impulse: Vector(core::array::from_fn(|axis| row[axis])),
            angular: core::array::from_fn(|axis| row[D + axis]),
        };
        Ok(values.chunks_exact(D + 3).map(one).collect())
    }
}

/// Checks that rows are where walls keep them: the next substep would put them there, out of reach of their tile.
fn check_places<T: Lanes, const D: usize>(
    name: &str,
    scene: &CheckedSetup<D>,
    group: &Group<T, D>,
) -> Result<(), CheckpointError> {
    for run in &group.runs {
        let middle = scene.lattice.middle(run.block);
        for (axis, middle) in middle.into_iter().enumerate() {
            let (low, high) = scene.walls.bounds[axis];
            let low = low.map_or(f64::NEG_INFINITY, |low| low - middle - ROUNDING);
            let high = high.map_or(f64::INFINITY, |high| high - middle + ROUNDING);
            let places = &group.columns[axis][run.rows()];
            if !places.iter().all(|x| (low..=high).contains(&x.to_f64())) {
                return wrong(name, "has rows outside of the walls");
            }
        }
    }
    Ok(())
}

fn write_readings<const D: usize>(
    out: &mut Out,
    scene: &CheckedSetup<D>,
    index: usize,
    readings: &Readings,
) {
    let (time, impulse) = readings.last;
    let last = [time, impulse[0], impulse[1], impulse[2], readings.pressed];
    let name = format!("probes.{index}.last");
    out.put(name, &[last.len()], Values::F64(last.to_vec()));
    let width = 1 + scene.setup.probes[index].gauge.columns().len();
    let count = readings.samples.len();
    let flat = |sample: &ProbeSample| [&[sample.time], sample.values.as_slice()].concat();
    let samples = readings.samples.iter().flat_map(flat).collect();
    let name = format!("probes.{index}.samples");
    out.put(name, &[count, width], Values::F64(samples));
}

fn read_readings<const D: usize>(
    arrays: &mut In,
    scene: &CheckedSetup<D>,
) -> Result<Vec<Readings>, CheckpointError> {
    let one = |(index, probe): (usize, &Probe<D>)| {
        let [time, x, y, z, pressed] = arrays.numbers(&format!("probes.{index}.last"))?;
        let name = format!("probes.{index}.samples");
        let (shape, values) = arrays.f64s(&name)?;
        let width = 1 + probe.gauge.columns().len();
        if shape.len() != 2 || shape[1] != width {
            return wrong(&name, format!("is not of the probe \"{}\"", probe.name));
        }
        let sample = |row: &[f64]| ProbeSample {
            time: row[0],
            values: row[1..].to_vec(),
        };
        Ok(Readings {
            samples: values.chunks_exact(width).map(sample).collect(),
            last: (time, [x, y, z]),
            pressed,
        })
    };
    scene.setup.probes.iter().enumerate().map(one).collect()
}

fn write_group<T: Instance<D>, const D: usize>(out: &mut Out, of: &str, group: &Group<T, D>) {
    let Group {
        law,
        density: _,     // of the setup
        sound_speed: _, // of the law
        columns,
        mass,
        volume0,
        id,
        body,
        runs,
    } = group;
    let stiffness: Vec<f64> = law.bulk_modulus().into_iter().collect();
    out.put(
        format!("{of}.bulk_modulus"),
        &[stiffness.len()],
        Values::F64(stiffness),
    );
    let mut copies = Vec::new();
    copy_columns(&mut copies, columns);
    for (column, values) in copies.into_iter().enumerate() {
        let (what, component) = column_name(column, D);
        let name = format!("{of}.{what}.{component}");
        out.put(name, &[values.len()], T::values(values));
    }
    for (what, values) in [("mass", mass), ("volume0", volume0)] {
        let values_of = T::values(numbers_of(values));
        out.put(format!("{of}.{what}"), &shape_of(values), values_of);
    }
    out.put(format!("{of}.id"), &[id.len()], Values::U32(id.clone()));
    let bodies = Values::U32(numbers_of(body));
    out.put(format!("{of}.body"), &shape_of(body), bodies);
    let blocks = runs.iter().flat_map(|run| run.block).collect();
    out.put(
        format!("{of}.runs.block"),
        &[runs.len(), D],
        Values::I32(blocks),
    );
    let starts = runs.iter().map(|run| run.start).collect();
    out.put(
        format!("{of}.runs.start"),
        &[runs.len()],
        Values::U32(starts),
    );
}

fn read_group<T: Instance<D>, const D: usize>(
    arrays: &mut In,
    of: &str,
    group: &Group<T, D>,
    (next_id, drift): (u32, f64),
) -> Result<Group<T, D>, CheckpointError> {
    let name = format!("{of}.id");
    let (_, id) = arrays.take(&name, Values::u32s)?;
    let count = id.len();
    if id.iter().any(|&id| id >= next_id) {
        return wrong(&name, "has numbers that were never given");
    }
    // A row that is further from the middle than it can have drifted since the last sort could be beyond its tile.
    let reach = 0.5 * block_edge(D) as f64 + drift + ROUNDING;
    let mut columns = Vec::with_capacity(group.columns.len());
    for column in 0..group.columns.len() {
        let (what, component) = column_name(column, D);
        let name = format!("{of}.{what}.{component}");
        let (_, values) = arrays.take(&name, T::from_values)?;
        if values.len() != count {
            return wrong(&name, format!("has {} of {count} numbers", values.len()));
        }
        let most = if what == "position" { reach } else { f64::MAX };
        if let Some(bad) = values.iter().position(|x| !(x.to_f64().abs() <= most)) {
            let value = values[bad].to_f64();
            return wrong(&name, format!("{value} of row {bad} is out of range"));
        }
        columns.push(values);
    }
    let positive = |x: &T| x.to_f64() > 0.0 && x.to_f64().is_finite();
    let mut per_particle = |what: &str| {
        let name = format!("{of}.{what}");
        let (shape, values) = arrays.take(&name, T::from_values)?;
        if count > 0 && !values.iter().all(positive) {
            return wrong(&name, "must be positive numbers");
        }
        uniform_or_each(&name, &shape, values, count)
    };
    let (mass, volume0) = (per_particle("mass")?, per_particle("volume0")?);
    let name = format!("{of}.body");
    let (shape, values) = arrays.take(&name, Values::u32s)?;
    let body = uniform_or_each(&name, &shape, values, count)?;
    let name = format!("{of}.bulk_modulus");
    let bulk_modulus = match (group.law.bulk_modulus(), arrays.f64s(&name)?.1.as_slice()) {
        (None, []) => None,
        (Some(_), &[stiffness]) if stiffness > 0.0 && stiffness.is_finite() => Some(stiffness),
        _ => return wrong(&name, "is not that of this material"),
    };
    let mut read = group.without_particles();
    if let Some(bulk_modulus) = bulk_modulus
        && group.law.bulk_modulus() != Some(bulk_modulus)
    {
        read.set_law(group.law.with_bulk_modulus(bulk_modulus).into());
    }
    Ok(Group {
        columns,
        mass,
        volume0,
        id,
        body,
        runs: read_runs(arrays, of, count)?,
        ..read
    })
}

fn uniform_or_each<T: Copy>(
    name: &str,
    shape: &[usize],
    values: Vec<T>,
    count: usize,
) -> Result<PerParticle<T>, CheckpointError> {
    match (shape, values.as_slice()) {
        ([], &[value]) => Ok(PerParticle::Uniform(value)),
        ([n], _) if *n == count => Ok(PerParticle::Each(values)),
        _ => wrong(name, format!("is neither one number nor {count}")),
    }
}

/// Reads the runs, which must cover all rows in ascending order of blocks.
fn read_runs<const D: usize>(
    arrays: &mut In,
    of: &str,
    count: usize,
) -> Result<Vec<Run<D>>, CheckpointError> {
    let name = format!("{of}.runs.block");
    let (shape, blocks) = arrays.take(&name, Values::i32s)?;
    if shape.len() != 2 || shape[1] != D {
        return wrong(&name, format!("has not {D} coordinates a block"));
    }
    let blocks: &[[i32; D]] = blocks.as_chunks().0;
    if !blocks.iter().all(|block| in_range(*block)) || !blocks.is_sorted_by(|a, b| a < b) {
        return wrong(&name, "must ascend, within the range of blocks");
    }
    let name = format!("{of}.runs.start");
    let (_, starts) = arrays.take(&name, Values::u32s)?;
    let end = u32::try_from(count).unwrap_or(u32::MAX);
    let ends = starts.iter().skip(1).copied().chain([end]);
    let covers = starts.first().map_or(count == 0, |first| *first == 0)
        && starts
            .iter()
            .zip(ends.clone())
            .all(|(start, end)| *start < end);
    if starts.len() != blocks.len() || !covers {
        return wrong(&name, "does not say which rows are in which block");
    }
    let run = |((block, start), end): ((&[i32; D], u32), u32)| Run {
        block: *block,
        start,
        end,
        tile: 0,
        first: false,
    };
    let starts = starts.iter().copied();
    Ok(blocks.iter().zip(starts).zip(ends).map(run).collect())
}

/// The arrays of a checkpoint that were not read yet.
struct In(Vec<Array>);

impl In {
    /// Takes out the array of that name. Returns its shape and its numbers, converted by `of`, which returns `None` for
    /// another type.
    fn take<V>(
        &mut self,
        name: &str,
        of: impl Fn(Values) -> Option<Vec<V>>,
    ) -> Result<(Vec<usize>, Vec<V>), CheckpointError> {
        let Some(index) = self.0.iter().position(|array| array.name == name) else {
            return wrong(name, "is missing");
        };
        // Arrays mostly come in the order in which they are asked for.
        let array = self.0.remove(index);
        let length = array
            .shape
            .iter()
            .try_fold(1, |n: usize, m| n.checked_mul(*m));
        if length != Some(array.values.len()) {
            return wrong(name, "is not as long as its shape says");
        }
        match of(array.values) {
            Some(values) => Ok((array.shape, values)),
            None => wrong(name, "is of another type of numbers"),
        }
    }

    /// Takes out an array of double precision without NaN.
    fn f64s(&mut self, name: &str) -> Result<(Vec<usize>, Vec<f64>), CheckpointError> {
        let (shape, values) = self.take(name, Values::f64s)?;
        if values.iter().any(|x| x.is_nan()) {
            return wrong(name, "has something that is no number");
        }
        Ok((shape, values))
    }

    fn numbers<const N: usize>(&mut self, name: &str) -> Result<[f64; N], CheckpointError> {
        let (_, values) = self.f64s(name)?;
        let length = values.len();
        let all = values.try_into().ok();
        all.map_or_else(|| wrong(name, format!("has {length} of {N} numbers")), Ok)
    }

    fn number(
        &mut self,
        name: &str,
        range: core::ops::RangeInclusive<f64>,
    ) -> Result<f64, CheckpointError> {
        let [value] = self.numbers(name)?;
        if range.contains(&value) {
            Ok(value)
        } else {
            wrong(name, format!("{value} is out of range"))
        }
    }

    fn counts<const N: usize>(&mut self, name: &str) -> Result<[u64; N], CheckpointError> {
        let (_, values) = self.take(name, Values::u64s)?;
        let all = values.try_into().ok();
        all.map_or_else(|| wrong(name, format!("has not {N} numbers")), Ok)
    }

    fn id(&mut self, name: &str) -> Result<u32, CheckpointError> {
        let (_, values) = self.take(name, Values::u32s)?;
        match values[..] {
            [id] => Ok(id),
            _ => wrong(name, "is not one number"),
        }
    }

    fn pointer(&mut self) -> Result<Option<Pointer>, CheckpointError> {
        let (_, values) = self.f64s("pointer")?;
        if values.is_empty() {
            return Ok(None);
        }
        let pointer = <[f64; POINTER]>::try_from(values)
            .ok()
            .and_then(pointer_from);
        pointer.map_or_else(
            || wrong("pointer", "is no pointer"),
            |pointer| Ok(Some(pointer)),
        )
    }
}

//! The public face: commands in, snapshots out.
//!
//! [`Simulation`] is the typed one; [`Simulate`] is the same without the types of numbers and
//! dimension, for outlets that open whatever scene they are given.

use crate::diagnostics::Diagnostics;
use crate::error::{DtLimit, Failure};
use crate::particles::{Field, Snapshot};
use crate::setup::Isa;

/// What can be told to a running simulation. Vectors have three components; 2D ignores the third.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Command {
    /// Replaces gravity \[m/s²\].
    Gravity([f64; 3]),
    /// Sets or lifts the hand that stirs.
    Pointer(Option<Pointer>),
}

/// A hand in the scene: acts on the nodes near it, until it is lifted.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pointer {
    /// Where it is \[m\].
    pub position: [f64; 3],
    /// How far it reaches \[m\].
    pub radius: f64,
    /// What it does.
    pub action: PointerAction,
}

/// What a hand does to a node at the offset d from it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum PointerAction {
    /// Accelerates towards the hand by this much \[m/s²\]; negative: away from it.
    Attract(f64),
    /// Drags along: node velocities near the hand are drawn to this velocity \[m/s\].
    Drag([f64; 3]),
}

/// What an advance did.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Advance {
    /// Substeps taken.
    pub substeps: u64,
    /// The shortest of them \[s\].
    pub dt_min: f64,
    /// What limited it.
    pub limit: DtLimit,
}

/// Seconds spent by phase, if a clock was given.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct PhaseTimes {
    /// Moving particles to their blocks.
    pub sort: f64,
    /// Particles to grid.
    pub scatter: f64,
    /// Grid update.
    pub grid: f64,
    /// Grid to particles, the law's update included.
    pub gather: f64,
    /// Sorts done.
    pub sorts: u64,
}

/// A simulation of any dimension and precision.
pub trait Simulate: Send {
    /// 2 or 3.
    fn dimension(&self) -> usize;
    /// "f32" or "f64".
    fn precision(&self) -> &'static str;
    /// The instruction set in use.
    fn isa(&self) -> Isa;
    /// Distance between nodes \[m\].
    fn dx(&self) -> f64;
    /// Corners of the domain \[m\]; `None`: unbounded.
    fn domain(&self) -> Option<([f64; 3], [f64; 3])>;
    /// Gravity now \[m/s²\].
    fn gravity(&self) -> [f64; 3];
    /// Names of the materials, by index.
    fn materials(&self) -> Vec<String>;
    /// Simulated time \[s\].
    fn time(&self) -> f64;
    /// Substeps since the start.
    fn substeps(&self) -> u64;
    /// Particles now.
    fn particle_count(&self) -> usize;
    /// Length that the next substep would have \[s\], and why.
    fn next_dt(&self) -> (f64, DtLimit);
    /// One substep.
    fn substep(&mut self) -> Result<Advance, Failure>;
    /// Substeps until `time` \[s\]: exactly with an automatic time step, to the nearest substep with
    /// a fixed one.
    fn advance_to(&mut self, time: f64) -> Result<Advance, Failure>;
    /// Takes effect at the next substep.
    fn command(&mut self, command: Command);
    /// A copy of `fields`, rows by ascending id.
    fn snapshot(&self, fields: &[Field]) -> Snapshot;
    /// Totals now.
    fn diagnostics(&self) -> Diagnostics;
    /// Gives the simulation a clock that returns seconds, for [`Simulate::phase_times`].
    fn set_clock(&mut self, clock: fn() -> f64);
    /// Seconds by phase since the clock was given.
    fn phase_times(&self) -> PhaseTimes;
    /// Blocks of nodes in use, and bytes held by grid and particles.
    fn memory(&self) -> Memory;
}

/// What a simulation holds.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Memory {
    /// Blocks of nodes.
    pub blocks: usize,
    /// Nodes in them.
    pub nodes: usize,
    /// Bytes of grid and tiles.
    pub grid_bytes: usize,
    /// Bytes of particles, buffers included.
    pub particle_bytes: usize,
}

// ---- scaffold: free fall only, replaced by the engine ----
use crate::error::SetupError;
use crate::math::Lanes;
use crate::particles::Data;
use crate::setup::{ParticleBatch, Setup, TimeStep};

/// A simulation in `D` dimensions with numbers of type `T`.
pub struct Simulation<T, const D: usize> {
    setup: Setup<D>,
    x: Vec<[f64; D]>,
    v: Vec<[f64; D]>,
    m: Vec<f64>,
    vol: Vec<f64>,
    mat: Vec<u32>,
    body: Vec<u32>,
    time: f64,
    substeps: u64,
    marker: core::marker::PhantomData<T>,
}

impl<T: Lanes, const D: usize> Simulation<T, D> {
    /// Checks the setup and takes in the particles.
    ///
    /// # Errors
    /// Names the key that cannot be simulated.
    pub fn new(setup: Setup<D>, batches: &[ParticleBatch<D>]) -> Result<Self, SetupError> {
        let mut s = Self {
            setup,
            x: vec![],
            v: vec![],
            m: vec![],
            vol: vec![],
            mat: vec![],
            body: vec![],
            time: 0.0,
            substeps: 0,
            marker: core::marker::PhantomData,
        };
        for b in batches {
            for (i, &x) in b.position.iter().enumerate() {
                s.x.push(x);
                s.v.push(match b.velocity.len() {
                    0 => [0.0; D],
                    1 => b.velocity[0],
                    _ => b.velocity[i],
                });
                let vol = if b.volume.len() == 1 {
                    b.volume[0]
                } else {
                    b.volume[i]
                };
                s.vol.push(vol);
                s.m.push(match b.mass.len() {
                    0 => vol * s.setup.materials[b.material].density,
                    1 => b.mass[0],
                    _ => b.mass[i],
                });
                s.mat.push(b.material as u32);
                s.body.push(b.body);
            }
        }
        Ok(s)
    }
}

fn three<const D: usize>(a: [f64; D]) -> [f64; 3] {
    core::array::from_fn(|i| if i < D { a[i] } else { 0.0 })
}

impl<T: Lanes, const D: usize> Simulate for Simulation<T, D> {
    fn dimension(&self) -> usize {
        D
    }
    fn precision(&self) -> &'static str {
        T::NAME
    }
    fn isa(&self) -> Isa {
        self.setup.isa
    }
    fn dx(&self) -> f64 {
        self.setup.dx
    }
    fn domain(&self) -> Option<([f64; 3], [f64; 3])> {
        self.setup
            .domain
            .as_ref()
            .map(|d| (three(d.min), three(d.max)))
    }
    fn gravity(&self) -> [f64; 3] {
        three(self.setup.gravity)
    }
    fn materials(&self) -> Vec<String> {
        self.setup
            .materials
            .iter()
            .map(|m| m.name.clone())
            .collect()
    }
    fn time(&self) -> f64 {
        self.time
    }
    fn substeps(&self) -> u64 {
        self.substeps
    }
    fn particle_count(&self) -> usize {
        self.x.len()
    }
    fn next_dt(&self) -> (f64, DtLimit) {
        match self.setup.time_step {
            TimeStep::Fixed(dt) => (dt, DtLimit::Fixed),
            TimeStep::Automatic { .. } => (1e-3, DtLimit::Sound),
        }
    }
    fn substep(&mut self) -> Result<Advance, Failure> {
        let (dt, limit) = self.next_dt();
        for i in 0..self.x.len() {
            for d in 0..D {
                self.v[i][d] += dt * self.setup.gravity[d];
                self.x[i][d] += dt * self.v[i][d];
                if let Some(domain) = &self.setup.domain {
                    if self.x[i][d] < domain.min[d] {
                        self.x[i][d] = domain.min[d];
                        self.v[i][d] *= -0.5;
                    }
                    if self.x[i][d] > domain.max[d] {
                        self.x[i][d] = domain.max[d];
                        self.v[i][d] *= -0.5;
                    }
                }
            }
        }
        self.time += dt;
        self.substeps += 1;
        Ok(Advance {
            substeps: 1,
            dt_min: dt,
            limit,
        })
    }
    fn advance_to(&mut self, time: f64) -> Result<Advance, Failure> {
        let mut a = Advance {
            dt_min: f64::INFINITY,
            ..Advance::default()
        };
        while self.time < time - 1e-9 {
            let one = self.substep()?;
            a = Advance {
                substeps: a.substeps + 1,
                ..one
            };
        }
        Ok(a)
    }
    fn command(&mut self, command: Command) {
        if let Command::Gravity(g) = command {
            self.setup.gravity = core::array::from_fn(|i| g[i]);
        }
    }
    fn snapshot(&self, fields: &[Field]) -> Snapshot {
        let n = self.x.len();
        let columns = fields
            .iter()
            .map(|&f| {
                (
                    f,
                    match f {
                        Field::Position => Data::F64(self.x.iter().flatten().copied().collect()),
                        Field::Velocity => {
                            Data::F32(self.v.iter().flatten().map(|&v| v as f32).collect())
                        }
                        Field::Affine | Field::DeformationGradient => {
                            Data::F32(vec![0.0; n * D * D])
                        }
                        Field::Jacobian | Field::PlasticJacobian => Data::F32(vec![1.0; n]),
                        Field::Pressure => Data::F32(vec![0.0; n]),
                        Field::Mass => Data::F64(self.m.clone()),
                        Field::Volume0 => Data::F64(self.vol.clone()),
                        Field::Material => Data::U32(self.mat.clone()),
                        Field::Body => Data::U32(self.body.clone()),
                        Field::Id => Data::U32((0..n as u32).collect()),
                    },
                )
            })
            .collect();
        Snapshot {
            time: self.time,
            dimension: D,
            count: n,
            columns,
        }
    }
    fn diagnostics(&self) -> Diagnostics {
        Diagnostics {
            time: self.time,
            substeps: self.substeps,
            particles: self.x.len() as u64,
            mass: self.m.iter().sum(),
            ..Diagnostics::default()
        }
    }
    fn set_clock(&mut self, _: fn() -> f64) {}
    fn phase_times(&self) -> PhaseTimes {
        PhaseTimes::default()
    }
    fn memory(&self) -> Memory {
        Memory::default()
    }
}

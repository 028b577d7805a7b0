//! The thread that writes a run's files, so that the simulation need not wait for the disk.

use std::fs::{self, File};
use std::path::Path;
use std::sync::mpsc::{Sender, SyncSender, channel, sync_channel};
use std::thread::{Builder, JoinHandle};

use lahar::{Checkpoint, Diagnostics, ProbeSamples, Snapshot};

use super::probes::ProbeFiles;
use super::{DiagnosticsFile, RunFolder, frame_name, write_frame};
use crate::checkpoint::{Header, OutputCounts, OutputState, Store};
use crate::export::{Format, TimeSeries};
use crate::files::{Durability, GrowingFile, OutputError, make_folder, sync_folder, write_whole};
use crate::image::{self, Renderer};

/// Most frames between simulation and disk: one that is being written, one that waits.
const UNDER_WAY: usize = 2;

/// The outputs of a run.
pub struct OutputPlan {
    /// Folder of the run.
    pub folder: RunFolder,
    /// Dimension: 2 or 3.
    pub dimension: usize,
    /// Formats of particles; each frame gets one file per format.
    pub formats: Vec<Format>,
    /// Pictures as PNG, if wanted.
    pub pictures: Option<PicturePlan>,
    /// Film as GIF, if wanted.
    pub film: Option<FilmPlan>,
}

/// Pictures that are kept as PNG files.
pub struct PicturePlan {
    /// Renderer that draws them.
    pub renderer: Renderer,
    /// Number of frames from one picture to the next.
    pub every: u64,
}

/// A film of a run.
pub struct FilmPlan {
    /// Renderer that draws its pictures.
    pub renderer: Renderer,
    /// Its frames and its speed.
    pub pace: FilmPace,
}

/// The frames that a film shows, and its speed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FilmPace {
    /// Number of frames from one picture to the next.
    pub every: u64,
    /// Pictures per second.
    pub rate: f64,
}

/// Most pictures per second of a film.
const FILM_RATE: f64 = 30.0;

/// Length below which a film is slowed down \[s\].
const SHORT_FILM: f64 = 2.0;

/// Returns the pace of a film of `frames` frames, with `frame_rate` frames per simulated second. It plays in real time
/// and skips frames above 30 per second. Films under two seconds are slowed down.
///
/// ```
/// use lahar_io::output::film_pace;
///
/// let pace = film_pace(60.0, 600);
/// assert_eq!((pace.every, pace.rate), (2, 30.0));
/// ```
pub fn film_pace(frame_rate: f64, frames: u64) -> FilmPace {
    let every = (frame_rate / FILM_RATE).ceil().max(1.0);
    let real_time = FilmPace {
        every: every as u64,
        rate: frame_rate / every,
    };
    if frames as f64 / frame_rate >= SHORT_FILM {
        return real_time;
    }
    let every = (frames as f64 / (SHORT_FILM * FILM_RATE)).floor().max(1.0);
    FilmPace {
        every: every as u64,
        rate: (frames as f64 / every / SHORT_FILM).clamp(5.0, FILM_RATE),
    }
}

enum Job {
    Frame(Box<Frame>),
    Checkpoint(Box<(Header, Checkpoint)>),
    /// A message to answer when everything before it is written.
    Barrier(Sender<()>),
}

struct Frame {
    index: u64,
    snapshot: Option<Snapshot>,
    diagnostics: Diagnostics,
    probes: Vec<ProbeSamples>,
}

/// Writes frames and checkpoints, in order, on a thread of its own.
pub struct Writer {
    jobs: Option<SyncSender<Job>>,
    thread: Option<JoinHandle<Result<OutputCounts, OutputError>>>,
}

impl Writer {
    /// Makes the folders and files and starts the thread. A run that is resumed passes the state of its files at the
    /// checkpoint, to which they are cut back.
    ///
    /// # Errors
    /// If a folder or file cannot be made.
    pub fn start(plan: OutputPlan, from: Option<&OutputState>) -> Result<Self, OutputError> {
        let folder = &plan.folder;
        for (wanted, path) in [
            (!plan.formats.is_empty(), folder.frames()),
            (plan.pictures.is_some(), folder.images()),
        ] {
            if wanted {
                make_folder(&path)?;
            }
        }
        let work = OutputFiles::new(plan, from)?;
        let (jobs, queue) = sync_channel::<Job>(UNDER_WAY - 1);
        let path = work.plan.folder.path().to_owned();
        let thread = Builder::new()
            .name("output".to_owned())
            .spawn(move || {
                let mut work = work;
                for job in queue {
                    match job {
                        Job::Frame(frame) => work.frame(&frame)?,
                        Job::Checkpoint(checkpoint) => work.checkpoint(*checkpoint)?,
                        // The thread that asked may have ended.
                        Job::Barrier(done) => drop(done.send(())),
                    }
                }
                work.finish()
            })
            .map_err(OutputError::at(&path))?;
        Ok(Self {
            jobs: Some(jobs),
            thread: Some(thread),
        })
    }

    /// Hands a frame to the thread, and waits while too many are there. A frame without a snapshot writes rows of csv files
    /// only; `probes` are the readings since the frame before.
    ///
    /// # Errors
    /// If an earlier frame could not be written.
    pub fn frame(
        &mut self,
        index: u64,
        snapshot: Option<Snapshot>,
        diagnostics: Diagnostics,
        probes: Vec<ProbeSamples>,
    ) -> Result<(), OutputError> {
        self.hand_over(Job::Frame(Box::new(Frame {
            index,
            snapshot,
            diagnostics,
            probes,
        })))
    }

    /// Hands a checkpoint to the thread. It is written after everything before it is on the disk, and gets the state of the
    /// run's files at that moment.
    ///
    /// # Errors
    /// If an earlier frame could not be written.
    pub fn checkpoint(
        &mut self,
        header: Header,
        checkpoint: Checkpoint,
    ) -> Result<(), OutputError> {
        self.hand_over(Job::Checkpoint(Box::new((header, checkpoint))))
    }

    /// Waits until all frames so far are written.
    ///
    /// # Errors
    /// If one of them could not be written.
    pub fn flush(&mut self) -> Result<(), OutputError> {
        let (done, answer) = channel();
        self.hand_over(Job::Barrier(done))?;
        match answer.recv() {
            Ok(()) => Ok(()),
            // The thread has ended with an error.
            Err(_) => self.end().map(|_| ()),
        }
    }

    fn hand_over(&mut self, job: Job) -> Result<(), OutputError> {
        if self
            .jobs
            .as_ref()
            .is_some_and(|jobs| jobs.send(job).is_ok())
        {
            return Ok(());
        }
        // The thread has ended, so it has an error.
        self.end().map(|_| ())
    }

    /// Writes the remaining frames and the film.
    ///
    /// # Errors
    /// If a file could not be written.
    pub fn finish(mut self) -> Result<OutputCounts, OutputError> {
        self.end()
    }

    fn end(&mut self) -> Result<OutputCounts, OutputError> {
        self.jobs = None;
        match self.thread.take().map(JoinHandle::join) {
            Some(Ok(result)) => result,
            Some(Err(panic)) => std::panic::resume_unwind(panic),
            None => Ok(OutputCounts::default()),
        }
    }
}

impl Drop for Writer {
    fn drop(&mut self) {
        // Without `finish` another error is on its way to the user; the remaining frames are still written.
        self.jobs = None;
        if let Some(thread) = self.thread.take() {
            drop(thread.join());
        }
    }
}

struct OutputFiles {
    plan: OutputPlan,
    diagnostics: DiagnosticsFile,
    probes: ProbeFiles,
    series: Option<TimeSeries>,
    film: Option<(image::Film, GrowingFile)>,
    written: OutputCounts,
    /// Files that do not grow: paths relative to the run's folder, and lengths \[bytes\].
    files: Vec<(String, u64)>,
    /// Number of these files that are known to be on the disk.
    settled: usize,
}

impl OutputFiles {
    fn new(plan: OutputPlan, from: Option<&OutputState>) -> Result<Self, OutputError> {
        let folder = &plan.folder;
        let written = from.map_or_else(OutputCounts::default, |state| state.written);
        let path = folder.time_series();
        let series = match plan.formats.contains(&Format::Vtk) {
            true => Some(
                TimeSeries::start(&path, written.particles as usize)
                    .map_err(OutputError::at(&path))?,
            ),
            false => None,
        };
        let film = match &plan.film {
            Some(film) => {
                let mut film = image::Film::new(film.pace.rate);
                let path = folder.film_pictures();
                let was = from.and_then(|state| state.film.as_ref());
                let file = GrowingFile::open(&path, was)?;
                fs::read(&path)
                    .and_then(|pictures| film.unpack(&pictures))
                    .map_err(OutputError::at(&path))?;
                Some((film, file))
            }
            None => None,
        };
        let was = from.and_then(|state| state.diagnostics.as_ref());
        Ok(Self {
            diagnostics: DiagnosticsFile::open(&folder.diagnostics(), plan.dimension, was)?,
            probes: match from {
                Some(state) => ProbeFiles::resume(&folder.probes(), folder.path(), &state.probes)?,
                None => ProbeFiles::new(&folder.probes()),
            },
            series,
            film,
            written,
            files: from.map_or_else(Vec::new, |state| state.files.clone()),
            settled: from.map_or(0, |state| state.files.len()),
            plan,
        })
    }

    fn checkpoint(
        &mut self,
        (mut header, checkpoint): (Header, Checkpoint),
    ) -> Result<(), OutputError> {
        header.progress.output = self.settle()?;
        let store = Store::new(&self.plan.folder.checkpoints());
        store.add(&header, &checkpoint).map(|_| ())
    }

    /// Waits until all files are on the disk and returns their state.
    fn settle(&mut self) -> Result<OutputState, OutputError> {
        let folder = &self.plan.folder;
        let run = folder.path();
        let mut folders = vec![run.to_owned(), folder.probes()];
        for (file, _) in &self.files[self.settled..] {
            let path = run.join(file);
            File::open(&path)
                .and_then(|file| file.sync_all())
                .map_err(OutputError::at(&path))?;
            let parent = path.parent().unwrap_or(run).to_owned();
            if !folders.contains(&parent) {
                folders.push(parent);
            }
        }
        for folder in folders.iter().filter(|folder| folder.is_dir()) {
            sync_folder(folder)?;
        }
        self.settled = self.files.len();
        let settle = |file: &GrowingFile| file.settle(run);
        Ok(OutputState {
            written: self.written,
            diagnostics: Some(settle(self.diagnostics.file())?),
            probes: self
                .probes
                .files()
                .iter()
                .map(settle)
                .collect::<Result<_, _>>()?,
            film: self
                .film
                .as_ref()
                .map(|(_, file)| settle(file))
                .transpose()?,
            series: self
                .series
                .as_ref()
                .map(|list| list.settle(run))
                .transpose()?,
            files: self.files.clone(),
        })
    }

    /// Adds a file to the list of those that do not grow.
    fn wrote(&mut self, path: &Path) -> Result<(), OutputError> {
        let bytes = fs::metadata(path).map_err(OutputError::at(path))?.len();
        let file = path.strip_prefix(self.plan.folder.path()).unwrap_or(path);
        let file = file.to_string_lossy().replace('\\', "/");
        self.files.push((file, bytes));
        Ok(())
    }

    fn frame(&mut self, job: &Frame) -> Result<(), OutputError> {
        if let Some(snapshot) = &job.snapshot {
            self.files(job.index, snapshot)?;
        }
        self.diagnostics.push(&job.diagnostics)?;
        self.probes.push(&job.probes)?;
        self.written.frames += 1;
        Ok(())
    }

    fn files(&mut self, index: u64, snapshot: &Snapshot) -> Result<(), OutputError> {
        let folder = self.plan.folder.clone();
        for format in self.plan.formats.clone() {
            let name = frame_name(index, format.info().ending);
            let path = folder.frames().join(&name);
            write_frame(&path, snapshot, format)?;
            self.wrote(&path)?;
            if let Some(series) = self.series.as_mut().filter(|_| format == Format::Vtk) {
                (series.push(snapshot.time, &format!("frames/{name}")))
                    .map_err(OutputError::at(series.path()))?;
            }
        }
        self.written.particles += u64::from(!self.plan.formats.is_empty());
        let due = |every: u64| index.is_multiple_of(every.max(1));
        if let Some(pictures) = self.plan.pictures.as_ref().filter(|p| due(p.every)) {
            let picture = pictures.renderer.render(snapshot);
            let path = folder.images().join(frame_name(index, "png"));
            write_whole(&path, Durability::Eventual, |mut writer| {
                picture.write_png(&mut writer)?;
                Ok(writer)
            })?;
            self.written.images += 1;
            self.wrote(&path)?;
        }
        if let (Some(plan), Some((film, file))) = (&self.plan.film, &mut self.film)
            && due(plan.pace.every)
        {
            film.push(&plan.renderer.render(snapshot))
                .map_err(OutputError::at(&folder.video()))?;
            file.add(&film.last_packed())?;
        }
        Ok(())
    }

    fn finish(mut self) -> Result<OutputCounts, OutputError> {
        if let Some((film, _)) = self.film.filter(|(film, _)| !film.is_empty()) {
            write_whole(
                &self.plan.folder.video(),
                Durability::Eventual,
                |mut writer| {
                    film.write(&mut writer)?;
                    Ok(writer)
                },
            )?;
            self.written.film = true;
        }
        Ok(self.written)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::image::{BACKGROUND, Scenery, Style, model_colors};
    use lahar::{Data, Field, ProbeSample};

    fn plan(folder: RunFolder) -> OutputPlan {
        let scenery = Scenery {
            dimension: 2,
            bounds: ([0.0; 3], [1.0, 1.0, 0.0]),
            walls: true,
            up: 1,
            dx: 0.1,
            speed: 1.0,
            background: BACKGROUND,
            colors: model_colors(&["fluid"]),
            bodies: Vec::new(),
            colliders: Vec::new(),
        };
        let renderer = Renderer::new(
            scenery,
            Style {
                width: 64,
                height: 64,
                ..Style::default()
            },
        );
        OutputPlan {
            folder,
            dimension: 2,
            formats: vec![Format::Npz, Format::Vtk],
            pictures: Some(PicturePlan {
                renderer: renderer.clone(),
                every: 1,
            }),
            film: Some(FilmPlan {
                renderer,
                pace: FilmPace {
                    every: 2,
                    rate: 25.0,
                },
            }),
        }
    }

    fn snapshot(x: f64) -> Option<Snapshot> {
        Some(Snapshot {
            time: x,
            dimension: 2,
            count: 1,
            columns: vec![(Field::Position, Data::F64(vec![x, 0.5]))],
        })
    }

    #[test]
    fn all_requested_files_are_written() {
        let root = tempfile::tempdir().unwrap();
        let folder = RunFolder::at(&root.path().join("run"), false).unwrap();
        let mut writer = Writer::start(plan(folder.clone()), None).unwrap();
        for index in 0..9 {
            let x = 0.1 * index as f64;
            writer
                .frame(
                    index,
                    snapshot(x),
                    Diagnostics {
                        time: x,
                        ..Diagnostics::default()
                    },
                    vec![ProbeSamples {
                        name: "P1".into(),
                        columns: vec!["pressure"],
                        samples: vec![ProbeSample {
                            time: x,
                            values: vec![2.0 * x],
                        }],
                    }],
                )
                .unwrap();
        }
        writer.flush().unwrap();
        assert!(folder.frames().join("000008.npz").exists());
        let written = writer.finish().unwrap();
        let read = super::super::Table::read(&folder.probes().join("P1.csv")).unwrap();
        let twice = |values: &[f64]| values.iter().map(|x| 2.0 * x).collect::<Vec<_>>();
        assert_eq!(
            read.column("time").map(twice).as_deref(),
            read.column("pressure")
        );
        assert_eq!(read.names(), ["time", "pressure"]);
        assert_eq!(read.column("time").map(<[f64]>::len), Some(9));
        assert_eq!(
            written,
            OutputCounts {
                frames: 9,
                particles: 9,
                images: 9,
                film: true
            }
        );
        assert_eq!(
            fs::read_to_string(folder.diagnostics())
                .unwrap()
                .lines()
                .count(),
            10
        );
        assert_eq!(fs::read_dir(folder.frames()).unwrap().count(), 18);
        let series = fs::read_to_string(folder.time_series()).unwrap();
        assert_eq!(series.matches("<DataSet timestep=").count(), 9);
        assert_eq!(fs::read_dir(folder.images()).unwrap().count(), 9);
        assert!(fs::read(folder.video()).unwrap().starts_with(b"GIF89a"));
    }

    #[test]
    fn an_error_in_the_background_reaches_the_caller() {
        let root = tempfile::tempdir().unwrap();
        let folder = RunFolder::at(&root.path().join("run"), false).unwrap();
        let mut writer = Writer::start(plan(folder.clone()), None).unwrap();
        fs::remove_dir_all(folder.frames()).unwrap();
        // The first frame is only handed over, so it has no error yet.
        writer
            .frame(0, snapshot(0.5), Diagnostics::default(), Vec::new())
            .unwrap();
        let error = writer.flush().unwrap_err();
        assert!(error.path.ends_with("frames/000000.npz"), "{error}");
        assert!(!error.usage);
    }

    #[test]
    fn films_play_in_real_time_unless_they_are_short() {
        assert_eq!(
            film_pace(60.0, 180),
            FilmPace {
                every: 2,
                rate: 30.0
            }
        );
        assert_eq!(
            film_pace(25.0, 100),
            FilmPace {
                every: 1,
                rate: 25.0
            }
        );
        assert_eq!(
            film_pace(1000.0, 100),
            FilmPace {
                every: 1,
                rate: 30.0
            }
        );
        assert_eq!(
            film_pace(1000.0, 600),
            FilmPace {
                every: 10,
                rate: 30.0
            }
        );
        assert_eq!(film_pace(60.0, 3).every, 1);
    }
}

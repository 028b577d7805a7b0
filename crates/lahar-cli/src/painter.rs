//! What draws a run's frames: the window's renderer where there is an adapter for it, or the processor.

use lahar::Snapshot;
use lahar_io::image::{Picture, Renderer, Scenery};
use lahar_io::output::Recording;
use lahar_scene::scene::Scene;

use crate::args;
use crate::error::CliError;
use crate::{appearance, terminal};

/// Draws frames of one run, all by the same view and colours.
pub(crate) enum Painter {
    Cpu(Box<Renderer>),
    #[cfg(feature = "window")]
    Gpu(Box<lahar_app::Painter>),
}

/// A run and how it is to be drawn.
pub(crate) struct Subject<'a> {
    #[cfg_attr(
        not(feature = "window"),
        expect(dead_code, reason = "the processor draws from the scene alone")
    )]
    pub(crate) recording: &'a Recording,
    /// With what options say of its camera.
    pub(crate) scene: &'a Scene,
    /// Its first frame.
    pub(crate) first: &'a Snapshot,
    /// Width and height at most \[pixels\].
    pub(crate) size: [u32; 2],
}

impl Painter {
    /// The one that was asked for; says on standard error which it is, and why where that is a choice.
    pub(crate) fn choose(which: args::Renderer, subject: &Subject) -> Result<Self, CliError> {
        match which {
            args::Renderer::Cpu => Ok(Self::cpu(subject, None)),
            args::Renderer::Gpu => Self::gpu(subject).map_err(|why| {
                CliError::Machine(format!(
                    "--renderer gpu: {why}; `--renderer cpu` needs no adapter"
                ))
            }),
            args::Renderer::Auto => {
                Self::gpu(subject).or_else(|why| Ok(Self::cpu(subject, Some(&why))))
            }
        }
    }

    /// The processor, and why not the window's renderer, if there is a reason.
    pub(crate) fn cpu(subject: &Subject, why: Option<&str>) -> Self {
        terminal::note(&match why {
            None => "pictures by the processor".to_owned(),
            Some(why) => format!("pictures by the processor: {why}"),
        });
        Self::Cpu(Box::new(by_processor(subject)))
    }

    /// The window's renderer, after a first picture: what drivers cannot do shows there.
    #[cfg(feature = "window")]
    fn gpu(subject: &Subject) -> Result<Self, String> {
        // One size, whatever draws.
        let [width, height] = by_processor(subject).size();
        let scenery = Scenery::recorded(subject.scene, subject.first);
        let style = lahar_io::image::Style {
            width,
            height,
            coloring: appearance::coloring(subject.scene, &scenery),
            ..lahar_io::image::Style::default()
        };
        let painter = lahar_app::Painter::new(
            subject.recording,
            &subject.scene.resolved(),
            subject.first,
            &style,
        )
        .and_then(|mut painter| painter.render(subject.first).map(|_| painter))
        .map_err(|error| error.to_string())?;
        terminal::note(&format!(
            "pictures by the window's renderer on {}",
            painter.adapter()
        ));
        Ok(Self::Gpu(Box::new(painter)))
    }

    #[cfg(not(feature = "window"))]
    fn gpu(_subject: &Subject) -> Result<Self, String> {
        Err("this program was built without the window's renderer".to_owned())
    }

    /// Draws one moment, or says why that cannot be done: then the processor still can.
    pub(crate) fn render(&mut self, snapshot: &Snapshot) -> Result<Picture, String> {
        match self {
            Self::Cpu(renderer) => Ok(renderer.render(snapshot)),
            #[cfg(feature = "window")]
            Self::Gpu(painter) => painter.render(snapshot).map_err(|error| error.to_string()),
        }
    }
}

fn by_processor(subject: &Subject) -> Renderer {
    let scenery = Scenery::recorded(subject.scene, subject.first);
    appearance::renderer(subject.scene, &scenery, subject.size)
}

//! Draws the frames of a run, by the window's renderer if there is an adapter for it, or on the processor.

use lahar::Snapshot;
use lahar_io::image::{Picture, Renderer, Scenery};
use lahar_io::output::Recording;
use lahar_scene::scene::Scene;

use crate::args;
use crate::error::CliError;
use crate::{appearance, terminal};

/// Draws the frames of one run, all with the same view and colors.
pub(crate) enum Painter {
    Cpu(Box<Renderer>),
    #[cfg(feature = "window")]
    Gpu(Box<lahar_app::Painter>),
}

/// A run, and the way to draw it.
pub(crate) struct Subject<'a> {
    #[cfg_attr(
        not(feature = "window"),
        expect(dead_code, reason = "only the window's renderer needs it")
    )]
    pub(crate) recording: &'a Recording,
    /// The run's scene, with the camera that the options ask for.
    pub(crate) scene: &'a Scene,
    /// The run's first frame.
    pub(crate) first: &'a Snapshot,
    /// The largest width and height \[pixels\].
    pub(crate) size: [u32; 2],
}

impl Painter {
    /// Returns the renderer that the option asks for. Prints on standard error which one it is, and the reason if the
    /// option leaves it open.
    pub(crate) fn choose(which: args::Renderer, subject: &Subject) -> Result<Self, CliError> {
        match which {
            args::Renderer::Cpu => Ok(Self::cpu(subject, None)),
            args::Renderer::Gpu => Self::gpu(subject).map_err(|why| {
                CliError::Machine(format!(
                    "--renderer gpu: {why}; `--renderer cpu` needs no graphics adapter"
                ))
            }),
            args::Renderer::Auto => {
                Self::gpu(subject).or_else(|why| Ok(Self::cpu(subject, Some(&why))))
            }
        }
    }

    /// Draws on the processor. `why` is the reason why the window's renderer cannot.
    pub(crate) fn cpu(subject: &Subject, why: Option<&str>) -> Self {
        terminal::note(&match why {
            None => "drawing on the processor".to_owned(),
            Some(why) => format!("drawing on the processor: {why}"),
        });
        Self::Cpu(Box::new(processor_renderer(subject)))
    }

    /// Returns the window's renderer, after a first picture has shown that the driver can draw.
    #[cfg(feature = "window")]
    fn gpu(subject: &Subject) -> Result<Self, String> {
        // Both renderers draw pictures of the same size.
        let [width, height] = processor_renderer(subject).size();
        let scenery = Scenery::recorded(subject.scene, subject.first);
        let style = lahar_io::image::Style {
            width,
            height,
            coloring: appearance::coloring(subject.scene, &scenery),
            ..lahar_io::image::Style::default()
        };
        let painter = lahar_app::Painter::new(
            subject.recording,
            subject.scene.view(),
            subject.first,
            &style,
        )
        .and_then(|mut painter| painter.render(subject.first).map(|_| painter))
        .map_err(|error| error.to_string())?;
        terminal::note(&format!(
            "drawing by the window's renderer on {}",
            painter.adapter()
        ));
        Ok(Self::Gpu(Box::new(painter)))
    }

    #[cfg(not(feature = "window"))]
    fn gpu(_subject: &Subject) -> Result<Self, String> {
        Err("lahar was built without the window's renderer".to_owned())
    }

    /// Draws one frame.
    ///
    /// # Errors
    /// The reason why the window's renderer cannot draw; the processor still can.
    pub(crate) fn render(&mut self, snapshot: &Snapshot) -> Result<Picture, String> {
        match self {
            Self::Cpu(renderer) => Ok(renderer.render(snapshot)),
            #[cfg(feature = "window")]
            Self::Gpu(painter) => painter.render(snapshot).map_err(|error| error.to_string()),
        }
    }
}

fn processor_renderer(subject: &Subject) -> Renderer {
    let scenery = Scenery::recorded(subject.scene, subject.first);
    appearance::renderer(subject.scene, &scenery, subject.size)
}

//! What a picture shows and how, and the file that it becomes.

use std::ops::RangeInclusive;
use std::path::{Display, Path, PathBuf};

use anyhow::anyhow;
use glam::DVec2;
use tautline::output::{WholeFile, check_place, write_whole};
use tautline::picture::{self, Drawing, Part, PictureError, Theme};

use super::failure::Failure;
use super::print;

/// What a picture shows and how.
#[derive(Debug, clap::Args)]
#[group(id = "look", multiple = true, requires = "picture")]
pub(crate) struct Look {
    /// Show the moment after step K, the move from point K-1 to point K [default: the last]
    #[arg(long, allow_negative_numbers = true, value_name = "K")]
    pub step: Option<usize>,
    /// A filmstrip: a small picture for each wrap and unwrap, of events FROM to TO [default: 1-24]
    #[arg(long, value_name = "FROM-TO", num_args = 0..=1, value_parser = frames,
        conflicts_with_all = ["step", "animate"])]
    pub frames: Option<Option<RangeInclusive<usize>>>,
    /// Play the trace: an .svg that moves by itself, or an .html with a slider
    #[arg(long)]
    pub animate: bool,
    /// The part of the plane: `near` the traces, `all` walls, or two corners
    #[arg(long, value_name = "near|all|X,Y,X,Y", allow_hyphen_values = true, value_parser = part,
        default_value = "near")]
    pub view: Part,
    /// The most rays of the pivot: those nearest to the free end [default: 12, with --frames 0]
    #[arg(long, allow_negative_numbers = true, value_name = "N")]
    pub rays: Option<usize>,
    /// The ground: `auto` is as the reader's system has it, in .png light
    #[arg(long, value_enum, default_value = "auto")]
    pub theme: ThemeArg,
    /// How many pixels wide a .png is [default: 1440]
    #[arg(long, allow_negative_numbers = true, value_name = "PIXELS")]
    pub width: Option<u32>,
}

impl Look {
    /// A whole scene.
    pub(crate) fn of_scene() -> Self {
        let theme = ThemeArg::Auto;
        Look { step: None, frames: None, animate: false, view: Part::All, rays: None, theme, width: None }
    }
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, clap::ValueEnum)]
pub(crate) enum ThemeArg {
    Auto,
    Light,
    Dark,
}

/// How wide pictures are as PNG: two pixels for each of the SVG's units.
const WIDTH: u32 = 1440;

/// `FROM-TO`, or one number.
fn frames(text: &str) -> Result<RangeInclusive<usize>, String> {
    let wrong = || "give the numbers of the first and the last event, such as 1-24".to_owned();
    let (from, to) = text.split_once('-').unwrap_or((text, text));
    let number = |t: &str| t.trim().parse::<usize>().map_err(|_| wrong());
    Ok(number(from)?..=number(to)?)
}

fn part(text: &str) -> Result<Part, String> {
    match text {
        "near" => return Ok(Part::Near),
        "all" => return Ok(Part::All),
        _ => {}
    }
    let wrong = || "give near, all, or two opposite corners, such as 0,0,4.5,3".to_owned();
    let numbers: Vec<f64> = text.split(',').map(tautline::parse_number).collect::<Option<_>>().ok_or_else(wrong)?;
    match numbers[..] {
        [x0, y0, x1, y1] => Ok(Part::Between(DVec2::new(x0, y0), DVec2::new(x1, y1))),
        _ => Err(wrong()),
    }
}

/// What kind of picture a file is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Kind {
    Svg,
    Png,
    Html,
}

/// Where a picture goes.
pub(crate) struct Target {
    path: PathBuf,
    kind: Kind,
}

impl Target {
    /// Checks, before anything is computed, that the file can be written and goes with the look. Leaves nothing behind.
    pub(crate) fn new(path: &Path, look: &Look) -> Result<Self, Failure> {
        let shown = path.display();
        let is = "the extension does not name a format; pictures are written as .svg, .png or .html";
        let target = Target::at(path, is)?;
        let no = |what: String| Err(Failure::input(anyhow!(what)));
        match target.kind {
            Kind::Png if look.animate => {
                no(format!("{shown}: a PNG does not move; --animate makes an .svg or an .html"))
            }
            Kind::Svg if look.animate && look.step.is_some() => {
                no(format!("--step and --animate: {shown} plays all steps; an .html begins at one"))
            }
            Kind::Svg | Kind::Html if look.width.is_some() => {
                no(format!("--width goes with a .png; {shown} has no pixels"))
            }
            _ => target.checked(),
        }
    }

    /// The same for what does not move and has no page; `is` says what it is drawn as.
    pub(crate) fn still(path: &Path, is: &str) -> Result<Self, Failure> {
        match Target::at(path, is)? {
            Target { kind: Kind::Html, .. } => Err(Failure::input(anyhow!("{}: {is}", path.display()))),
            target => target.checked(),
        }
    }

    fn at(path: &Path, is: &str) -> Result<Self, Failure> {
        check_place(path)?;
        let extension = path.extension().map(|e| e.to_string_lossy().to_ascii_lowercase()).unwrap_or_default();
        let kind = match extension.as_str() {
            "svg" => Kind::Svg,
            "png" => Kind::Png,
            "html" | "htm" => Kind::Html,
            _ => return Err(Failure::input(anyhow!("{}: {is}", path.display()))),
        };
        Ok(Target { path: path.to_owned(), kind })
    }

    fn checked(self) -> Result<Self, Failure> {
        WholeFile::create(&self.path).map(drop)?;
        Ok(self)
    }

    /// Writes a picture; a PNG is that many pixels wide.
    pub(crate) fn save(&self, text: String, width: u32) -> Result<(), Failure> {
        let bytes = match self.kind {
            Kind::Png => picture::png(&text, width)?,
            Kind::Svg | Kind::Html => text.into_bytes(),
        };
        Ok(write_whole(&self.path, &bytes)?)
    }

    /// Whether it is a page.
    pub(crate) fn is_page(&self) -> bool {
        self.kind == Kind::Html
    }

    /// The file's name as people see it.
    pub(crate) fn shown(&self) -> Display<'_> {
        self.path.display()
    }
}

/// Draws, writes what is drawn, and says so.
pub(crate) fn write(target: &Target, drawing: &Drawing<'_>, look: &Look) -> Result<(), Failure> {
    save(target, drawing, look)?;
    print(&format!("wrote {}\n", target.shown()))
}

/// Draws, and writes what is drawn.
pub(crate) fn save(target: &Target, drawing: &Drawing<'_>, look: &Look) -> Result<(), Failure> {
    let theme = match look.theme {
        ThemeArg::Auto => Theme::Reader,
        ThemeArg::Light => Theme::Light,
        ThemeArg::Dark => Theme::Dark,
    };
    let mut drawing = drawing.clone().theme(theme).part(look.view);
    drawing = look.step.into_iter().fold(drawing, Drawing::at_step);
    drawing = look.rays.into_iter().fold(drawing, Drawing::rays);
    let text = match (target.kind, &look.frames) {
        (Kind::Html, None) => drawing.page()?,
        (Kind::Html, Some(events)) => drawing.frames_page(events.clone())?,
        (_, Some(events)) => drawing.frames(events.clone())?,
        (_, None) if look.animate => drawing.animated()?,
        (_, None) => drawing.svg()?,
    };
    target.save(text, look.width.unwrap_or(WIDTH))
}

impl From<PictureError> for Failure {
    fn from(error: PictureError) -> Self {
        match error {
            PictureError::Size { .. } => Failure::input(anyhow!("--width: {error}")),
            other => Failure::internal(other.into()),
        }
    }
}

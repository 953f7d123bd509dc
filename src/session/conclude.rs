//! The answer of a study, in its folder.

use std::path::Path;

use super::chosen;
use super::error::SessionError;
use super::folder::Folder;
use super::names::{PAGE, RUN_REPORT, SUMMARY};
use super::report::{RunReport, pretty};
use super::rows;
use super::under_way::{Session, locked};
use crate::picture::{self, PictureError};
use crate::study::{Shard, State, Stopped, Study, Summary};

/// How wide the pictures are as PNG, in pixels: two for each of the SVG's units.
pub(super) const WIDTH: u32 = 1600;

impl Session {
    /// Writes the answer so far, and what it cost: `summary.json`, `run.json`, and where the study says so the pictures
    /// and the page that shows them, and the steps and points of chosen traces.
    ///
    /// # Errors
    ///
    /// What the operating system says, and what the chosen traces do.
    pub fn conclude(&self, report: &RunReport) -> Result<Summary, SessionError> {
        let (folder, study) = (&self.folder, &*self.study);
        // The state is not locked meanwhile: this can take its time.
        let chosen = chosen::write(folder, study, &self.state())?;
        let summary = {
            let mut state = locked(&self.state);
            state.kept.files.extend(chosen);
            let summary = state.summary(study);
            folder.write(SUMMARY, pretty(&summary)?.as_bytes())?;
            let report = pretty(report)?;
            folder.write(RUN_REPORT, report.as_bytes())?;
            state.kept.files.insert(RUN_REPORT.to_owned(), blake3::hash(report.as_bytes()).into());
            folder.save(&state)?;
            summary
        };
        if study.plan().outputs.pictures {
            draw(folder, &summary, study, report)?;
        }
        Ok(summary)
    }
}

/// Writes the pictures and the page that shows them.
fn draw(folder: &Folder, summary: &Summary, study: &Study, report: &RunReport) -> Result<(), SessionError> {
    let scene = study.models()[0].scene();
    let pictures = picture::all(summary, scene);
    for (name, _, svg) in &pictures {
        folder.write(&format!("{name}.svg"), svg.as_bytes())?;
        match picture::png(svg, WIDTH) {
            Ok(png) => folder.write(&format!("{name}.png"), &png)?,
            // The page and the SVGs say the same.
            Err(PictureError::Unavailable) => {}
            Err(error) => return Err(SessionError::Picture { name: name.clone(), error }),
        }
    }
    let shown: Vec<_> = pictures.into_iter().map(|(_, title, svg)| (title, svg)).collect();
    let report = serde_json::to_value(report)?;
    folder.write(PAGE, picture::page(summary, scene, &shown, Some(&report)).as_bytes())
}

/// A study in a folder, and how far it is. Its files are named from `base`, or else from where they were as it began.
/// Whoever writes there is not disturbed.
///
/// # Errors
///
/// A folder without a study or with a damaged one; a study whose files are not there any more, or of which nothing is
/// saved.
pub fn look(folder: &Path, base: Option<&Path>) -> Result<(Study, State), SessionError> {
    let folder = Folder::at(folder);
    let (study, _) = folder.study(base)?;
    let state = folder.state(&study)?;
    Ok((study, state))
}

/// The answer of this part of a study, if `folder` holds it whole, with all that the study writes besides. Whoever
/// writes there is not disturbed.
///
/// # Errors
///
/// A folder that holds another study or something else.
pub fn answered(folder: &Path, study: &Study, shard: Shard) -> Result<Option<Summary>, SessionError> {
    let here = Folder::at(folder);
    let Some(state) = here.held(study, shard, true)? else { return Ok(None) };
    let outputs = &study.plan().outputs;
    let is_there =
        [(true, RUN_REPORT), (outputs.pictures, PAGE)].iter().all(|(is, name)| !is || here.file(name).exists());
    if state.stopped() == Stopped::Unfinished || !is_there {
        return Ok(None);
    }
    let summary = state.summary(study);
    let is_whole = is_answer(folder, &summary)?
        && (!outputs.traces || rows::of_shard(&here, &state).is_ok())
        && chosen::are_whole(&here, study, &state);
    Ok(is_whole.then_some(summary))
}

/// Whether `folder` holds the answer of this study, whole or ended by its rule, whoever put it together.
///
/// # Errors
///
/// A folder that holds another study or something else.
pub fn is_answered(folder: &Path, study: &Study) -> Result<bool, SessionError> {
    let held = Folder::at(folder).held(study, Shard::WHOLE, false)?;
    Ok(held.is_some_and(|state| state.stopped() != Stopped::Unfinished))
}

/// Whether the folder's `summary.json` is this one, or rightly not there since the study has not ended.
///
/// # Errors
///
/// A summary that cannot be written as JSON.
pub fn is_answer(folder: &Path, summary: &Summary) -> Result<bool, SessionError> {
    Ok(match std::fs::read(folder.join(SUMMARY)) {
        Ok(bytes) => bytes == pretty(summary)?.as_bytes(),
        Err(_) => summary.stopped == Stopped::Unfinished,
    })
}

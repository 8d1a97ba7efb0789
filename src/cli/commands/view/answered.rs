//! The page of what a solve has answered: the path, or the scene with what keeps it from having one.

use crate::cli::commands::solve::answer::Answer;
use crate::cli::commands::view::written;
use crate::cli::console::print::{Refusal, say};
use crate::scene::{PackagePath, Scene};
use crate::view::{Page, ViewOptions, Visuals, page_of_scene, page_of_solution};
use std::path::PathBuf;

/// Whether a page is asked for, and where.
#[derive(clap::Args, Clone, Debug)]
pub(crate) struct ViewArguments {
    /// Write a page that shows the answer, to be opened in a browser; without a name a temporary file, whose name is printed
    #[arg(long, value_name = "PAGE.html", num_args = 0..=1)]
    #[allow(clippy::option_option, reason = "given or not, with a name or without")]
    view: Option<Option<PathBuf>>,
}

impl ViewArguments {
    /// The file that is named for the page.
    pub fn file(&self) -> Option<&PathBuf> {
        self.view.as_ref()?.as_ref()
    }

    /// Writes the page, where one is asked for. Why there is none is said: the answer stays what it is.
    pub fn write(&self, scene: &Scene, answer: &Answer, told: (&PackagePath, fn(&str))) {
        if let Err(Refusal(why)) = self.try_to_write(scene, answer, told) {
            say(&format!("error: there is no page: {why}\n"));
        }
    }

    fn try_to_write(
        &self,
        scene: &Scene,
        answer: &Answer,
        (packages, tell): (&PackagePath, fn(&str)),
    ) -> Result<(), Refusal> {
        let Some(out) = &self.view else { return Ok(()) };
        let visuals = Visuals::of_scene(scene, &packages.clone().with_placeholders())?;
        let options = ViewOptions::default();
        let page: Page = match &answer.0 {
            Ok(solution) => page_of_solution(solution, &visuals, &options).map_err(|e| Refusal(e.to_string()))?,
            Err(none) => {
                let mut page = page_of_scene(scene, Ok(answer.model().clone()), &visuals, &options);
                page.count_tries(&none.report.funnel);
                page.tell("answer", none.reason.to_string());
                page
            }
        };
        written::write(&page, out.as_deref(), tell)
    }
}

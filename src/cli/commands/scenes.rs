//! `foliate scenes`: what is shipped.

use crate::cli::console::print::{Ending, Refusal, print, print_json};
use crate::scene::shipped_scenes;
use serde::Serialize;
use std::fmt::Write;

/// Lists the scenes that are shipped
#[derive(clap::Args)]
pub(crate) struct Arguments {
    /// One JSON object instead of text
    #[arg(long)]
    json: bool,
    /// Write this scene's file to standard output instead; saved anywhere, it solves as it is
    #[arg(long, value_name = "NAME")]
    show: Option<String>,
}

#[derive(Serialize)]
struct Listed {
    name: &'static str,
    summary: &'static str,
    needs_models: bool,
}

pub(crate) fn run(arguments: &Arguments) -> Result<Ending, Refusal> {
    let scenes = shipped_scenes();
    if let Some(name) = &arguments.show {
        let scene = scenes.iter().find(|s| s.name == name);
        let names: Vec<_> = scenes.iter().map(|s| s.name).collect();
        let scene = scene.ok_or_else(|| {
            Refusal(format!("there is no shipped scene `{}`; known: {}", name.escape_debug(), names.join(", ")))
        })?;
        print(&scene.copy());
        return Ok(Ending::Done);
    }
    if arguments.json {
        let scenes: Vec<_> =
            scenes.iter().map(|s| Listed { name: s.name, summary: s.summary, needs_models: s.needs_models }).collect();
        print_json(&serde_json::json!({ "scenes": scenes }))?;
        return Ok(Ending::Done);
    }
    let width = scenes.iter().map(|s| s.name.len()).max().unwrap_or_default();
    let mut text = String::new();
    for scene in scenes {
        let star = if scene.needs_models { " *" } else { "" };
        let _ = writeln!(text, "{:width$}  {}{star}", scene.name, scene.summary);
    }
    text.push_str("\n* needs published robot models: foliate models --install\n");
    print(&text);
    Ok(Ending::Done)
}

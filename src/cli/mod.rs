//! The command line: all functions without a window.

mod args;
mod camera;
mod compare;
mod examples;
mod export;
mod free_memory;
mod glossary;
mod lessons;
mod link;
mod list;
mod look;
mod outputs;
mod paper;
mod print;
mod report;
mod run;
mod search;
mod step;
mod task;

use std::ffi::OsString;
use std::path::Path;
use std::process::ExitCode;

use clap::Parser;
use clap::error::ErrorKind;
use motionscope_core::base::Error;

use crate::experiment::source::Source;
use crate::media::{self, Given, Info, Open};
use crate::session::{Named, trust};
use crate::{ui, work};
use args::{Args, Command};
use print::{say, say_json, to_json};

/// Runs the command; errors go to standard error as one sentence.
pub fn main(arguments: impl IntoIterator<Item = OsString>) -> ExitCode {
    let args = match Args::try_parse_from(look::joined(arguments)) {
        Ok(args) => args,
        Err(error) => return usage(&error),
    };
    motionscope_core::base::heap::measure_with(free_memory::free_bytes);
    match run(args) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("error: {error}");
            ExitCode::FAILURE
        }
    }
}

/// Prints help or version; any other error as one sentence.
fn usage(error: &clap::Error) -> ExitCode {
    if matches!(error.kind(), ErrorKind::DisplayHelp | ErrorKind::DisplayVersion) {
        return match error.print() {
            Ok(()) => ExitCode::SUCCESS,
            Err(_) => ExitCode::FAILURE,
        };
    }
    let message = error.to_string();
    let sentence: Vec<_> = message.lines().map(str::trim).take_while(|line| !line.is_empty()).collect();
    let sentence = sentence.join(" ");
    let why = sentence.strip_prefix("error: ").unwrap_or(&sentence);
    eprintln!("error: {}", Error::new(format!("{why} (see motionscope --help)")));
    ExitCode::from(2)
}

fn run(args: Args) -> Result<(), Error> {
    trust::keep_in(eframe::storage_dir("motionscope"));
    if args.trust {
        trust::trust_all();
    }
    match args.command {
        None => window(args.clip.map(|clip| task::clip_name(clip, args.next)).transpose()?, args.link_base),
        Some(Command::List { estimators, json }) => {
            let all = list::chosen(&estimators)?;
            if json { say_json(&list::json(&all)) } else { say(&list::text(&all, !estimators.is_empty())) }
        }
        Some(Command::Glossary { term, json }) => said(json)(&glossary(&query(&term)?, json)?),
        Some(Command::Search { words, json }) => said(json)(&search::found(&query(&words)?, json)?),
        Some(Command::Lessons { lesson, json }) => said(json)(&lessons::listed(lesson.as_deref(), json)?),
        Some(Command::Info { clip, next, json, count, truth, given: args }) => {
            let clip = task::clip_name(clip, next)?;
            let named = Named::find(&clip, args.with(Given { truth, ..Given::default() }))?;
            let Named { source, given, faults, .. } = named;
            task::warn_of_faults(&faults);
            let clip = source.open(&Open { count, given, ..Open::default() })?.clip;
            let info = Info::of(&clip).with_repeats(&clip, count);
            if json { say_json(&to_json(&info)?) } else { say(&info.to_string()) }
        }
        Some(Command::Synth { name, out, set, list }) => match (name, out) {
            (Some(name), Some(out)) if !list => synth(&name, &out, &set),
            _ => say(&list::scenes()),
        },
        Some(Command::Camera(args)) => say(&camera::camera(&args)?),
        Some(Command::Run(run)) => run::run(&run, args.link_base.as_deref()),
        Some(Command::Export(args)) => export::export(&args),
        Some(Command::Compare(args)) => compare::compare(&args),
    }
}

/// How a command with and without --json prints.
fn said(json: bool) -> fn(&str) -> Result<(), Error> {
    if json { say_json } else { say }
}

fn window(clip: Option<OsString>, link_base: Option<String>) -> Result<(), Error> {
    ui::run(ui::Start { open: clip }, link_base)
}

/// The words that are looked for, if they are not longer than any text in which they could be found.
fn query(words: &[String]) -> Result<String, Error> {
    /// The most letters of a query.
    const MOST_LETTERS: usize = 300;
    let query = words.join(" ");
    match query.chars().count() {
        count if count > MOST_LETTERS => {
            Err(Error::new(format!("nothing has {count} letters to look for; give at most {MOST_LETTERS}")))
        }
        _ => Ok(query),
    }
}

fn glossary(term: &str, json: bool) -> Result<String, Error> {
    match (term.is_empty(), json) {
        (true, true) => Ok(glossary::json()),
        (true, false) => Ok(glossary::text()),
        (false, true) => glossary::json_entry(term),
        (false, false) => glossary::entry(term),
    }
}

fn synth(name: &str, out: &Path, settings: &[String]) -> Result<(), Error> {
    let mut source = Source::parse(format!("synth:{}", name.trim_start_matches("synth:")))?;
    settings.iter().try_for_each(|setting| source.set(setting))?;
    let clip = source.open(&Open::default())?.clip;
    work::finish(media::export::clip(&clip, out, None))?;
    let frames = clip.info().frames.unwrap_or_default();
    say(&format!("{}: {frames} frames with ground truth in {}", clip.info().name, out.display()))
}

//! The flags of the view options, generated from their declaration.

use std::ffi::OsString;

use clap::builder::Str;
use clap::{Arg, ArgMatches, Command};
use motionscope_core::params::{Kind, Spec};

use crate::view::look::{Changes, Look};

/// The view options that were set by flags.
#[derive(Debug, Default)]
pub struct LookFlags(pub Changes);

impl clap::Args for LookFlags {
    fn augment_args(command: Command) -> Command {
        Look::entries().iter().fold(command, |command, spec| command.arg(flag(spec)))
    }

    fn augment_args_for_update(command: Command) -> Command {
        Self::augment_args(command)
    }
}

impl clap::FromArgMatches for LookFlags {
    fn from_arg_matches(matches: &ArgMatches) -> Result<Self, clap::Error> {
        let mut changes = Changes::default();
        for (index, spec) in Look::entries().iter().enumerate() {
            if let Some(text) = matches.get_one::<String>(&spec.name) {
                let message = |error| clap::Error::raw(clap::error::ErrorKind::ValueValidation, error);
                changes.set(index, text).map_err(message)?;
            }
        }
        Ok(Self(changes))
    }

    fn update_from_arg_matches(&mut self, matches: &ArgMatches) -> Result<(), clap::Error> {
        *self = Self::from_arg_matches(matches)?;
        Ok(())
    }
}

fn flag(spec: &'static Spec) -> Arg {
    let name = Str::from(spec.name.as_str());
    let read = |text: &str| spec.parse(text).map(|_| text.to_owned()).map_err(|error| error.to_string());
    let flag = Arg::new(name.clone()).long(name).help(help(spec)).value_name(value(spec)).value_parser(read);
    match &spec.kind {
        // --legend alone switches it on; --legend=off is for a session that has one.
        kind if is_switch(kind) => flag.num_args(0..=1).require_equals(true).default_missing_value(ON),
        _ => flag,
    }
}

/// Whether the flag alone says on: that of a switch, and of what is more than one.
fn is_switch(kind: &Kind) -> bool {
    match kind {
        Kind::Switch => true,
        Kind::Choice(all) => all.iter().any(|choice| choice.name == ON),
        _ => false,
    }
}

/// What a flag alone stands for.
const ON: &str = "on";

/// Arguments in which a word of a look's own that stands behind such a flag belongs to it: `--caption full` is `--caption=full`.
pub fn joined(arguments: impl IntoIterator<Item = OsString>) -> Vec<OsString> {
    let flags = Look::entries().iter().filter(|spec| matches!(spec.kind, Kind::Choice(_)) && is_switch(&spec.kind));
    let flags: Vec<(String, &Spec)> = flags.map(|spec| (format!("--{}", spec.name), spec)).collect();
    let mut all: Vec<OsString> = Vec::new();
    for argument in arguments {
        let spec = all.last().and_then(|last| flags.iter().find(|(flag, _)| last == flag.as_str()));
        let word = argument.to_str().filter(|word| spec.is_some_and(|(_, spec)| spec.parse(word).is_ok()));
        match (word, all.last_mut()) {
            (Some(word), Some(last)) => last.push(format!("={word}")),
            _ => all.push(argument),
        }
    }
    all
}

/// What it does, what may be given, and what counts where nothing is.
fn help(spec: &Spec) -> String {
    let doc = spec.doc.trim_end_matches('.');
    match spec.kind {
        Kind::Switch => doc.to_owned(),
        _ => format!("{doc} ({}; default {})", spec.allowed(), spec.default),
    }
}

/// Returns the placeholder of the value in the help.
fn value(spec: &Spec) -> &'static str {
    let kind = match &spec.kind {
        Kind::Optional { of, .. } => of,
        kind => kind,
    };
    match (kind, spec.unit) {
        (Kind::Switch, _) => "on|off",
        (kind, _) if is_switch(kind) => "on|off|full",
        (Kind::Int { .. } | Kind::Real { .. }, "px") => "PX",
        (Kind::Int { .. } | Kind::Real { .. }, _) => "NUMBER",
        _ => "NAME",
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_word_behind_the_caption_belongs_to_it_and_a_clip_does_not() {
        let message = |words: &[&str]| joined(words.iter().map(OsString::from));
        assert_eq!(message(&["run", "--caption", "full", "a.png"]), ["run", "--caption=full", "a.png"]);
        assert_eq!(message(&["run", "--caption", "a.png"]), ["run", "--caption", "a.png"]);
        assert_eq!(message(&["run", "--legend", "off"]), ["run", "--legend", "off"], "as it was");
    }
}

//! The flags of the view options, generated from their declaration.

use clap::builder::Str;
use clap::{Arg, ArgMatches, Command};
use motionscope_core::Spec;
use motionscope_core::params::Kind;

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
                let told = |error| clap::Error::raw(clap::error::ErrorKind::ValueValidation, error);
                changes.set(index, text).map_err(told)?;
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
    match spec.kind {
        // --legend alone switches it on; --legend=off is for a session that has one.
        Kind::Switch => flag.num_args(0..=1).require_equals(true).default_missing_value("on"),
        _ => flag,
    }
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
        (Kind::Int { .. } | Kind::Real { .. }, "px") => "PX",
        (Kind::Int { .. } | Kind::Real { .. }, _) => "NUMBER",
        _ => "NAME",
    }
}

//! The reference of the command line as Markdown: one section per command.

use clap::{Arg, Command};
use std::fmt::Write as _;

/// All commands.
pub fn markdown(mut command: Command) -> String {
    // Gives every subcommand its full name and usage.
    command.build();
    let mut text = String::new();
    let global: Vec<&Arg> = command
        .get_arguments()
        .filter(|a| a.is_global_set())
        .collect();
    text.push_str("Every command also takes `--help` and these:\n\n");
    table(&mut text, &global);
    for sub in command.get_subcommands() {
        section(&mut text, sub, 2);
    }
    text
}

fn section(text: &mut String, command: &Command, depth: usize) {
    if command.get_name() == "help" {
        return;
    }
    let name = command.get_bin_name().unwrap_or(command.get_name());
    let _ = writeln!(text, "{} {name}\n", "#".repeat(depth));
    if let Some(about) = command.get_long_about().or(command.get_about()) {
        let _ = writeln!(text, "{}\n", line(&about.to_string()));
    }
    if command.has_subcommands() {
        for sub in command.get_subcommands() {
            section(text, sub, depth + 1);
        }
        return;
    }
    let usage = command.clone().render_usage().to_string();
    let usage = usage.trim_start_matches("Usage: ");
    let _ = writeln!(text, "```text\n{}\n```\n", line(usage));
    let own: Vec<&Arg> = command
        .get_arguments()
        .filter(|a| !a.is_global_set() && !a.is_hide_set() && a.get_id() != "help")
        .collect();
    table(text, &own);
}

fn table(text: &mut String, arguments: &[&Arg]) {
    if arguments.is_empty() {
        return;
    }
    text.push_str("| argument | default | meaning |\n|---|---|---|\n");
    for argument in arguments {
        let help = argument.get_long_help().or(argument.get_help());
        let mut meaning = help.map(|help| line(&help.to_string())).unwrap_or_default();
        let values = argument.get_possible_values();
        let values: Vec<String> = values
            .iter()
            .filter(|value| !value.is_hide_set())
            .map(|value| format!("`{}`", value.get_name()))
            .collect();
        // Flags have true and false.
        if argument.get_action().takes_values() && !values.is_empty() {
            meaning = format!("{meaning}. One of {}", values.join(", "));
        }
        let default: Vec<String> = argument
            .get_default_values()
            .iter()
            .filter(|_| {
                !argument.is_hide_default_value_set() && argument.get_action().takes_values()
            })
            .map(|value| format!("`{}`", value.to_string_lossy()))
            .collect();
        let _ = writeln!(
            text,
            "| `{}` | {} | {} |",
            written(argument),
            default.join(" "),
            meaning.replace('|', "\\|")
        );
    }
    text.push('\n');
}

/// As it is typed: `-o, --output FILE`.
fn written(argument: &Arg) -> String {
    let values = argument.get_value_names().unwrap_or_default();
    let values: Vec<String> = values.iter().map(|name| name.to_string()).collect();
    let values = values.join(" ");
    let names = [
        argument.get_short().map(|short| format!("-{short}")),
        argument.get_long().map(|long| format!("--{long}")),
    ];
    let names: Vec<String> = names.into_iter().flatten().collect();
    match (names.is_empty(), argument.get_action().takes_values()) {
        (true, _) => values,
        (false, true) => format!("{} {values}", names.join(", ")),
        (false, false) => names.join(", "),
    }
}

/// On one line.
fn line(text: &str) -> String {
    text.split_whitespace().collect::<Vec<_>>().join(" ")
}

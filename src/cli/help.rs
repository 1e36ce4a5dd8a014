//! What `--help` shows beside arguments: the commands by what they are for, and examples.

use clap::Command;
use std::fmt::Write as _;

/// Commands by what they are for.
const GROUPS: [(&str, &[&str]); 7] = [
    (
        "Start",
        &["demo", "scenes", "new", "import", "check", "plan", "doctor"],
    ),
    ("Run", &["serve", "device", "rpc", "relay", "lobby", "auth"]),
    ("Watch the bus", &["ls", "hz", "echo"]),
    (
        "Recordings",
        &[
            "info", "view", "replay", "play", "export", "explain", "recover",
        ],
    ),
    ("Experiments", &["scenario", "batch", "probe"]),
    ("Surfaces", &["surface"]),
    ("This program", &["schema", "completions", "man"]),
];

/// Columns of a terminal, and those before what a command does.
const WIDTH: usize = 80;
const INDENT: usize = 14;

/// Examples by command: what is typed after `palpate`, and what it does.
const EXAMPLES: &[(&str, [(&str, &str); 2])] = &[
    (
        "demo",
        [
            ("demo", "press the teardrop and watch it in a browser"),
            ("demo --for 10s --headless", "press without serving a page"),
        ],
    ),
    (
        "serve",
        [
            (
                "serve scene.toml --http 127.0.0.1:8080",
                "run a scene, with its page",
            ),
            (
                "serve builtin:teardrop --record recordings --for 1m",
                "record a minute",
            ),
        ],
    ),
    (
        "scenes",
        [("scenes", "list them"), ("scenes --json", "as JSON")],
    ),
    (
        "scenario",
        [
            ("scenario --list", "list them with their bars"),
            (
                "scenario palpation --out out",
                "run one and keep its tables",
            ),
        ],
    ),
    (
        "batch",
        [
            ("batch sweep.toml -o runs.csv", "run it on all cores"),
            (
                "batch sweep.toml --shard 1/4 -o part.csv",
                "the first quarter, for one of four machines",
            ),
        ],
    ),
    (
        "schema",
        [
            ("schema > scene.schema.json", "let an editor check scenes"),
            ("schema --markdown", "every key with its unit and default"),
        ],
    ),
    (
        "new",
        [
            ("new scene.toml", "a soft teardrop and a ball"),
            ("new sheet.toml --from sheet", "another scene to start from"),
        ],
    ),
    (
        "import",
        [
            (
                "import kidney.stl --unit mm",
                "a scan, as a body with a scene",
            ),
            (
                "import part.step --model rigid -o part.toml",
                "a CAD part that stays rigid",
            ),
        ],
    ),
    (
        "check",
        [
            ("check scene.toml", "errors, warnings and a few ticks"),
            ("check scene.toml --json", "as JSON"),
        ],
    ),
    (
        "plan",
        [
            ("plan scene.toml", "what it builds and what a tick costs"),
            (
                "plan scene.toml --finer",
                "how far results are from finer cells",
            ),
        ],
    ),
    (
        "replay",
        [
            ("replay session.mcap", "exit code 1 at the first difference"),
            (
                "replay session.mcap --from 1000 --until 2000",
                "some of its ticks",
            ),
        ],
    ),
    (
        "play",
        [
            ("play session.mcap --http 127.0.0.1:8080", "with the page"),
            (
                "play session.mcap --rate 0.1 --loop",
                "slowly, again and again",
            ),
        ],
    ),
    (
        "view",
        [
            ("view session.mcap", "open it in a browser"),
            (
                "view new.mcap --against old.mcap",
                "two recordings, one picture",
            ),
        ],
    ),
    (
        "info",
        [
            ("info session.mcap", "what it holds"),
            ("info session.mcap --check", "find damaged parts"),
        ],
    ),
    (
        "export",
        [
            ("export session.mcap --csv ticks.csv", "one row a tick"),
            ("export session.mcap --svg plots.svg", "forces and depths"),
        ],
    ),
    (
        "explain",
        [
            (
                "explain session.mcap --tick 1200",
                "list gaps, compliances and forces of its contacts",
            ),
            ("explain session.mcap --tick 1200 --json", "as JSON"),
        ],
    ),
    (
        "recover",
        [
            (
                "recover session.mcap.part",
                "finish a file that was cut short",
            ),
            ("recover session.mcap.part -o session.mcap", "under a name"),
        ],
    ),
    (
        "device",
        [
            (
                "device --tool ball --motion press --for 10s",
                "press with a simulated hand",
            ),
            (
                "device --tool ball --hardware haply",
                "move it with an Inverse3",
            ),
        ],
    ),
    (
        "probe",
        [
            (
                "probe scene.toml --poses poses.csv",
                "a force for each pose",
            ),
            (
                "probe scene.toml --poses poses.csv --explain",
                "and where it comes from",
            ),
        ],
    ),
    (
        "rpc",
        [
            ("rpc pause", "stop the ticks"),
            ("rpc record_start", "begin a recording"),
        ],
    ),
    (
        "relay",
        [
            (
                "relay --from tcp/127.0.0.1:7447 --listen tcp/127.0.0.1:7450 --read-only",
                "viewers of this machine",
            ),
            (
                "relay --from tcp/127.0.0.1:7447 --listen tcp/127.0.0.1:7450 --net-hz 10",
                "fewer control nets",
            ),
        ],
    ),
    (
        "lobby",
        [
            ("lobby", "listen on http://127.0.0.1:7440"),
            (
                "lobby --scenes scenes --max 4",
                "a folder of scenes, four at once",
            ),
        ],
    ),
    (
        "echo",
        [
            ("echo tool/ball/force", "each force of a tool"),
            ("echo status --count 1 --json", "one message, for programs"),
        ],
    ),
    (
        "ls",
        [
            ("ls", "instances of this machine"),
            (
                "ls -e tls/lab:7447 --identity viewer.json5",
                "on another machine",
            ),
        ],
    ),
    (
        "hz",
        [
            ("hz all", "every key, for 5 s"),
            ("hz tool/ball/force --for 1m", "one key, for a minute"),
        ],
    ),
    (
        "doctor",
        [
            ("doctor", "check this machine"),
            ("doctor scene.toml", "the rate at which it can run a scene"),
        ],
    ),
    (
        "completions",
        [
            (
                "completions bash > ~/.local/share/bash-completion/completions/palpate",
                "for bash",
            ),
            ("completions fish | source", "load into this shell"),
        ],
    ),
    (
        "man",
        [
            ("man ~/.local/share/man/man1", "write manual pages"),
            ("man --markdown", "one reference of all commands"),
        ],
    ),
    (
        "auth init",
        [
            ("auth init keys", "an authority, a daemon and an operator"),
            (
                "auth init keys --host lab --for 30d",
                "for a daemon called lab",
            ),
        ],
    ),
    (
        "auth issue",
        [
            (
                "auth issue keys --role tool --tool ball",
                "who may move a tool",
            ),
            (
                "auth issue keys --role viewer --for 12h",
                "who may look on, today",
            ),
        ],
    ),
    (
        "auth show",
        [
            ("auth show keys", "all of a directory"),
            ("auth show keys/daemon.json5", "a single identity"),
        ],
    ),
    (
        "auth rules",
        [
            ("auth rules scene.toml", "for a router in front of a daemon"),
            ("auth rules scene.toml --instance lab", "of an instance"),
        ],
    ),
    (
        "surface info",
        [
            ("surface info part.step", "print faces, area and volume"),
            ("surface info builtin:torus --json", "as JSON"),
        ],
    ),
    (
        "surface eval",
        [
            ("surface eval surface.json --uv uv.csv", "points"),
            (
                "surface eval surface.json --uv uv.csv --derivatives 1",
                "and first derivatives",
            ),
        ],
    ),
    (
        "surface closest",
        [
            (
                "surface closest part.step --points points.csv",
                "one answer a row",
            ),
            (
                "surface closest builtin:teardrop --points points.csv --json",
                "as JSON",
            ),
        ],
    ),
    (
        "surface convert",
        [
            ("surface convert part.iges part.step", "another CAD format"),
            ("surface convert surface.json surface.stl", "triangles"),
        ],
    ),
    (
        "surface tessellate",
        [
            (
                "surface tessellate part.step -o part.stl --tolerance 1e-5",
                "to 10 µm",
            ),
            (
                "surface tessellate surface.json -o surface.obj --cells 8",
                "eight cells a span",
            ),
        ],
    ),
    (
        "surface fit",
        [
            ("surface fit scan.stl -o scan.json", "closed triangles"),
            (
                "surface fit points.csv -o sheet.json --net 12x12",
                "scattered points",
            ),
        ],
    ),
    (
        "surface degree",
        [
            (
                "surface degree surface.json -o cubic.json --u 3 --v 3",
                "to degree 3 in both directions",
            ),
            (
                "surface degree surface.json -o flat.json --u 2 --json",
                "lower, with a bound of the error",
            ),
        ],
    ),
    (
        "surface merge",
        [
            (
                "surface merge a.json b.json -o joined.json",
                "join two patches",
            ),
            (
                "surface merge a.json b.json c.json d.json --grid 2x2 -o joined.json",
                "join four patches",
            ),
        ],
    ),
    (
        "surface isolate",
        [
            (
                "surface isolate a.json b.json -o apart.json",
                "move a out of b",
            ),
            (
                "surface isolate a.json b.json --json",
                "print the translations as JSON",
            ),
        ],
    ),
    (
        "surface truncate",
        [
            (
                "surface truncate a.json b.json -o walls",
                "give both a common wall",
            ),
            (
                "surface truncate a.json b.json -o walls --json",
                "with its figures",
            ),
        ],
    ),
    (
        "surface pipe",
        [
            ("surface pipe curve.json", "the largest radius"),
            (
                "surface pipe curve.json --radius 0.002 -o pipe.json",
                "a pipe of 2 mm",
            ),
        ],
    ),
    (
        "surface cut",
        [
            (
                "surface cut part.step --point 0,0,0.01 --normal 0,0,1 -o pieces.step",
                "cut by a plane",
            ),
            (
                "surface cut part.step --point 0,0,0.01 --normal 0,0,1 --json",
                "measures only",
            ),
        ],
    ),
    (
        "surface branch",
        [
            (
                "surface branch tree.json -o tree-surface.json",
                "one surface of a tree",
            ),
            (
                "surface branch branched.json --check",
                "measure a branching surface",
            ),
        ],
    ),
];

/// The program's command with what `--help` shows beside arguments.
pub(super) fn dressed(command: Command) -> Command {
    let mut command = command;
    for (path, examples) in EXAMPLES {
        let mut text = String::from("Examples:");
        for (typed, does) in examples {
            let _ = write!(text, "\n  palpate {typed}\n      {does}");
        }
        command = at(command, path, |own| {
            let text = match own.get_after_help() {
                Some(after) => format!("{text}\n\n{after}"),
                None => text,
            };
            own.after_help(text)
        });
    }
    let template = format!(
        "{{about-with-newline}}\n{{usage-heading}} {{usage}}\n\n{}Options:\n{{options}}{{after-help}}",
        groups(&command)
    );
    command.help_template(template)
}

/// Changes a command that is named by its path.
fn at(command: Command, path: &str, change: impl FnOnce(Command) -> Command) -> Command {
    match path.split_once(' ') {
        Some((first, rest)) => command.mut_subcommand(first, |sub| at(sub, rest, change)),
        None => command.mut_subcommand(path, change),
    }
}

/// Each group with a line for each of its commands.
fn groups(command: &Command) -> String {
    let mut text = String::new();
    for (heading, names) in GROUPS {
        let _ = writeln!(text, "{heading}:");
        for name in names {
            let about = command.find_subcommand(name).and_then(Command::get_about);
            let about = about.map(ToString::to_string).unwrap_or_default();
            let _ = write!(text, "  {name:<12}");
            let mut column = INDENT;
            for word in about.split_whitespace() {
                if column + 1 + word.chars().count() > WIDTH {
                    let _ = write!(text, "\n{:INDENT$}", "");
                    column = INDENT;
                }
                let _ = write!(text, " {word}");
                column += 1 + word.chars().count();
            }
            text.push('\n');
        }
        text.push('\n');
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    fn leaves(command: &Command, path: &str, out: &mut Vec<String>) {
        for sub in command.get_subcommands().filter(|s| s.get_name() != "help") {
            let path = format!("{path} {}", sub.get_name()).trim().to_owned();
            match sub.has_subcommands() {
                true => leaves(sub, &path, out),
                false => out.push(path),
            }
        }
    }

    #[test]
    fn each_command_is_in_one_group_and_has_examples_that_parse() {
        let command = super::super::command();
        let mut grouped: Vec<&str> = GROUPS
            .iter()
            .flat_map(|(_, names)| *names)
            .copied()
            .collect();
        let mut all: Vec<&str> = command.get_subcommands().map(Command::get_name).collect();
        grouped.sort_unstable();
        all.sort_unstable();
        assert_eq!(grouped, all);
        let mut paths = Vec::new();
        leaves(&command, "", &mut paths);
        let mut named: Vec<&str> = EXAMPLES.iter().map(|(path, _)| *path).collect();
        named.sort_unstable();
        paths.sort_unstable();
        assert_eq!(named, paths);
        let mut refused = Vec::new();
        for (path, examples) in EXAMPLES {
            for (typed, _) in examples {
                assert!(typed.starts_with(path), "{typed}");
                // What follows is the shell's.
                let given = typed.split(['>', '|']).next().unwrap();
                let words = std::iter::once("palpate").chain(given.split_whitespace());
                if let Err(error) = command.clone().try_get_matches_from(words) {
                    refused.push(format!("{typed}: {error}"));
                }
            }
        }
        assert!(refused.is_empty(), "{refused:#?}");
    }

    // A heading of flattened arguments would hold for the fields after them.
    #[test]
    fn options_of_the_command_itself_are_under_no_heading() {
        fn look(command: &Command) {
            let own = [
                "json",
                "headless",
                "html",
                "clock",
                "mouse_tool",
                "ready_fd",
            ];
            for argument in command.get_arguments() {
                if own.contains(&argument.get_id().as_str()) {
                    let name = command.get_name();
                    assert_eq!(argument.get_help_heading(), None, "{name} {argument}");
                }
            }
            command.get_subcommands().for_each(look);
        }
        look(&super::super::command());
    }

    #[test]
    fn help_has_groups_lines_of_a_terminal_and_the_exit_codes() {
        let mut command = super::super::command();
        let help = command.render_help().to_string();
        for (heading, _) in GROUPS {
            assert!(help.contains(&format!("\n{heading}:\n")), "{help}");
        }
        assert!(help.contains("Exit codes"), "{help}");
        let listed = help.split("\nOptions:").next().unwrap();
        let wide = listed
            .lines()
            .skip(1)
            .find(|line| line.chars().count() > WIDTH);
        assert_eq!(wide, None);
        let merge = command.find_subcommand_mut("surface").unwrap();
        let merge = merge.find_subcommand_mut("merge").unwrap();
        let help = merge.render_help().to_string();
        assert!(
            help.contains("Examples:") && help.contains("Exit codes"),
            "{help}"
        );
    }
}

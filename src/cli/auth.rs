//! `palpate auth`: who may touch.

use super::{Outcome, scenes, text};
use crate::auth::{Authority, Identity, Request, Role, grants, rules};
use std::path::{Path, PathBuf};
use std::time::Duration;
use time::OffsetDateTime;

#[derive(clap::Subcommand, Debug)]
pub enum Args {
    /// Make a certificate authority in a directory, with identities of a daemon and an operator.
    Init(InitArgs),
    /// Issue an identity: one file with key and certificate, for --identity.
    Issue(IssueArgs),
    /// Print whose an identity is, how long it is valid, and what its role may do.
    Show(ShowArgs),
    /// Print the access rules of a scene as a Zenoh configuration, for routers before a daemon.
    Rules(RulesArgs),
}

#[derive(clap::Args, Debug)]
pub struct InitArgs {
    /// Directory; keep ca.key in it away from the machines that only use identities.
    directory: PathBuf,
    #[command(flatten)]
    hosts: Hosts,
    /// How long the two identities are valid.
    #[arg(long = "for", value_parser = text::validity, default_value = "365d")]
    valid: Duration,
}

/// Names of a daemon.
#[derive(clap::Args, Debug)]
struct Hosts {
    /// Name or address under which clients reach the daemon, beside localhost; can be repeated.
    #[arg(long, value_name = "NAME")]
    host: Vec<String>,
}

#[derive(clap::Args, Debug)]
pub struct IssueArgs {
    /// Directory of the authority.
    directory: PathBuf,
    /// What its holder may do.
    #[arg(long, value_enum)]
    role: Kind,
    /// The tool that may be moved, for role tool.
    #[arg(long, required_if_eq("role", "tool"))]
    tool: Option<String>,
    /// Whose it is: it gives no rights, `auth show` prints it, and files are named after it.
    #[arg(long, value_parser = who)]
    name: Option<String>,
    #[command(flatten)]
    hosts: Hosts,
    /// How long it is valid, for example 12h or 30d. There is no other way to take it back.
    #[arg(long = "for", value_parser = text::validity, default_value = "365d")]
    valid: Duration,
    /// File to write [default: named after role and name, in the directory].
    #[arg(short, long)]
    out: Option<PathBuf>,
}

/// Roles by name.
#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
enum Kind {
    Operator,
    Tool,
    Viewer,
    Daemon,
}

#[derive(clap::Args, Debug)]
pub struct ShowArgs {
    /// Identity files, or directories of them.
    #[arg(required = true)]
    paths: Vec<PathBuf>,
    /// Instance name, for the keys.
    #[arg(long, default_value = "default")]
    instance: String,
}

#[derive(clap::Args, Debug)]
pub struct RulesArgs {
    /// Scene file, or builtin:NAME: its tools have roles.
    scene: PathBuf,
    /// Instance name.
    #[arg(long, default_value = "default")]
    instance: String,
}

pub fn run(args: &Args) -> anyhow::Result<Outcome> {
    match args {
        Args::Init(args) => init(args),
        Args::Issue(args) => issue(args),
        Args::Show(args) => show(args),
        Args::Rules(args) => {
            let loaded = scenes::load(&args.scene)?;
            let tools = loaded.spec.tools.iter().map(|tool| tool.id.as_str());
            let rules = rules(&args.instance, tools, false)?;
            println!("{:#}", serde_json::json!({ "access_control": rules }));
            Ok(Outcome::Ok)
        }
    }
}

fn who(text: &str) -> Result<String, String> {
    palpate_proto::keys::check_id(text)
        .map(str::to_owned)
        .map_err(|e| e.to_string())
}

impl Hosts {
    /// With those of the machine itself.
    fn all(&self) -> Vec<String> {
        let own = ["localhost", "127.0.0.1", "::1"].map(str::to_owned);
        own.into_iter().chain(self.host.iter().cloned()).collect()
    }
}

fn init(args: &InitArgs) -> anyhow::Result<Outcome> {
    let authority = Authority::create(&args.directory)?;
    let request = |role: Role, hosts| Request {
        role,
        name: None,
        hosts,
        valid: args.valid,
    };
    let daemon = authority.issue(&request(Role::Daemon, args.hosts.all()), None)?;
    let operator = authority.issue(&request(Role::Operator, Vec::new()), None)?;
    let directory = args.directory.display();
    println!("authority  {directory}/ca.pem; {directory}/ca.key can make any role: keep it safe");
    println!(
        "daemon     palpate serve SCENE --listen tls/0.0.0.0:7447 --identity {}",
        daemon.display()
    );
    println!(
        "operator   palpate ls --connect tls/HOST:7447 --identity {}",
        operator.display()
    );
    println!("others     palpate auth issue {directory} --role tool --tool ID, or --role viewer");
    Ok(Outcome::Ok)
}

fn issue(args: &IssueArgs) -> anyhow::Result<Outcome> {
    let role = match (args.role, &args.tool) {
        (Kind::Tool, Some(tool)) => Role::tool(tool)?,
        (Kind::Tool, None) => anyhow::bail!("--role tool: which? Name it with --tool ID"),
        (Kind::Operator, None) => Role::Operator,
        (Kind::Viewer, None) => Role::Viewer,
        (Kind::Daemon, None) => Role::Daemon,
        (_, Some(_)) => anyhow::bail!("--tool is for --role tool only"),
    };
    let hosts = match role {
        Role::Daemon => args.hosts.all(),
        _ if args.hosts.host.is_empty() => Vec::new(),
        _ => anyhow::bail!("--host is for --role daemon only: clients are not connected to"),
    };
    let request = Request {
        role,
        name: args.name.clone(),
        hosts,
        valid: args.valid,
    };
    let authority = Authority::open(&args.directory)?;
    println!(
        "{}",
        authority.issue(&request, args.out.as_deref())?.display()
    );
    Ok(Outcome::Ok)
}

fn show(args: &ShowArgs) -> anyhow::Result<Outcome> {
    let mut files = Vec::new();
    for path in &args.paths {
        if path.is_dir() {
            for entry in std::fs::read_dir(path)? {
                let path = entry?.path();
                files
                    .extend((path.extension().is_some_and(|kind| kind == "json5")).then_some(path));
            }
        } else {
            files.push(path.clone());
        }
    }
    files.sort();
    anyhow::ensure!(!files.is_empty(), "there are no identity files (.json5)");
    let mut outcome = Outcome::Ok;
    for file in &files {
        let identity = Identity::read(file)?;
        if !print(file, &identity, &args.instance)? {
            outcome = Outcome::Difference;
        }
    }
    Ok(outcome)
}

/// False when no one would let it in.
fn print(file: &Path, identity: &Identity, instance: &str) -> anyhow::Result<bool> {
    let now = OffsetDateTime::now_utc();
    let days = (identity.until - now).whole_hours() as f64 / 24.0;
    let valid = match identity.is_valid_at(now) {
        true => format!("valid for {days:.1} days, until {}", identity.until),
        false if identity.until < now => format!("EXPIRED on {}", identity.until),
        false => format!("NOT VALID before {}", identity.from),
    };
    let name = identity
        .name
        .as_ref()
        .map_or(String::new(), |name| format!(", of {name}"));
    println!(
        "{}: {}{name}, {valid}",
        file.display(),
        identity.common_name
    );
    if identity.readable_by_others {
        println!(
            "  WARNING: others on this machine can read it, and it is refused; chmod 600 {}",
            file.display()
        );
    }
    match &identity.role {
        None => println!("  no role: it may do nothing"),
        Some(Role::Daemon) => {
            println!("  serves, under the names {}", identity.hosts.join(", "));
        }
        Some(Role::Operator) => println!("  everything: commands, any tool"),
        Some(role) => {
            for line in grants(role, instance)?
                .iter()
                .filter_map(|grant| grant.said())
            {
                println!("  {line}");
            }
            println!("  nothing else: no command, no other tool");
        }
    }
    Ok(identity.role.is_some() && identity.is_valid_at(now))
}

//! This program, for processes of their own.

use std::process::Command;

/// A command that runs `palpate`, whose arguments follow. In Python's wheel the program is a module.
///
/// # Errors
/// The system does not say where this program is.
pub fn command() -> std::io::Result<Command> {
    let path = std::env::current_exe()?;
    let name = path.file_name().unwrap_or_default().to_string_lossy();
    let in_python = name.starts_with("python");
    let mut command = Command::new(&path);
    if in_python {
        command.args(["-m", "palpate"]);
    }
    Ok(command)
}

//! Writes the modules of clients in other languages from the table in `proto/src/messages.rs`, and
//! the Rust types of recordings from the files in `proto/proto`:
//! `cargo run -p palpate-proto --example generate`.

#[path = "files.rs"]
mod files;

fn main() -> std::io::Result<()> {
    let root = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
    for (path, contents) in files::all() {
        let path = root.join(path);
        if std::fs::read(&path).ok().as_ref() != Some(&contents) {
            println!("{}", path.display());
            std::fs::write(path, contents)?;
        }
    }
    Ok(())
}

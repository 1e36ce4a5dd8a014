//! Writes the modules of clients in other languages from the table in `proto/src/messages.rs`:
//! `cargo run -p palpate-proto --example generate`.

#[path = "files.rs"]
mod files;

fn main() -> std::io::Result<()> {
    let root = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
    for (path, text) in files::all() {
        let path = root.join(path);
        if std::fs::read_to_string(&path).ok().as_ref() != Some(&text) {
            println!("{}", path.display());
            std::fs::write(path, text)?;
        }
    }
    Ok(())
}

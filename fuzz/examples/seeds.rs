//! Writes what each target starts from into `corpus/TARGET/`.

#[path = "../parsers.rs"]
#[allow(dead_code)]
mod parsers;

fn main() -> std::io::Result<()> {
    for target in parsers::TARGETS {
        let directory = std::path::Path::new(env!("CARGO_MANIFEST_DIR"))
            .join("corpus")
            .join(target.name);
        std::fs::create_dir_all(&directory)?;
        for (k, seed) in (target.seeds)().iter().enumerate() {
            std::fs::write(directory.join(format!("seed-{k}")), seed)?;
        }
    }
    Ok(())
}

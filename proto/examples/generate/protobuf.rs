//! Rust types and descriptors of the Protobuf messages of recordings, from the files in
//! `proto/proto`. Needs no `protoc`.

use prost::Message as _;
use prost_build::Module;
use prost_types::FileDescriptorProto;
use std::path::Path;

const OURS: [&str; 2] = ["palpate/v1/inputs.proto", "palpate/v1/recording.proto"];

/// Types of our messages, types of the Foxglove messages, and a `FileDescriptorSet` of both.
pub fn files() -> [Vec<u8>; 3] {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("proto");
    let mut paths: Vec<String> = OURS.map(str::to_owned).into();
    paths.extend(published(&root.join("foxglove")));
    let mut set = protox::compile(&paths, [&root]).expect("the messages are well formed");
    // Comments of our own messages say what their packed numbers are; the published ones are known.
    let is_foreign = |file: &&mut FileDescriptorProto| !OURS.contains(&file.name());
    let foreign = set.file.iter_mut().filter(is_foreign);
    let sources: Vec<_> = foreign.map(|file| file.source_code_info.take()).collect();
    let descriptors = set.encode_to_vec();
    // Doc comments are made of them.
    let foreign = set.file.iter_mut().filter(is_foreign);
    std::iter::zip(foreign, sources).for_each(|(file, source)| file.source_code_info = source);
    let requests = set.file.into_iter().map(|file| {
        let module = Module::from_protobuf_package_name(file.package());
        (module, file)
    });
    let modules = prost_build::Config::new().generate(requests.collect());
    let mut modules = modules.expect("the messages have Rust types");
    let mut types = |package: &str| {
        let module = Module::from_protobuf_package_name(package);
        let text = modules.remove(&module).expect("a package of ours");
        text.into_bytes()
    };
    [types("palpate.v1"), types("foxglove"), descriptors]
}

/// The Foxglove messages that recordings use, as paths below the root, sorted.
fn published(directory: &Path) -> Vec<String> {
    let entries = std::fs::read_dir(directory).expect("the messages are there");
    let name = |entry: std::io::Result<std::fs::DirEntry>| {
        let name = entry.expect("a file").file_name();
        format!("foxglove/{}", name.to_string_lossy())
    };
    let mut files: Vec<String> = entries.map(name).collect();
    files.sort();
    files
}

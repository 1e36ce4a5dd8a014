//! Programs in the READMEs of the clients in C and Python, executed as they stand.

use crate::documents::{Block, blocks, root};
use std::fmt::Write as _;
use std::process::Command;

fn of(document: &str, language: &str) -> Vec<Block> {
    let mut found = blocks();
    found.retain(|block| block.place.starts_with(document) && block.language == language);
    assert!(!found.is_empty(), "{document} has no {language}");
    found
}

/// The golden bytes of a message as a C array.
fn array(name: &str, golden: &str) -> String {
    let bytes = std::fs::read(root().join("proto/golden").join(golden)).unwrap();
    let mut text = format!("static const uint8_t {name}[] = {{");
    for byte in &bytes {
        let _ = write!(text, "{byte},");
    }
    text + "};\n"
}

// Each block is a function after what stands in the block before it; what a block takes for granted is
// golden bytes, and each says what it did.
#[test]
fn the_blocks_of_the_c_client_compile_and_run() {
    let mut program = array("payload", "tool_force.bin");
    program += &array("contacts", "contact_set.bin");
    program += "#include <stdio.h>\nstatic const size_t payload_size = sizeof payload;\n";
    let mut main = String::new();
    for (k, block) in of("clients/c/README.md", "c").iter().enumerate() {
        let (includes, body): (Vec<&str>, Vec<&str>) = block
            .code
            .lines()
            .partition(|line| line.starts_with("#include"));
        program = format!("#include <stdint.h>\n{}\n{program}", includes.join("\n"));
        let (before, after) = match block.kind.as_str() {
            "list" => (
                "palpate_contact_set set; palpate_contact contact; if (palpate_contact_set_decode(&set, contacts, sizeof contacts) != PALPATE_OK) return 1;",
                "if (items.next != items.end || contact.depth <= 0.0) return 1; printf(\"contacts read\\n\"); return 0;",
            ),
            "watchdog" => (
                "uint64_t now_ns = 1000000000u;",
                "if (share != 1.0 || silence_ns != 0 || palpate_watchdog_gain(&dog, now_ns + 60000000u) != 0.0) return 1; return 0;",
            ),
            _ => (
                "",
                "if (size == 0 || force.tick == 0) return 1; printf(\"%u bytes on %s\\n\", (unsigned)size, key); return 0;",
            ),
        };
        let _ = writeln!(
            program,
            "static int block_{k}(void) {{ {before}\n{}\n{after} }}",
            body.join("\n")
        );
        let _ = writeln!(main, "if (block_{k}()) return {};", k + 1);
    }
    let _ = writeln!(program, "int main(void) {{ {main} return 0; }}");
    let directory = tempfile::tempdir().unwrap();
    let (source, executable) = (
        directory.path().join("readme.c"),
        directory.path().join("readme"),
    );
    std::fs::write(&source, &program).unwrap();
    let compiled = Command::new("cc")
        .args(["-std=c99", "-Wall", "-I"])
        .arg(root().join("clients/c"))
        .arg("-o")
        .args([&executable, &source])
        .output();
    let Ok(compiled) = compiled else {
        println!("skipped: no cc");
        return;
    };
    assert!(
        compiled.status.success(),
        "{}",
        String::from_utf8_lossy(&compiled.stderr)
    );
    let ran = Command::new(&executable).output().unwrap();
    let said = String::from_utf8_lossy(&ran.stdout);
    assert!(ran.status.success(), "{said}{:?}", ran.status);
    assert!(
        said.contains("bytes on palpate/default/tool/ball/pose"),
        "{said}"
    );
}

// Pure Python: the package beside its README, without the compiled part.
#[test]
fn the_messages_of_the_python_readme_run_without_the_wheel() {
    let found = of("clients/python/README.md", "python");
    let block = found.iter().find(|block| block.kind == "messages").unwrap();
    let golden = root().join("proto/golden/tool_force.bin");
    let program = format!(
        "other_payload = open({:?}, 'rb').read()\n{}\nassert force.tick >= 0 and len(payload) > 50\nprint(force)",
        golden.display().to_string(),
        block.code
    );
    let ran = Command::new("python3")
        .args(["-c", &program])
        .env("PYTHONPATH", root().join("clients/python"))
        .env("PYTHONDONTWRITEBYTECODE", "1")
        .output();
    let Ok(ran) = ran else {
        println!("skipped: no python3");
        return;
    };
    assert!(
        ran.status.success(),
        "{}",
        String::from_utf8_lossy(&ran.stderr)
    );
}

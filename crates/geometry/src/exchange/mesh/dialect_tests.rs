//! The same cube in the dialects that other programs write and read.

use super::*;
use crate::math::Random;
use crate::surface::file::Unit;
use crate::surface::{Shell, builtin};

/// A tetrahedron.
fn body() -> Mesh {
    let at = |x: f64, y: f64, z: f64| Point3::new(x, y, z);
    let points = vec![
        at(0.0, 0.0, 0.0),
        at(1.0, 0.0, 0.0),
        at(0.0, 1.5, 0.0),
        at(0.0, 0.0, 2.0),
    ];
    Mesh::from_triangles(points, vec![[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]]).unwrap()
}

fn wide(text: &str) -> Vec<u8> {
    [0xff, 0xfe]
        .into_iter()
        .chain(text.encode_utf16().flat_map(u16::to_le_bytes))
        .collect()
}

#[test]
fn stl_text_is_read_in_every_hand() {
    let plain = write_stl_ascii(&body(), Unit::Metre).unwrap();
    let wanted = read_stl(plain.as_bytes(), Unit::Metre).unwrap();
    let one_line_a_facet = plain
        .replace("\n outer", " outer")
        .replace("\n  vertex", " vertex")
        .replace("\n end", " end")
        .replace("\nend", " end")
        .replace(" endsolid", "\nendsolid");
    let (first, second) = plain.split_at(plain.match_indices("facet normal").nth(2).unwrap().0);
    for text in [
        plain.to_uppercase(),
        format!("\u{feff}{plain}"),
        format!("\u{feff}\r\n {}", plain.to_uppercase()),
        plain.replace('\n', "\r\n"),
        plain.replace('\n', "\r"),
        plain.replace(' ', "\t"),
        plain.replace("endsolid surface", "end solid"),
        plain.replace("endsolid surface", "ENDSOLID"),
        plain
            .replace("endloop", "end loop")
            .replace("endfacet", "End Facet"),
        plain.replace("solid surface", "solid"),
        plain.replace("solid surface", "solid facet of an outer loop, endsolid"),
        format!("{first}endsolid a\n\nsolid b\n{second}"),
        format!("{plain}\u{1a}"),
        format!("{plain}\0\0\0\0"),
        one_line_a_facet,
    ] {
        assert_eq!(
            read_stl(text.as_bytes(), Unit::Metre).as_ref(),
            Ok(&wanted),
            "{text}"
        );
    }
    let six = plain
        .replacen(" endloop\nendfacet\n", "", 1)
        .replacen("facet normal", "", 2);
    let told = read_stl(six.as_bytes(), Unit::Metre)
        .unwrap_err()
        .to_string();
    assert!(told.contains("expected"), "{told}");
    let loop_of_six = plain
        .lines()
        .filter(|line| !line.contains("facet") && !line.contains("loop"));
    let loop_of_six = loop_of_six
        .collect::<Vec<_>>()
        .join("\n")
        .replace("endsolid", "endloop\nendsolid");
    let told = read_stl(loop_of_six.as_bytes(), Unit::Metre)
        .unwrap_err()
        .to_string();
    assert!(told.contains("three vertices before endloop"), "{told}");
}

#[test]
fn stl_is_known_by_its_bytes_and_not_by_its_first_word() {
    let binary = write_stl(&body(), Unit::Metre).unwrap();
    let wanted = read_stl(&binary, Unit::Metre).unwrap();
    let mut solid = binary.clone();
    solid[..5].copy_from_slice(b"solid");
    for filling in [&b""[..], b"\n", &[7; 49], &[0; 512]] {
        for file in [&binary, &solid] {
            let filled = [file, filling].concat();
            assert_eq!(
                read_stl(&filled, Unit::Metre).as_ref(),
                Ok(&wanted),
                "{} more",
                filling.len()
            );
        }
    }
    let told = |bytes: &[u8]| read_stl(bytes, Unit::Metre).unwrap_err().to_string();
    assert!(
        told(&[&binary[..], &[1; 50]].concat()).contains("4 triangles"),
        "another triangle would be lost"
    );
    let text = write_stl_ascii(&body(), Unit::Metre).unwrap();
    let other = text.replace("solid", "lump");
    assert_eq!(
        told(other.as_bytes()),
        "line 1: expected a line of an STL file, such as vertex or facet, found 2 words"
    );
    assert_eq!(
        told(&wide(&text)),
        "the file is text in UTF-16; save it as UTF-8 or ASCII"
    );
}

#[test]
fn obj_is_read_in_every_hand() {
    let plain = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3 4\n";
    let wanted = read_obj(plain.as_bytes(), Unit::Metre).unwrap();
    for text in [
        plain
            .replace(" 4\n", " 4 # side\n")
            .replace("v 0 0 0", "v 0 0 0# corner"),
        plain.replace("f 1 2", "f 1 \\\n 2\\\n"),
        plain.replace("f 1 2", "f 1 \\\r\n 2\\\r\n"),
        plain.replace("1 2 3 4", "1/1/1 2/2 3//3 4"),
        plain.replace("1 2 3 4", "-4 -3// -2/-1/-1 -1"),
        plain.replace("0 0 0\n", "0 0 0 0.5 0.25 1.0\n"),
        plain.replace('\n', "\r"),
        plain.replace(' ', "\t"),
        format!(
            "\u{feff}mtllib a b.mtl\no x\ng y#z\ns off\nusemtl m\nvt 0 0\nvn 0 0 1\n{plain}l 1 2\np 1\n"
        ),
        plain.replace("f ", "fo "),
    ] {
        let read = read_obj(text.as_bytes(), Unit::Metre);
        assert_eq!(read.as_ref(), Ok(&wanted), "{text}");
        assert_eq!(
            read_obj_points(text.as_bytes(), Unit::Metre).as_ref(),
            Ok(&wanted.points),
            "{text}"
        );
    }
    let told = |text: &str| {
        read_obj(text.as_bytes(), Unit::Metre)
            .unwrap_err()
            .to_string()
    };
    assert_eq!(
        told(
            &plain
                .replace("0 1 0", "0 3 0")
                .replace("1 2 3 4", "1 3 2 4")
        ),
        "face 1 at line 5: its 4 corners make edges that cross or turn back on each other"
    );
    assert_eq!(
        told(&plain.replace("1 2 3 4", "\\\n1 2 2 1")),
        "face 1 at line 5: its 4 corners enclose no area"
    );
    assert_eq!(
        told(&plain.replace("f 1 2 3 4", "surf 0 1 0 1 1 2 3 4")),
        "line 5: faces of this kind (`surf`) are not read; convert them to polygons"
    );
    assert!(read_obj(&wide(plain), Unit::Metre).is_err_and(|error| error == MeshFileError::Wide));
    let many = "v 0 0 0\\\n".to_owned() + &"\\\n".repeat(200_000);
    assert!(read_obj(many.as_bytes(), Unit::Metre).is_err());
}

#[test]
fn a_header_of_ply_may_end_its_lines_in_any_way() {
    let header = "ply\nformat binary_little_endian 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\n\
                  element face 1\nproperty list uchar int vertex_indices\nend_header\n";
    // The first byte of the first corner is a line feed.
    let corners = [
        [1e-44f32, 0.0, 0.0],
        [2.0, 0.0, 0.0],
        [0.5, 0.5, 0.0],
        [0.0, 2.0, 0.0],
    ];
    let numbers = corners.iter().flatten().flat_map(|x| x.to_le_bytes());
    let face = [2i32, 3, 0, 1].into_iter().flat_map(i32::to_le_bytes);
    let mut body: Vec<u8> = numbers.chain([4]).chain(face).collect();
    body[0] = b'\n';
    for end in ["\n", "\r\n", "\r"] {
        let file = [header.replace('\n', end).as_bytes(), &body].concat();
        let read = read_ply(&file, Unit::Metre).unwrap();
        assert_eq!(read.points.len(), 4, "{end:?}");
        assert_eq!(read.triangles.len(), 2, "{end:?}");
    }
    let at = body.len() - 16;
    body[at] = 0;
    body[at + 4] = 1;
    let told = read_ply(&[header.as_bytes(), &body].concat(), Unit::Metre).unwrap_err();
    assert!(
        matches!(
            told,
            MeshFileError::Polygon {
                face: 1,
                line: None,
                corners: 4,
                ..
            }
        ),
        "{told}"
    );
}

// A fan over each of these faces closes the notch.
#[test]
fn a_prism_keeps_its_notch() {
    let ell = "v 0 40 0\nv 0 0 0\nv 40 0 0\nv 40 20 0\nv 20 20 0\nv 20 40 0\nv 0 40 10\nv 0 0 10\nv 40 0 10\nv 40 20 10\nv 20 20 10\nv 20 40 10\n\
               f 7 8 9 10 11 12\nf 6 5 4 3 2 1\nf 1 2 8 7\nf 2 3 9 8\nf 3 4 10 9\nf 4 5 11 10\nf 5 6 12 11\nf 6 1 7 12\n";
    let census = Shell::of(&read_obj(ell.as_bytes(), Unit::Millimetre).unwrap())
        .unwrap()
        .census();
    assert!(census.is_closed());
    assert!((census.volume_m3 / 12e-6 - 1.0).abs() < 1e-12);
}

#[test]
fn random_words_are_refused_or_read() {
    const WORDS: [&[u8]; 32] = [
        b"solid",
        b"endsolid",
        b"end",
        b"facet",
        b"normal",
        b"outer",
        b"loop",
        b"endloop",
        b"vertex",
        b"v",
        b"f",
        b"l",
        b"1",
        b"2",
        b"3",
        b"-1",
        b"4/2",
        b"0.5",
        b"1e9",
        b"\\",
        b"#",
        b"\n",
        b"\n",
        b"\r",
        b"\t",
        b"\0",
        b"\xef\xbb\xbf",
        b"surf",
        b"ply",
        b"5",
        b"-0",
        b"\xff",
    ];
    let sheet = write_obj(
        &builtin("sheet", None, None)
            .unwrap()
            .tessellated([1; 2])
            .unwrap(),
        Unit::Metre,
    )
    .unwrap();
    let mut random = Random(406);
    for k in 0..20_000 {
        let mut file = if k % 2 == 0 {
            Vec::new()
        } else {
            sheet.as_bytes()[..sheet.find("vn").unwrap()].to_vec()
        };
        for _ in 0..random.integer(1, 60) {
            file.extend_from_slice(WORDS[random.below(WORDS.len())]);
            file.push(b" \n"[random.below(2)]);
        }
        let _ = read_stl(&file, Unit::Metre);
        let _ = read_obj(&file, Unit::Metre);
        let _ = read_text_points(&file, Unit::Metre);
    }
}

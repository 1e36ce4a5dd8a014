use super::*;
use crate::exchange::SplineError;
use crate::exchange::testing::{difference, every_prefix, mutations, small, surfaces};
use crate::surface::builtin;
use crate::surface::file::Unit;

fn read_text(text: &str) -> Result<Imported, IgesError> {
    read(text.as_bytes(), Pick::First)
}

#[test]
fn a_written_surface_is_read_back_bit_for_bit() {
    for (name, surface) in surfaces() {
        let text = write(&surface, Unit::Metre).unwrap();
        assert!(
            text.lines().all(|line| line.len() == 80),
            "{name}: lines have 80 columns"
        );
        let read = read_text(&text).unwrap();
        assert_eq!(read.surface, surface, "{name}");
        assert_eq!((read.count, read.id, read.unit.name()), (1, 1, "m"));
        let millimetres = read_text(&write(&surface, Unit::Millimetre).unwrap()).unwrap();
        assert_eq!(millimetres.unit.name(), "mm");
        assert!(difference(&millimetres.surface, &surface) < 1e-14, "{name}");
    }
}

#[test]
fn random_surfaces_are_read_back_bit_for_bit_or_refused_for_their_gap() {
    for surface in crate::surface::testing::fifty_surfaces(62) {
        match write(&surface, Unit::Metre) {
            Ok(text) => {
                let again = read_text(&text).unwrap().surface;
                assert_eq!(
                    (again.net(), again.weights()),
                    (surface.net(), surface.weights())
                );
                assert_eq!(
                    (again.knots_u(), again.knots_v()),
                    (surface.knots_u(), surface.knots_v())
                );
            }
            Err(error) => assert!(matches!(error, SplineError::Disjoined { .. }), "{error}"),
        }
    }
}

/// A file of entities `(kind, matrix, parameters)`, by hand.
pub(super) fn file(global: &str, entities: &[(u32, u32, &str)]) -> String {
    let mut out = format!("{:<72}S{:>7}\n", "", 1);
    out += &format!("{global:<72}G{:>7}\n", 1);
    let (mut directory, mut parameters) = (String::new(), String::new());
    let mut line = 0;
    for (k, (kind, matrix, text)) in entities.iter().enumerate() {
        let pieces: Vec<&str> = text
            .as_bytes()
            .chunks(64)
            .map(|c| std::str::from_utf8(c).unwrap())
            .collect();
        let (first, id) = (line + 1, 2 * k + 1);
        directory += &format!(
            "{kind:>8}{first:>8}{:>32}{matrix:>8}{:>16}D{id:>7}\n",
            "", ""
        );
        directory += &format!(
            "{kind:>8}{:>16}{:>8}{:>40}D{:>7}\n",
            "",
            pieces.len(),
            "",
            id + 1
        );
        for piece in pieces {
            line += 1;
            parameters += &format!("{piece:<64}{id:>8}P{line:>7}\n");
        }
    }
    out + &directory
        + &parameters
        + &format!(
            "S{:>7}G{:>7}D{:>7}P{line:>7}{:>40}T{:>7}\n",
            1,
            1,
            2 * entities.len(),
            "",
            1
        )
}

pub(super) const GLOBAL: &str = "1H,,1H;,,,,,,,,,,,1.0,6,1HM;";
// z = 7 over the unit square, u along x.
pub(super) const SHEET: &str = "128,1,1,1,1,0,0,1,0,0,0.,0.,1.,1.,0.,0.,1.,1.,1.,1.,1.,1.,0.,0.,7.,1.,0.,7.,0.,1.,7.,1.,1.,7.,0.,1.,0.,1.;";

#[test]
fn the_file_runs_through_u_first() {
    let read = read_text(&file(GLOBAL, &[(128, 0, SHEET)])).unwrap();
    let corner = read.surface.point(1.0, 0.0);
    assert_eq!((corner.x, corner.y, corner.z), (1.0, 0.0, 7.0));
    assert_eq!(read.surface.weights(), None, "polynomial");
}

// Ranges with nine digits, of knots with seventeen.
#[test]
fn a_range_may_be_rounded_and_not_cut() {
    let pi = std::f64::consts::PI;
    let knots = SHEET.replace(
        "0.,0.,1.,1.,0.,0.,1.,1.,1.",
        &format!("0.,0.,{pi},{pi},0.,0.,1.,1.,1."),
    );
    let to = |end: &str| {
        let text = knots.replace(
            "1.,1.,7.,0.,1.,0.,1.;",
            &format!("1.,1.,7.,0.,{end},0.,1.;"),
        );
        read_text(&file(GLOBAL, &[(128, 0, &text)])).map(|read| read.surface.knots_u().domain())
    };
    assert_eq!(to("3.14159265").unwrap(), (0.0, pi));
    for cut in ["3.141592", "3.1415926"] {
        assert!(matches!(to(cut), Err(IgesError::Cut { .. })), "{cut}");
    }
}

#[test]
fn units_scales_defaults_and_other_delimiters_are_read() {
    let side = |global: &str, sheet: &str| {
        let read =
            read_text(&file(global, &[(128, 0, sheet)])).map_err(|error| error.to_string())?;
        Ok::<_, String>((read.surface.net().at(1, 0).x, read.unit.name().to_owned()))
    };
    let named = |x: f64, unit: &str| Ok((x, unit.to_owned()));
    assert_eq!(side(GLOBAL, SHEET), named(1.0, "m"));
    assert_eq!(side(",,,,,,,,,,,,,;", SHEET), named(0.0254, "inch"));
    assert_eq!(
        side(",,9Hwith,;,it,,,,,,,,,,1.,2,2HMM;", SHEET),
        named(0.001, "mm")
    );
    assert_eq!(side(",,,,,,,,,,,,2.,10,2HCM;", SHEET), named(0.005, "cm"));
    assert_eq!(side(",,,,,,,,,,,,1.D0,3,2HFT;", SHEET), named(0.3048, "ft"));
    let slashes = SHEET.replace(',', "/").replace(';', "#");
    assert_eq!(
        side("1H//1H#///////////1.0/6/1HM#", &slashes),
        named(1.0, "m")
    );
    assert_eq!(
        side(",,,,,,,,,,,,1.,12;", SHEET).unwrap_err(),
        "global parameter 14 (the unit's flag, 1 to 11) is \"12\""
    );
    assert_eq!(
        side(",,,,,,,,,,,,0.,2;", SHEET).unwrap_err(),
        "global parameter 13 (the model's scale, a number above 0) is \"0.\""
    );
    assert!(
        side("2H,,;", SHEET)
            .unwrap_err()
            .starts_with("global parameter 1 (a delimiter")
    );
    assert!(
        side(",,99999999999999999999H;", SHEET)
            .unwrap_err()
            .contains("a string is longer")
    );
}

#[test]
fn matrices_place_the_surface_in_turn() {
    // A quarter turn about z and a shift along x; then a shift along z.
    let turn = "124,0.,-1.,0.,10.,1.,0.,0.,0.,0.,0.,1.,0.;";
    let shift = "124,1.,0.,0.,0.,0.,1.,0.,0.,0.,0.,1.,5.;";
    let read = read_text(&file(
        GLOBAL,
        &[(128, 3, SHEET), (124, 5, turn), (124, 0, shift)],
    ))
    .unwrap();
    let p = read.surface.point(1.0, 0.0);
    assert_eq!((p.x, p.y, p.z), (10.0, 1.0, 12.0));
    let message =
        |entities: &[(u32, u32, &str)]| read_text(&file(GLOBAL, entities)).unwrap_err().to_string();
    assert_eq!(
        message(&[(128, 3, SHEET), (124, 3, turn)]),
        "the transformation matrices of directory entry 1 refer to each other without end"
    );
    assert_eq!(
        message(&[(128, 7, SHEET)]),
        "directory entry 1 refers to 7 as its transformation matrix, which is not an entity 124"
    );
    assert_eq!(
        message(&[(128, 1, SHEET)]),
        "directory entry 1 refers to 1 as its transformation matrix, which is not an entity 124"
    );
    assert_eq!(
        message(&[(128, 3, SHEET), (124, 0, "124,1.,0.;")]),
        "entity 124 at directory entry 3 has 2 parameters; it needs 12"
    );
}

#[test]
fn broken_surfaces_are_refused_with_what_and_where() {
    let message = |from: &str, to: &str| {
        assert!(SHEET.contains(from), "{from}");
        read_text(&file(
            GLOBAL,
            &[
                (116, 0, "116,0.,0.,0.;"),
                (128, 0, &SHEET.replacen(from, to, 1)),
            ],
        ))
        .unwrap_err()
        .to_string()
    };
    let at = "entity 128 at directory entry 3";
    let cases = [
        (
            "128,1,1,",
            "128,4,1,",
            format!("{at} has 37 parameters; it needs 64"),
        ),
        (
            "128,1,1,",
            "128,1099511627775,1099511627775,",
            format!("{at} has 37 parameters; it needs 18446744073709551615"),
        ),
        (
            "128,1,1,",
            "128,x,1,",
            format!(
                "{at}: parameter 1 (upper index of the first sum) should be a whole number, but is \"x\""
            ),
        ),
        (
            "128,1,1,1,",
            "128,1,1,16,",
            format!("{at}: parameter 3 (degree in u) should be at most 15, but is \"16\""),
        ),
        (
            "128,1,1,1,",
            "128,1,1,0,",
            format!("{at}: knots in u: degree 0 is outside 1..=15"),
        ),
        (
            "0.,0.,1.,1.,",
            "0.,0.,1.,nan,",
            format!("{at}: parameter 13 (knot in u) should be a finite number, but is \"nan\""),
        ),
        (
            "0.,0.,1.,1.,",
            "0.,2.,1.,1.,",
            format!("{at}: knots in u: knot 2 (1) is smaller than the one before it (2)"),
        ),
        (
            "0.,1.,7.",
            "0.,1D999,7.",
            format!("{at}: parameter 29 (coordinate) should be a finite number, but is \"1D999\""),
        ),
        (
            "0.,1.,0.,1.;",
            "0.,.5,0.,1.;",
            format!("{at} is cut to u = 0 ..= 0.5, its knots go from 0 to 1"),
        ),
        (
            ";",
            "",
            "the file is cut short: a list of parameters has no end".to_owned(),
        ),
    ];
    for (from, to, wanted) in cases {
        assert_eq!(message(from, to), wanted, "{from} → {to}");
    }
    let none = read_text(&file(GLOBAL, &[(116, 0, "116,0.,0.,0.;")]))
        .unwrap_err()
        .to_string();
    assert_eq!(
        none,
        "no B-spline surface (entity 128) among the file's 1 entities; convert its surfaces to B-splines"
    );
}

#[test]
fn surfaces_are_picked_by_place_or_directory_entry() {
    let text = file(
        GLOBAL,
        &[
            (128, 0, SHEET),
            (116, 0, "116,0.,0.,0.;"),
            (128, 0, &SHEET.replace("7.", "8.")),
        ],
    );
    let pick = |pick| read(text.as_bytes(), pick);
    assert_eq!(super::surfaces(text.as_bytes()).unwrap(), [1, 5]);
    assert_eq!(pick(Pick::First).unwrap().surface.net().at(0, 0).z, 7.0);
    assert_eq!(pick(Pick::Index(1)).unwrap(), pick(Pick::Id(5)).unwrap());
    assert_eq!(pick(Pick::Id(5)).unwrap().surface.net().at(0, 0).z, 8.0);
    assert_eq!(
        pick(Pick::Id(3)).unwrap_err().to_string(),
        "no B-spline surface #3; the file has 2 of them"
    );
}

#[test]
fn lines_out_of_place_are_named() {
    let text = file(GLOBAL, &[(128, 0, SHEET)]);
    let message = |text: &str| read_text(text).unwrap_err().to_string();
    assert!(message("solid x\n").contains("its first line has no S in column 73"));
    assert!(message(&format!("{:<72}C      1\n", "")).contains("compressed form"));
    let mut lines: Vec<&str> = text.lines().collect();
    lines.swap(1, 3);
    assert!(
        message(&lines.join("\n"))
            .starts_with("line 4: expected a letter of S, G, D, P, T in column 73, in that order")
    );
    let mut lines: Vec<&str> = text.lines().collect();
    lines.remove(5);
    assert!(message(&lines.join("\n")).contains("not as many lines"));
}

#[test]
fn files_cut_short_or_changed_are_refused_or_read_but_never_more() {
    for rational in [false, true] {
        let text = write(&small(rational), Unit::Metre).unwrap();
        let whole = text.trim_end().len() - 7;
        every_prefix(text.as_bytes(), whole, |bytes| {
            read(bytes, Pick::First).is_ok()
        });
        mutations(text.as_bytes(), 9, |bytes| drop(read(bytes, Pick::First)));
    }
    let sheet = builtin("sheet", None, None).unwrap().with_flip_normal(true);
    assert_eq!(
        read_text(&write(&sheet, Unit::Metre).unwrap())
            .unwrap()
            .surface,
        sheet.swap_uv()
    );
}

// The same face whole, without a corner and with a hole, written by OpenCASCADE.
#[test]
fn a_trimmed_face_is_noticed_and_a_whole_one_is_not() {
    let path = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/opencascade");
    let read = |name: &str| read(&std::fs::read(path.join(name)).unwrap(), Pick::First).unwrap();
    for (name, trimmed) in [
        ("whole_face.igs", false),
        ("corner_cut.igs", true),
        ("holed.igs", true),
    ] {
        let left_out = read(name).left_out;
        assert_eq!(
            (left_out.faces, left_out.trimmed),
            (1, trimmed),
            "{name}: {left_out}"
        );
        assert_eq!(left_out.other_faces, 0, "{name}");
    }
}

#[test]
fn damaged_trims_are_read_or_refused() {
    let path = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/opencascade");
    let whole = std::fs::read(path.join("holed.igs")).unwrap();
    // Every fourth line, so that it ends in time: pointers, counts and knots are everywhere.
    for (k, line) in whole.chunks(81).enumerate().filter(|(k, _)| k % 4 == 0) {
        for (at, byte) in [(3, b'9'), (9, b','), (20, b'-')] {
            let mut changed = whole.clone();
            if at < line.len() {
                changed[81 * k + at] = byte;
            }
            let _ = read(&changed, Pick::First);
        }
    }
}

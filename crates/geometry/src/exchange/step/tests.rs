use super::*;
use crate::exchange::testing::{difference, every_prefix, mutations, small, surfaces};
use crate::surface::file::Unit;
use crate::surface::{Closing, builtin};

fn read_text(text: &str) -> Result<Imported, StepError> {
    read(text.as_bytes(), Pick::First)
}

#[test]
fn a_written_surface_is_read_back_bit_for_bit() {
    for (name, surface) in surfaces() {
        let read = read_text(&write(&surface, Unit::Metre).unwrap()).unwrap();
        assert_eq!(read.surface, surface, "{name}");
        assert_eq!((read.count, read.unit.name()), (1, "m"));
        let millimetres = read_text(&write(&surface, Unit::Millimetre).unwrap()).unwrap();
        assert_eq!(millimetres.unit.name(), "mm");
        for (a, b) in millimetres
            .surface
            .net()
            .points()
            .iter()
            .zip(surface.net().points())
        {
            assert!(
                (a - b).norm() <= 4e-16 * b.coords.norm(),
                "{name}: {a} is not {b}"
            );
        }
        assert!(difference(&millimetres.surface, &surface) < 1e-14, "{name}");
    }
}

#[test]
fn random_surfaces_are_read_back_bit_for_bit_or_refused_for_their_gap() {
    let mut refused = 0;
    for surface in crate::surface::testing::fifty_surfaces(61) {
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
            Err(SplineError::Disjoined { .. }) => refused += 1,
            Err(other) => panic!("{other}"),
        }
    }
    assert!((1..30).contains(&refused), "{refused} of 50 come apart");
}

#[test]
fn an_open_surface_keeps_its_outward_side() {
    let sheet = builtin("sheet", None, None).unwrap().with_flip_normal(true);
    let read = read_text(&write(&sheet, Unit::Metre).unwrap())
        .unwrap()
        .surface;
    assert_eq!(read, sheet.swap_uv());
    assert!((read.normal(0.4, 0.3) - sheet.normal(0.3, 0.4)).norm() < 1e-15);
}

// The form that OpenCASCADE reads and writes for periodic surfaces.
#[test]
fn one_period_with_unrepeated_points_is_periodic() {
    let torus = builtin("torus", Some([5, 4]), None).unwrap();
    let points: Vec<String> = torus
        .net()
        .points()
        .iter()
        .enumerate()
        .map(|(k, p)| {
            format!(
                "#{}=CARTESIAN_POINT('',({:?},{:?},{:?}));",
                10 + k,
                p.x,
                p.y,
                p.z
            )
        })
        .collect();
    let rows: Vec<String> = (0..5)
        .map(|i| {
            format!(
                "(#{},#{},#{},#{})",
                10 + 4 * i,
                11 + 4 * i,
                12 + 4 * i,
                13 + 4 * i
            )
        })
        .collect();
    let body = format!(
        "#1=B_SPLINE_SURFACE_WITH_KNOTS('',3,3,({}),.UNSPECIFIED.,.T.,.T.,.F.,(1,1,1,1,1,1),(1,1,1,1,1),(0.,0.2,0.4,0.6000000000000001,0.8,1.),(0.,0.25,0.5,0.75,1.),.UNSPECIFIED.);{}",
        rows.join(","),
        points.join("\n")
    );
    let read = read_text(&file(&body)).unwrap();
    assert_eq!(
        read.unit.to_string(),
        "mm (assumed: the file names no unit)"
    );
    let scaled = read.surface.scaled(1000.0);
    assert_eq!(scaled.topology().closing, [Closing::Periodic; 2]);
    assert!(difference(&scaled, &torus) < 1e-15);
    // Four points are one too few for a periodic vector of degree 4, but not for the surface.
    let raised = read_text(&file(&body.replace("'',3,3", "'',3,4")))
        .unwrap()
        .surface;
    assert_eq!(
        raised.topology().closing,
        [Closing::Periodic, Closing::Touching]
    );
    assert!((raised.point(0.3, 0.0) - raised.point(0.3, 1.0)).norm() < 1e-18);
}

fn file(data: &str) -> String {
    format!("ISO-10303-21;\nHEADER;\nENDSEC;\nDATA;\n{data}\nENDSEC;\nEND-ISO-10303-21;\n")
}

const POINTS: &str = "#1=CARTESIAN_POINT('',(0.,0.,0.));\n#2=CARTESIAN_POINT('',(0.,1.,0.));\n\
                      #3=CARTESIAN_POINT('',(1.,0.,0.));\n#4=CARTESIAN_POINT('',(1.,1.,0.));\n";
const PLAIN: &str = "#5=B_SPLINE_SURFACE_WITH_KNOTS('',1,1,((#1,#2),(#3,#4)),.UNSPECIFIED.,.F.,.F.,.F.,(2,2),(2,2),\
                     (0.,1.),(0.,1.),.UNSPECIFIED.);\n";

#[test]
fn surfaces_without_knots_have_those_of_their_form() {
    let knots = |form: &str| {
        let data =
            format!("{POINTS}#5={form}('',1,1,((#1,#2,#1),(#3,#4,#3)),.UNSPECIFIED.,.F.,.F.,.F.);");
        read_text(&file(&data)).map(|read| read.surface.knots_v().knots().to_vec())
    };
    assert_eq!(
        knots("QUASI_UNIFORM_SURFACE").unwrap(),
        [0.0, 0.0, 1.0, 2.0, 2.0]
    );
    assert_eq!(
        knots("UNIFORM_SURFACE").unwrap(),
        [0.0, 1.0, 2.0, 0.0].map(|k| k - 1.0)[..3]
            .iter()
            .chain(&[2.0, 3.0])
            .copied()
            .collect::<Vec<_>>()
    );
    assert!(
        knots("BEZIER_SURFACE")
            .unwrap_err()
            .to_string()
            .contains("4 knots in v, but degree 1 with 3 control points needs 5")
    );
    let rational = format!(
        "{POINTS}#5=(BEZIER_SURFACE()BOUNDED_SURFACE()B_SPLINE_SURFACE(1,1,((#1,#2),(#3,#4)),.UNSPECIFIED.,.F.,.F.,.F.)\
         RATIONAL_B_SPLINE_SURFACE(((1.,2.),(3.,4.)))SURFACE());"
    );
    let surface = read_text(&file(&rational)).unwrap().surface;
    assert_eq!(
        (surface.weights().unwrap(), surface.knots_u().knots()),
        (&[1.0, 2.0, 3.0, 4.0][..], &[0.0, 0.0, 1.0, 1.0][..])
    );
}

#[test]
fn coordinates_are_in_the_unit_of_the_context_above_the_surface() {
    let inch = "#20=(CONVERSION_BASED_UNIT('INCH',#21)LENGTH_UNIT()NAMED_UNIT(#24));#21=LENGTH_MEASURE_WITH_UNIT(\
                LENGTH_MEASURE(25.4),#22);#22=(LENGTH_UNIT()NAMED_UNIT(*)SI_UNIT(.MILLI.,.METRE.));#24=DIMENSIONAL_EXPONENTS(1.,0.,0.,0.,0.,0.,0.);\
                #23=(GEOMETRIC_REPRESENTATION_CONTEXT(3)GLOBAL_UNIT_ASSIGNED_CONTEXT((#20))REPRESENTATION_CONTEXT('',''));";
    let metre = "#30=(LENGTH_UNIT()NAMED_UNIT(*)SI_UNIT($,.METRE.));\
                 #31=(GEOMETRIC_REPRESENTATION_CONTEXT(3)GLOBAL_UNIT_ASSIGNED_CONTEXT((#30))REPRESENTATION_CONTEXT('',''));";
    let angle = "#40=(CONVERSION_BASED_UNIT('DEGREE',#41)NAMED_UNIT(*)PLANE_ANGLE_UNIT());\
                 #42=(GLOBAL_UNIT_ASSIGNED_CONTEXT((#40))REPRESENTATION_CONTEXT('',''));";
    let side = |more: &str| {
        let read = read_text(&file(&format!("{POINTS}{PLAIN}{more}"))).unwrap();
        (read.surface.net().at(1, 0).x, read.unit.to_string())
    };
    assert_eq!(side(inch), (0.0254, "inch".to_owned()));
    assert_eq!(side(metre), (1.0, "m".to_owned()));
    assert_eq!(side(angle).1, "mm (assumed: the file names no unit)");
    let users = "#50=SHAPE_REPRESENTATION('',(#51),#31);#51=FACE_SURFACE('',(),#5,.F.);#52=SHAPE_REPRESENTATION('',(),#23);";
    assert_eq!(
        side(&format!("{inch}{metre}{users}")),
        (1.0, "m".to_owned())
    );
    let other = users
        .replace("#31", "#99")
        .replace("#23", "#31")
        .replace("#99", "#23");
    assert_eq!(
        side(&format!("{inch}{metre}{other}")),
        (0.0254, "inch".to_owned())
    );
    let wrong = file(&format!("{POINTS}{PLAIN}{}", inch.replace("25.4", "-25.4")));
    assert_eq!(
        read_text(&wrong).unwrap_err().to_string(),
        "#20: the length unit is -0.0254 m; it should be above 0 and finite"
    );
}

#[test]
fn an_open_surface_follows_the_sense_of_its_face() {
    for (sense, flip) in [("T", false), ("F", true)] {
        let data = format!("{POINTS}{PLAIN}#7=ADVANCED_FACE('',(#8),#5,.{sense}.);");
        assert_eq!(read_text(&file(&data)).unwrap().surface.flip_normal(), flip);
    }
}

#[test]
fn surfaces_are_picked_by_place_or_number() {
    let data = file(&format!(
        "{POINTS}{PLAIN}{}",
        PLAIN.replace("#5=", "#9=").replace("(#1,#2)", "(#2,#2)")
    ));
    let pick = |pick| read(data.as_bytes(), pick);
    let first = pick(Pick::First).unwrap();
    assert_eq!(
        (first.id, first.count, surfaces_of(&data)),
        (5, 2, vec![5, 9])
    );
    assert_eq!(pick(Pick::Index(0)).unwrap(), first);
    assert_eq!(pick(Pick::Index(1)).unwrap(), pick(Pick::Id(9)).unwrap());
    assert_eq!(
        pick(Pick::Index(2)).unwrap_err().to_string(),
        "no B-spline surface at place 2 (from 0); the file has 2 of them: #5, #9"
    );
    assert_eq!(
        pick(Pick::Id(4)).unwrap_err().to_string(),
        "no B-spline surface #4; the file has 2 of them: #5, #9"
    );
}

fn surfaces_of(text: &str) -> Vec<u64> {
    super::surfaces(text.as_bytes()).unwrap()
}

#[test]
fn broken_surfaces_are_refused_with_what_and_where() {
    let message = |from: &str, to: &str| {
        let data = format!("{POINTS}{PLAIN}");
        assert!(data.contains(from), "{from}");
        read_text(&file(&data.replacen(from, to, 1)))
            .unwrap_err()
            .to_string()
    };
    let cases = [
        (
            "(2,2),(2,2)",
            "(2,3),(2,2)",
            "#5: 5 knots in u, but degree 1 with 2 control points needs 4",
        ),
        (
            "(2,2),(2,2)",
            "(2,99999999999999999),(2,2)",
            "#5: u_multiplicities should be a whole number, but is 100000000000000000",
        ),
        (
            "(2,2),(2,2)",
            "(2,999999999999999),(2,2)",
            "#5: 1000000000000001 knots in u, but degree 1 with 2 control points needs 4",
        ),
        (
            "(2,2),(2,2)",
            "(2,1,1),(2,2)",
            "#5: 2 knots but 3 multiplicities in u",
        ),
        (
            "(2,2),(2,2)",
            "(2,-2),(2,2)",
            "#5: u_multiplicities should be a whole number, but is -2",
        ),
        (
            "(0.,1.),.UN",
            "(1.,0.),.UN",
            "#5: knots in v: knot 2 (0) is smaller than the one before it (1)",
        ),
        (
            "'',1,1",
            "'',1000000000,1",
            "#5: knots in u: degree 1000000000 is outside 1..=15",
        ),
        (
            "'',1,1",
            "'',1.5,1",
            "#5: u_degree should be a whole number, but is 1.5",
        ),
        (
            "(#3,#4)",
            "(#3,#7)",
            "#5 refers to #7, which the file does not define",
        ),
        (
            "(#3,#4)",
            "(#3,#5)",
            "#5: CARTESIAN_POINT should be a point with three coordinates, but is a B_SPLINE_SURFACE_WITH_KNOTS",
        ),
        (
            "(#3,#4)",
            "(#3,4)",
            "#5: control_points_list should be references to CARTESIAN_POINTs, but is 4",
        ),
        (
            "(#3,#4)",
            "(#3)",
            "#5: row 1 of control_points_list should be as long as the first row, but is a list of 1",
        ),
        (
            "((#1,#2),(#3,#4))",
            "()",
            "#5: 4 knots in u, but degree 1 with 0 control points needs 2",
        ),
        (
            "(0.,1.,0.)",
            "(0.,1.)",
            "#2: CARTESIAN_POINT should be a point with three coordinates, but is a list of 2",
        ),
        (
            "(0.,1.,0.)",
            "(0.,1E999,0.)",
            "line 6: expected a finite number, such as 1.5E-3, found \"1E999,0.))\"",
        ),
        (
            ",.UNSPECIFIED.);",
            ");",
            "#5: B_SPLINE_SURFACE_WITH_KNOTS should be there with all its attributes, but is incomplete",
        ),
        (
            "#5=B_SPLINE_SURFACE_WITH_KNOTS",
            "#5=PLANE",
            "no B-spline surface among the file's 5 instances (there are PLANE: convert them to B-splines where the file comes from)",
        ),
        (
            "#5=B_",
            "#5=A_",
            "no B-spline surface among the file's 5 instances",
        ),
    ];
    for (from, to, wanted) in cases {
        assert_eq!(message(from, to), wanted, "{from} → {to}");
    }
}

#[test]
fn files_cut_short_or_changed_are_refused_or_read_but_never_more() {
    for rational in [false, true] {
        let text = write(&small(rational), Unit::Metre).unwrap();
        let whole = text.trim_end().len();
        every_prefix(text.as_bytes(), whole, |bytes| {
            read(bytes, Pick::First).is_ok()
        });
        mutations(text.as_bytes(), 7, |bytes| drop(read(bytes, Pick::First)));
    }
    assert!(matches!(read(b"", Pick::First), Err(StepError::NotStep)));
}

// A megabyte of references to one long point, of contexts of one long unit, of brackets: all within
// moments.
#[test]
fn work_grows_with_the_length_of_the_file_and_no_faster() {
    let long = "0.,".repeat(100_000);
    let references = vec!["#1"; 100_000].join(",");
    let data = format!(
        "#1=CARTESIAN_POINT('',({long}0.));#2=B_SPLINE_SURFACE_WITH_KNOTS('',1,1,(({references})),.U.,.F.,.F.,.F.,(2),(2),(0.),(0.),.U.);"
    );
    assert!(read_text(&file(&data)).is_err());
    let mut contexts = format!("{POINTS}{PLAIN}#6=(LENGTH_UNIT()SI_UNIT({long}.METRE.));");
    for k in 0..20_000 {
        contexts += &format!("#{}=(GLOBAL_UNIT_ASSIGNED_CONTEXT((#6,#6,#6)));", 100 + k);
    }
    assert!(read_text(&file(&contexts)).is_ok());
    assert!(read_text(&file(&format!("#1={}", "((((".repeat(200_000)))).is_err());
}

fn by_opencascade(name: &str) -> Vec<u8> {
    let path = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/opencascade");
    std::fs::read(path.join(name)).unwrap()
}

// An assembly, and one inside another, written by OpenCASCADE; where points are was computed there
// too, in mm.
#[test]
fn a_part_that_is_placed_once_is_read_where_the_assembly_puts_it() {
    let expected: serde_json::Value =
        serde_json::from_slice(&by_opencascade("placed.json")).unwrap();
    for name in ["placed_once", "placed_nested"] {
        let read = read(&by_opencascade(&format!("{name}.step")), Pick::First).unwrap();
        assert_eq!(read.left_out.placements, 0, "{name}");
        let surface = &read.surface;
        let domain = [surface.knots_u().domain(), surface.knots_v().domain()];
        let rows = expected[name].as_array().unwrap();
        assert_eq!(rows.len(), 6);
        for row in rows {
            let row: Vec<f64> = row
                .as_array()
                .unwrap()
                .iter()
                .map(|x| x.as_f64().unwrap())
                .collect();
            let at = |k: usize| domain[k].0 + row[k] * (domain[k].1 - domain[k].0);
            let point = surface.point(at(0), at(1));
            let wanted = crate::math::Point3::new(row[2], row[3], row[4]) / 1000.0;
            assert!(
                (point - wanted).norm() < 1e-9,
                "{name}: {point} is not {wanted}"
            );
        }
    }
}

#[test]
fn a_part_that_is_placed_three_times_is_nowhere_in_particular() {
    let read = read(&by_opencascade("placed_thrice.step"), Pick::First).unwrap();
    assert_eq!(read.left_out.placements, 3);
    assert!(
        read.left_out.to_string().contains("the 3 places"),
        "{}",
        read.left_out
    );
    mutations(&by_opencascade("placed_nested.step"), 91, |bytes| {
        let _ = super::read(bytes, Pick::First);
    });
}

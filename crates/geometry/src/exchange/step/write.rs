//! Writes one surface as an AP214 file: product, shape, a geometric set with the surface. Same
//! surface, same bytes.
//!
//! A geometric set needs no trimming curves, so nothing of the surface is cut at seams or poles;
//! OpenCASCADE makes one face of it. A face with edges would have to be trimmed along curves that a
//! reader may then heal.

use crate::exchange::number::real;
use crate::exchange::spline::{SplineError, Written, runs};
use crate::surface::Surface;
use crate::surface::file::Unit;
use std::fmt::Write as _;

/// Instances before the surface.
const SURFACE: usize = 21;

/// The file of a surface. In metres, reading it gives the same numbers bit for bit.
///
/// Which side is out has no place in the file: a closed surface is turned outwards when it is read,
/// an open one with `flip_normal` is written with u and v exchanged.
///
/// # Errors
/// A surface that comes apart at a knot.
pub fn write(surface: &Surface, unit: Unit) -> Result<String, SplineError> {
    let written = Written::new(surface)?;
    let mut out = String::with_capacity(4096 + 120 * written.points.len());
    let prefix = match unit {
        Unit::Metre => "$",
        Unit::Millimetre => ".MILLI.",
    };
    out.push_str("ISO-10303-21;\nHEADER;\nFILE_DESCRIPTION(('B-spline surface'),'2;1');\n");
    // A time would make two files of one surface differ.
    let version = env!("CARGO_PKG_VERSION");
    let _ = writeln!(
        out,
        "FILE_NAME('surface','1970-01-01T00:00:00',(''),(''),'palpate {version}','palpate {version}','');\n\
         FILE_SCHEMA(('AUTOMOTIVE_DESIGN {{ 1 0 10303 214 1 1 1 1 }}'));\nENDSEC;\nDATA;"
    );
    let _ = writeln!(
        out,
        "#1=APPLICATION_CONTEXT('core data for automotive mechanical design processes');\n\
         #2=APPLICATION_PROTOCOL_DEFINITION('international standard','automotive_design',2000,#1);\n\
         #3=PRODUCT_CONTEXT('',#1,'mechanical');\n\
         #4=PRODUCT('surface','surface','',(#3));\n\
         #5=PRODUCT_RELATED_PRODUCT_CATEGORY('part',$,(#4));\n\
         #6=PRODUCT_DEFINITION_FORMATION('','',#4);\n\
         #7=PRODUCT_DEFINITION_CONTEXT('part definition',#1,'design');\n\
         #8=PRODUCT_DEFINITION('design','',#6,#7);\n\
         #9=PRODUCT_DEFINITION_SHAPE('','',#8);\n\
         #10=(LENGTH_UNIT()NAMED_UNIT(*)SI_UNIT({prefix},.METRE.));\n\
         #11=(NAMED_UNIT(*)PLANE_ANGLE_UNIT()SI_UNIT($,.RADIAN.));\n\
         #12=(NAMED_UNIT(*)SI_UNIT($,.STERADIAN.)SOLID_ANGLE_UNIT());\n\
         #13=UNCERTAINTY_MEASURE_WITH_UNIT(LENGTH_MEASURE({uncertainty}),#10,'distance_accuracy_value','');\n\
         #14=(GEOMETRIC_REPRESENTATION_CONTEXT(3)GLOBAL_UNCERTAINTY_ASSIGNED_CONTEXT((#13))\
         GLOBAL_UNIT_ASSIGNED_CONTEXT((#10,#11,#12))REPRESENTATION_CONTEXT('',''));\n\
         #15=CARTESIAN_POINT('',(0.,0.,0.));\n\
         #16=DIRECTION('',(0.,0.,1.));\n\
         #17=DIRECTION('',(1.,0.,0.));\n\
         #18=AXIS2_PLACEMENT_3D('',#15,#16,#17);\n\
         #19=GEOMETRICALLY_BOUNDED_SURFACE_SHAPE_REPRESENTATION('',(#18,#20),#14);\n\
         #20=GEOMETRIC_SET('',(#{SURFACE}));",
        uncertainty = real(1e-9 * unit.per_metre(), 'E'),
    );
    let text = surface_text(&written, |k| format!("#{}", SURFACE + 2 + k));
    let _ = writeln!(out, "#{SURFACE}={text};");
    let _ = writeln!(
        out,
        "#{}=SHAPE_DEFINITION_REPRESENTATION(#9,#19);",
        SURFACE + 1
    );
    for (k, point) in written.points.iter().enumerate() {
        let [x, y, z] = [point.x, point.y, point.z].map(|x| real(x * unit.per_metre(), 'E'));
        let _ = writeln!(
            out,
            "#{}=CARTESIAN_POINT('',({x},{y},{z}));",
            SURFACE + 2 + k
        );
    }
    out.push_str("ENDSEC;\nEND-ISO-10303-21;\n");
    Ok(out)
}

/// A surface's entity, without its number. `point` is the reference to a control point.
pub(super) fn surface_text(written: &Written, point: impl Fn(usize) -> String) -> String {
    let [degree_u, degree_v] = written.degrees;
    let logical = |flag: bool| if flag { ".T." } else { ".F." };
    let points = grid(written.rows, written.columns, point);
    let common = format!(
        "{degree_u},{degree_v},{points},.UNSPECIFIED.,{},{},.U.",
        logical(written.closed[0]),
        logical(written.closed[1])
    );
    let [u, v] = [&written.knots[0], &written.knots[1]].map(|knots| runs(knots));
    let list = |values: Vec<String>| format!("({})", values.join(","));
    let times = |runs: &[(f64, u64)]| list(runs.iter().map(|run| run.1.to_string()).collect());
    let values = |runs: &[(f64, u64)]| list(runs.iter().map(|run| real(run.0, 'E')).collect());
    let knots = format!(
        "{},{},\n{},\n{},.UNSPECIFIED.",
        times(&u),
        times(&v),
        values(&u),
        values(&v)
    );
    match &written.weights {
        None => format!("B_SPLINE_SURFACE_WITH_KNOTS('',{common},\n{knots})"),
        Some(weights) => {
            let weights = grid(written.rows, written.columns, |k| real(weights[k], 'E'));
            // Parts of a complex instance stand in alphabetical order.
            format!(
                "(BOUNDED_SURFACE()B_SPLINE_SURFACE({common})\n\
                 B_SPLINE_SURFACE_WITH_KNOTS({knots})\n\
                 GEOMETRIC_REPRESENTATION_ITEM()RATIONAL_B_SPLINE_SURFACE({weights})\n\
                 REPRESENTATION_ITEM('')SURFACE())"
            )
        }
    }
}

/// `((…),(…))`, a row a line.
fn grid(rows: usize, columns: usize, cell: impl Fn(usize) -> String) -> String {
    let row = |i: usize| {
        (0..columns)
            .map(|j| cell(i * columns + j))
            .collect::<Vec<_>>()
            .join(",")
    };
    let rows: Vec<String> = (0..rows).map(|i| format!("\n({})", row(i))).collect();
    format!("({})", rows.join(","))
}

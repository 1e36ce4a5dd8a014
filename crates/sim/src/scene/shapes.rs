//! Tool shapes of a scene file.

use super::build::{SceneError, build_surface, error, inline_surface, unit};
use super::spec::{InlineMesh, MeshSpec, MeshUnit, ShapeSpec};
use palpate_geometry::contact::implicit::ImplicitShape;
use palpate_geometry::contact::mesh::MeshTool;
use palpate_geometry::contact::{SurfaceShape, ToolShape};
use palpate_geometry::exchange::{self, Format};
use palpate_geometry::math::Point3;
use palpate_geometry::surface::Mesh;
use palpate_geometry::surface::file::Unit;
use std::path::Path;

/// The shape a scene asks for; `path` names it in errors.
pub(super) fn build(
    spec: &ShapeSpec,
    path: &str,
    directory: &Path,
) -> Result<ToolShape, SceneError> {
    let implicit = |shape: ImplicitShape, reach_m: Option<f64>| {
        let tool = shape.compile().map_err(|e| error(path, e))?;
        Ok(ToolShape::Implicit {
            tool: Box::new(tool),
            reach_m,
        })
    };
    match spec {
        ShapeSpec::Point {} => Ok(ToolShape::Point),
        ShapeSpec::Sphere { radius_m } if radius_m.is_finite() && *radius_m > 0.0 => {
            Ok(ToolShape::Sphere {
                radius_m: *radius_m,
            })
        }
        ShapeSpec::Sphere { radius_m } => Err(error(
            format!("{path}.sphere.radius_m"),
            format!("{radius_m} is no radius; give metres above 0"),
        )),
        ShapeSpec::Plane { normal } => Ok(ToolShape::Plane {
            normal: unit(normal, &format!("{path}.plane.normal"))?,
        }),
        ShapeSpec::Surface(spec) => {
            let surface = build_surface(spec, &format!("{path}.surface"), directory)?;
            Ok(ToolShape::Surface(Box::new(SurfaceShape::new(surface))))
        }
        &ShapeSpec::Cylinder {
            radius_m,
            half_length_m,
        } => implicit(
            ImplicitShape::Cylinder {
                radius_m,
                half_length_m,
            },
            half_length_m.map(|half| libm::hypot(half, radius_m)),
        ),
        &ShapeSpec::Cone {
            half_angle_rad,
            height_m,
        } => {
            let reach_m = height_m / libm::cos(half_angle_rad);
            implicit(
                ImplicitShape::Cone {
                    half_angle_rad,
                    height_m,
                },
                Some(reach_m),
            )
        }
        &ShapeSpec::Ellipsoid { semi_axes_m } => {
            let reach_m = semi_axes_m.into_iter().fold(0.0, f64::max);
            implicit(ImplicitShape::Ellipsoid { semi_axes_m }, Some(reach_m))
        }
        &ShapeSpec::Torus {
            major_radius_m,
            minor_radius_m,
        } => implicit(
            ImplicitShape::Torus {
                major_radius_m,
                minor_radius_m,
            },
            Some(major_radius_m + minor_radius_m),
        ),
        &ShapeSpec::Box { half_extents_m } => {
            let reach_m = Point3::from(half_extents_m).coords.norm();
            implicit(ImplicitShape::Box { half_extents_m }, Some(reach_m))
        }
        ShapeSpec::Implicit { f, reach_m } => {
            if let Some(reach_m) =
                reach_m.filter(|reach_m| !(reach_m.is_finite() && *reach_m > 0.0))
            {
                let reason = format!("{reach_m} is no reach; give metres above 0, or leave it out");
                return Err(error(format!("{path}.implicit.reach_m"), reason));
            }
            let shape = ImplicitShape::Expression { text: f.clone() };
            let tool = shape
                .compile()
                .map_err(|e| error(format!("{path}.implicit.f"), e))?;
            Ok(ToolShape::Implicit {
                tool: Box::new(tool),
                reach_m: *reach_m,
            })
        }
        ShapeSpec::Mesh(spec) => {
            let path = format!("{path}.mesh");
            let (vertices, triangles) = match (&spec.file, &spec.inline) {
                (Some(_), None) => {
                    let mesh = read_mesh(spec, &path, directory)?;
                    (mesh.points, mesh.triangles)
                }
                (None, Some(mesh)) => (
                    mesh.vertices.iter().map(|&p| Point3::from(p)).collect(),
                    mesh.triangles.clone(),
                ),
                _ => return Err(error(path, "give exactly one of file, inline")),
            };
            let tool = MeshTool::new(&vertices, &triangles).map_err(|e| error(path, e))?;
            Ok(ToolShape::Mesh(Box::new(tool)))
        }
    }
}

/// Replaces files by what is in them.
pub(super) fn inline(spec: &mut ShapeSpec, path: &str, directory: &Path) -> Result<(), SceneError> {
    match spec {
        ShapeSpec::Surface(surface) => {
            inline_surface(surface, &format!("{path}.surface"), directory)
        }
        ShapeSpec::Mesh(mesh) if mesh.file.is_some() => {
            let read = read_mesh(mesh, &format!("{path}.mesh"), directory)?;
            let vertices = read.points.iter().map(|p| p.coords.into()).collect();
            let inline = Some(InlineMesh {
                vertices,
                triangles: read.triangles,
            });
            *mesh = MeshSpec {
                file: None,
                inline,
                unit: MeshUnit::M,
            };
            Ok(())
        }
        _ => Ok(()),
    }
}

fn read_mesh(spec: &MeshSpec, path: &str, directory: &Path) -> Result<Mesh, SceneError> {
    let Some(file) = &spec.file else {
        return Err(error(path, "give a file"));
    };
    let (path, full) = (format!("{path}.file"), directory.join(file));
    let unit = match spec.unit {
        MeshUnit::M => Unit::Metre,
        MeshUnit::Mm => Unit::Millimetre,
    };
    let bytes = std::fs::read(&full)
        .map_err(|e| error(&path, format!("cannot read {}: {e}", full.display())))?;
    Format::of(&full)
        .and_then(|format| exchange::read_mesh(&bytes, format, unit))
        .map_err(|e| error(&path, format!("{}: {e}", full.display())))
}

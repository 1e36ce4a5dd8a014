//! IGES 5.3: the rational B-spline surface, entity 128, read and written.
//!
//! ```text
//! 80-column lines ── sections: start, global, directory, parameters ──▶ read: one entity 128, its matrices 124, the
//!                                                                       unit of the global section ──▶ FileSurface
//! ```
//! The surface is taken whole, where what takes it over puts it: matrices of its face and solid (124) and a single place of its
//! subfigure (408) apply. Trimming (entities 144, 143, 510), what else is made of it (offsets, say), other faces and several
//! places are left out, which [`Imported::left_out`] says; parameter ranges
//! (the entity's last four values) that cut it are refused, since the surface would be larger than
//! what the file means.

mod error;
mod faces;
mod read;
mod sections;
mod uses;
mod write;
mod write_part;

pub use error::IgesError;
pub use write::write;
pub use write_part::{WritePartError, write_part};

use super::{Imported, Pick};
use crate::surface::Loaded;
use sections::File;
use uses::Uses;

/// The directory entries (odd numbers) of all B-spline surfaces of a file, ascending.
///
/// # Errors
/// Not an IGES file, cut short, or without such a surface.
pub fn surfaces(bytes: &[u8]) -> Result<Vec<u64>, IgesError> {
    read::find(&File::index(bytes)?)
}

/// Reads one surface of a file. A closed one is turned outwards.
///
/// # Errors
/// See [`IgesError`]; each says what is wrong and where.
pub fn read(bytes: &[u8], pick: Pick) -> Result<Imported, IgesError> {
    let file = File::index(bytes)?;
    let ids = read::find(&file)?;
    let Some(id) = pick.among(&ids) else {
        return Err(IgesError::NoSuch { pick, ids });
    };
    let entry = file.entry(id).ok_or(IgesError::NoSurface(file.count()))?;
    let (unit, uses) = (file.unit()?, Uses::of(&file, entry));
    let (values, ranges) = read::surface(&file, &uses.chain, &unit)?;
    let Loaded { surface, merged } = values
        .build()
        .map_err(|source| IgesError::Spline { id, source })?;
    for (direction, knots, (start, end)) in [
        ('u', surface.knots_u(), ranges[0]),
        ('v', surface.knots_v(), ranges[1]),
    ] {
        let domain = knots.domain();
        // Written with fewer digits than the knots, often: nine leave 5e-9. A period may be meant from any start.
        let slack = 1e-8 * knots.length();
        let whole = if knots.is_periodic() {
            end - start >= knots.length() - slack
        } else {
            start <= domain.0 + slack && end >= domain.1 - slack
        };
        if !whole {
            return Err(IgesError::Cut {
                id,
                direction,
                start,
                end,
                domain,
            });
        }
    }
    let surface = surface.oriented_outward();
    let left_out = faces::left_out(&file, &uses, &ids, &surface, &unit);
    Ok(Imported {
        surface,
        merged,
        id,
        count: ids.len(),
        unit,
        trim: None,
        left_out,
    })
}

#[cfg(test)]
mod tests;
#[cfg(test)]
mod uses_tests;

//! Contact forces: from contacts to the forces that couplings and bodies feel.
//!
//! ```text
//! proxy             a sphere held back by the surface as it stands
//! side              on which side of an open surface a point is
//! rows              a unilateral row for each contact, and for each surface sample inside the other party
//! delassus          C A⁻¹ Cᵀ: how the rows on one body move each other through it
//! matrix            D: how each row's force moves every other through all that gives way
//! complementarity   forces λ ≥ 0 with D λ + gap ≥ 0, by projected Gauss–Seidel
//! friction          the same for forces with three components: Coulomb's cone, grips
//! grip              what a tool holds on to while it grabs
//! hold              what holds a tool that only translates, exactly
//! solver            all of it for a tick
//! sharing, cones    how several rigid contacts of one tool share its force
//! ```

pub mod complementarity;
pub mod cones;
pub mod delassus;
pub mod friction;
pub mod grip;
pub mod hold;
pub mod indentation;
pub mod matrix;
pub mod proxy;
pub mod rigid_part;
pub mod row_key;
pub mod rows;
pub mod sharing;
pub mod side;
pub mod solver;

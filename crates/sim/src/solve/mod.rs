//! Contact forces: from contacts to the forces that couplings and bodies feel.
//!
//! ```text
//! proxy             a sphere held back by the surface as it stands
//! side              on which side of an open surface a point is
//! rows              a unilateral row for each contact, and for each surface sample inside the other party
//! delassus          C A⁻¹ Cᵀ: how the rows on one body move each other through it
//! matrix            D: how each row's force moves every other through all that gives way
//! friction          what a row's force may be: a push, Coulomb's cone, a grip
//! motions           free rigid bodies as unknowns: how rows load and follow them
//! problem           forces that keep the laws of all rows, by projected Gauss–Seidel
//! direct            the end of a solve with free rigid bodies: Newton's method in their motions
//! grip              what a tool holds on to while it grabs
//! hold              what holds a tool that only translates, exactly
//! sharing           how several rigid contacts of one tool share its force
//! solver            all of it for a tick
//! ```

pub mod delassus;
pub mod direct;
pub mod friction;
pub mod grip;
pub mod hold;
pub mod impacts;
pub mod indentation;
pub mod matrix;
pub mod motions;
pub mod problem;
pub mod proxy;
pub mod rigid_part;
pub mod row_key;
pub mod rows;
pub mod sharing;
pub mod side;
pub mod solver;

//! Copies that allocate nothing.

/// `Clone` of a struct whose `clone_from` hands on to that of each field, so that between values with as much room
/// nothing is allocated.
macro_rules! clone_in_place {
    ($type:ident { $($field:ident),* $(,)? }) => {
        impl Clone for $type {
            fn clone(&self) -> Self {
                let Self { $($field),* } = self;
                Self { $($field: $field.clone()),* }
            }

            fn clone_from(&mut self, from: &Self) {
                let Self { $($field),* } = self;
                $($field.clone_from(&from.$field);)*
            }
        }
    };
}

pub(crate) use clone_in_place;

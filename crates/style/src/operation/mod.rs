//! An operation of any kind, and the table of all kinds.

mod file;

use crate::operate::{AnyOperation, Kind, Operate};
use crate::operations::{
    Bend, Braid, Clump, Coil, Curl, Damping, Density, Dreadlock, Dye, Friction, Fringe, Frizz, Gradient,
    Grey, HairTie, Hand, Highlights, Hold, Length, Lift, Melanin, Noise, Part, Scissors, Smooth, Stiffness,
    Straighten, Strays, Streak, Sweep, Taper, Twist, Wander, Wave, Width,
};
use crate::stored::UnknownOperation;

macro_rules! operations {
    ($($name:ident),+ $(,)?) => {
        /// An operation of a style.
        #[derive(Clone, Debug, PartialEq)]
        pub enum Operation {
            $(
                #[doc = concat!("See [`", stringify!($name), "`].")]
                $name($name),
            )+
            /// An operation of another version, which does nothing.
            Unknown(UnknownOperation),
        }

        impl Operation {
            /// Every kind, in the order of menus.
            pub const KINDS: &'static [Kind] = &[$(<$name as Operate>::KIND),+];

            /// A new operation of the kind with that id.
            pub fn new(id: &str) -> Option<Self> {
                $(
                    if <$name as Operate>::KIND.id == id {
                        return Some(Self::$name($name::default()));
                    }
                )+
                None
            }

            /// The operation itself; `None` for one of another version.
            pub fn known(&self) -> Option<&dyn AnyOperation> {
                match self {
                    $(Self::$name(operation) => Some(operation),)+
                    Self::Unknown(_) => None,
                }
            }

            /// The same, to be changed.
            pub fn known_mut(&mut self) -> Option<&mut dyn AnyOperation> {
                match self {
                    $(Self::$name(operation) => Some(operation),)+
                    Self::Unknown(_) => None,
                }
            }
        }

        $(
            impl From<$name> for Operation {
                fn from(operation: $name) -> Self {
                    Self::$name(operation)
                }
            }
        )+
    };
}

// The table of operations, in the order of menus: each is a file or folder of `operations`.
operations!(
    Length, Scissors, Hand, Lift, Bend, Straighten, Smooth, Twist, Sweep, Part, Fringe, Wave, Noise, HairTie,
    Coil, Dreadlock, Braid, Clump, Curl, Frizz, Strays, Wander, Density, Width, Taper, Melanin, Dye,
    Gradient, Highlights, Grey, Streak, Stiffness, Hold, Damping, Friction
);

impl Operation {
    /// Its id in files.
    pub fn id(&self) -> &str {
        match self {
            Self::Unknown(unknown) => &unknown.id,
            known => known.known().map_or("", |operation| operation.kind().id),
        }
    }

    /// Its name in the window.
    pub fn label(&self) -> &str {
        match self {
            Self::Unknown(unknown) => &unknown.id,
            known => known.known().map_or("", |operation| operation.kind().label),
        }
    }

    /// The operation with every value in its range.
    #[must_use]
    pub fn clamped(&self) -> Self {
        let mut out = self.clone();
        if let Some(operation) = out.known_mut() {
            operation.settings_mut().clamp();
            for i in 0..operation.ramps().len() {
                *operation.ramp_mut(i) = operation.ramp(i).clamped();
            }
        }
        out
    }
}

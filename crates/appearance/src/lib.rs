//! The appearance of hair, without any drawing: how a fibre scatters light, how many fibres together do, and the light that comes
//! from all directions.

pub mod environment;
pub mod fibre;
